"""The steady state of a law at constant velocity, as expressions."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING

from stribeck.expressions.graph import BOUND, Expr, derivative, root, substitute, symbols, wrap
from stribeck.expressions.ops import Value

if TYPE_CHECKING:
    from stribeck.laws.base import Law

SLOWEST = 1e-100  # m/s or rad/s: products of slower speeds would underflow


def steady_deflection(law: type[Law], p: SimpleNamespace, v: Expr, side: Value = 1.0) -> Expr:
    """The deflection z at which dz/dt = 0 at constant v; ``side`` is the sign of v.

    If dz/dt is linear in z, it is a closed form. Otherwise it is the first root that a bristle reaches from z = 0.
    """
    rate = wrap(law.dz_dt(p, v, BOUND))
    slope = derivative(rate, BOUND)
    if BOUND.value not in symbols([slope]):
        (at_0,) = substitute([rate], {BOUND: wrap(0.0)})
        return -at_0 / slope
    return wrap(side * root(wrap(side * law.dz_dt(p, v, side * BOUND)), wrap(law.scales(p).length)))


def steady_force(law: type[Law], p: SimpleNamespace, v: Expr, side: Value = 1.0) -> Expr:
    """The friction force at constant v, as the expression that arrays, compiled machines and exports share."""
    z = steady_deflection(law, p, v, side) if law.has_z else wrap(0.0)
    return wrap(law.friction(p, v, z, wrap(0.0)))
