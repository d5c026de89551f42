"""The steady state of a law while its velocity is held, as expressions."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING

from stribeck.expressions.graph import BOUND, Expr, derivative, root, substitute, symbols, wrap
from stribeck.expressions.ops import Value

if TYPE_CHECKING:
    from stribeck.laws.base import Law

SLOWEST = 1e-100  # m/s or rad/s: products of slower speeds would vanish


def steady_deflection(law: type[Law], p: SimpleNamespace, v: Expr, side: Value = 1.0) -> Expr:
    """The deflection z at which dz/dt = 0 while v is held: the closed form where dz/dt is linear in z, else the first
    root that a bristle meets on its way from z = 0. ``side`` is the sign of v."""
    rate = wrap(law.dz_dt(p, v, BOUND))
    slope = derivative(rate, BOUND)
    if BOUND.value not in symbols([slope]):
        (at_0,) = substitute([rate], {BOUND: wrap(0.0)})
        return -at_0 / slope
    return wrap(side * root(wrap(side * law.dz_dt(p, v, side * BOUND)), wrap(law.scales(p).length)))


def steady_force(law: type[Law], p: SimpleNamespace, v: Expr, side: Value = 1.0) -> Expr:
    """The friction force while v is held, as an expression: arrays, compiled machines and exports evaluate this one."""
    z = steady_deflection(law, p, v, side) if law.has_z else wrap(0.0)
    return wrap(law.friction(p, v, z, wrap(0.0)))
