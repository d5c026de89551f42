"""The commands that set a fitted model or a scenario against a measured record: ``predict`` and ``validate``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.shared import Json, Out, ScenarioFile, Set, Trust, app


@app.command(epilog="Example: stribeck predict another.csv --fit fit --out predicted")
def predict(
    data: Annotated[list[Path], typer.Argument(metavar="DATA...", help="A record that the fit has not seen.")],
    fit: Annotated[Path, typer.Option("--fit", metavar="DIR", help="The folder that stribeck fit --out wrote.")],
    time: Annotated[
        str | None, typer.Option("--time", metavar="COL", help="Columns: as in the fit unless given.")
    ] = None,
    position: Annotated[str | None, typer.Option("--position", metavar="COL")] = None,
    velocity: Annotated[str | None, typer.Option("--velocity", metavar="COL")] = None,
    force: Annotated[str | None, typer.Option("--force", metavar="COL")] = None,
    force_gain: Annotated[str | None, typer.Option("--force-gain", metavar="X")] = None,
    load: Annotated[str | None, typer.Option("--load", metavar="COL")] = None,
    pressure: Annotated[str | None, typer.Option("--pressure", metavar="COL")] = None,
    unit: Annotated[list[str] | None, typer.Option("--unit", metavar="COL=UNIT")] = None,
    cutoff: Annotated[float | None, typer.Option("--cutoff", metavar="HZ", help="Of the motion's filter.")] = None,
    out: Out = None,
    json: Json = False,
) -> int:
    """The force that a fitted model predicts for another record: error, overlay and page."""
    from stribeck.cli import fit as words
    from stribeck.cli import predict as command

    columns = {
        "time": time, "position": position, "velocity": velocity, "force": force, "load": load, "pressure": pressure,
    }  # fmt: skip
    given = {"columns": columns, "units": words.units(unit or []), "force_gain": force_gain, "cutoff": cutoff}
    return command.predict(data, fit, given, out, json)


@app.command(epilog="Example: stribeck validate rig.toml --log log.csv --time t --position y")
def validate(
    scenario: ScenarioFile,
    log: Annotated[Path, typer.Option("--log", metavar="FILE", help="The measured record.")],
    time: Annotated[str | None, typer.Option("--time", metavar="COL")] = None,
    position: Annotated[str | None, typer.Option("--position", metavar="COL", help="Compared with y.")] = None,
    velocity: Annotated[str | None, typer.Option("--velocity", metavar="COL", help="Compared with v.")] = None,
    force: Annotated[
        str | None, typer.Option("--force", metavar="COL", help="Measured friction, compared with F.")
    ] = None,
    force_gain: Annotated[str | None, typer.Option("--force-gain", metavar="X")] = None,
    command: Annotated[
        str | None,
        typer.Option("--command", metavar="COL", help="What drove the rig: it replaces the scenario's signal."),
    ] = None,
    unit: Annotated[list[str] | None, typer.Option("--unit", metavar="COL=UNIT")] = None,
    set_: Set = None,
    trust: Trust = False,
    out: Out = None,
    json: Json = False,
) -> int:
    """A scenario against a measured record: overlay, error, residuals."""
    from stribeck.cli import fit as words
    from stribeck.cli import predict as work

    columns = {"time": time, "position": position, "velocity": velocity, "force": force, "command": command}
    given = {"columns": columns, "units": words.units(unit or []), "force_gain": force_gain}
    return work.validate(scenario, log, given, set_ or [], out, json, trust)
