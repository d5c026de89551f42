"""Zero-phase filters with MATLAB's conventions, in little memory for arrays of any length."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import signal
from scipy.interpolate import CubicSpline

from stribeck.arrays import Array
from stribeck.identify.log import MANY_ROWS

ORDER = 4  # of the Butterworth filter, as in the published procedure for least squares
HIGHEST = 0.4  # of the sampling rate: the highest cut-off; the edge of a digital filter is distorted nearer to one half
SETTLED = 5.0  # periods of the cut-off, at the start of a run, in which the filter settles
ASTRAY = 1.5  # periods of the cut-off, at the end of a run in motion, in which the filter's continuation is wrong
_STAGE = 13  # largest reduction by one Chebyshev filter of order 8, as MATLAB advises for decimate
_FORGOTTEN = 1e-10  # rest of a filter's state, or of a spline's end, where pieces meet: below the sensors' last bit
_ENDS = 1.2  # periods of the cut-off by which a run is continued: 5 % of an edge remains there


def zero_phase(b: Array, a: Array, x: Array, padding: int = 0) -> Array:
    """Filter forwards and backwards.

    The padding is MATLAB's, three times the order, or ``padding`` if that is more. Long arrays are filtered in overlapping
    pieces, so that no whole copy is needed.
    """
    padding = max(3 * (len(a) - 1), padding)
    if len(x) <= 2 * MANY_ROWS:
        return np.asarray(signal.filtfilt(b, a, x, padlen=min(padding, len(x) - 1)))
    slowest = float(np.max(abs(np.roots(a))))
    overlap = min(int(np.log(_FORGOTTEN) / np.log(slowest)) + padding, MANY_ROWS)
    out = np.empty(len(x))
    for first in range(0, len(x), MANY_ROWS):
        last = min(first + MANY_ROWS, len(x))
        low, high = max(first - overlap, 0), min(last + overlap, len(x))
        out[first:last] = signal.filtfilt(b, a, x[low:high], padlen=padding)[first - low : last - low]
    return out


_butterworth, _chebyshev = lru_cache(signal.butter), lru_cache(signal.cheby1)


def low_pass(x: Array, cutoff: float, step: float, order: int = ORDER) -> Array:
    """Zero-phase Butterworth filter; ``cutoff`` in Hz.

    The padding is at least 1.2 periods: MATLAB's 12 samples are too short for a cut-off far below the sampling rate.
    """
    return zero_phase(*_butterworth(order, 2 * cutoff * step), x, round(_ENDS / (cutoff * step)))


def stages(q: int) -> list[int]:
    """The factors of a reduction of the sampling rate, each at most 13."""
    parts = []
    while q > 1:
        parts.append(next(s for s in range(_STAGE, 1, -1) if q % s == 0))
        q //= parts[-1]
    return parts


def decimate(x: Array, q: int) -> Array:
    """Samples 1, 1 + q, 1 + 2 q, ... (counted from 0) after a Chebyshev filter of type 1 (order 8, 0.05 dB, 0.8/q)."""
    for part in stages(q):
        x = zero_phase(*_chebyshev(8, 0.05, 0.8 / part), x)[1::part]
    return x


def decimated_rows(count: int, q: int) -> NDArray[np.intp]:
    """The rows that :func:`decimate` keeps."""
    rows = np.arange(count)
    for part in stages(q):
        rows = rows[1::part]
    return rows


def spline_derivative(x: Array, step: float) -> Array:
    """dx/dt by a cubic spline, of fourth order; long arrays in overlapping pieces.

    At a tenth of the sampling rate the amplitude is 0.1 % too small; with central differences it is 6 % too small.
    """
    out = np.empty(len(x))
    overlap = int(-np.log(_FORGOTTEN) / np.log(2 + 3**0.5)) + 1  # each knot divides the effect of an end by 2 + sqrt(3)
    for first in range(0, len(x), MANY_ROWS):
        last = min(first + MANY_ROWS, len(x))
        low, high = max(first - overlap, 0), min(last + overlap, len(x))
        t = step * np.arange(high - low)
        out[first:last] = CubicSpline(t, x[low:high])(t[first - low : last - low], 1)
    return out


def slope(x: Array, step: float, spline: bool) -> Array:
    """dx/dt by a spline, or by central differences as in the published procedure for least squares."""
    return spline_derivative(x, step) if spline else np.asarray(np.gradient(x, step))
