"""Raw columns of a recorded file: CSV, Parquet, MAT (v5 and v7.3) and NPZ, converted to SI."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from zipfile import is_zipfile

import numpy as np
from numpy.typing import NDArray

from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.identify.data.units import ROLES, factor, is_drive
from stribeck.parameter_sets import read_toml

Array = NDArray[np.float64]
_SCALARS = 1  # a variable of so many values is a constant of the file, not a column


@dataclass(frozen=True)
class Columns:
    """Which column of a file is what.

    Attributes:
        names: the column's name in the file by role: time, position, velocity, acceleration, force, load, pressure,
            command, run. The columns of a CSV file without a head are called 1, 2, 3, ...
        units: the unit of a column by its name; SI unless given.
        force_gain: force per unit of the force column: a number, or the name of a constant in the file.
    """

    names: dict[str, str] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    force_gain: float | str | None = None

    def over(self, other: Columns) -> Columns:
        """These where given, the other's elsewhere."""
        gain = self.force_gain if self.force_gain is not None else other.force_gain
        return Columns({**other.names, **self.names}, {**other.units, **self.units}, gain)


def beside(path: Path) -> Columns:
    """What the TOML file of the same name beside the data says: tables [columns] and [units], and force_gain."""
    return from_toml(path.with_suffix(".toml")) if path.with_suffix(".toml").is_file() else Columns()


def from_toml(path: Path) -> Columns:
    """The columns that a TOML file names.

    Raises:
        InputError: the file cannot be read or holds something else.
    """
    data = read_toml(path)
    problems = [
        f"{path}: {key}: unknown key{nearest(key, ('columns', 'units', 'force_gain'))} (known: columns, units, force_gain)"
        for key in data
        if key not in ("columns", "units", "force_gain")
    ]
    for table in ("columns", "units"):
        given = data.get(table, {})
        if not isinstance(given, dict) or not all(isinstance(v, str | int) for v in given.values()):
            problems.append(f"{path}: {table}: {show(given)}: must be a table of names")
        elif table == "columns":
            problems += [
                f"{path}: columns.{key}: unknown key{nearest(key, ROLES)} (known: {', '.join(ROLES)})"
                for key in given
                if key not in ROLES
            ]
    gain = data.get("force_gain")
    if gain is not None and not isinstance(gain, str | int | float):
        problems.append(f"{path}: force_gain: {show(gain)}: must be a number or the name of a constant in the data")
    if problems:
        raise InputError(problems)
    names, units = ({str(k): str(v) for k, v in data.get(table, {}).items()} for table in ("columns", "units"))
    return Columns(names, units, gain)


def read(path: Path, columns: Columns) -> dict[str, Array]:
    """The file's columns by role, in SI units, as long as each other; NaN where a cell is empty.

    Raises:
        InputError: the file or a column is not there, or holds no numbers; an unknown unit; a line for each problem.
    """
    import pyarrow

    path = Path(path)
    source = _open(path)
    columns = columns.over(beside(path))
    problems: list[str] = []
    if "time" not in columns.names:
        problems.append(f"--time: must be given, the name of the time column ({path} has {_list(source.names)})")
    if not {"position", "velocity"} & set(columns.names):
        problems.append(f"--position or --velocity: must be given (columns of {path}: {_list(source.names)})")
    if "force" not in columns.names:
        problems.append(f"--force: must be given, the column of the driving force ({path} has {_list(source.names)})")
    wanted = {}
    for role, name in columns.names.items():
        if name in source.names:
            wanted[role] = name
        else:
            guess = nearest(name, source.names) or f" (it has {_list(source.names)})"
            problems.append(f"--{role}: {name!r}: {path} has no such column{guess}")
    used = set(columns.names.values())
    problems += [
        f"--unit: {name!r}: no column of that name is used{nearest(name, used)}"
        for name in columns.units
        if name not in used
    ]
    factors: dict[str, float] = {}
    for role, name in wanted.items():
        try:
            factors[role] = factor(role, name, columns.units[name]) if name in columns.units else 1.0
        except InputError as error:
            problems += error.problems
    gain = _gain(columns, source, problems)
    if problems:
        raise InputError(problems)
    data = source.columns(wanted)
    pyarrow.default_memory_pool().release_unused()  # it would keep as much as the columns take
    lengths = {len(x) for x in data.values()}
    if len(lengths) > 1:
        raise InputError(
            [f"--{r}: {wanted[r]!r}: has {len(x)} rows, others of {path} have not" for r, x in data.items()]
        )
    factors["force"] *= gain
    for role, column in data.items():
        if factors[role] != 1.0:
            np.multiply(column, factors[role], out=column)
    return data


