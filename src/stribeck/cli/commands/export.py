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
        help="Folder for c, mujoco and mujoco_plugin; a file for other targets.",
    ),
]

ExportPart = Annotated[
    str | None,
    typer.Option(
        "--part",
        metavar="PART",
        help="law, body, observer, controller, compensator or machine; law unless given, of a machine file machine.",
    ),
]

ExportScenario = Annotated[
    Path | None,
    typer.Option(
        "--scenario",
        metavar="FILE",
        rich_help_panel=ADVANCED,
        help="Scenario that gives mass, controller, and the law unless LAW is given.",
    ),
]

ExportContact = Annotated[
    str | None, typer.Option("--contact", metavar="NAME", help="Contact of the machine whose friction is exported.")
]

ExportStep = Annotated[
    float | None,
    typer.Option(
        "--step",
        metavar="S",
        rich_help_panel=ADVANCED,
        help="Time step of the target (s); the loss of accuracy is reported.",
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
            help="Law, FILE.py:NAME, or a machine file; the scenario's law unless given.",
        ),
    ] = None,
    parameters: Annotated[
        str | None, typer.Option("--parameters", metavar="SET", help="Built-in parameter set or TOML file.")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option(
            "--set", metavar="KEY=VALUE", help="Set a constant, such as k_v=1e7 (of a machine: links.gear.gap=0)."
        ),
    ] = None,
    part: ExportPart = None,
    scenario: ExportScenario = None,
    contact: ExportContact = None,
    controller: ControllerName = None,
    step: ExportStep = None,
    self_test: Annotated[
        bool, typer.Option("--self-test", rich_help_panel=ADVANCED, help="Add a program that tests the C.")
    ] = False,
    fmi: Annotated[int, typer.Option("--fmi", metavar="VERSION", help="FMI version of an FMU: 3 or 2.")] = 3,
    platforms: Annotated[
        str,
        typer.Option(
            "--platforms",
            metavar="here|all",
            rich_help_panel=ADVANCED,
            help="Binaries of an FMU: here, or all for Windows and macOS too (takes minutes at first).",
        ),
    ] = "here",
    trust: Trust = False,
    json: Json = False,
    _undetermined: Undetermined = False,
) -> int:
    """Write a law, a controller or a machine for another tool: C, FMU, MuJoCo, Isaac Lab, Newton, a table."""
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
