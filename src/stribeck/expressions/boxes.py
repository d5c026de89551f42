"""Proofs by boxes: a bound is proved on boxes that cover a domain, and boxes where it is undecided are halved."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.expressions.intervals import Interval

Bound = Callable[[Sequence[Interval]], Interval]

_MOST = 400_000  # boxes: the search gives up beyond
_WIDE = 4.0  # a side whose ends have a larger ratio is halved on a logarithmic scale
_LEAP = 16.0  # a side from 0 is cut at its end over this; a side to infinity at its end times this
_NARROW = 1e-13  # relative width below which a box is undecided: some 500 floats, where rounding decides


@dataclass(frozen=True)
class Cover:
    """The result of a proof.

    Attributes:
        holds: whether the bound is proved.
        boxes: the number of boxes examined.
        where: otherwise a box where it is not proved: the ends of each side.
        reason: otherwise the reason.
        negative: whether the bound is known to be negative in that box.
    """

    holds: bool
    boxes: int
    where: tuple[tuple[float, float], ...] | None = None
    reason: str = ""
    negative: bool = False


def not_negative(bound: Bound, low: Array, high: Array) -> Cover:
    """Prove that ``bound`` is nowhere negative.

    A point where ``bound`` is negative ends the search.

    Args:
        bound: a function of one interval for each dimension.
        low, high: ends of the first boxes, shape (dimensions, boxes); they may be infinite.
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
    """The relative width of every side, and the place to cut it."""
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