def _gain(columns: Columns, source: _Source, problems: list[str]) -> float:
    gain = columns.force_gain
    if gain is None:
        unit = columns.units.get(columns.names.get("force", ""), "N")
        if is_drive(unit):
            problems.append(f"--force-gain: must be given: the force column is in {unit}, not in N or N m")
        return 1.0
    if isinstance(gain, str):
        try:
            gain = float(gain)
        except ValueError:
            if gain not in source.constants:
                known = f" (it has {', '.join(source.constants)})" if source.constants else ""
                problems.append(f"--force-gain: {gain!r}: must be a number, or a constant in the file{known}")
                return 1.0
            gain = source.constants[gain]
    if not math.isfinite(gain) or gain == 0:
        problems.append(f"--force-gain: {show(gain)}: must be a finite number other than 0")
    return float(gain)


def _list(names: Sequence[str]) -> str:
    shown = ", ".join(names[:12])
    return f"{shown}, ..." if len(names) > 12 else shown or "none"


class _Source:
    """A file that is open: the names of its columns and constants, and the columns themselves."""

    def __init__(self, path: Path, variables: Mapping[str, Any]) -> None:
        self.path = path
        self.variables = {name: x for name, x in variables.items() if not name.startswith(("__", "#"))}
        sizes = {name: int(np.size(x)) for name, x in self.variables.items()}
        self.names = [name for name, size in sizes.items() if size > _SCALARS]
        self.constants = {
            name: float(np.ravel(x)[0])
            for name, x in self.variables.items()
            if sizes[name] == _SCALARS and np.asarray(x).dtype.kind in "fiu"
        }

    def columns(self, wanted: dict[str, str]) -> dict[str, Array]:
        """The columns by role, as arrays of their own."""
        problems, found = [], {}
        for role, name in wanted.items():
            column = np.asarray(
                self.variables.pop(name) if list(wanted.values()).count(name) == 1 else self.variables[name]
            )
            if column.dtype.kind not in "fiub":
                problems.append(f"--{role}: {name!r}: this column of {self.path} holds no numbers")
            elif column.ndim > 1 and max(column.shape) != column.size:
                problems.append(f"--{role}: {name!r}: this variable of {self.path} is a matrix, {column.shape}")
            else:
                own = column.base is None and column.dtype == np.float64 and list(wanted.values()).count(name) == 1
                found[role] = column.ravel() if own else np.array(column.ravel(), float)
        if problems:
            raise InputError(problems)
        return found


class _CsvSource(_Source):
    """A CSV file, read in blocks; separators , ; tab and space, with a head or without."""

    def __init__(self, path: Path) -> None:
        self.path = path
        with path.open("r", encoding="utf-8-sig", errors="replace") as file:
            first = file.readline()
            second = file.readline()
        if not first.strip():
            raise InputError(f"DATA: '{path}': is empty")
        if "\0" in first:
            raise InputError(f"DATA: '{path}': is not text in UTF-8")
        self.separator = max("\t;,", key=first.count)
        cells = [cell.strip().strip('"') for cell in first.rstrip("\r\n").split(self.separator)]
        self.head = not all(_is_number(cell) for cell in cells)
        if self.head and not second.strip():
            raise InputError(f"DATA: '{path}': has a head but no rows")
        self.names = cells if self.head else [str(i + 1) for i in range(len(cells))]
        self.constants = {}
        self.decimal = "," if self.separator != "," and "," in second and "." not in second else "."

    def columns(self, wanted: dict[str, str]) -> dict[str, Array]:
        import pyarrow
        from pyarrow import csv

        twice = [name for name in dict.fromkeys(wanted.values()) if self.names.count(name) > 1]
        if twice:
            raise InputError([f"DATA: '{self.path}': has column {name!r} more than once" for name in twice])
        include = list(dict.fromkeys(wanted.values()))
        # a column that is text in one block is read as text throughout, so that the first bad cell can be named
        options = csv.ConvertOptions(
            include_columns=include,
            column_types=dict.fromkeys(include, pyarrow.float64()),
            decimal_point=self.decimal,
        )
        try:
            reader = csv.open_csv(
                self.path,
                csv.ReadOptions(
                    column_names=self.names, skip_rows=int(self.head), block_size=1 << 20, use_threads=False
                ),
                csv.ParseOptions(delimiter=self.separator),
                options,
            )
            joined = {name: np.empty(0) for name in include}
            rows = 0
            for batch in reader:
                for name, column in joined.items():
                    if rows + len(batch) > len(column):  # grows in place: no second copy of a long column
                        column.resize(2 * rows + len(batch), refcheck=False)
                    column[rows : rows + len(batch)] = batch.column(name).to_numpy(zero_copy_only=False)
                rows += len(batch)
            for column in joined.values():
                column.resize(rows, refcheck=False)
        except (OSError, pyarrow.ArrowException) as error:
            raise InputError(self._reason(error)) from None
        return {
            role: joined[name] if list(wanted.values()).count(name) == 1 else joined[name].copy()
            for role, name in wanted.items()
        }

    def _reason(self, error: Exception) -> str:
        text = str(error).splitlines()[0]
        _, bad, rest = text.partition("invalid value ")
        if bad:
            column = text.partition("CSV column #")[2].partition(":")[0]
            name = self.names[int(column)] if column.isdigit() and int(column) < len(self.names) else column
            return f"DATA: '{self.path}': column {name!r} holds text: {rest}, not a number"
        return f"DATA: '{self.path}': cannot be read: {text}"


