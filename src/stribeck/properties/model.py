"""A law's equations as expressions, taken apart for the proofs; nothing is written a second time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from stribeck.expressions.graph import (
    ONE,
    ZERO,
    Expr,
    derivative,
    is_zero,
    rebuild,
    rewrite,
    substitute,
    symbol,
    symbols,
    wrap,
)
from stribeck.expressions.intervals import Evaluator, Interval, point
from stribeck.expressions.ops import sqrt
from stribeck.laws.base import Law

V, Z, RATE, U, T = symbol("v"), symbol("z"), symbol("dz_dt"), symbol("u"), symbol("t")  # u = |v|, t = 1/u


@dataclass(frozen=True)
class Relaxation:
    """dz/dt = v - rho(v, z) z, F = a z + b(v) dz/dt + c(v) v and the stored energy e z^2/2, with a = e."""

    rho: Expr
    b: Expr
    c: Expr
    e: float


class Model:
    """The equations of a law with its constants.

    Attributes:
        rate: dz/dt as an expression of v and z.
        force: F as an expression of v, z and dz_dt.
        constants: the values of the constants, as intervals.
    """

    def __init__(self, law: Law) -> None:
        self.law = law
        p = law.symbolic(symbol, law.structure)
        self.rate = wrap(law.dz_dt(p, V, Z))
        self.force = wrap(law.friction(p, V, Z, RATE))
        self.stored = wrap(law.stored_energy(p, Z))
        self.constants: dict[str, Interval] = {n: point(x) for n, x in law.values.items() if x is not None}

    def value(self, expr: Expr) -> Interval:
        """An expression of the constants alone."""
        return Evaluator([expr])(self.constants)[0]

    @cached_property
    def relaxation(self) -> Relaxation | None:
        """The law as a relaxation; None where it has another form."""
        loss = self.rate.args[1] if self.rate.op == "sub" and self.rate.args[0] is V else None
        rho = divided(loss, Z) if loss is not None else ZERO if self.rate is V else None
        b, a = derivative(self.force, RATE), derivative(self.force, Z)
        c = divided(substitute([self.force], {RATE: ZERO, Z: ZERO})[0], V)
        if rho is None or c is None or symbols([a]) & {"v", "z", "dz_dt"} or symbols([b, c]) & {"z", "dz_dt"}:
            return None
        slope = derivative(derivative(self.stored, Z), Z)
        if "z" in symbols([slope]):
            return None
        stiffness, spring = self.value(slope), self.value(a)
        exact = stiffness.low == stiffness.high == spring.low == spring.high
        return Relaxation(rho, b, c, float(spring.low)) if exact and spring.low > 0 else None

    def sided(self, expr: Expr, side: int) -> Expr:
        """The expression with v = side u, u > 0."""
        return rewrite(substitute([expr], {V: U if side > 0 else -U}), _without_u)[0]


def _without_u(node: Expr) -> Expr:
    """u x <= 0 means x <= 0, and |u| is u."""
    if node.op == "abs" and (node.args[0] is U or node.args[0] is -U):
        return U
    if node.op in ("lt", "le"):
        for i, other in ((0, node.args[1]), (1, node.args[0])):
            if is_zero(other) and (part := divided(node.args[i], U)) is not None:
                return rebuild(node, (part, other) if i == 0 else (other, part))
    return node


def divided(node: Expr, by: Expr, remainder: Callable[[Expr], Expr] | None = None) -> Expr | None:
    """node/by, with ``by`` > 0, where ``by`` can be divided out; what it does not divide goes to ``remainder``."""
    if node is by:
        return ONE
    if is_zero(node):
        return ZERO
    found: Expr | None = None
    if node.op == "mul":
        for i, a in enumerate(node.args):
            if (part := divided(a, by)) is not None:
                return part * node.args[1 - i]
        for i, a in enumerate(node.args):
            if remainder is not None and grows(a, by) and (part := divided(a, by, remainder)) is not None:
                return part * node.args[1 - i]
    elif node.op == "div" and (part := divided(node.args[0], by, remainder)) is not None:
        return part / node.args[1]
    elif node.op in ("add", "sub", "neg", "where"):
        skip = 1 if node.op == "where" else 0
        parts = [divided(a, by, remainder) for a in node.args[skip:]]
        if all(part is not None for part in parts):
            found = rebuild(node, (*node.args[:skip], *parts))  # type: ignore[arg-type]
    elif node.op == "abs" and (part := divided(node.args[0], by)) is not None:
        return abs(part)
    elif node.op == "sqrt" and remainder is not None:
        once = divided(node.args[0], by, remainder)
        twice = divided(once, by, remainder) if once is not None else None
        found = sqrt(twice) if twice is not None else None
    if found is None and remainder is not None:
        return remainder(node)
    return found


def grows(node: Expr, by: Expr) -> bool:
    """Whether the expression holds ``by`` where it may be divided out."""
    if node.op in ("add", "sub", "neg", "mul", "abs", "sqrt"):
        return any(grows(a, by) for a in node.args)
    if node.op == "where":
        return any(grows(a, by) for a in node.args[1:])
    return node is by or (node.op == "div" and grows(node.args[0], by))


def over_u(node: Expr) -> Expr:
    """node/u with t = 1/u for what u does not divide."""
    found = divided(node, U, lambda rest: rest * T)
    assert found is not None
    return found


def reciprocal(u: Interval) -> Interval:
    """t = 1/u for u >= 0."""
    with np.errstate(all="ignore"):
        return point(np.ones_like(u.low)) / u
