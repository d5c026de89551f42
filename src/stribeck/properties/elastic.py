"""The proof of passivity with the law's own stored energy e z^2/2, for laws dz/dt = v - rho(v, z) z.

With F = e z + b(v) dz/dt + c(v) v the power that is lost is D = F v - e z dz/dt = (b + c) v^2 + rho (e z^2 - b v z).
For 0 <= rho <= r(v) and |z| <= Z its minimum over z has a closed form, from which v^2 divides out:
D/v^2 >= b + c - r x (|b| - e x), x = min(Z/|v|, |b|/(2 e)). What is left depends on v alone and touches no zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.expressions.boxes import Cover, grid, not_negative
from stribeck.expressions.graph import ONE, Expr, derivative, ordered, substitute, symbol, symbols, wrap
from stribeck.expressions.intervals import Evaluator, Interval, interval, point
from stribeck.properties.algebra import sign_over_all
from stribeck.properties.model import RATE, Model, Relaxation, U, V, Z, divided, over_u, reciprocal
from stribeck.properties.storage import own_speeds

Array = NDArray[np.float64]

METHOD = (
    "interval arithmetic over all v, with the stored energy sigma_0 z^2/2, its minimum over z in closed form and v^2 "
    "divided out"
)


def speed_edges(model: Model, v_max: float | None) -> list[float]:
    """Where speeds are cut at first: at the law's own, and one far below and above them."""
    own = own_speeds(model.law)
    edges = [0.0, own[0] * 1e-3, *own, own[-1] * 1e3]
    if v_max is None:
        return [*dict.fromkeys(edges), float("inf")]
    return [*dict.fromkeys(x for x in edges if x < v_max), v_max]


def prove(model: Model, v_max: float | None, reach: float | None, deadline: float) -> Cover:
    """D >= 0 for all |z| <= reach and |v| <= v_max."""
    law = model.relaxation
    if law is None:
        return Cover(False, 0, reason="dz/dt is not v - rho z")
    boxes = 0
    for side in (1, -1):
        rho, b, c = (model.sided(x, side) for x in (law.rho, law.b, law.c))
        evaluate = Evaluator([rho, over_u(rho), b, c, _rise(b)])
        bound = _Bound(evaluate, model, law.e, np.inf if reach is None else reach)
        edges = speed_edges(model, v_max)
        if v_max is None and (far := _far(model, law, side, reach)) is not None:
            edges = [*(u for u in edges if u < far), far]
        cover = not_negative(bound, *grid([edges]), deadline)
        boxes += cover.boxes
        if not cover.holds:
            return Cover(False, boxes, cover.where, cover.reason)
    return Cover(True, boxes)


def _rise(b: Expr) -> Expr:
    """An expression whose sign is that of the derivative of u b(u), for a damping that is a factor times exp(...); else 1."""
    for factor in (node for node in ordered([b]) if node.op == "exp"):
        parts = [divided(x, factor) for x in (b, derivative(b, U))]
        if parts[0] is not None and parts[1] is not None:
            return parts[0] + U * parts[1]
    return ONE


def _far(model: Model, law: Relaxation, side: int, reach: float | None) -> float | None:
    """A speed from which the minimum over z is at z = Z, where D has no negative value by exact algebra; None where that
    is not so. It serves sets at their limit, such as F_s = F_c with sigma_2 = 0, where D/v^2 tends to 0 for fast v."""
    if reach is None or symbols([law.b]) & {"v"} or symbols([law.rho]) & {"z"}:
        return None
    damping = float(model.value(law.b).low)
    if not damping > 0:
        return None
    bound = wrap(model.law.z_bound(model.law.symbolic(symbol, model.law.structure)))
    power = V * substitute([model.force], {RATE: model.rate})[0] - derivative(model.stored, Z) * model.rate
    values = {n: x for n, x in model.law.values.items() if x is not None}
    for z_side in (1, -1):
        at_bound = substitute([model.sided(power, side)], {Z: bound if z_side > 0 else -bound})[0]
        if not sign_over_all(at_bound, values).not_negative:
            return None
    return 4 * law.e * reach / damping


@dataclass(frozen=True)
class _Bound:
    """A lower bound of D/v^2 on boxes of u = |v|."""

    evaluate: Evaluator
    model: Model
    e: float
    reach: float

    def __call__(self, box: Sequence[Interval]) -> Interval:
        u = box[0]
        t = reciprocal(u)
        z = interval(np.full_like(u.low, -self.reach), np.full_like(u.low, self.reach))
        rho, rho_t, b, c, rise = self.evaluate({**self.model.constants, "u": u, "t": t, "z": z})
        # where u b falls it is at most that at the box's lower end, also on an unbounded box
        falls = (rise.high <= 0) & (b.low >= 0)
        with np.errstate(all="ignore"):
            most = point(abs(b).high) / point(4 * self.e)
            share = np.fmin((rho * most).high, np.where(falls, (rho_t * point(u.low) * most).high, np.inf))
        return _loss(rho, rho_t, b, c, point(self.e), point(self.reach), u, t, share)


def _loss(
    rho: Interval,
    rho_t: Interval,
    b: Interval,
    c: Interval,
    e: Interval,
    depth: Interval,
    u: Interval,
    t: Interval,
    share: Array,
) -> Interval:
    """A lower bound of D/v^2 (as the low end); below zero also where rho might be negative. ``share`` bounds
    rho |b|/(4 e): the share of b that the bristles can give back at most."""
    with np.errstate(all="ignore"):
        size = abs(b)
        high, low = point(size.high), point(size.low)
        two_e = e + e
        # x (|b| - e x) rises with x up to |b|/(2 e), and with |b|
        x_high = _least(depth * point(t.high), high / two_e)
        x_low = _least(depth * point(t.low), low / two_e)
        lever = (high - e * x_low).high
        near = (rho * x_high * (high - e * point(x_high.low))).high
        y = _least(depth, high * point(u.high) / two_e)
        far = (rho_t * y * point(lever)).high
        spent = np.fmin(np.fmin(near, far), (point(share) * high).high)
        value = (b + c) - point(np.maximum(spent, 0.0))
        kept = np.where((b.low >= 0) & (share <= 1), c.low, -np.inf)  # b (1 - share) + c, also where b vanishes
    negative = ~((rho.low >= 0) & np.isfinite(spent))
    return Interval(
        np.where(negative, -np.inf, np.fmax(value.low, kept)), np.where(np.isfinite(spent), value.high, np.inf)
    )  # high: of a point


def _least(a: Interval, b: Interval) -> Interval:
    return Interval(np.fmin(a.low, b.low), np.fmin(a.high, b.high))