def _is_number(text: str) -> bool:
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True


def _parquet(path: Path) -> _Source:
    from pyarrow import parquet

    class Lazy(_Source):
        def __init__(self) -> None:
            self.path = path
            self.file = parquet.ParquetFile(path, pre_buffer=False)
            self.names = list(self.file.schema_arrow.names)
            self.constants = {}

        def columns(self, wanted: dict[str, str]) -> dict[str, Array]:
            names = list(dict.fromkeys(wanted.values()))
            rows, place = self.file.metadata.num_rows, 0
            self.variables = {}
            for batch in self.file.iter_batches(1 << 18, columns=names, use_threads=False):
                for name in names:
                    part = batch.column(name).to_numpy(zero_copy_only=False)
                    if part.dtype.kind not in "fiub":  # text, which the check below names
                        self.variables[name] = part
                        continue
                    self.variables.setdefault(name, np.empty(rows))[place : place + len(part)] = part
                place += len(batch)
            return super().columns(wanted)

    return Lazy()


def _mat(path: Path) -> _Source:
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        return _Source(path, loadmat(path))
    except NotImplementedError:  # MATLAB's 7.3 is HDF5
        return _Source(path, _hdf5(path))
    except (MatReadError, ValueError, TypeError) as error:
        raise InputError(f"DATA: '{path}': cannot be read as a MAT file: {error}") from None


def _hdf5(path: Path) -> dict[str, Any]:
    try:
        import h5py
    except ImportError:
        raise InputError(
            f"DATA: '{path}': a MAT file of version 7.3 needs h5py (pip install 'stribeck[mat]')"
        ) from None
    with h5py.File(path) as file:
        return {name: x[()] for name, x in file.items() if isinstance(x, h5py.Dataset) and x.dtype.kind in "fiu"}


def _npz(path: Path) -> _Source:
    if not is_zipfile(path):
        raise InputError(f"DATA: '{path}': is no NPZ file")
    with np.load(path, allow_pickle=False) as data:
        return _Source(path, dict(data))


_READERS = {".csv": _CsvSource, ".txt": _CsvSource, ".tsv": _CsvSource, ".parquet": _parquet, ".pq": _parquet,
            ".mat": _mat, ".npz": _npz}  # fmt: skip


def _open(path: Path) -> _Source:
    kind = path.suffix.lower()
    if kind not in _READERS:
        raise InputError(f"DATA: '{path}': must be a file .csv, .tsv, .txt, .parquet, .mat or .npz")
    try:
        if path.stat().st_size == 0:
            raise InputError(f"DATA: '{path}': is empty")
        return _READERS[kind](path)
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"DATA: '{path}': cannot be read: {error.strerror or error}") from None
    except Exception as error:  # a damaged file fails in as many ways as there are libraries
        raise InputError(f"DATA: '{path}': cannot be read: {str(error).splitlines()[0]}") from None
