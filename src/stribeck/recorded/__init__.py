"""Recorded tables: columns of numbers in CSV, Parquet, MAT (v5 and v7.3) and NPZ files, data frames and mappings."""

from __future__ import annotations

import csv
import io
import math
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from decimal import Decimal
from functools import partial
from importlib.util import find_spec
from itertools import islice
from numbers import Real
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck import platforms
from stribeck.arrays import Array, of_arrow
from stribeck.errors import InputError, StribeckError, arg, nearest, needed, note
from stribeck.recorded.layout import (
    MISSING,
    commas_twice,
    decimals_shown,
    encoding_of,
    is_blank,
    is_thousands,
    is_units,
    mark_of,
    number,
    split_cells,
    table_begins,
    thousands_without_mark,
)

Numbers = NDArray[Any]  # of any type

_WIDEST = 1000  # columns of a matrix: more are an image or a result, not signals
_NUMBERS = ("int", "uint", "float", "double", "halffloat", "decimal", "bool")  # Arrow's types that are numbers
_LINE_END = re.compile(r"\r\n?|\n")  # as readers of rows have it: other marks of Unicode are part of a line
_HEAD = 1 << 16  # bytes of an array's file in which its shape stands; NumPy takes heads of 10 000
_SCALARS = 1  # size of a variable that is a constant of the file, not a column


def is_table(data: object) -> bool:
    """Whether data is a table in memory: a data frame, or a mapping from names to arrays."""
    return isinstance(data, Mapping) or (hasattr(data, "columns") and hasattr(data, "__getitem__"))


def listed(names: Sequence[str]) -> str:
    """The first names of a table's columns, for messages."""
    shown = ", ".join(names[:12])
    return f"{shown}, ..." if len(names) > 12 else shown or "none"


def no_column(role: str, name: str, source: Source) -> str:
    """The message about a column that a table does not have."""
    if name in getattr(source, "variables", {}):  # a CSV file has none
        size = math.prod(source.shape_and_kind(name)[0])
        text = "is empty" if not size else "is one value, no column"
        return f"{arg(role)}: {name!r}: this variable of {source.path} {text}"
    guess = nearest(name, source.names) or f" (it has {listed(source.names)})"
    return f"{arg(role)}: {name!r}: {source.path} has no such column{guess}"


def opened_with(data: Any, wanted: Mapping[str, str]) -> Source:
    """An open file or table that has these columns; ``wanted`` has the column's name for each role.

    Raises:
        InputError: if the file cannot be read, or a column is missing; one line for each problem.
    """
    require_columns(source := opened(data), wanted)
    return source


def require_columns(source: Source, wanted: Mapping[str, str]) -> None:
    """Check that a source has the columns ``wanted``, names by role.

    Raises:
        InputError: a column is missing; one line for each.
    """
    if missing := [no_column(role, name, source) for role, name in wanted.items() if name not in source.names]:
        raise InputError(missing)


@dataclass(frozen=True)
class Later:
    """A variable of a file that is read at its first use.

    Attributes:
        shape, kind: as in NumPy's arrays and dtypes.
        read: reads its numbers.
        refused: the reason if its numbers are not in the file itself, or twice; empty otherwise.
    """

    shape: tuple[int, ...]
    kind: str
    read: Callable[[], Numbers]
    refused: str = ""


