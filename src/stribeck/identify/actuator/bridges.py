"""Interpolates a machine's inputs across missing samples, with an estimate of the error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.data.smoother import smooth, smoothing

GAP = 1.6  # sampling periods: a longer interval lacks a sample
_SHIFTS = 12  # places at which the same samples are left out: their median error is known to a quarter
DRAWS = 4  # of an error that a simulation carries on: each is simulated, so that more take longer than the fit


@dataclass(frozen=True)
class Bridged:
    """A signal with interpolated gaps.

    Attributes:
        x: the signal.
        others: (draws, times) with the possible error added, of random sign in each gap; empty without gaps.
    """

    t: Array
    x: Array
    others: Array


def bridged(t: Array, x: Array) -> Bridged:
    """Interpolate missing samples by straight lines or by the likeliest spline: in each gap by the better of both elsewhere.

    The errors are the medians where samples are left out in the same pattern, later in the record.
    """
    step = float(np.median(np.diff(t))) if len(t) > 1 else 1.0
    number = np.rint((t - t[:1]) / step).astype(np.int64)
    lost = np.setdiff1d(np.arange(number[-1] + 1 if len(t) else 0), number)
    if not len(lost) or not np.diff(number).all() or not np.max(np.diff(t)) > GAP * step:
        return Bridged(t, x, x[None][:0])  # without an even grid, a long interval lacks no sample
    gap = np.cumsum(np.diff(lost, prepend=lost[0]) > 1).astype(np.intp)
    lam = smoothing(number.astype(float), x)
    errors = _errors(number, x, lost, gap, lam)
    ways = _ways(number, x, lost, lam)
    best = np.argmin(errors, axis=0)
    there = np.interp(lost, number, t)
    order = np.argsort(new := np.concatenate([t, there]))
    whole = np.concatenate([x, ways[best[gap], np.arange(len(lost))]])[order]
    error = np.min(errors, axis=0)
    sides = np.random.default_rng(0).choice([-1.0, 1.0], (DRAWS, len(error)))
    bulge = np.concatenate([_bulge(lost[gap == i]) for i in range(len(error))])
    added = np.concatenate([np.zeros((DRAWS, len(t))), (error * sides)[:, gap] * bulge], axis=1)
    return Bridged(new[order], whole, whole + added[:, order])


def _ways(number: NDArray[np.int64], x: Array, lost: NDArray[np.int64], lam: float) -> Array:
    """Straight lines and the likeliest spline at lost samples, (2, lost)."""
    return np.stack([np.interp(lost, number, x), smooth(number.astype(float), x, lam)(lost)])


def _errors(number: NDArray[np.int64], x: Array, lost: NDArray[np.int64], gap: NDArray[np.intp], lam: float) -> Array:
    """The rms error of both ways in each gap, (2, gaps); where too few samples are left, that of no knowledge."""
    count, gaps = int(number[-1]) + 1, int(gap[-1]) + 1
    squares = np.full((_SHIFTS, 2, gaps), np.nan)
    for k, shift in enumerate(np.linspace(0, count, _SHIFTS + 2).astype(int)[1:-1].tolist()):
        away = (lost + shift) % count
        inside = (away > number[1]) & (away < number[-2]) & np.isin(away, number)
        rest = ~np.isin(number, away)
        if inside.any():
            off = (_ways(number[rest], x[rest], away[inside], lam) - np.interp(away[inside], number, x)) ** 2
            known = np.bincount(gap[inside], minlength=gaps)
            squares[k] = np.array([np.bincount(gap[inside], each, gaps) for each in off]) / np.where(
                known, known, np.nan
            )
    squares[0] = np.where(np.isnan(squares).all(axis=0), np.var(x), squares[0])
    return np.asarray(np.sqrt(np.nanmedian(squares, axis=0)))


def _bulge(lost: NDArray[np.int64]) -> Array:
    """A parabola over the lost samples of a gap, 0 at the samples beside it, with rms 1."""
    x = (lost - lost[0] + 1.0) * (lost[-1] + 1.0 - lost)
    return np.asarray(x / np.sqrt(np.mean(x**2)))
