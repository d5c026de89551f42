"""Recorded tables: columns of numbers in CSV, Parquet, MAT (v5 and v7.3) and NPZ files, data frames and mappings."""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array, of_arrow
from stribeck.errors import InputError, StribeckError, arg, nearest, needed
from stribeck.table_layout import commas_twice, encoding_of, is_units, table_begins

_WIDEST = 1000  # columns of a matrix
_NUMBERS = ("int", "uint", "float", "double", "halffloat", "bool")  # Arrow's types that are numbers
_SCALARS = 1  # a variable of so many values is a constant of the file, not a column


def is_table(data: object) -> bool:
    """Whether data is a table in memory: a data frame, or a mapping of names to arrays."""
    return isinstance(data, Mapping) or (hasattr(data, "columns") and hasattr(data, "__getitem__"))


def listed(names: Sequence[str]) -> str:
    """The first names of a table's columns, for messages."""
    shown = ", ".join(names[:12])
    return f"{shown}, ..." if len(names) > 12 else shown or "none"


def no_column(role: str, name: str, source: Source) -> str:
    """The message about a column that a table does not have."""
    guess = nearest(name, source.names) or f" (it has {listed(source.names)})"
    return f"{arg(role)}: {name!r}: {source.path} has no such column{guess}"


def _matrix_columns(variables: Mapping[str, object]) -> dict[str, object]:
    """The columns of matrices as variables of their own: q[0], q[1], ...; time runs along the longer side."""
    found: dict[str, object] = {}
    for name, x in variables.items():
        if isinstance(x, np.ndarray) and x.ndim == 2 and min(x.shape) > 1 and x.dtype.kind in "fiu":
            columns = x if x.shape[0] >= x.shape[1] else x.T
            if columns.shape[1] <= _WIDEST:
                found |= {f"{name}[{i}]": columns[:, i] for i in range(columns.shape[1])}
    return found


def read_columns(data: Any, wanted: dict[str, str]) -> dict[str, Array]:
    """The columns of a file or table by role; ``wanted`` has the column's name for each role. Empty cells are NaN.

    Raises:
        InputError: the file cannot be read, or a column is not there or holds no numbers; a line for each problem.
    """
    source = opened(data)
    if missing := [no_column(role, name, source) for role, name in wanted.items() if name not in source.names]:
        raise InputError(missing)
    return source.columns(wanted)


class Source:
    """A file or table that is open: the names of its columns and constants, and the columns themselves."""

    def __init__(self, path: Path | str, variables: Mapping[str, Any]) -> None:
        self.path = path
        self.variables = {name: x for name, x in variables.items() if not name.startswith(("__", "#"))}
        self.variables |= _matrix_columns(self.variables)
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
                problems.append(f"{arg(role)}: {name!r}: this column of {self.path} holds text or dates, not numbers")
            elif column.ndim > 1 and max(column.shape) != column.size:
                hint = f"; its columns are {name}[0], {name}[1], ..." if f"{name}[0]" in self.names else ""
                problems.append(
                    f"{arg(role)}: {name!r}: this variable of {self.path} is a matrix, {column.shape}{hint}"
                )
            else:
                own = column.base is None and column.dtype == np.float64 and list(wanted.values()).count(name) == 1
                found[role] = column.ravel() if own else np.array(column.ravel(), float)
        if problems:
            raise InputError(problems)
        return found


def _once(source: Source, wanted: Mapping[str, str]) -> None:
    if twice := [(role, name) for role, name in wanted.items() if source.names.count(name) > 1]:
        text = f"{source.path} has this column more than once; the name must be unique"
        raise InputError([f"{arg(role)}: {name!r}: {text}" for role, name in twice])