class Source:
    """An open file or table: the names of its columns, its constants, and the columns themselves.

    Each column of a matrix has a name: q[0], q[1], ...; time is along the matrix's longer side.
    """

    stated: Mapping[str, str] = {}  # units by column, where the file has a row of them

    def __init__(self, path: Path | str, variables: Mapping[str, Any]) -> None:
        self.path = path
        self.variables = {name: x for name, x in variables.items() if not name.startswith(("__", "#"))}
        stated = {name: self.shape_and_kind(name) for name in self.variables}
        shapes = {name: shape for name, (shape, _) in stated.items()}
        kinds = {name: kind for name, (_, kind) in stated.items()}
        self._parts = {  # the matrix and the column of each name
            f"{name}[{i}]": (name, i)
            for name, shape in shapes.items()
            if len(shape) == 2 and 1 < min(shape) <= _WIDEST and kinds[name] in "fiu"
            for i in range(min(shape))
        }
        sizes = {name: math.prod(shape) for name, shape in shapes.items()}
        self.names = [name for name, size in sizes.items() if size > _SCALARS] + list(self._parts)
        self.constants = {
            name: float(np.ravel(x.read() if isinstance(x, Later) else x)[0])
            for name, x in self.variables.items()
            if sizes[name] == _SCALARS and kinds[name] in "fiu" and not getattr(x, "refused", "")
        }

    def shape_and_kind(self, name: str) -> tuple[tuple[int, ...], str]:
        """A variable's shape and the kind of its numbers, for which it is not read."""
        x = self.variables[name]
        return (x.shape, x.kind) if isinstance(x, Later) else (np.shape(x), np.asarray(x).dtype.kind)

    def unit(self, name: str, known: Mapping[str, float]) -> str:
        """The unit that the file itself states of a column; empty if it states none, or none of those ``known``.

        A note says which word of a row of units is not used.
        """
        word = self.stated.get(name, "").strip("[]() ")
        if word and word not in known:
            note(
                f"'{self.path}': column {name!r}: {word!r} below its name is no unit of it: the numbers are read as in SI"
            )
        return word if word in known else ""

    def columns(self, wanted: dict[str, str], times: Mapping[str, str] | None = None) -> dict[str, Array]:
        """The columns by role, as separate arrays; empty cells are nan.

        Args:
            wanted: the column's name for each role.
            times: the role of a column's times, by its own role; the same for all of them, ``time``, unless given.

        Raises:
            InputError: before any is read: a column is in another file, holds no numbers, is a matrix, or is not as long as
                its times; they take more memory than is free; then: the file is damaged.
        """
        holders = {name: self._parts.get(name, (name, None))[0] for name in wanted.values()}
        if problems := [
            f"{arg(role)}: {name!r}: this column of {self.path} {x.refused}; must be in the file itself, whole and once"
            for role, name in wanted.items()
            if isinstance(x := self.variables[holders[name]], Later) and x.refused
        ]:
            raise InputError(problems)
        self._check_lengths(wanted, times)
        self._check_memory(
            math.prod(x.shape) for x in map(self.variables.get, set(holders.values())) if isinstance(x, Later)
        )
        columns = {}
        with _readable(self.path):
            arrays = {name: self._read(name) for name in set(holders.values())}
        if problems := [  # MAT files of version 5 list complex numbers as real ones
            self._no_numbers(role, name, "c") for role, name in wanted.items() if np.iscomplexobj(arrays[holders[name]])
        ]:
            raise InputError(problems)
        for role, name in wanted.items():
            matrix, i = self._parts.get(name, (name, None))
            column = arrays[matrix]
            if i is not None:
                column = column[:, i] if column.shape[0] >= column.shape[1] else column[i]
            shared = list(holders.values()).count(matrix) + list(wanted.values()).count(name) > 2
            columns[role] = column.ravel().astype(float, copy=shared or i is not None)
        return columns

    def _check_lengths(self, wanted: Mapping[str, str], times: Mapping[str, str] | None) -> None:
        """Check that each column is a vector of numbers, as long as its times, by what the file states of it.

        Raises:
            InputError: with a line for each that is not.
        """
        rows: dict[str, int] = {}
        problems = []
        for role, name in wanted.items():
            matrix, i = self._parts.get(name, (name, None))
            shape, kind = self.shape_and_kind(matrix)
            size = math.prod(shape)
            if kind not in "fiub":
                problems.append(self._no_numbers(role, name, kind))
            elif i is None and len(shape) > 1 and max(shape) != size:
                hint = f"; its columns are {name}[0], {name}[1], ..." if f"{name}[0]" in self.names else ""
                problems.append(f"{arg(role)}: {name!r}: this variable of {self.path} is a matrix, {shape}{hint}")
            else:
                rows[role] = size if i is None else max(shape)
        if times is None:
            times = dict.fromkeys(wanted, "time" if "time" in wanted else next(iter(wanted), ""))
        for role, time_role in times.items():
            if role in rows and time_role in rows and rows[role] != rows[time_role]:
                text = f"has {rows[role]} rows, its times ({wanted[time_role]}) have {rows[time_role]}"
                problems.append(f"{arg(role)}: {wanted[role]!r}: this column of {self.path} {text}")
        if problems:
            raise InputError(problems)

    def _no_numbers(self, role: str, name: str, kind: str) -> str:
        what = "complex numbers, not real ones" if kind == "c" else "text or dates, not numbers"
        return f"{arg(role)}: {name!r}: this column of {self.path} holds {what}"

    def _read(self, name: str) -> Numbers:
        x = self.variables[name]
        return np.asarray(x.read() if isinstance(x, Later) else x)

    def _check_memory(self, counts: Iterable[int]) -> None:
        """Check that numbers fit into memory before they are read.

        Raises:
            InputError: if they do not.
        """
        wanted, free = 8.0 * sum(counts), platforms.free_memory()
        if wanted > free:
            text = f"the columns take {platforms.size_of(wanted)}, and {platforms.size_of(free)} are free"
            raise InputError(f"{arg('data')}: '{self.path}': cannot be read: {text}")


