"""``stribeck export`` and its options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from stribeck.cli.shared import ADVANCED, ControllerName, Json, Trust, Undetermined, app, place

ExportTarget = Annotated[
    str,
    typer.Option(
        "--target",
        metavar="NAME",
        help="c, fmu, isaaclab, mjwarp, mujoco, mujoco_plugin, newton or table.",
    ),
]

ExportOut = Annotated[
    Path,
    typer.Option(
        "--out",
        metavar="PATH",
        parser=place,
        help="Where to: a folder for c, mujoco and mujoco_plugin, else a file.",
    ),
]

ExportPart = Annotated[
    str | None,
    typer.Option(
        "--part",
        metavar="PART",
        help="law, body, observer, controller, compensator or machine (of a machine unless given).",
    ),
]

ExportScenario = Annotated[
    Path | None,
    typer.Option(
        "--scenario",
        metavar="FILE",
        rich_help_panel=ADVANCED,
        help="A scenario: mass, controller, and law unless given.",
    ),
]

ExportContact = Annotated[
    str | None, typer.Option("--contact", metavar="NAME", help="The contact of a machine whose law it is.")
]

ExportStep = Annotated[
    float | None,
    typer.Option(
        "--step",
        metavar="S",
        rich_help_panel=ADVANCED,
        help="The time step that the tool will take: what is lost is said.",
    ),
]


@app.command(epilog="Example: stribeck export lugre --parameters canudas1995 --target c --out firmware")
def export(
    target: ExportTarget,
    out: ExportOut,
    law: Annotated[
        str | None,
        typer.Argument(
            metavar="LAW",
            help="The law, the scenario's unless given; FILE.py:NAME is one too. Or a scenario: MACHINE.toml.",
        ),
    ] = None,
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="SET", help="A built-in set of parameters, or a TOML file.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="A constant, such as k_v=1e7 (machine: links.gear.gap=0)."),
    ] = None,
    part: ExportPart = None,
    scenario: ExportScenario = None,
    contact: ExportContact = None,
    controller: ControllerName = None,
    step: ExportStep = None,
    self_test: Annotated[
        bool, typer.Option("--self-test", rich_help_panel=ADVANCED, help="With a program that checks the C.")
    ] = False,
    fmi: Annotated[int, typer.Option("--fmi", metavar="VERSION", help="Of an FMU: 3 or 2.")] = 3,
    platforms: Annotated[
        str,
        typer.Option(
            "--platforms",
            metavar="here|all",
            rich_help_panel=ADVANCED,
            help="Of an FMU's binaries; all: Windows and macOS too, which takes minutes at first.",
        ),
    ] = "here",
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Write a law or a compensator for another tool: C, FMU, MuJoCo and its kin, a table."""
    from stribeck.cli import export as command

    return command.export(
        law,
        target,
        out,
        parameters,
        set_ or [],
        part,
        scenario,
        contact,
        step,
        self_test,
        fmi,
        json,
        trust,
        controller,
        platforms,
    )
