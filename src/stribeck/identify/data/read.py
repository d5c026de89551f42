"""The raw columns of a log by role, converted to SI."""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, arg, nearest
from stribeck.identify.data.units import ROLES, UNITS, factor, is_drive
from stribeck.parameter_sets import read_toml
from stribeck.recorded import Source, listed, no_column, opened


@dataclass(frozen=True)
class ColumnNames:
    """The roles of the columns of a file.

    Attributes:
        names: the column's name in the file by role: time, position, velocity, acceleration, force, load, pressure,
            command, run. The columns of a CSV file without a header are called 1, 2, 3, ...
        units: the unit of a column by its name; SI unless given.
        force_gain: force per unit of the force column: a number, or the name of a constant in the file.
    """

    names: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    force_gain: float | str | None = None

    def over(self, other: ColumnNames) -> ColumnNames:
        """These names, units and gain, completed by the other's."""
        gain = self.force_gain if self.force_gain is not None else other.force_gain
        return ColumnNames({**other.names, **self.names}, {**other.units, **self.units}, gain)


def beside(path: Path) -> ColumnNames:
    """The columns in the TOML file of the same name as the data: [columns], [units] and force_gain.

    A file with a schema is a scenario or a machine, and describes no log.

    Raises:
        InputError: the file cannot be read or holds something else.
    """
    path = path.with_suffix(".toml")
    data = read_toml(path) if path.is_file() else {}
    if "schema" in data:
        return ColumnNames()
    known, columns = ("columns", "units", "force_gain"), data.get("columns", {})
    problems = [
        f"{key}: unknown key{nearest(key, known)} (known: {', '.join(known)})" for key in data if key not in known
    ]
    for table in ("columns", "units"):
        names = data.get(table, {})
        if not isinstance(names, dict) or not all(isinstance(x, str | int) for x in names.values()):
            problems.append(f"{table}: {show(names)}: must be a table of names")
    strange = [key for key in columns if key not in ROLES] if isinstance(columns, dict) else []
    problems += [f"columns.{key}: unknown key{nearest(key, ROLES)} (known: {', '.join(ROLES)})" for key in strange]
    gain = data.get("force_gain")
    if gain is not None and not isinstance(gain, str | int | float):
        problems.append(f"force_gain: {show(gain)}: must be a number or the name of a constant in the data")
    if problems:
        raise InputError([f"{path}: {text}" for text in problems])
    names, units = ({str(k): str(x) for k, x in data.get(table, {}).items()} for table in ("columns", "units"))
    return ColumnNames(names, units, gain)


def named_in(source: Source, columns: ColumnNames, needs_force: bool = True) -> ColumnNames:
    """The columns of a file, completed by the TOML file beside it and then by the file's own row of units.

    If no column is named, those that are called like their role are taken, else those of them that a fit requires; a command
    only if it is named.
    """
    if isinstance(source.path, Path):
        columns = columns.over(beside(source.path))
    taken = set(UNITS) - {"command"}
    if columns.names:
        motion = {"position", "velocity"}
        taken = {"time", "force", *(motion if motion.isdisjoint(columns.names) else ())} if needs_force else {"time"}
    columns = columns.over(ColumnNames({role: role for role in UNITS if role in source.names and role in taken}))
    if not isinstance(source.path, Path):
        return columns
    stated = {
        name: unit
        for role, name in columns.names.items()
        if name not in columns.units and (unit := source.unit(name, UNITS[role]))
    }
    return columns.over(ColumnNames(units=stated))


def read(data: Any, columns: ColumnNames, needs_force: bool = True) -> dict[str, Array]:
    """The columns of a file or table by role, in SI units and of equal length; NaN for an empty cell.

    Args:
        data: a file or table.
        columns: the roles of its columns.
        needs_force: whether a force column is required.

    Raises:
        InputError: a file or column is missing or not numeric, or a unit is unknown; a line for each problem.
    """
    source = opened(data)
    return read_named(source, named_in(source, columns, needs_force), needs_force)


def read_named(source: Source, columns: ColumnNames, needs_force: bool = True) -> dict[str, Array]:
    """Like :func:`read`, for an open file or table whose columns :func:`named_in` has completed."""
    used, problems = set(columns.names.values()), _missing(columns, source, needs_force)
    wanted = {role: name for role, name in columns.names.items() if name in source.names}
    problems += [no_column(role, name, source) for role, name in columns.names.items() if role not in wanted]
    problems += [
        f"{arg('unit')}: {name!r}: no column of that name is used{nearest(name, used)}"
        for name in columns.units if name not in used
    ]  # fmt: skip
    factors: dict[str, float] = {}
    for role, name in wanted.items():
        try:
            factors[role] = factor(role, name, columns.units[name]) if name in columns.units else 1.0
        except InputError as error:
            problems += error.problems
    gain = _gain(columns, source, problems)
    if problems:
        raise InputError(problems)
    values = source.columns(wanted)
    if (arrow := sys.modules.get("pyarrow")) is not None:
        arrow.default_memory_pool().release_unused()  # else it keeps as much memory as the columns need
    if "force" in factors:
        factors["force"] *= gain
    for role, column in values.items():
        if not column.flags.writeable:  # a data frame's own memory
            values[role] = column = column.copy()
        if factors[role] != 1.0:
            with np.errstate(over="ignore"):
                np.multiply(column, factors[role], out=column)
        column[np.isinf(column)] = np.nan  # no measurement either
    return values


def _missing(columns: ColumnNames, source: Source, needs_force: bool) -> list[str]:
    """A message for each required column that is not named."""
    there, problems = f"({source.path} has {listed(source.names)})", []
    if "time" not in columns.names:
        problems.append(f"{arg('time')}: must be given, the name of the time column {there}")
    if needs_force and not {"position", "velocity"} & set(columns.names):
        problems.append(f"{arg('position')} or {arg('velocity')}: must be given {there}")
    if needs_force and "force" not in columns.names:
        problems.append(f"{arg('force')}: must be given, the column of the driving force {there}")
    return problems


def _gain(columns: ColumnNames, source: Source, problems: list[str]) -> float:
    gain = columns.force_gain
    if gain is None:
        unit = columns.units.get(columns.names.get("force", ""), "N")
        if is_drive(unit):
            problems.append(f"{arg('force_gain')}: must be given: the force column is in {unit}, not in N or N m")
        return 1.0
    if isinstance(gain, str):
        try:
            gain = float(gain)
        except ValueError:
            if gain not in source.constants:
                known = f" (it has {', '.join(source.constants)})" if source.constants else ""
                problems.append(f"{arg('force_gain')}: {gain!r}: must be a number, or a constant in the file{known}")
                return 1.0
            gain = source.constants[gain]
    if not math.isfinite(gain) or gain == 0:
        problems.append(f"{arg('force_gain')}: {show(gain)}: must be a finite number other than 0")
    return float(gain)
