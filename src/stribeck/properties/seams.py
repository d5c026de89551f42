"""Where the cases of an equation meet: |v|, signs and conditions, and whether values and derivatives agree there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from stribeck.errors import needed
from stribeck.expressions.graph import (
    ZERO,
    Expr,
    constant,
    derivative,
    is_zero,
    ordered,
    rebuild,
    rewrite,
    substitute,
    symbol,
    symbols,
)  # fmt: skip
from stribeck.expressions.intervals import Evaluator, Interval, interval
from stribeck.expressions.pretty import multiple_of_pi
from stribeck.properties.model import Model, U, V, Z, divided

W = symbol("w")  # |z|
_GENERATORS = 24
SIDES = tuple((a, b) for a in (1, -1) for b in (1, -1))


@dataclass(frozen=True)
class Seam:
    """A place where two forms of dz/dt meet: the forms, in (u, w), and what makes u or w lie there."""

    text: str
    quadrant: tuple[int, int]
    forms: tuple[Expr, Expr]
    there: Mapping[Expr, Expr]


class Quadrants:
    """dz/dt for each sign of v and z, as expressions of u = |v| > 0 and w = |z| > 0."""

    def __init__(self, model: Model) -> None:
        self.model = model
        everything = interval(0.0, np.inf)
        self.domain: dict[str, Interval] = {**model.constants, "u": everything, "w": everything}
        self.form = {side: self._form(*side) for side in SIDES}

    def _form(self, v_side: int, z_side: int) -> Expr:
        here = {V: U if v_side > 0 else -U, Z: W if z_side > 0 else -W}
        return fold(rewrite(substitute([self.model.rate], here), _positive)[0], self.domain)

    def within(self, depth: float) -> dict[str, Interval]:
        """The domain with |z| <= depth."""
        return {**self.domain, "w": interval(0.0, depth)}

    @cached_property
    def regular(self) -> bool:
        """Whether no divisor, root, logarithm or power is singular anywhere."""
        for form in self.form.values():
            nodes = ordered([form])
            known = Evaluator([form]).all(self.domain)
            for node in nodes:
                if node.op == "div":
                    x = known[node.args[1]]
                    if not np.all((x.low > 0) | (x.high < 0)):
                        return False
                elif node.op in ("sqrt", "log", "pow") and not np.all(known[node.args[0]].low > 0):
                    return False
        return True

    def seams(self) -> list[Seam]:
        """Every place where forms meet."""
        found = []
        for s in (1, -1):
            found.append(Seam("v = 0", (1, s), (self.form[1, s], self.form[-1, s]), {U: ZERO}))
            found.append(Seam("z = 0", (s, 1), (self.form[s, 1], self.form[s, -1]), {W: ZERO}))
        for side, form in self.form.items():
            for node in ordered([form]):
                if node.op in ("abs", "sign"):
                    ways = (node.args[0], -node.args[0]) if node.op == "abs" else (constant(1.0), constant(-1.0))
                    forms = (substitute([form], {node: ways[0]})[0], substitute([form], {node: ways[1]})[0])
                    found.append(Seam(f"{node!r}", side, forms, {node.args[0]: ZERO}))
                elif node.op in ("lt", "le"):
                    a, b = (substitute_condition(form, node, x) for x in (True, False))
                    less, more = node.args
                    there = {less: more} if less.op != "constant" else {more: less}
                    found.append(Seam("a condition changes", side, (a, b), there))
                elif node.op in ("both", "either"):
                    found.append(Seam("a combined condition", side, (form, ZERO), {}))
        return found

    def meet(self, seam: Seam, order: int) -> bool:
        """Whether the two forms agree there in value (order 0), or also in their first derivatives (order 1)."""
        if not seam.there:
            return False
        pairs = [seam.forms] if order == 0 else [seam.forms, *self.slopes(seam)]
        return all(self._same(a, b, seam) for a, b in pairs)

    def _same(self, a: Expr, b: Expr, seam: Seam) -> bool:
        return any(
            vanishes(fold(substitute([a - b], there)[0], self.domain)) for there in (seam.there, *solved(seam.there))
        )

    def slopes(self, seam: Seam) -> list[tuple[Expr, Expr]]:
        """The derivatives of the two forms by v and by z."""
        a, b = seam.forms
        found = []
        for by, name in ((U, "v = 0"), (W, "z = 0")):
            other = derivative(b, by)
            found.append((derivative(a, by), -other if seam.text == name else other))
        return found

    def at_rest(self) -> bool:
        """Whether dz/dt at v = 0, and at z = 0, is what it tends to."""
        for here, side in ((V, {U: ZERO}), (Z, {W: ZERO})):
            for sign in (1, -1):
                other = {Z: W if sign > 0 else -W} if here is V else {V: U if sign > 0 else -U}
                exact = fold(
                    rewrite(substitute([self.model.rate], {here: ZERO, **other}), _positive)[0], self.domain, True
                )
                limit = fold(substitute([self.form[(1, sign) if here is V else (sign, 1)]], side)[0], self.domain)
                if not vanishes(exact - limit):
                    return False
        return True


def substitute_condition(form: Expr, condition: Expr, holds: bool) -> Expr:
    """The expression where a condition is known."""

    def rule(node: Expr) -> Expr:
        if node.op == "where" and node.args[0] is condition:
            return node.args[1 if holds else 2]
        return node

    return rewrite([form], rule)[0]


def solved(there: Mapping[Expr, Expr]) -> list[dict[Expr, Expr]]:
    """What makes u or w lie there, where the place is linear in one of them."""
    ((left, right),) = there.items()
    difference, found = left - right, []
    for x in (U, W):
        slope = derivative(difference, x)
        if str(x.value) in symbols([difference]) and str(x.value) not in symbols([slope]):
            found.append({x: -substitute([difference], {x: ZERO})[0] / slope})
    return found


def _positive(node: Expr) -> Expr:
    """What u > 0 and w > 0 say of signs."""
    if node.op in ("abs", "sign"):
        x = node.args[0]
        side = _sign_of(x)
        if side:
            size = x if side > 0 else -x
            return size if node.op == "abs" else constant(side)
    if node.op in ("lt", "le"):
        for i, other in ((0, node.args[1]), (1, node.args[0])):
            if is_zero(other):
                part = node.args[i]
                for by in (U, W):
                    rest = divided(part, by)
                    part = part if rest is None else rest
                return rebuild(node, (part, other) if i == 0 else (other, part))
    return node


def _sign_of(x: Expr) -> int:
    if x is U or x is W:
        return 1
    if x.op == "neg":
        return -_sign_of(x.args[0])
    return _sign_of(x.args[0]) * _sign_of(x.args[1]) if x.op == "mul" else 0


def fold(expr: Expr, domain: Mapping[str, Interval], exactly: bool = False) -> Expr:
    """The expression without the cases that do not occur in the domain.

    A condition whose sides may be equal is left, unless ``exactly``: at a seam either case may be meant.
    """
    while True:
        known = Evaluator(node.args[0] for node in ordered([expr]) if node.op == "where").all(domain)
        new = rewrite([expr], lambda node, known=known: _decided(node, known, domain, exactly))[0]  # type: ignore[misc]
        if new is expr:
            return expr
        expr = new


def _decided(node: Expr, known: Mapping[Expr, Any], domain: Mapping[str, Interval], exactly: bool) -> Expr:
    if node.op != "where":
        return node
    condition, a, b = node.args
    truth = known.get(condition)
    if truth is None:
        return node
    if condition.op in ("lt", "le"):
        less, more = (known[x] for x in condition.args)
        apart = np.all((less.high < more.low) | (less.low > more.high))
        if not (apart or exactly):
            return node
        if np.all(truth.must) or not np.any(truth.may):
            return a if np.all(truth.must) else b
        if exactly and np.all(less.high <= more.low):  # the other case only where both sides are equal
            there = fold(substitute([b], {condition.args[0]: condition.args[1]})[0], domain, True)
            return a if there is fold(a, domain, True) else node
    return node


# -- identities --------------------------------------------------------------------------------------------------------


def vanishes(expr: Expr) -> bool:
    """Whether an expression is identically zero, by exact algebra over its transcendental parts; False where it cannot
    be told."""
    if is_zero(expr):
        return True
    try:
        return bool(_Identity().convert(expr)[0].is_zero())
    except _Opaque:
        return False


class _Opaque(Exception):
    pass


class _Identity:
    """Expressions as quotients of polynomials in their symbols and transcendental parts."""

    def __init__(self) -> None:
        with needed("a proof"):
            from flint import Ordering, fmpq, fmpq_mpoly_ctx

        self.context = fmpq_mpoly_ctx.get(("pi", *(f"x{i}" for i in range(_GENERATORS))), Ordering.lex)
        self.pi, *self.free = self.context.gens()
        self.rational = lambda x: self.context.constant(fmpq(x.numerator, x.denominator))
        self.known: dict[Any, tuple[Any, Any]] = {}

    def convert(self, node: Expr) -> tuple[Any, Any]:
        """The numerator and the denominator."""
        for each in ordered([node]):
            if each not in self.known and each.op not in ("lt", "le", "both", "either"):
                self.known[each] = self._value(each)
        return self.known[node]

    def _value(self, node: Expr) -> tuple[Any, Any]:
        one = self.context.constant(1)
        if node.op == "constant":
            assert isinstance(node.value, float)
            multiple = multiple_of_pi(node.value)
            if multiple:
                ratio, above = multiple
                return (self.rational(ratio) * self.pi, one) if above else (self.rational(ratio), self.pi)
            return self.rational(Fraction(node.value)), one
        if node.op in ("where", "sign"):
            return self._fresh(), one
        args = [self.known[a] for a in node.args]
        if node.op in ("add", "sub"):
            (a, b), (c, d) = args
            return self._reduced(a * d + c * b if node.op == "add" else a * d - c * b, b * d)
        if node.op == "neg":
            return -args[0][0], args[0][1]
        if node.op == "mul":
            return self._reduced(args[0][0] * args[1][0], args[0][1] * args[1][1])
        if node.op == "div":
            if args[1][0].is_zero():
                raise _Opaque
            return self._reduced(args[0][0] * args[1][1], args[0][1] * args[1][0])
        if args and all(a.is_zero() for a, _ in args) and node.op != "pow":
            at_zero = {"exp": 1, "cos": 1}.get(node.op, 0)
            if node.op in ("log", "sqrt"):
                raise _Opaque
            return self.context.constant(at_zero), one
        if node.op in ("sin", "cos") and (wave := self._quarter(node.op, *args[0])) is not None:
            return self.context.constant(wave), one
        key = (node.op, tuple((str(a), str(b)) for a, b in args)) if args else node
        if key not in self.known:
            self.known[key] = (self._fresh(), one)
        return self.known[key]

    def _reduced(self, top: Any, bottom: Any) -> tuple[Any, Any]:
        common = top.gcd(bottom)
        return (top, bottom) if common.is_one() else (top / common, bottom / common)

    def _fresh(self) -> Any:
        if not self.free:
            raise _Opaque
        return self.free.pop()

    def _quarter(self, op: str, top: Any, bottom: Any) -> int | None:
        """sin or cos of a multiple of pi/2."""
        ratio, rest = divmod(top * 2, bottom * self.pi)
        if not rest.is_zero() or not ratio.is_constant():
            return None
        value = next(iter(ratio.to_dict().values()), 0)
        if value != int(value):
            return None
        k = int(value) + (1 if op == "cos" else 0)
        return (0, 1, 0, -1)[k % 4]