class CsvSource(Source):
    """A CSV file, read in blocks; separators , ; and tab, decimal points or commas, with a head or without."""

    def __init__(self, path: Path) -> None:
        self.path, self.file = path, path
        self.encoding = encoding_of(path)
        with path.open("r", encoding=self.encoding, newline="") as file:
            text = file.read(1 << 16)  # whole numbers may come first: a decimal comma shows later
        if not text.strip():
            raise InputError(f"{arg('data')}: '{path}': is empty")
        if "\0" in text:
            raise InputError(f"{arg('data')}: '{path}': is not text")
        lines = text.splitlines()
        self.skipped, self.head, self.separator = table_begins(lines)
        first, second = lines[self.skipped], "\n".join(lines[self.skipped + 1 :])
        cells = [cell.strip().strip('"') for cell in first.split(self.separator)]
        if self.head and not second.strip():
            raise InputError(f"{arg('data')}: '{path}': has a head but no rows")
        self.rows_from = self.skipped + int(self.head)
        if (
            self.head
            and len(lines) > self.rows_from + 1
            and is_units(lines[self.rows_from], self.separator, len(cells))
        ):
            self.rows_from += 1  # a line of units below the names
        self.names = cells if self.head else [str(i + 1) for i in range(len(cells))]
        if self.head and len(lines[self.rows_from].split(self.separator)) == len(cells) + 1:
            self.names.append(str(len(cells) + 1))  # rows alone end in a separator
        if not self.head and self.skipped and commas_twice(lines, self.skipped):
            text = "decimal commas between columns that commas part: must be points, or semicolons between columns"
            raise InputError(f"{arg('data')}: '{path}': {text}")
        self.constants = {}
        self.decimal = "," if self.separator != "," and "," in second and "." not in second else "."

    def columns(self, wanted: dict[str, str]) -> dict[str, Array]:
        """The columns by role, as arrays of their own."""
        _once(self, wanted)
        include = list(dict.fromkeys(wanted.values()))
        joined = self._by_arrow(include, wanted) if find_spec("pyarrow") else self._by_lines(include, wanted)
        return {
            role: joined[name] if list(wanted.values()).count(name) == 1 else joined[name].copy()
            for role, name in wanted.items()
        }

    def _by_lines(self, include: list[str], wanted: dict[str, str]) -> dict[str, Array]:
        """The columns without pyarrow: some twenty times slower."""
        at = {name: self.names.index(name) for name in include}
        found: dict[str, list[float]] = {name: [] for name in include}
        with self.file.open("r", encoding=self.encoding, newline="") as file:
            for number, cells in enumerate(csv.reader(file, delimiter=self.separator), start=1):
                if number <= self.rows_from or not cells:
                    continue
                if len(cells) != len(self.names):
                    text = f"row {number} has {len(cells)} cells, not {len(self.names)}"
                    raise InputError(f"{arg('data')}: '{self.path}': cannot be read: {text}")
                for name, i in at.items():
                    cell = cells[i].strip()
                    try:
                        found[name].append(float((cell.replace(",", ".") if self.decimal == "," else cell) or "nan"))
                    except ValueError:
                        raise InputError(self._text(name, f"'{cell}'", wanted, str(number))) from None
        return {name: np.array(values) for name, values in found.items()}

    def _by_arrow(self, include: list[str], wanted: dict[str, str]) -> dict[str, Array]:
        import pyarrow
        from pyarrow import csv as arrow_csv

        # a column that is text in one block is read as text throughout, so that the first bad cell can be named
        options = arrow_csv.ConvertOptions(
            include_columns=include,
            column_types=dict.fromkeys(include, pyarrow.float64()),
            decimal_point=self.decimal,
        )
        try:
            reader = arrow_csv.open_csv(
                self.path,
                arrow_csv.ReadOptions(
                    column_names=self.names,
                    skip_rows=self.rows_from,
                    block_size=1 << 20,
                    use_threads=False,
                    encoding="utf8" if self.encoding == "utf-8-sig" else self.encoding,
                ),
                arrow_csv.ParseOptions(delimiter=self.separator),
                options,
            )
            joined = {name: np.empty(0) for name in include}
            rows = 0
            for batch in reader:
                for name, column in joined.items():
                    if rows + len(batch) > len(column):  # grows in place: no second copy of a long column
                        column.resize(2 * rows + len(batch), refcheck=False)
                    column[rows : rows + len(batch)] = of_arrow(batch.column(name))
                rows += len(batch)
            for column in joined.values():
                column.resize(rows, refcheck=False)
        except (OSError, pyarrow.ArrowException) as error:
            raise InputError(self._reason(error, wanted)) from None
        return joined

    def _text(self, name: str, cell: str, wanted: dict[str, str], row: str) -> str:
        role = next((role for role, column in wanted.items() if column == name), "data")
        place = f"{self.path}, row {row}" if row.isdigit() else self.path
        return f"{arg(role)}: column {name!r} holds text: {cell}, not numbers ({place})"

    def _reason(self, error: Exception, wanted: dict[str, str]) -> str:
        text = str(error).splitlines()[0]
        _, bad, rest = text.partition("invalid value ")
        if bad:
            column = text.partition("CSV column #")[2].partition(":")[0]
            name = self.names[int(column)] if column.isdigit() and int(column) < len(self.names) else column
            return self._text(name, rest, wanted, text.partition("Row #")[2].partition(":")[0])
        return f"{arg('data')}: '{self.path}': cannot be read: {text}"


