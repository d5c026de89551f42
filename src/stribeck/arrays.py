"""The one type of array that numbers are kept in."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pyarrow

Array = NDArray[np.float64]


def of_arrow(column: pyarrow.Array) -> Array:
    """An Arrow array of numbers in double precision, nan where there is none. Arrow's own way reads pandas first, which takes
    a quarter of a second and swallows a Ctrl-C that comes meanwhile."""
    column = column.cast("float64", safe=False)
    there, held = column.buffers()
    found = np.frombuffer(held, float, len(column), 8 * column.offset).copy() if len(column) else np.empty(0)
    if column.null_count:
        bits = np.unpackbits(np.frombuffer(there, np.uint8), bitorder="little")
        found[bits[column.offset : column.offset + len(column)] == 0] = np.nan
    return found
