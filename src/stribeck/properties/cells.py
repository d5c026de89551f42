"""The proof of passivity with a storage function fitted to the interval [L, U]: its slope is the law's own stored
energy's where that serves, and a constant w on each of many cells of z where it does not. On a cell the power that is
lost, D = F v - w dz/dt, is divided by |v| symbolically (by v^2 for fast v) and shown to be nowhere negative by boxes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.expressions.boxes import Cover, not_negative
from stribeck.expressions.graph import substitute, symbol
from stribeck.expressions.intervals import Evaluator, Interval
from stribeck.properties import elastic
from stribeck.properties.model import RATE, Model, V, over_u, reciprocal
from stribeck.properties.storage import Storage

Array = NDArray[np.float64]

METHOD = (
    "interval arithmetic over all v and z, with sigma_0 z^2/2 as storage near z = 0 and slopes fitted to [L, U] beyond"
)
_CELLS, _HALVINGS = 24, 5
_W = symbol("w")


@dataclass(frozen=True)
class Fitted:
    """The slopes of a storage function on cells of z; sigma_0 z for |z| <= ``own``."""

    own: float
    low: Array
    high: Array
    slope: Array


def fit(storage: Storage, stiffness: float) -> Fitted | None:
    """A storage function's slopes between L and U as sampled; None where the law's own does not serve near z = 0."""
    z = storage.largest * np.linspace(0, 1, 400)[1:] if storage.reach is None else storage.reach * _dense()
    served = np.ones(len(z), bool)
    for side in (1, -1):
        low, high = storage.interval(side * z)
        room = 1e-7 * stiffness * z
        served &= (low <= side * stiffness * z + room) & (high >= side * stiffness * z - room)
    if not served[0]:
        return None
    if served.all():
        return Fitted(storage.largest, *(np.zeros(0),) * 3)
    own = float(z[max(int(served.argmin()) - 1, 0)]) * 0.99
    top = storage.reach if storage.reach is not None else storage.largest
    parts = [_slopes(storage, stiffness, np.sort(side * np.linspace(own, top, _CELLS + 1))) for side in (1, -1)]
    return Fitted(own, *(np.concatenate(x) for x in zip(*parts, strict=True)))


def _dense() -> Array:
    return np.concatenate([np.linspace(0, 0.99, 250)[1:], 1 - np.logspace(-2, -7, 60)])


def _slopes(storage: Storage, stiffness: float, edges: Array) -> tuple[Array, Array, Array]:
    """Cells and their slopes; cells over which L and U change much are halved."""
    for _ in range(_HALVINGS):
        low, high = edges[:-1], edges[1:]
        points = low + (high - low) * np.array([1e-9, 0.5, 1 - 1e-9])[:, None]
        lower, upper = (x.reshape(points.shape) for x in storage.interval(points.ravel()))
        bottom, top = lower.max(axis=0), upper.min(axis=0)
        tight = top - bottom < 0.5 * (upper - lower)[1]
        if not tight.any():
            break
        edges = np.sort(np.concatenate([edges, points[1][tight]]))
    scale = stiffness * storage.largest
    own = stiffness * points[1]
    bottom = np.where(np.isfinite(bottom), bottom, np.minimum(own, np.where(np.isfinite(top), top, own)) - scale)
    top = np.minimum(top, np.maximum(bottom + 2 * abs(bottom) + scale, own))
    quarter = 0.25 * (top - bottom)
    return low, high, np.clip(own, bottom + quarter, top - quarter)


def prove(model: Model, storage: Storage, deadline: float) -> tuple[Cover, Fitted | None]:
    """D >= 0 with a fitted storage function."""
    law = model.relaxation
    fitted = fit(storage, law.e) if law is not None else None
    if fitted is None:
        return Cover(False, 0, reason="the law's own stored energy does not serve near z = 0"), None
    cover = elastic.prove(model, storage.v_max, fitted.own, deadline)
    boxes = cover.boxes
    edges = np.asarray(elastic.speed_edges(model, storage.v_max))
    for side in (1, -1) if cover.holds else ():
        power = V * substitute([model.force], {RATE: model.rate})[0] - _W * model.rate
        slow = over_u(model.sided(power, side))
        evaluate = Evaluator([slow, over_u(slow)])

        def bound(box: Sequence[Interval], evaluate: Evaluator = evaluate) -> Interval:
            z, w, u = box
            slow, fast = evaluate({**model.constants, "z": z, "w": w, "u": u, "t": reciprocal(u)})
            return Interval(np.fmax(slow.low, fast.low), np.fmin(slow.high, fast.high))

        n, k = len(fitted.slope), len(edges) - 1
        low = np.stack([np.repeat(fitted.low, k), np.repeat(fitted.slope, k), np.tile(edges[:-1], n)])
        high = np.stack([np.repeat(fitted.high, k), np.repeat(fitted.slope, k), np.tile(edges[1:], n)])
        cover = not_negative(bound, low, high, deadline)
        boxes += cover.boxes
        if not cover.holds:
            break
    return Cover(cover.holds, boxes, cover.where, cover.reason), fitted
