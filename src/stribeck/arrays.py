"""The type of numeric arrays, and their conversion from Arrow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pyarrow

Array = NDArray[np.float64]


def of_arrow(column: pyarrow.Array) -> Array:
    """The numbers of an Arrow array in double precision, nan for missing ones.

    Arrow's own conversion imports pandas first, which takes a quarter of a second and ignores a Ctrl-C in that time.
    """
    column = column.cast("float64", safe=False)
    validity, data = column.buffers()
    values = np.frombuffer(data, float, len(column), 8 * column.offset).copy() if len(column) else np.empty(0)
    if column.null_count:
        bits = np.unpackbits(np.frombuffer(validity, np.uint8), bitorder="little")
        values[bits[column.offset : column.offset + len(column)] == 0] = np.nan
    return values


def distinct(x: Array) -> Array:
    """Each number once, in order. NumPy's unique imports numpy.ma at its first call: a tenth of a short command's time."""
    x = np.sort(x)
    first = np.ones(len(x), bool)
    first[1:] = x[1:] != x[:-1]
    return np.asarray(x[first])
