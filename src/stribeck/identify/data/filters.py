"""Zero-phase filters in MATLAB's conventions, on arrays of any length within little memory."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import signal
from scipy.interpolate import CubicSpline

from stribeck.arrays import Array
from stribeck.identify.log import MANY_ROWS

ORDER = 4  # of the Butterworth filter, as in the published procedure for least squares
HIGHEST = 0.4  # of the sampling rate: the highest cut-off; nearer to half of it a digital filter's edge is squeezed
SETTLED = 5.0  # periods of the cut-off at the start of a run, in which a filter is not settled
ASTRAY = 1.5  # periods of the cut-off at the end of a run in motion: there the filter continues the motion wrongly
_STAGE = 13  # the most that one Chebyshev filter of order 8 reduces the rate by, as MATLAB advises for its decimate
_FORGOTTEN = 1e-10  # what is left of a filter's state where pieces meet: below the sensors' last bit
_KNOTS = 32  # of a cubic spline, behind which an end is forgotten to rounding: each takes a factor of 2 + sqrt(3)
_ENDS = 1.2  # periods of the cut-off that a run is continued by: a twentieth of an edge is left there


class Filter(NamedTuple):
    """Coefficients of a filter, and its state behind a constant input of 1."""

    b: Array
    a: Array
    settled: Array


def zero_phase(filter: Filter, x: Array, padding: int = 0) -> Array:
    """There and back with MATLAB's padding, 3 (order), or more; long arrays in overlapping pieces, so that no copy is as long;
    the rows of a matrix each by itself."""
    padding = max(3 * len(filter.settled), padding)
    if x.ndim > 1 or len(x) <= 2 * MANY_ROWS:
        return _there_and_back(filter, x, min(padding, x.shape[-1] - 1))
    slowest = float(np.max(abs(np.roots(filter.a))))
    overlap = min(int(np.log(_FORGOTTEN) / np.log(slowest)) + padding, MANY_ROWS)
    out = np.empty(len(x))
    for first in range(0, len(x), MANY_ROWS):
        last = min(first + MANY_ROWS, len(x))
        low, high = max(first - overlap, 0), min(last + overlap, len(x))
        out[first:last] = _there_and_back(filter, x[low:high], padding)[first - low : last - low]
    return out


def _there_and_back(filter: Filter, x: Array, padding: int) -> Array:
    """SciPy's filtfilt, but for the filter's settled state, which that finds anew at each call."""
    ends = 2 * x[..., :1] - x[..., padding:0:-1], 2 * x[..., -1:] - x[..., -2 : -padding - 2 : -1]
    out = np.concatenate([ends[0], x, ends[1]], axis=-1)
    for _ in range(2):
        out = signal.lfilter(filter.b, filter.a, out, zi=filter.settled * out[..., :1])[0][..., ::-1]
    return np.asarray(out[..., padding : out.shape[-1] - padding])


def _settled(b: Array, a: Array) -> Filter:
    return Filter(b, a, signal.lfilter_zi(b, a))


@lru_cache
def _butterworth(order: int, share: float) -> Filter:
    """With its cut-off as a share of half the sampling rate."""
    return _settled(*signal.butter(order, share))


def low_pass(x: Array, cutoff: float, step: float, order: int = ORDER) -> Array:
    """Butterworth at ``cutoff`` Hz, there and back.

    MATLAB's padding of 12 samples is too short for a cut-off far below the sampling rate: it is 1.2 periods at least.
    """
    return zero_phase(_butterworth(order, 2 * cutoff * step), x, round(_ENDS / (cutoff * step)))


def stages(q: int) -> list[int]:
    """A reduction of the rate as a product of small ones."""
    parts = []
    while q > 1:
        parts.append(next(s for s in range(_STAGE, 1, -1) if q % s == 0))
        q //= parts[-1]
    return parts


@lru_cache
def _anti_alias(q: int) -> Filter:
    return _settled(*signal.cheby1(8, 0.05, 0.8 / q))


def decimate(x: Array, q: int) -> Array:
    """Samples 1, 1 + q, 1 + 2 q, ... (from 0) behind a Chebyshev filter of type 1 (order 8, 0.05 dB, 0.8/q)."""
    for part in stages(q):
        x = zero_phase(_anti_alias(part), x)[..., 1::part].copy()  # and not a view, which would hold all of it
    return x


def decimated_rows(count: int, q: int) -> NDArray[np.intp]:
    """The rows that :func:`decimate` keeps."""
    rows = np.arange(count)
    for part in stages(q):
        rows = rows[1::part]
    return rows


def spline_derivative(x: Array, step: float) -> Array:
    """dx/dt by a cubic spline, whose error is of the fourth order: what moves at a tenth of the sampling rate comes out
    0.1 % too small, where central differences lose 6 %. A long one in overlapping pieces."""
    if len(x) < 4:
        return np.asarray(np.gradient(x, step))
    out = np.empty(len(x))
    for first in range(0, len(x), MANY_ROWS):
        last = min(first + MANY_ROWS, len(x))
        low, high = max(first - _KNOTS, 0), min(last + _KNOTS, len(x))
        t = step * np.arange(high - low)
        out[first:last] = CubicSpline(t, x[low:high])(t[first - low : last - low], 1)
    return out


def slope(x: Array, step: float, spline: bool) -> Array:
    """dx/dt by a spline or central differences, which are the published procedure's for least squares."""
    return spline_derivative(x, step) if spline else np.asarray(np.gradient(x, step))
