"""A law's own equations as expressions, with its constants as exact rational numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import cached_property

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import (
    ONE,
    ZERO,
    Expr,
    constant,
    is_zero,
    ordered,
    rebuild,
    rewrite,
    substitute,
    symbol,
    symbols,
    wrap,
)
from stribeck.expressions.intervals import Box, Range
from stribeck.expressions.ops import Value, where
from stribeck.laws.base import Law
from stribeck.properties.prover.leaf import Leaf, Rules
from stribeck.properties.prover.region import Axis, Region, down, up
from stribeck.properties.prover.ring import Quotient, Ring, Unclear
from stribeck.properties.prover.search import Hints, Prover
from stribeck.properties.storage import own_speeds

V, Z, RATE, U, W, T = (symbol(n) for n in ("v", "z", "dz_dt", "u", "w", "t"))  # u = |v|, w = |z|, t = 1/u
REST = symbol("rest")  # v or z of exactly 0; unlike a literal 0, it cancels nothing
SIGNS = (1, -1)
_NUMBER = "k."  # prefix of the names of numbers
_FARTHEST = 10**300  # of the places at which regions are split: beyond it floats overflow


class Unreadable(Exception):
    """An equation that the proofs cannot treat."""


class Model:
    """The equations of a law with its constants.

    Attributes:
        rate: dz/dt as an expression of v and z.
        force: F as an expression of v, z and dz_dt.
        values: the exact constants, named ``c_NAME`` in the expressions.
        v_max: largest speed for passivity, or None.
    """

    def __init__(self, law: Law, v_max: float | None = None) -> None:
        self.law = law
        p = law.symbolic(lambda name: symbol(f"c_{name}"), law.form)
        self.rate = finite(wrap(law.dz_dt(p, V, Z)))
        self.force = finite(wrap(law.friction(p, V, Z, RATE)))
        self.power_force = substitute([self.force], {RATE: self.rate})[0]
        try:
            self.stored = finite(wrap(law.stored_energy(p, Z)))
        except InputError:  # the base class needs sigma_0
            self.stored = ZERO
        self._bound = finite(wrap(law.z_bound(p)))
        self.values = {f"c_{n}": Fraction(x) for n, x in law.p.numbers.items()}
        self.values["rest"] = Fraction(0)
        self.v_max = Fraction(v_max) if v_max is not None else None
        self.inputs: dict[str, Range] = {n: (float(x), float(x)) for n, x in self.values.items()}
        self.ring = Ring(self.values)
        self._forms: dict[tuple[Expr, int, int], Expr] = {}

    @cached_property
    def bound(self) -> tuple[Fraction, Fraction]:
        """Z of the law between two rational numbers, equal where it is rational.

        Raises:
            Unreadable: it is not a positive number.
        """
        low, high = Box(self.inputs)(self._bound)
        if not 0 < low <= high < math.inf:
            beyond = low >= 0 and high > 0 and self._bound is not ZERO
            what = "is beyond what floats hold" if beyond else "is not a positive number"
            raise Unreadable(f"z_bound of the law {what}: it lies between {low:g} and {high:g} m")
        try:
            quotient = Leaf(self.ring, Region(()), Rules(), self.inputs).convert(self._bound)
        except Unclear:
            return Fraction(low), Fraction(high)
        exact = quotient.rational
        return (exact, exact) if exact is not None else (Fraction(low), Fraction(high))

    @cached_property
    def prover(self) -> Prover:
        """The prover of claims, with the law's natural scales."""
        scales = self.law.scales(self.law.p)
        speeds = {Fraction(x) for x in own_speeds(self.law)}
        lengths = {Fraction(scales.length)} if 0 < scales.length < math.inf else set()
        for name, c in self.law.constants().items():
            value = self.values.get(f"c_{name}")
            if value and value > 0:
                speeds |= (
                    {1 / value} if c.unit == "s/m" and _FARTHEST * value > 1 else {value} if c.unit == "m/s" else set()
                )
                lengths |= {value} if c.unit == "m" else set()
        lengths |= {self.bound[1], 2 * self.bound[1]}  # beyond Z all cases are decided
        law_speeds = sorted(own_speeds(self.law))
        for u in (law_speeds[-1] * 1e6, law_speeds[0] * 1e-6):  # steady z at high and at low speed
            z = abs(float(self.law.steady_deflection(u)))
            lengths |= {Fraction(z)} if 0 < z < 1e3 * float(self.bound[1]) else set()
        places = self._switches()
        speeds |= places["u"]
        lengths |= places["w"]
        return Prover(self.ring, self.inputs, Hints(tuple(sorted(speeds)), tuple(sorted(lengths))))

    def _switches(self) -> dict[str, set[Fraction]]:
        """The rational speeds and deflections at which conditions switch."""
        switching: dict[str, set[Fraction]] = {"u": set(), "w": set()}
        leaf = self._anywhere(Rules(opaque=True))
        for s in SIGNS:
            for t in SIGNS:
                for node in ordered([self.form(s, t), self.form_of(self.power_force, s, t)]):
                    if node.op not in ("lt", "le"):
                        continue
                    try:
                        difference = leaf.convert(node.args[0] - node.args[1])
                    except Unclear:
                        continue
                    for name, root in linear_roots(difference):
                        switching[name].add(root)
        return {name: {x for x in roots if 0 < x < _FARTHEST} for name, roots in switching.items()}

    def numeric(self, outputs: Sequence[Expr], **inputs: Array) -> tuple[Value, ...]:
        """Expressions of the named inputs and the constants, in floats."""
        names = [n for n in self.values if n.isidentifier()]
        function = python_function([*names, *inputs], outputs)
        with np.errstate(all="ignore"):
            return function(*(float(self.values[n]) for n in names), *inputs.values())

    def number(self, x: Fraction) -> Expr:
        """An exact number as a symbol."""
        name = f"{_NUMBER}{x}"
        if name not in self.values:
            self.values[name] = x
            self.inputs[name] = down(x), up(x)
        return symbol(name)

    # -- forms -----------------------------------------------------------------------------------------------------

    def form(self, v_side: int, z_side: int) -> Expr:
        """dz/dt for v = v_side u and z = z_side w, with u, w > 0; a side of 0 is v = 0 or z = 0 exactly."""
        return self.form_of(self.rate, v_side, z_side)

    def form_of(self, expr: Expr, v_side: int, z_side: int) -> Expr:
        """An expression of v and z for such signs; |x|, signs and combined conditions as cases."""
        key = (expr, v_side, z_side)
        if key not in self._forms:
            here = {V: _sided(U, v_side), Z: _sided(W, z_side)}
            by_sign = rewrite(substitute([expr], here), lambda node: positive(without_root(node), self.values))
            self._forms[key] = rewrite(rewrite(by_sign, as_cases), self._settled)[0]
        return self._forms[key]

    def _settled(self, node: Expr) -> Expr:
        """The expression without conditions, minima and maxima that are the same for all u, w > 0."""
        if node.op in ("lt", "le") and node not in (TRUE, FALSE):
            with suppress(Unclear):
                holds = self._anywhere(Rules(opaque=True)).holds(node)
                return node if holds is None else TRUE if holds else FALSE
        if node.op == "where" and set(node.args[1:]) == set(node.args[0].args):
            less, more = node.args[0].args
            with suppress(Unclear):
                leaf = self._anywhere(Rules())
                above, below, _ = leaf.signs(leaf.convert(more - less))
                return node.args[1 if above else 2] if above or below else node
        return _without_infinite(node)

    def _anywhere(self, rules: Rules) -> Leaf:
        """A leaf for all u, w > 0."""
        axes = (Axis("u", Fraction(0), None), Axis("w", Fraction(0), None))
        return Leaf(Ring(self.ring.values), Region(axes), rules, self.inputs)


