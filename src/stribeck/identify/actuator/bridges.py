"""What drove a machine while samples of it are missing: a curve across each gap, and how far it may be off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array

GAP = 1.6  # sample times: a longer one lacks a sample
_INSIDE = 50  # points set in a gap, at most
_NEAR = 4.5, 12.5  # samples' times from which the slope at an end of a gap is taken
_LEAST, _MOST = 4, 12
_TESTS = 24  # gaps of the same length that are made elsewhere, to see how well they are crossed


@dataclass(frozen=True)
class Bridged:
    """A signal with its gaps crossed: ``x`` in the better way, ``other`` in another one; ``doubt``: how far it may be off
    there, by how far the two are from each other."""

    t: Array
    x: Array
    other: Array
    doubt: float = 0.0


def bridged(t: Array, x: Array) -> Bridged:
    """A signal with points set in its gaps: a cubic with the slopes that it has before and after, or straight, whichever
    misses less where the same gap is made elsewhere."""
    gaps = np.diff(t)
    step = float(np.median(gaps)) if len(gaps) else 1.0
    at = np.flatnonzero(gaps > GAP * step).astype(np.int64)
    if not len(at) or len(t) < 3 * _LEAST:
        return Bridged(t, x, x)
    lacks = np.rint(gaps[at] / step).astype(int).tolist()
    missed = {lack: _missed(t, x, lack, step, at) for lack in set(lacks)}
    times, values, others, wrong = list[Array](), list[Array](), list[Array](), list[float]()
    for i, lack in zip(at.tolist(), lacks, strict=True):
        inner = np.linspace(t[i], t[i + 1], min(lack, _INSIDE) + 1)[1:-1]
        ways = _ways(t, x, i, i + 1, inner, step)
        best = int(np.argmin(missed[lack]))
        times.append(inner)
        values.append(ways[best])
        others.append(ways[0 if best else 1])
        wrong.append(float(missed[lack][best]))
    apart = float(np.sqrt(np.mean((np.concatenate(values) - np.concatenate(others)) ** 2)))
    error = float(np.sqrt(np.mean(np.square(wrong))))
    order = np.argsort(new := np.concatenate([t, *times]))
    whole, other = (np.concatenate([x, *crossed])[order] for crossed in (values, others))
    return Bridged(new[order], whole, other, error / apart if apart > 0 else 0.0)


def _ways(t: Array, x: Array, i: int, j: int, when: Array, step: float) -> Array:
    """From sample i to sample j straight, and as cubics with slopes from few and from many samples."""
    return np.stack(
        [np.interp(when, t[[i, j]], x[[i, j]]), *(_cubic(t, x, i, j, when, reach * step) for reach in _NEAR)]
    )


def _cubic(t: Array, x: Array, i: int, j: int, when: Array, reach: float) -> Array:
    """The cubic from sample i to sample j, with the slopes of those before and after."""
    span, secant = t[j] - t[i], (x[j] - x[i]) / (t[j] - t[i])
    slopes = []
    for end, near in ((i, np.arange(max(i - _MOST, 0), i + 1)), (j, np.arange(j, min(j + _MOST, len(t))))):
        near = near[abs(t[near] - t[end]) < reach]
        s = (t[near] - t[end]) / reach
        order = 2 if len(near) > 3 else 1
        slopes.append(float(np.polyfit(s, x[near], order)[-2]) / reach if len(near) > 1 else secant)
    s = (when - t[i]) / span
    near_, far = (slopes[0] - secant) * span, (slopes[1] - secant) * span
    return np.asarray(x[i] + secant * span * s + s * (1 - s) * ((1 - s) * near_ - s * far))


def _missed(t: Array, x: Array, lack: int, step: float, gaps: NDArray[np.int64]) -> Array:
    """The root mean square by which each way misses samples that are there."""
    room = lack + _LEAST
    last = len(t) - 1 - room if len(t) > 2 * room else 0
    places = {int(i) for i in np.linspace(_LEAST, last, _TESTS)} if last else set[int]()
    errors: list[Array] = []
    for i in sorted(places):
        if not ((gaps >= i - _LEAST) & (gaps < i + room)).any():
            there = x[i + 1 : i + lack]
            errors.append(_ways(t, x, i, i + lack, t[i + 1 : i + lack], step) - there)
    if not errors:
        return np.full(1 + len(_NEAR), np.std(x))
    return np.asarray(np.sqrt(np.mean(np.concatenate(errors, axis=1) ** 2, axis=1)))
