"""Proofs by boxes: a bound is shown on boxes that cover a domain, and boxes where it is not yet shown are halved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.expressions.intervals import Interval

Bound = Callable[[Sequence[Interval]], Interval]

_MOST = 400_000  # boxes
_WIDE = 4.0  # ends of this ratio are halved on a logarithmic scale
_LEAP = 16.0  # where a side reaches to 0 or to infinity it is cut at this share of its other end, or so many times it
_NARROW = 1e-13  # relative width below which a box is given up


@dataclass(frozen=True)
class Cover:
    """What came of a proof: whether the bound holds, with how many boxes; else a box where it was not shown, why, and
    whether it is known to be negative there."""

    holds: bool
    boxes: int
    where: tuple[tuple[float, float], ...] | None = None
    reason: str = ""
    negative: bool = False


def not_negative(bound: Bound, low: Array, high: Array) -> Cover:
    """Show that ``bound``, given one interval a dimension, is nowhere negative; low and high have a row a dimension.

    Boxes may reach to infinity. A point where ``bound`` is negative ends the search.
    """
    count = 0
    while low.shape[1]:
        n = low.shape[1]
        count += n
        width, cut = _cuts(low, high)
        value = bound([Interval(np.append(a, c), np.append(b, c)) for a, b, c in zip(low, high, cut, strict=True)])
        open_ = ~(value.low[:n] >= 0)
        if not open_.any():
            break
        below = (value.high[n:] < 0) & open_
        stuck = (below | (width.max(axis=0) < _NARROW)) & open_
        if stuck.any() or count > _MOST:
            i = int(stuck.argmax()) if stuck.any() else int(open_.argmax())
            box = tuple((float(a), float(b)) for a, b in zip(low[:, i], high[:, i], strict=True))
            text = "it is negative" if below[i] else "boxes became too small" if stuck[i] else "too many boxes"
            return Cover(False, count, box, text, bool(below[i]))
        low, high, width, cut = (x[:, open_] for x in (low, high, width, cut))
        axis, lanes = width.argmax(axis=0), np.arange(low.shape[1])
        left, right = high.copy(), low.copy()
        left[axis, lanes] = right[axis, lanes] = cut[axis, lanes]
        low, high = np.hstack([low, right]), np.hstack([left, high])
    return Cover(True, count)


def _cuts(low: Array, high: Array) -> tuple[Array, Array]:
    """The relative width of every side, and where it is to be cut."""
    with np.errstate(all="ignore"):
        size = np.maximum(abs(low), abs(high))
        same = (low > 0) | (high < 0)
        small = np.minimum(abs(low), abs(high))
        ratio = np.where(same, size / small, np.inf)
        geometric = np.sign(low + high) * np.sqrt(small) * np.sqrt(size)
        cut = np.where(same & (ratio > _WIDE), geometric, 0.5 * low + 0.5 * high)
        cut = np.where((low == 0) & (high > 0), high / _LEAP, cut)
        cut = np.where((high == 0) & (low < 0), low / _LEAP, cut)
        cut = np.where(np.isinf(high) & (low > 0), _LEAP * low, cut)
        width = np.where(np.isinf(size), 50.0, np.where(same, np.log(ratio), 5.0))
        width = np.where((low == 0) | (high == 0), np.where(size < 1e-280, 0.0, 3.0), width)
        width = np.where((low < 0) & (high > 0), 3.0, width)
    return np.where(high > low, width, 0.0), cut


def grid(edges: Sequence[Sequence[float]]) -> tuple[Array, Array]:
    """Boxes between edges: every combination of the pieces of each dimension."""
    pieces = [np.asarray(e, float) for e in edges]
    low = np.stack([x.ravel() for x in np.meshgrid(*(e[:-1] for e in pieces), indexing="ij")])
    high = np.stack([x.ravel() for x in np.meshgrid(*(e[1:] for e in pieces), indexing="ij")])
    return low, high
