"""Atomic writing of files and folders, and reading that never waits for a pipe."""

from __future__ import annotations

import errno
import json
import math
import os
import re
import shutil
import stat
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import file_digest
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from stribeck.errors import needed
from stribeck.platforms import locked, refuse_open

if TYPE_CHECKING:
    import pyarrow

_LONGEST_NAME = 255  # letters of a file's name, the limit of common file systems


def write_with(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file atomically: ``write`` creates it under another name, and it is renamed. A failure leaves nothing behind.

    A link is kept, and its target is written. Devices and pipes such as /dev/stdout are written directly.
    """
    if path.exists() and not path.is_file() and not path.is_dir():
        write(path)
        return
    path = path.resolve()
    beside = path.with_name(f".{os.getpid()}-{os.urandom(4).hex()}.tmp")  # short, since the name itself may be long
    try:
        with _user_path_in_errors(beside, path):
            write(beside)
            beside.replace(path)
    except BaseException:
        with suppress(OSError):
            beside.unlink()
        raise


@contextmanager
def together(folder: Path, last: str = "summary.json", older: Mapping[str, str] | None = None) -> Iterator[Path]:
    """A temporary folder for the files of one result, which all move into ``folder`` if the block succeeds.

    The file ``last`` marks a complete result: it is removed first and moved last, so that it is never beside files of
    another run. On any failure, Ctrl-C included, the folder is unchanged. Remaining files of an older result are removed:
    those in the list of its summary.json, and those of ``older``.

    Args:
        folder: the folder of the result.
        last: name of the file that moves last.
        older: patterns of names, each with a regular expression for the beginning of the file's text.
    """
    existed = folder.exists()
    beside = folder / f".{os.getpid()}-{os.urandom(4).hex()}.tmp"
    try:
        with _user_path_in_errors(beside, folder):
            folder.mkdir(parents=True, exist_ok=True)
            beside.mkdir()
            state = folder.stat()
            yield beside
            files = {file.relative_to(beside) for file in beside.rglob("*") if file.is_file()}
            with locked(folder):
                if not beside.is_dir() or not os.path.samestat(state, folder.stat()):
                    raise OSError(errno.ESTALE, "was replaced by another folder meanwhile", str(folder))
                obsolete = (_summary_files(folder / last) | _older_files(folder, older or {})) - files
                if text := misplaced(folder, sorted({*files, *obsolete, Path(last)})):
                    raise OSError(errno.EISDIR, text, str(folder))
                for path in (folder / name for name in {*files, *obsolete, Path(last)}):
                    if path.is_file():
                        refuse_open(path)
                (folder / last).unlink(missing_ok=True)
                for name in obsolete:
                    (folder / name).unlink(missing_ok=True)
                for name in sorted(files, key=lambda name: (name == Path(last), name)):
                    (folder / name).parent.mkdir(parents=True, exist_ok=True)
                    (beside / name).replace(folder / name)
    finally:
        shutil.rmtree(beside, ignore_errors=True)
        if not existed:
            with suppress(OSError):  # not empty: the result is there
                folder.rmdir()


def _summary_files(summary: Path) -> set[Path]:
    """The files in the list of an older result's summary that are in its folder, relative to it."""
    try:
        files = [Path(name) for name in json_of(summary)["files"]]
        folder = next(path.parent for path in reversed(files) if path.name == summary.name)
    except (OSError, ValueError, KeyError, TypeError, StopIteration):
        return set()
    relative = {path.relative_to(folder) for path in files if path.is_relative_to(folder)}
    return {path for path in relative if ".." not in path.parts and (summary.parent / path).is_file()}


def _older_files(folder: Path, older: Mapping[str, str]) -> set[Path]:
    """The files of these names that a command wrote, by the beginning of their text."""
    return {
        path.relative_to(folder)
        for pattern, begin in older.items()
        for path in folder.glob(pattern)
        if re.match(begin, _head(path))
    }


def _head(path: Path) -> str:
    try:
        with open_file(path) as file:
            return file.read(1000).decode("utf-8", "replace")
    except OSError:
        return ""


@contextmanager
def _user_path_in_errors(beside: Path, path: Path) -> Iterator[None]:
    """A context in which errors contain the user's path instead of the temporary one."""
    try:
        yield
    except OSError as error:
        text = (error.strerror or str(error)).replace(str(beside), str(path)).replace(beside.name, path.name)
        name = str(error.filename or path).replace(str(beside), str(path))
        raise OSError(error.errno, text, name) from None


def misplaced(folder: Path, names: Iterable[str | Path]) -> str | None:
    """A message about a folder that stands in the place of one of these files, or None."""
    taken = next((name for name in names if (folder / name).is_dir()), None)
    return None if taken is None else f"{taken} in it is a folder; must be a file"


def trouble(path: Path, folder: bool = False, parents: bool = True) -> str | None:
    """Why a file (or, with ``folder``, a folder) cannot be written there, or None; nothing is created.

    ``parents``: missing parent folders will be created.
    """
    if not folder and os.path.islink(path):  # noqa: PTH114 (no error for too long a name)
        path, parents = Path(os.path.realpath(path)), False  # the link's target is written
    if any(len(part) > _LONGEST_NAME for part in path.parts):  # Windows reports such a file as not found
        return "cannot be written: File name too long"
    try:
        with suppress(FileNotFoundError, NotADirectoryError):
            mode = path.stat().st_mode
            if folder is not stat.S_ISDIR(mode):
                is_, must = ("file", "folder") if folder else ("folder", "file")
                text = f"is a {is_}; must be a {must} or a new name"
                return None if not folder and not stat.S_ISDIR(mode) else text
        ways = (path if folder else path.parent, *path.absolute().parents)
        existing = next((p for p in ways if os.path.lexists(p)), None)
        if existing is None:
            return f"there is no {path.absolute().anchor}"
        if not existing.is_dir():
            return f"{existing} is {'a link to nothing' if existing.is_symlink() else 'a file'}; must be a folder"
        if not parents and existing.absolute() != path.absolute().parent:
            return f"there is no folder {path.absolute().parent}"
        from tempfile import TemporaryFile

        with TemporaryFile(dir=existing):
            return None
    except (OSError, ValueError) as error:
        return f"cannot be written: {getattr(error, 'strerror', None) or error}"


def read_file(path: Path) -> bytes:
    """The content of a file.

    Raises:
        OSError: if it cannot be read, or is a device or a named pipe, for which reading would wait.
    """
    with open_file(path) as file:
        return file.read()


def json_of(path: Path) -> Any:
    """The data of a JSON file.

    Raises:
        OSError: as :func:`read_file`.
        ValueError: if it is not JSON, or is nested too deeply.
    """
    try:
        return json.loads(read_file(path))
    except RecursionError as error:
        raise ValueError(str(error)) from None


def open_file(path: Path) -> BinaryIO:
    """Open a file for reading.

    Raises:
        OSError: as :func:`read_file`.
    """
    return open(path, "rb", opener=_open_at_once)


def _open_at_once(path: str, flags: int) -> int:
    """Open for reading without waiting for a writer; pipes that a shell has opened (/dev/fd/63) are allowed."""
    if path.startswith(("/dev/fd/", "/dev/stdin", "/proc/self/fd/")):
        return os.open(path, flags)
    try:
        handle = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    except PermissionError:
        if os.path.isdir(path):  # noqa: PTH112 (Windows opens no folders)
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path) from None
        raise
    if not stat.S_ISREG(mode := os.fstat(handle).st_mode):
        os.close(handle)
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
        raise OSError(errno.EINVAL, "must be a file, not a pipe or a device", path)
    return handle