def _sided(x: Expr, side: int) -> Expr:
    return REST if side == 0 else x if side > 0 else -x


def finite(expr: Expr) -> Expr:
    """The expression without infinite literals, which may only be limits.

    Raises:
        Unreadable: one has another use, or a literal is nan.
    """
    cleaned = rewrite([expr], _without_infinite)[0]
    for node in ordered([cleaned]):
        if node.op == "floor":
            raise Unreadable("the equations hold floor(...), which the proofs do not treat")
        if isinstance(node.value, float) and not math.isfinite(node.value):
            raise Unreadable(f"the equations hold the number {node.value}")
        if node.op in ("both", "either", "where"):
            for a in node.args[: 1 if node.op == "where" else 2]:
                if a.op not in ("lt", "le", "both", "either"):
                    raise Unreadable(f"a condition that is no comparison: {a.op}")
    return cleaned


TRUE, FALSE = constant(0.0) < constant(1.0), constant(1.0) < constant(0.0)


def _without_infinite(node: Expr) -> Expr:
    def limit(x: Expr) -> float:
        return x.value if isinstance(x.value, float) and math.isinf(x.value) else 0.0

    if node.op in ("lt", "le"):
        a, b = map(limit, node.args)
        if a or b:
            return TRUE if a < b or (a == b and node.op == "le") else FALSE
    if node.op == "where" and node.args[0] in (TRUE, FALSE):
        return node.args[1 if node.args[0] is TRUE else 2]
    if node.op == "both" and set(node.args) & {TRUE, FALSE}:
        return FALSE if FALSE in node.args else node.args[1] if node.args[0] is TRUE else node.args[0]
    if node.op == "either" and set(node.args) & {TRUE, FALSE}:
        return TRUE if TRUE in node.args else node.args[1] if node.args[0] is FALSE else node.args[0]
    if node.op == "div" and limit(node.args[1]):
        return ZERO
    return node


