"""Options that name the columns of a record, and what they say."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from stribeck.cli.options import ADVANCED, setting
from stribeck.constants import show as shown
from stribeck.errors import InputError, read_pairs

Keywords = dict[str, Any]  # arguments of a function of the library
Data = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="DATA",
        help="Log: CSV, Parquet, MAT or NPZ; several files are several runs. With --logs a machine file.",
    ),
]


@dataclass(frozen=True)
class Columns:
    """The columns of a record by their roles, and their units."""

    time: Annotated[str | None, setting("--time", "COL", "Column of the time.")] = None
    position: Annotated[str | None, setting("--position", "COL", "Column of the position.")] = None
    velocity: Annotated[str | None, setting("--velocity", "COL", "Column of the velocity.")] = None
    force: Annotated[str | None, setting("--force", "COL", "Column of the driving force, torque or current.")] = None
    force_gain: Annotated[
        str | None,
        setting(
            "--force-gain",
            "X",
            "Force per unit of the force column (in N/A for a current): a number, or a name in the file; 1 unless given.",
        ),
    ] = None
    unit: Annotated[list[str] | None, setting("--unit", "COL=UNIT", "Unit of a column; SI unless given.")] = None
    load: Annotated[str | None, setting("--load", "COL", "Column of the normal load.", ADVANCED)] = None
    pressure: Annotated[str | None, setting("--pressure", "COL", "Column of the pressure.", ADVANCED)] = None

    def given(self) -> Keywords:
        """The same as arguments of :func:`stribeck.fit`: the columns by their roles, and units, each given as ``COL=UNIT``.

        Raises:
            InputError: a unit is something else, or is given twice.
        """
        names = {
            role: name for role, name in vars(self).items() if role not in ("force_gain", "unit") and name is not None
        }
        units = read_pairs(_unit, self.unit or [], "--unit")
        return {"columns": names, "unit": units, "force_gain": self.force_gain}


@dataclass(frozen=True)
class ColumnsOfALog(Columns):
    """The columns of a log that is fitted."""

    acceleration: Annotated[str | None, setting("--acceleration", "COL", "Column of the acceleration.", ADVANCED)] = (
        None
    )
    run: Annotated[str | None, setting("--run", "COL", "Column of the run number.", ADVANCED)] = None


@dataclass(frozen=True)
class ColumnsAsFitted(Columns):
    """The columns of a record that is predicted: as in the fit, unless given."""

    time: Annotated[
        str | None, setting("--time", "COL", "Column of the time; columns are as in the fit unless given.")
    ] = None
    force_gain: Annotated[
        str | None, setting("--force-gain", "X", "Force per unit of the force column; as in the fit unless given.")
    ] = None
    command: Annotated[
        str | None,
        setting("--command", "COL", "With --machine: column that drove the rig; replaces the file's signal.", ADVANCED),
    ] = None


def constants(assignments: list[str]) -> dict[str, float | str]:
    """``KEY=VALUE`` as a mapping."""
    return read_pairs(_constant, assignments, "--set")


def _constant(text: str) -> tuple[str, float | str]:
    from stribeck.scenario import parse_assignment

    path, value = parse_assignment(text)
    name = path.removeprefix("law.").removeprefix("parameters.")
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise InputError(f"--set {name}: {shown(value)}: must be a number or a word")
    return name, value if isinstance(value, str) else float(value)


def _unit(text: str) -> tuple[str, str]:
    column, equals, unit = text.rpartition("=")
    if not equals or not column or not unit:
        raise InputError(f"--unit: {text!r}: must be COL=UNIT, such as pos=mm")
    return column.strip(), unit.strip()