def _parquet(path: Path) -> Source:
    with needed("reading Parquet files"):
        from pyarrow import ArrowException, parquet

    class Lazy(Source):
        def __init__(self) -> None:
            self.path = path
            self.file = parquet.ParquetFile(path, pre_buffer=False)
            self.names = list(self.file.schema_arrow.names)
            self.constants = {}
            if not self.file.metadata.num_rows:
                raise InputError(f"{arg('data')}: '{path}': has a head but no rows")

        def columns(self, wanted: dict[str, str]) -> dict[str, Array]:
            _once(self, wanted)
            try:
                self._read(list(dict.fromkeys(wanted.values())))
            except (OSError, ArrowException) as error:  # damaged behind the head
                text = (str(error).splitlines() or [type(error).__name__])[0]
                raise InputError(f"{arg('data')}: '{path}': cannot be read: {text}") from None
            return super().columns(wanted)

        def _read(self, names: list[str]) -> None:
            rows, place = self.file.metadata.num_rows, 0
            self.variables = {}
            for batch in self.file.iter_batches(1 << 18, columns=names, use_threads=False):
                for name in names:
                    part = batch.column(name)
                    part = part.dictionary_decode() if hasattr(part, "dictionary_decode") else part
                    if not str(part.type).startswith(_NUMBERS):  # text, which the check below names
                        self.variables[name] = part.to_numpy(zero_copy_only=False)
                        continue
                    self.variables.setdefault(name, np.empty(rows))[place : place + len(part)] = of_arrow(part)
                place += len(batch)

    return Lazy()


def _mat(path: Path) -> Source:
    with needed("reading MAT files"):
        from scipy.io import loadmat
        from scipy.io.matlab import MatReadError

    try:
        return Source(path, loadmat(path))
    except NotImplementedError:  # MATLAB's 7.3 is HDF5
        return Source(path, _hdf5(path))
    except (MatReadError, ValueError, TypeError) as error:
        raise InputError(f"{arg('data')}: '{path}': cannot be read as a MAT file: {error}") from None


def _hdf5(path: Path) -> dict[str, object]:
    with needed("reading MAT files of version 7.3"):
        import h5py
    with h5py.File(path) as file:
        return {name: x[()] for name, x in file.items() if isinstance(x, h5py.Dataset) and x.dtype.kind in "fiu"}


def _npz(path: Path) -> Source:
    from zipfile import is_zipfile

    if not is_zipfile(path):
        raise InputError(f"{arg('data')}: '{path}': is no NPZ file")
    with np.load(path, allow_pickle=False) as data:
        return Source(path, dict(data))


_READERS = {".csv": CsvSource, ".txt": CsvSource, ".tsv": CsvSource, ".dat": CsvSource, ".parquet": _parquet, ".pq": _parquet,
            ".mat": _mat, ".npz": _npz}  # fmt: skip


def opened(data: Any) -> Source:
    """The file, data frame or mapping, its columns not read yet.

    Raises:
        InputError: there is no such file, or it cannot be read.
    """
    if not is_table(data):
        return _file(Path(data))
    names = data.keys() if isinstance(data, Mapping) else data.columns
    return Source("the table", {str(name): _plain(data[name]) for name in names})


def _plain(column: object) -> NDArray[Any]:
    """A column of a data frame as an array; pandas' own missing values are NaN."""
    if hasattr(column, "to_numpy") and str(getattr(column, "dtype", "")).startswith(("Int", "Float")):
        return np.asarray(column.to_numpy(dtype=float, na_value=np.nan))
    return np.asarray(column)


def _file(path: Path) -> Source:
    kind = path.suffix.lower()
    try:
        if path.is_dir():
            raise InputError(f"{arg('data')}: '{path}': cannot be read: it is a folder")
        if kind not in _READERS:
            raise InputError(f"{arg('data')}: '{path}': must be a file .csv, .tsv, .txt, .dat, .parquet, .mat or .npz")
        if path.exists() and not path.is_file():
            raise InputError(f"{arg('data')}: '{path}': cannot be read: must be a file, not a pipe or a device")
        if path.stat().st_size == 0:
            raise InputError(f"{arg('data')}: '{path}': is empty")
        return _READERS[kind](path)
    except StribeckError:
        raise
    except OSError as error:
        raise InputError(f"{arg('data')}: '{path}': cannot be read: {error.strerror or error}") from None
    except Exception as error:  # a damaged file fails in as many ways as there are libraries
        raise InputError(
            f"{arg('data')}: '{path}': cannot be read: {(str(error).splitlines() or [type(error).__name__])[0]}"
        ) from None
