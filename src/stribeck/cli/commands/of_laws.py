"""The commands about a law and its constants."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.shared import Json, Out, Trust, Undetermined, app


@app.command(epilog="Example: stribeck advise lugre_sobczyk --parameters canudas1995 --creep 1e-6")
def advise(
    law: Annotated[str, typer.Argument(metavar="LAW", help="A bristle law with k_v.")],
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="NAME or FILE", help="The machine's parameters.")
    ] = None,
    set_: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Another constant, such as z_ba=7e-6.")
    ] = None,
    creep: Annotated[float | None, typer.Option(help="Tolerated creep in m/s under a held load.")] = None,
    share: Annotated[float, typer.Option(help="That load, and presliding's, as a share of F_s.")] = 0.95,
    steady_error: Annotated[float | None, typer.Option(help="Tolerated relative error of friction at --speed.")] = None,
    speed: Annotated[float | None, typer.Option(help="That speed, m/s.")] = None,
    presliding_error: Annotated[
        float | None, typer.Option(help="Tolerated error of the presliding position, relative to its peak.")
    ] = None,
    force_rate: Annotated[float | None, typer.Option(help="The force's rate in presliding, N/s.")] = None,
    position_error: Annotated[
        float | None, typer.Option(help="Tolerated error of the position in --scenario, m.")
    ] = None,
    scenario: Annotated[Path | None, typer.Option(metavar="SCENARIO.toml", help="That scenario.")] = None,
    sample_time: Annotated[
        float | None, typer.Option(help="Step of the target, s: explicit Euler is to be stable with it.")
    ] = None,
    v_max: Annotated[float | None, typer.Option(help="Largest speed that matters, m/s; 100 v_s unless given.")] = None,
    mass: Annotated[float | None, typer.Option(help="Mass of the body, kg.")] = None,
    level: Annotated[
        str | None,
        typer.Option(metavar="LOW:HIGH", help="The largest v_d that keeps it passive while F_c and F_s vary so."),
    ] = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Which k_v? The smallest that meets what you tolerate, what it costs, and the same for the majorant law."""
    from stribeck.cli import advise as command

    tolerated = {
        "creep": creep, "share": share, "steady_error": steady_error, "speed": speed, "presliding_error": presliding_error,
        "force_rate": force_rate, "position_error": position_error, "scenario": scenario, "sample_time": sample_time,
        "v_max": v_max, "mass": mass, "level": level,
    }  # fmt: skip
    return command.advise(law, parameters, set_ or [], tolerated, out, json, trust)