@contextmanager
def _readable(path: Path | str) -> Iterator[None]:
    """A context in which any error of a library about a damaged file becomes an `InputError` of one line."""
    try:
        yield
    except StribeckError:
        raise
    except OSError as error:
        raise InputError(f"{arg('data')}: '{path}': cannot be read: {error.strerror or error}") from None
    except Exception as error:  # a damaged file fails in as many ways as there are libraries
        text = (str(error).splitlines() or [type(error).__name__])[0]
        raise InputError(f"{arg('data')}: '{path}': cannot be read: {text}") from None


def _check_unique(source: Source, wanted: Mapping[str, str]) -> None:
    if twice := [(role, name) for role, name in wanted.items() if source.names.count(name) > 1]:
        text = f"{source.path} has this column more than once; the name must be unique"
        raise InputError([f"{arg(role)}: {name!r}: {text}" for role, name in twice])


class CsvSource(Source):
    """A CSV file, read in blocks; with separators , ; or tab, decimal points or commas, with or without a head."""

    def __init__(self, path: Path) -> None:
        self.path, self.file = path, path
        self.encoding = encoding_of(path)
        with path.open("r", encoding=self.encoding, newline="") as file:
            text = file.read(1 << 16)  # so much because the first decimal comma may come late
            while text.count("\n") < 3 and (more := file.read(len(text))):  # a head of very many names
                text += more
        every = _LINE_END.split(text)
        places = [i for i, line in enumerate(every) if not is_blank(line)]
        lines = [every[i] for i in places]
        if not lines:
            raise InputError(f"{arg('data')}: '{path}': is empty")
        if "\0" in text:
            raise InputError(f"{arg('data')}: '{path}': is not text")
        begin, head, self.separator = table_begins(lines)
        first, second = lines[begin], "\n".join(lines[begin + 1 :])
        cells = [cell.strip().strip('"') for cell in split_cells(first, self.separator)]
        if head and not second:
            raise InputError(f"{arg('data')}: '{path}': has a head but no rows")
        rows = begin + int(head)
        if head and len(lines) > rows + 1 and is_units(lines[rows], self.separator, len(cells)):
            words = split_cells(lines[rows], self.separator)
            self.stated = dict(zip(cells, words, strict=True))
            rows += 1
        self.rows_from = places[rows - 1] + 1 if head else places[rows]
        while not every[self.rows_from].strip(" "):  # separators alone are a row, of missing numbers
            self.rows_from += 1
        self.names = cells if head else [str(i + 1) for i in range(len(cells))]
        widths = Counter(map(len, csv.reader(lines[rows:], delimiter=self.separator)))
        if head and max(widths, key=widths.__getitem__) == len(cells) + 1:  # of most rows: a few may have a fault
            self.names.append(str(len(cells) + 1))  # rows alone end in a separator
        if not head and begin and commas_twice(lines, begin):
            text = "decimal commas between columns that commas part: must be points, or semicolons between columns"
            raise InputError(f"{arg('data')}: '{path}': {text}")
        self.constants, self.quoted = {}, '"' in text
        self.decimal = "," if self.separator != "," and "," in second and "." not in second else "."

    def columns(self, wanted: dict[str, str], times: Mapping[str, str] | None = None) -> dict[str, Array]:
        """The columns by role, as separate arrays; all of them are equally long."""
        _check_unique(self, wanted)
        self._check_quotes()
        include = list(dict.fromkeys(wanted.values()))
        joined = self._by_arrow(include, wanted) if find_spec("pyarrow") else self._by_lines(include, wanted)
        if self.separator != "," and not any(map(decimals_shown, joined.values())):
            self._ask_about_thousands({name for name in include if not thousands_without_mark(joined[name])})
        return {
            role: joined[name] if list(wanted.values()).count(name) == 1 else joined[name].copy()
            for role, name in wanted.items()
        }

    def _check_quotes(self) -> None:
        """Refuse a file with a quote that is never closed, which would swallow the rows below it."""
        with self.file.open("r", encoding=self.encoding, errors="replace", newline="") as file:
            count = sum(part.count('"') for part in iter(lambda: file.read(1 << 20), ""))
            if count % 2 == 0:
                return
            file.seek(0)
            rows, begin = csv.reader(file, delimiter=self.separator, strict=True), 1
            try:
                for _ in rows:
                    begin = rows.line_num + 1
            except csv.Error:
                text = f"'{self.path}': cannot be read: row {begin} has a quote that is never closed"
                raise InputError(f"{arg('data')}: {text}") from None

    def _ask_about_thousands(self, columns: Collection[str]) -> None:
        """One note if the mark in these columns may be that of thousands, and no cell of the file shows what it is."""
        asked: dict[str, str] = {}
        with self.file.open("r", encoding=self.encoding, newline="") as file:
            lines = (line for line in islice(file, self.rows_from, None) if self.decimal in line)
            for row in csv.reader(lines, delimiter=self.separator):
                for name, cell in zip(self.names, row, strict=False):
                    if (mark := mark_of(cell, self.decimal)) == "decimals":
                        return
                    if mark == "either" and name in columns:
                        asked.setdefault(name, cell.strip())
        if asked:
            name, cell = next(iter(asked.items()))
            more = f", and so are others in {listed(list(asked)[1:])}" if len(asked) > 1 else ""
            text = (
                f"{cell!r} in column {name!r} is read as {cell.replace(',', '.')}, not as a number of thousands{more}"
            )
            note(f"'{self.path}': {text}: write such numbers without the mark if they are thousands")

    def _by_lines(self, include: list[str], wanted: dict[str, str]) -> dict[str, Array]:
        """The columns without pyarrow, which is some twenty times slower."""
        indices = {name: self.names.index(name) for name in include}
        columns: dict[str, list[float]] = {name: [] for name in include}
        with self.file.open("r", encoding=self.encoding, newline="") as file:
            for row, cells in enumerate(csv.reader(file, delimiter=self.separator), start=1):
                if row <= self.rows_from or not cells:
                    continue
                if len(cells) != len(self.names):
                    text = f"row {row} has {len(cells)} cells, not {len(self.names)}"
                    raise InputError(f"{arg('data')}: '{self.path}': cannot be read: {text}")
                for name, i in indices.items():
                    try:
                        columns[name].append(number(cells[i], self.decimal))
                    except ValueError:
                        raise InputError(self._text(name, f"'{cells[i].strip()}'", wanted, str(row))) from None
        return {name: np.array(values) for name, values in columns.items()}

    def _by_arrow(self, include: list[str], wanted: dict[str, str]) -> dict[str, Array]:
        import pyarrow
        from pyarrow import csv as arrow_csv

        # without given types, text in one block makes the whole column text; with them the error has the first bad cell
        options = arrow_csv.ConvertOptions(
            include_columns=include,
            column_types=dict.fromkeys(include, pyarrow.float64()),
            decimal_point=self.decimal,
            null_values=MISSING,
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
                arrow_csv.ParseOptions(delimiter=self.separator, newlines_in_values=self.quoted),
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
        if is_thousands(cell.strip("'"), self.separator):
            return f"{arg(role)}: column {name!r}: {cell}: must be written without the comma of thousands ({place})"
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
        from pyarrow import parquet, types

    class Columns(Source):
        def __init__(self) -> None:
            self.path, self.file = path, parquet.ParquetFile(path, pre_buffer=False)
            schema, rows = self.file.schema_arrow, self.file.metadata.num_rows
            self.names, self._parts, self.constants, self.variables = list(schema.names), {}, {}, {}
            if not rows:
                raise InputError(f"{arg('data')}: '{path}': has a head but no rows")
            for name, kind in zip(schema.names, schema.types, strict=True):
                kind = kind.value_type if types.is_dictionary(kind) else kind
                is_number = str(kind).startswith(_NUMBERS)
                self.variables[name] = Later((rows,), "f" if is_number else "O", partial(self._column, name))

        def columns(self, wanted: dict[str, str], times: Mapping[str, str] | None = None) -> dict[str, Array]:
            _check_unique(self, wanted)
            return super().columns(wanted, times)

        def _column(self, name: str) -> Numbers:
            parts = self.file.read(columns=[name], use_threads=False).column(0).chunks
            decoded = (part.dictionary_decode() if hasattr(part, "dictionary_decode") else part for part in parts)
            return np.concatenate([of_arrow(part) for part in decoded])

    return Columns()


def _mat(path: Path) -> Source:
    with needed("reading MAT files"):
        from scipy.io import loadmat, whosmat
        from scipy.io.matlab import MatReadError

    def read(name: str) -> Numbers:
        return np.asarray(loadmat(path, variable_names=[name])[name])

    try:
        listing = whosmat(path)
    except NotImplementedError:  # MATLAB's 7.3 is HDF5
        return Source(path, _hdf5(path))
    except (MatReadError, ValueError, TypeError) as error:
        raise InputError(f"{arg('data')}: '{path}': cannot be read as a MAT file: {error}") from None
    kinds = {"double": "f", "single": "f", "logical": "u", "char": "U"}
    variables = {}
    for name, shape, matlab_type in listing:
        kind = kinds.get(matlab_type, "i" if "int" in matlab_type else "O")
        variables[name] = Later(tuple(shape), kind, partial(read, name))
    return Source(path, variables)


def _hdf5(path: Path) -> dict[str, Later]:
    """The variables of a MAT file of version 7.3. Links, of which MATLAB writes none, are not followed.

    The file holds the transpose of what MATLAB shows, text as numbers, and the shape of an array in place of an empty one.
    """
    with needed("reading MAT files of version 7.3"):
        import h5py

    def read(name: str) -> Numbers:
        with h5py.File(path) as file:
            return np.asarray(file[name][()]).T

    def kind_of(x: h5py.Dataset) -> str:
        """The kind of its numbers; MATLAB's complex ones have two fields, and attributes say what is none."""
        if x.attrs.get("MATLAB_class", b"") in (b"char", b"cell"):
            return "O"
        return "c" if x.dtype.names == ("real", "imag") else str(x.dtype.kind)

    variables = {}
    with h5py.File(path) as file:
        for name in file:
            if not isinstance(name, str):  # bytes that are no text, which nobody can name
                continue
            link = file.get(name, getlink=True)
            if not isinstance(link, h5py.HardLink):
                outside = isinstance(link, h5py.ExternalLink)
                refused = "lies in another file (an external link)" if outside else f"is a link to {link.path!r}"
                variables[name] = Later((2,), "f", partial(read, name), refused)
            elif isinstance(x := file[name], h5py.Dataset):
                elsewhere = "a virtual dataset" if x.is_virtual else "external storage" if x.external else ""
                refused = f"lies in another file ({elsewhere})" if elsewhere else ""
                if not refused and x.size and x.id.get_space_status() != h5py.h5d.SPACE_STATUS_ALLOCATED:
                    refused = "has rows that were never written"
                empty = x.shape is None or "MATLAB_empty" in x.attrs
                variables[name] = Later((0,) if empty else x.shape[::-1], kind_of(x), partial(read, name), refused)
    return variables


def _npz(path: Path) -> Source:
    from zipfile import ZipFile, is_zipfile

    if not is_zipfile(path):
        raise InputError(f"{arg('data')}: '{path}': is no NPZ file")

    def read(name: str) -> Numbers:
        with np.load(path, allow_pickle=False) as data:
            return np.asarray(data[name])

    headers = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}
    variables = {}
    with ZipFile(path) as archive:
        for entry in archive.namelist():
            name, dot, _ = entry.rpartition(".npy")
            if not dot:
                continue
            with archive.open(entry) as file:
                head = io.BytesIO(file.read(_HEAD))
            version = np.lib.format.read_magic(head)
            if version not in headers:  # 3.0 is for tables with named fields, which are no columns
                continue
            shape, _, dtype = headers[version](head)
            twice = "is there twice" if name in variables else ""
            variables[name] = Later(shape, "O" if dtype.hasobject else dtype.kind, partial(read, name), twice)
    return Source(path, variables)