def positive(node: Expr, values: Mapping[str, Fraction]) -> Expr:
    """The expression with |x|, signs and conditions decided by u > 0, w > 0 and the constants' signs."""
    if node.op in ("abs", "sign"):
        x = node.args[0]
        side = _sign_of(x, values)
        if side:
            size = x if side > 0 else -x
            return size if node.op == "abs" else constant(side)
        if x is REST:
            return REST if node.op == "abs" else ZERO
    if node.op in ("lt", "le"):
        for i, other in ((0, node.args[1]), (1, node.args[0])):
            if is_zero(other):
                part = node.args[i]
                side = _sign_of(part, values)
                if side:
                    return TRUE if (side < 0) == (i == 0) else FALSE
                for by in (U, W):
                    rest = divided(part, by)
                    part = part if rest is None else rest
                return rebuild(node, (part, other) if i == 0 else (other, part))
    if node.op in ("both", "either", "where"):
        node = _without_infinite(node)
    return node


def without_root(node: Expr) -> Expr:
    """The expression with sqrt(x^2) = |x| and (x^2)^c = |x|^(2 c) applied to explicit squares."""
    if node.op == "sqrt" and (x := square_root(node.args[0])) is not None:
        return abs(x)
    if node.op == "pow" and node.args[1].op == "constant" and (x := square_root(node.args[0])) is not None:
        return wrap(abs(x) ** (2 * node.args[1].value))  # type: ignore[operator]
    return node


def square_root(x: Expr) -> Expr | None:
    """The root of a product of squares, or None for another expression."""
    if x.op == "mul" and x.args[0] is x.args[1]:
        return x.args[0]
    if x.op in ("mul", "div"):
        first, second = (square_root(a) for a in x.args)
        return None if first is None or second is None else rebuild(x, (first, second))
    return None


def as_cases(node: Expr) -> Expr:
    """|x|, sign(x) and combined conditions as cases of single conditions."""
    if node.op == "abs":
        return wrap(where(node.args[0] >= ZERO, node.args[0], -node.args[0]))
    if node.op == "sign":
        x = node.args[0]
        return wrap(where(x > ZERO, 1.0, where(x < ZERO, -1.0, 0.0)))
    if node.op == "where":
        condition, a, b = node.args
        if condition.op == "both":
            inner = as_cases(wrap(where(condition.args[1], a, b)))
            return as_cases(wrap(where(condition.args[0], inner, b)))
        if condition.op == "either":
            inner = as_cases(wrap(where(condition.args[1], a, b)))
            return as_cases(wrap(where(condition.args[0], a, inner)))
    return node


def _sign_of(x: Expr, values: Mapping[str, Fraction]) -> int:
    if x is U or x is W:
        return 1
    if x.op == "neg":
        return -_sign_of(x.args[0], values)
    if x.op in ("mul", "div"):
        return _sign_of(x.args[0], values) * _sign_of(x.args[1], values)
    value = values.get(str(x.value), 0) if x.op == "symbol" else x.value if isinstance(x.value, float) else 0
    return int(value > 0) - int(value < 0)


def linear_roots(x: Quotient) -> list[tuple[str, Fraction]]:
    """The u or w at which a normal form vanishes, if it is linear in this variable and has no other."""
    degrees = [int(d) for d in x.top.degrees()]
    used = [i for i, d in enumerate(degrees) if d]
    if len(used) != 1 or used[0] not in (1, 2) or degrees[used[0]] != 1:
        return []
    terms = {k[used[0]]: c for k, c in x.top.to_dict().items()}
    root = -terms.get(0, 0) / terms[1]
    return [(("u", "w")[used[0] - 1], Fraction(int(root.p), int(root.q)) if root else Fraction(0))]


def divided(node: Expr, by: Expr) -> Expr | None:
    """node/by, with ``by`` > 0; None if ``by`` does not divide it."""
    if node is by:
        return ONE
    if is_zero(node):
        return ZERO
    if node.op == "mul":
        for i, a in enumerate(node.args):
            if (part := divided(a, by)) is not None:
                return part * node.args[1 - i]
    elif node.op == "div" and (part := divided(node.args[0], by)) is not None:
        return part / node.args[1]
    elif node.op == "abs" and (part := divided(node.args[0], by)) is not None:
        return abs(part)
    elif node.op in ("add", "sub", "neg", "where"):
        skip = 1 if node.op == "where" else 0
        parts = [divided(a, by) for a in node.args[skip:]]
        if all(part is not None for part in parts):
            return rebuild(node, (*node.args[:skip], *parts))  # type: ignore[arg-type]
    return None


def depends(expr: Expr, *on: Expr) -> bool:
    """Whether an expression contains one of these symbols."""
    return bool(symbols([expr]) & {str(x.value) for x in on})
