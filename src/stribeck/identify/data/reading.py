"""Reads a log from files or tables, and keeps how it was read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.constants import kind_of, show
from stribeck.errors import InputError, arg, nearest
from stribeck.identify.data.prepare import Preparation, load_log
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.data.units import ROLES
from stribeck.identify.log import Log
from stribeck.recorded import is_table

Data = Any  # a path, a Log, a data frame or mapping of columns, or a sequence of paths or frames


@dataclass(frozen=True)
class RecordReading:
    """How a log was read: its files, if it is from files, what the user said of its columns, and the preparation."""

    files: tuple[str, ...] = ()
    named: ColumnNames = field(default_factory=ColumnNames)
    how: Preparation = field(default_factory=Preparation)

    @property
    def title(self) -> str:
        """The file's name, or how many there are."""
        if not self.files:
            return "the record"
        return Path(self.files[0]).name if len(self.files) == 1 else f"{len(self.files)} files"


def files_of(data: Data) -> tuple[str, ...]:
    """The files of a record that is from files."""
    sources = data if isinstance(data, list | tuple) else [data]
    return tuple(str(Path(each).resolve()) for each in sources if isinstance(each, str | Path))


def read_log(data: Data, columns: ColumnNames, how: Preparation | None = None) -> Log:
    """The log in files or tables of one layout, in SI units, ready to be fitted; a log as it is.

    Raises:
        InputError: a file cannot be read, a column is missing or has no unit; one line for each problem.
    """
    names, how = {role: x for role, x in columns.names.items() if x is not None}, how or Preparation()
    columns = replace(columns, names=names)
    if unknown := [n for n in names if n not in ROLES]:
        raise InputError([f"{n}: {show(names[n])}: unknown argument{nearest(n, ROLES)}" for n in unknown])
    if wrong := [n for n, x in names.items() if not isinstance(x, str)]:
        text = "must be the name of a column, not"
        raise InputError([f"{arg(n)}: {show(names[n])}: {text} {kind_of(names[n])}" for n in wrong])
    if isinstance(data, Log):
        asked = {**names, "unit": columns.units or None, "force_gain": columns.force_gain, "cutoff": how.cutoff}
        if given := [name for name, value in asked.items() if value is not None]:
            raise InputError(
                [f"{arg(n)}: {show(asked[n])}: is for columns of a file; a Log is taken as it is" for n in given]
            )
        return data
    several = isinstance(data, Iterable) and not (is_table(data) or isinstance(data, str | bytes | np.ndarray))
    sources = list(data) if several else [data]
    if not sources:
        raise InputError(f"{arg('data')}: missing: must be a file, a table or several of these")
    for i, each in enumerate(sources):
        if not (isinstance(each, str | Path) or is_table(each)):
            name = arg("data") + (f"[{i}]" if several else "")
            raise InputError(f"{name}: {show(each)}: must be a file, a table or several of these, not {kind_of(each)}")
    return load_log(sources, columns, how)
