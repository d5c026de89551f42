"""Interpolates a machine's inputs across gaps of missing samples, with an estimate of the error."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array

GAP = 1.6  # sampling periods: a longer interval lacks a sample
_INSIDE = 50  # interpolated points in a gap, at most: a cubic needs no more
# Sampling periods from which the slope at an end of a gap is estimated: few follow the motion, many average the noise.
_NEAR = (4.5, 12.5)
_LEAST, _MOST = 4, 12  # samples for such a slope
_TESTS = 24  # artificial gaps of the same length elsewhere, from which the error is estimated to 15 %
_DRAWS = 4  # of the interpolation error, with a random sign in each gap


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
    """Interpolate the gaps of a signal by a straight line, or by a cubic with the slopes before and after.

    The method with the smaller error in artificial gaps of the same length is chosen.
    """
    gaps = np.diff(t)
    step = float(np.median(gaps)) if len(gaps) else 1.0
    before = np.flatnonzero(gaps > GAP * step).tolist()
    if not before or len(t) < 3 * _LEAST:
        return Bridged(t, x, x[None][:0])
    number = np.rint((t - t[0]) / step).astype(np.int64)
    if not np.diff(number).all():  # without an even grid, a long interval lacks no sample
        return Bridged(t, x, x[None][:0])
    even = np.full(int(number[-1]) + 1, np.nan)
    even[number] = x
    times, values, errors = zip(*(_across(t, x, i, step, number, even) for i in before), strict=True)
    order = np.argsort(new := np.concatenate([t, *times]))
    whole = np.concatenate([x, *values])[order]
    if not max(errors) > 0:
        return Bridged(new[order], whole, whole[None][:0])
    sides = np.random.default_rng(0).choice([-1.0, 1.0], (_DRAWS, len(before)))
    added = [np.zeros((_DRAWS, len(t)))]
    for i, inner, error, side in zip(before, times, errors, sides.T, strict=True):
        parabola = (inner - t[i]) * (t[i + 1] - inner)
        added.append(error * side[:, None] * (parabola / np.sqrt(np.mean(parabola**2))))
    return Bridged(new[order], whole, whole + np.concatenate(added, axis=1)[:, order])


def _across(
    t: Array, x: Array, i: int, step: float, number: NDArray[np.int64], even: Array
) -> tuple[Array, Array, float]:
    """Times and values in the gap after sample i, and their rms error, by the best method in artificial gaps elsewhere.

    Args:
        even: the signal on an even grid, nan where a sample is missing; ``number``: the samples' indices there.
    """
    some = slice(max(i - _MOST, 0), min(i + 2 + _MOST, len(t)))
    here, lack = i - some.start, round((t[i + 1] - t[i]) / step)
    inner = np.linspace(t[i], t[i + 1], min(lack, _INSIDE) + 1)[1:-1]
    ways = _ways(t[some], x[some, None], here, inner, step)[:, :, 0]
    around, within = number[some] - number[i], np.arange(1, number[i + 1] - number[i])
    first, last = -int(around[0]), len(even) - int(around[-1])
    places = np.arange(first, max(last, first))
    places = places[np.isfinite(even[places[:, None] + np.concatenate([around, within])]).all(axis=1)]
    if not len(places):
        return inner, ways[0], float(np.std(x))
    places = places[np.unique(np.linspace(0, len(places) - 1, _TESTS).astype(int))]
    tried = _ways(around * step, even[places + around[:, None]], here, within * step, step)
    missed = np.sqrt(np.mean((tried - even[places + within[:, None]]) ** 2, axis=(1, 2)))
    best = int(np.argmin(missed))
    return inner, ways[best], float(missed[best])


def _ways(t: Array, x: Array, i: int, when: Array, step: float) -> Array:
    """Interpolations of signals (times, signals) from sample i to the next, (methods, when, signals).

    The methods are a straight line, and cubics with slopes from few and from many samples.
    """
    span = t[i + 1] - t[i]
    s = ((when - t[i]) / span)[:, None]
    secant = (x[i + 1] - x[i]) / span
    straight = x[i] + secant * span * s
    ways = [straight]
    for reach in _NEAR:
        slopes = []
        for end, near in ((i, np.arange(i, -1, -1)[:_MOST]), (i + 1, np.arange(i + 1, len(t))[:_MOST])):
            far = abs(t[near] - t[end])
            near = near[(far < reach * step) | (np.arange(len(near)) < _LEAST)]  # another gap may lie nearby
            order = 2 if len(near) > 3 else 1
            slopes.append(np.polyfit((t[near] - t[end]) / step, x[near], order)[-2] / step if len(near) > 1 else secant)
        before, after = (slopes[0] - secant) * span, (slopes[1] - secant) * span
        ways.append(straight + s * (1 - s) * ((1 - s) * before - s * after))
    return np.stack(ways)
