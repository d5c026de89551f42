"""Files written beside and renamed, so that none is ever left half-written."""

from __future__ import annotations

import errno
import json
import math
import os
import stat
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from stribeck.errors import needed


def write_with(path: Path, write: Callable[[Path], Any]) -> None:
    """Have ``write`` make the file under another name, then rename it; on any failure nothing is left behind."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        write(beside)
        beside.replace(path)
    except BaseException:
        with suppress(OSError):
            beside.unlink()
        raise


def read_file(path: Path) -> bytes:
    """The content of a file.

    Raises:
        OSError: it cannot be read; or it is no file but a device or a pipe by name, which would be waited for.
    """
    with open(path, "rb", opener=_open_at_once) as file:
        return file.read()


def _open_at_once(path: str, flags: int) -> int:
    """Open for reading without waiting for a writer; pipes that a shell has opened (/dev/fd/63) are read as they are."""
    if path.startswith(("/dev/fd/", "/dev/stdin", "/proc/self/fd/")):
        return os.open(path, flags)
    handle = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    if not stat.S_ISREG(mode := os.fstat(handle).st_mode):
        os.close(handle)
        if stat.S_ISDIR(mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
        raise OSError(errno.EINVAL, "must be a file, not a pipe or a device", path)
    return handle


def write_text(path: Path, text: str) -> None:
    """Write a text file in UTF-8."""
    write_with(path, lambda beside: beside.write_text(text, encoding="utf-8"))


def arrow_array(values: Any) -> Any:
    """Values as an Arrow array; numbers without Arrow's way through pandas, whose import costs 0.2 s and 40 MB."""
    import numpy as np

    with needed("a Parquet file"):
        import pyarrow

    if not isinstance(values, np.ndarray) or values.dtype != np.float64:
        return pyarrow.array(list(values))
    buffer = pyarrow.py_buffer(np.ascontiguousarray(values))
    return pyarrow.Array.from_buffers(pyarrow.float64(), len(values), [None, buffer])


def write_columns(path: Path, columns: Mapping[str, Any]) -> None:
    """Columns of equal length as a Parquet file."""
    with needed("a Parquet file"):
        import pyarrow
        from pyarrow import parquet

    arrays = [arrow_array(values) for values in columns.values()]
    table = pyarrow.Table.from_arrays(arrays, names=list(columns))
    write_with(path, lambda beside: parquet.write_table(table, beside))


def finite(data: Any) -> Any:
    """The data with every number that is not finite replaced by None: JSON knows none of them."""
    if isinstance(data, dict):
        return {key: finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data


def write_json(path: Path, data: Any) -> None:
    """Write data as JSON for people and programs."""
    write_text(path, json.dumps(finite(data), indent=2, allow_nan=False) + "\n")
