"""Amplitude and period of a sustained oscillation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def amplitude_and_period(t: Array, y: Array) -> tuple[float, float]:
    """Half of peak to peak, and the mean time between crossings of the middle upwards, interpolated between rows.

    The period is nan where the middle is crossed upwards less than twice.
    """
    middle = 0.5 * (float(y.max()) + float(y.min()))
    over = y - middle
    up = np.flatnonzero((over[:-1] < 0) & (over[1:] >= 0))
    crossings = t[up] + (t[up + 1] - t[up]) * over[up] / (over[up] - over[up + 1])
    period = float(np.mean(np.diff(crossings))) if len(crossings) > 1 else float("nan")
    return 0.5 * float(np.ptp(y)), period


def first_maximum(y: Array) -> int:
    """The index of the first local maximum, of the last value where there is none."""
    falls = np.flatnonzero(np.diff(y) < 0)
    return int(falls[0]) if len(falls) else len(y) - 1
