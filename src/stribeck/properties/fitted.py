"""Fits a storage function whose slope lies in the interval [L, U].

Near z = 0 the slope is the elastic force, which lies in the interval there. Beyond, it is constant on each of many cells of z.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.properties.storage import Storage

Slope = Callable[[Array], Array]

_CELLS, _HALVINGS = 24, 5  # of z on each side at first, and how often narrow ones are halved: to 0.1 % of the range


@dataclass(frozen=True)
class Fitted:
    """The slopes of a storage function on cells of z; the elastic force for |z| <= ``elastic_up_to``."""

    elastic_up_to: float
    low: Array
    high: Array
    slope: Array


def serves(storage: Storage, elastic: Slope, top: float) -> NDArray[np.bool_]:
    """A mask of the grid of |z| up to ``top``: whether the elastic force lies between sampled L and U for both signs of z."""
    z = top * _dense()
    inside = np.ones(len(z), bool)
    for side in (1, -1):
        low, high = storage.interval(side * z)
        slope = elastic(side * z)
        room = 1e-7 * abs(slope)
        with np.errstate(invalid="ignore"):  # a slope of nan never lies in the interval
            inside &= (low <= slope + room) & (high >= slope - room)
    return inside


def fit(storage: Storage, elastic: Slope, top: float, served: NDArray[np.bool_]) -> Fitted | None:
    """Slopes of a storage function between sampled L and U, or None if one is not finite.

    ``served`` is where the elastic force lies between them: near z = 0, and not everywhere.
    """
    z = top * _dense()
    start = float(z[max(int(served.argmin()) - 1, 0)]) * 0.99
    parts = [_slopes(storage, elastic, np.sort(side * np.linspace(start, top, _CELLS + 1))) for side in (1, -1)]
    fitted = Fitted(start, *(np.concatenate(x) for x in zip(*parts, strict=True)))
    return fitted if np.all(np.isfinite([fitted.low, fitted.high, fitted.slope])) else None


def _dense() -> Array:
    return np.concatenate([np.linspace(0, 0.99, 250)[1:], 1 - np.logspace(-2, -7, 60)])


def _slopes(storage: Storage, elastic: Slope, edges: Array) -> tuple[Array, Array, Array]:
    """Cells and their slopes. Cells over which L or U changes much are halved."""
    for _ in range(_HALVINGS):
        low, high = edges[:-1], edges[1:]
        points = low + (high - low) * np.array([1e-9, 0.5, 1 - 1e-9])[:, None]
        lower, upper = (x.reshape(points.shape) for x in storage.interval(points.ravel()))
        bottom, top = lower.max(axis=0), upper.min(axis=0)
        tight = top - bottom < 0.5 * (upper - lower)[1]
        if not tight.any():
            break
        edges = np.sort(np.concatenate([edges, points[1][tight]]))
    wanted = elastic(points[1])
    scale = float(np.max(abs(elastic(np.array([edges[0], edges[-1]])))))
    bottom = np.where(np.isfinite(bottom), bottom, np.minimum(wanted, np.where(np.isfinite(top), top, wanted)) - scale)
    top = np.minimum(top, np.maximum(bottom + 2 * abs(bottom) + scale, wanted))
    quarter = 0.25 * (top - bottom)
    return low, high, np.clip(wanted, bottom + quarter, top - quarter)
