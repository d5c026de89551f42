"""Options that name the columns of a record, and what they say."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from stribeck.cli.shared import ADVANCED
from stribeck.constants import show as shown
from stribeck.errors import InputError, refuse_twice

if TYPE_CHECKING:
    from stribeck.identify.data.read import ColumnNames

Data = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="DATA...",
        help="Log: CSV, Parquet, MAT or NPZ; several files are several runs. With --logs a machine file.",
    ),
]
Time = Annotated[str | None, typer.Option("--time", metavar="COL", help="Column of the time.")]
Position = Annotated[str | None, typer.Option("--position", metavar="COL", help="Column of the position.")]
Velocity = Annotated[str | None, typer.Option("--velocity", metavar="COL", help="Column of the velocity.")]
Acceleration = Annotated[
    str | None,
    typer.Option("--acceleration", metavar="COL", rich_help_panel=ADVANCED, help="Column of the acceleration."),
]
Force = Annotated[
    str | None, typer.Option("--force", metavar="COL", help="Column of the driving force, torque or current.")
]
GainOrName = Annotated[
    str | None,
    typer.Option(
        "--force-gain",
        metavar="X",
        help="Force per unit of the force column, such as N/A; or a constant of the file; 1 unless given.",
    ),
]
Gain = Annotated[
    str | None,
    typer.Option("--force-gain", metavar="X", help="Force per unit of the force column; as in the fit unless given."),
]
Load = Annotated[
    str | None, typer.Option("--load", metavar="COL", rich_help_panel=ADVANCED, help="Column of the normal load.")
]
Pressure = Annotated[
    str | None, typer.Option("--pressure", metavar="COL", rich_help_panel=ADVANCED, help="Column of the pressure.")
]
Command = Annotated[
    str | None,
    typer.Option(
        "--command", metavar="COL", rich_help_panel=ADVANCED, help="Column of the drive's command (for --drive)."
    ),
]
Run = Annotated[
    str | None, typer.Option("--run", metavar="COL", rich_help_panel=ADVANCED, help="Column of the run number.")
]
Unit = Annotated[
    list[str] | None,
    typer.Option("--unit", metavar="COL=UNIT", help="Unit of a column; SI unless given; may be repeated."),
]
UnitOrSI = Annotated[
    list[str] | None, typer.Option("--unit", metavar="COL=UNIT", help="Unit of a column; SI unless given.")
]


def drive(text: str | None) -> dict[str, object] | None:
    """``KIND:KEY=VALUE,...`` as the table [drive] of a scenario; None where none is given.

    Raises:
        InputError: it is something else.
    """
    if text is None:
        return None
    from stribeck.scenario import parse_assignment

    kind, _, rest = text.partition(":")
    found: dict[str, object] = {"kind": kind}
    given = ["kind"]
    for part in filter(None, rest.split(",")):
        if "=" not in part:
            raise InputError(f"--drive: {text!r}: must be KIND or KIND:KEY=VALUE,...")
        name, found_value = parse_assignment(part)
        given.append(name)
        found[name] = float(found_value) if type(found_value) is int else found_value
    refuse_twice(given, f"--drive: {text!r}:")
    return found


def constants(assignments: list[str]) -> dict[str, float | str]:
    """``KEY=VALUE`` as a mapping."""
    from stribeck.scenario import parse_assignment

    found: dict[str, float | str] = {}
    given = [
        (path.removeprefix("law.").removeprefix("parameters."), x) for path, x in map(parse_assignment, assignments)
    ]
    refuse_twice([name for name, _ in given], "--set")
    for name, value in given:
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            raise InputError(f"--set {name}: {shown(value)}: must be a number or a word")
        found[name] = value if isinstance(value, str) else float(value)
    return found


def columns(names: dict[str, str | None], units: list[str], force_gain: str | None) -> ColumnNames:
    """The columns that options name, each by its role, and their units, each as ``COL=UNIT``."""
    from stribeck.identify.data.read import ColumnNames

    given = []
    for text in units:
        column, equals, unit = text.rpartition("=")
        if not equals or not column or not unit:
            raise InputError(f"--unit: {text!r}: must be COL=UNIT, such as pos=mm")
        given.append((column.strip(), unit.strip()))
    refuse_twice([column for column, _ in given], "--unit")
    return ColumnNames({role: name for role, name in names.items() if name is not None}, dict(given), force_gain)