def seen_from(folder: Path, path: Path) -> str:
    """A path relative to a folder, so that both can be moved together; absolute if there is no relative path."""
    try:
        relative = os.path.relpath(path.absolute(), folder.absolute())
    except ValueError:  # on another drive of Windows
        relative = str(path.absolute())
    return Path(relative).as_posix()


def write_text(path: Path, text: str) -> None:
    """Write a text file in UTF-8; invalid characters, as in names of files, are escaped."""
    write_with(path, lambda beside: beside.write_bytes(text.encode("utf-8", "backslashreplace")))


def arrow_array(values: object, missing: bool = False) -> pyarrow.Array:
    """Values as an Arrow array, with ``missing`` nan as null; without pandas, whose import costs 0.2 s and 40 MB."""
    import numpy as np
    import pyarrow

    if not isinstance(values, np.ndarray) or values.dtype != np.float64:
        return pyarrow.array(np.asarray(values).tolist())
    mask = pyarrow.py_buffer(np.packbits(~np.isnan(values), bitorder="little").tobytes()) if missing else None
    buffer = pyarrow.py_buffer(np.ascontiguousarray(values))
    return pyarrow.Array.from_buffers(pyarrow.float64(), len(values), [mask, buffer])


def parquet_of(columns: Iterable[tuple[str, str, str, object]], about: Mapping[str, str] | None = None) -> bytes:
    """Columns of name, unit, meaning and values as a Parquet file, with text about all of them.

    Raises:
        MissingExtra: if pyarrow is not installed.
    """
    with needed("a Parquet file"):
        import pyarrow
        from pyarrow import parquet

    fields, arrays = [], []
    for name, unit, meaning, values in columns:
        arrays.append(arrow_array(values, missing=True))
        fields.append(pyarrow.field(name, arrays[-1].type, metadata={"unit": unit, "meaning": meaning}))
    sink = pyarrow.BufferOutputStream()
    table = pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields, metadata=about))
    parquet.write_table(table, sink, compression="zstd")
    return bytes(sink.getvalue())


def finite(data: object) -> Any:
    """The data with None for every number that is not finite, which JSON cannot represent."""
    if isinstance(data, dict):
        return {key: finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data


def sha256_of(path: Path) -> str:
    """The SHA-256 of a file's bytes, in hexadecimal."""
    with path.open("rb") as file:
        return file_digest(file, "sha256").hexdigest()


def write_json(path: Path, data: object) -> None:
    """Write data as indented JSON."""
    write_text(path, json.dumps(finite(data), indent=2, allow_nan=False) + "\n")


def write_summary(
    paths: list[Path],
    place: Path,
    folder: Path,
    summary: Mapping[str, object],
    more: Mapping[str, object] | None = None,
) -> list[str]:
    """Write summary.json in ``place``, with a list of all files; returns their paths in ``folder``.

    Args:
        paths: the files of the result in ``place``.
        place: the temporary folder of :func:`together`.
        folder: the folder of the result.
        summary: the data.
        more: data after the list of files.
    """
    files = [str(folder / path.name) for path in (*paths, place / "summary.json")]
    write_json(place / "summary.json", {**summary, "files": files, **(more or {})})
    return files