_READERS = {".csv": CsvSource, ".txt": CsvSource, ".tsv": CsvSource, ".dat": CsvSource, ".parquet": _parquet, ".pq": _parquet,
            ".mat": _mat, ".npz": _npz}  # fmt: skip


def opened(data: Any) -> Source:
    """Open a file, data frame or mapping; its columns are read later.

    Raises:
        InputError: if there is no such file, or it cannot be read.
    """
    if not is_table(data):
        return _open_path(Path(data))
    names = data.keys() if isinstance(data, Mapping) else getattr(data, "column_names", data.columns)
    with _readable("the table"):
        return Source("the table", {str(name): _as_array(data[name]) for name in names})


def _as_array(column: object) -> Numbers:
    """A column of a table in memory as an array; missing and masked values become nan."""
    if hasattr(column, "to_numpy") and str(getattr(column, "dtype", "")).startswith(("Int", "Float")):
        return np.asarray(column.to_numpy(dtype=float, na_value=np.nan))
    if isinstance(column, np.ma.MaskedArray) and column.dtype.kind in "fiub":
        return np.asarray(np.ma.filled(column.astype(float), np.nan))
    array = np.asarray(column)
    if array.dtype.kind != "O":
        return array
    missing = np.asarray(column.isna() if hasattr(column, "isna") else [x is None for x in array.flat], dtype=bool)
    if all(isinstance(x, (Real, Decimal)) for x in array.ravel()[~missing]):
        values = [math.nan if gone else _float(x) for x, gone in zip(array.flat, missing, strict=True)]
        return np.reshape(values, array.shape)
    return array


def _float(x: Real | Decimal) -> float:
    try:
        return float(x)
    except OverflowError:  # as 1e400 in a file
        return -math.inf if x < 0 else math.inf


def _open_path(path: Path) -> Source:
    kind = path.suffix.lower()
    with _readable(path):
        if path.is_dir():
            raise InputError(f"{arg('data')}: '{path}': cannot be read: it is a folder")
        if kind not in _READERS:
            raise InputError(f"{arg('data')}: '{path}': must be a file .csv, .tsv, .txt, .dat, .parquet, .mat or .npz")
        if path.exists() and not path.is_file():
            raise InputError(f"{arg('data')}: '{path}': cannot be read: must be a file, not a pipe or a device")
        if path.stat().st_size == 0:
            raise InputError(f"{arg('data')}: '{path}': is empty")
        return _READERS[kind](path)
