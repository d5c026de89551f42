"""Signs of expressions of v by exact algebra, where intervals cannot tell because the expression touches 0.

Each transcendental part becomes a share of which only the range [0, 1] is used: exp(-x) = 1 - E, and for y > 0
atan(y) = pi/2 - (1 - A)/y, because 0 <= y atan(1/y) <= 1, or atan(y) = (pi/2) B, and sqrt(u^2 + r^2) = u + r Q. What is left
is a quotient of polynomials in pi, u = |v| > 0 and the shares, with rational coefficients. It has a sign if its factors have,
and a factor has one if its Bernstein coefficients in the shares have, for every power of u.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import comb
from typing import Any

import numpy as np

from stribeck.errors import needed
from stribeck.expressions.graph import Expr
from stribeck.expressions.intervals import Evaluator, point
from stribeck.expressions.pretty import multiple_of_pi

_SHARES = 10
_MOST_TERMS = 4000


class Unclear(Exception):
    """An expression that this algebra cannot treat; ``condition`` where a case distinction at ``speed`` would help."""

    def __init__(self, text: str, condition: Expr | None = None, speed: Fraction | None = None) -> None:
        super().__init__(text)
        self.condition, self.speed = condition, speed


@dataclass(frozen=True)
class Signs:
    """What is known of the sign of a value."""

    not_negative: bool
    not_positive: bool
    not_zero: bool


@dataclass(frozen=True)
class _Quotient:
    top: Any
    bottom: Any


class Algebra:
    """Converts expressions of ``u`` for one range of u and tells their signs.

    Args:
        values: the constants.
        start: u begins here.
        end: u ends here, None for no end.
        forms: 1 or 2, of atan.
        decided: conditions that are known to hold, or not to hold, in this range.
    """

    def __init__(
        self, values: Mapping[str, float], start: Fraction = Fraction(0), end: Fraction | None = None, form: int = 1,
        decided: Mapping[Expr, bool] | None = None,
    ) -> None:  # fmt: skip
        with needed("a proof"):
            from flint import Ordering, fmpq, fmpq_mpoly_ctx

        self._number = lambda x: fmpq(Fraction(x).numerator, Fraction(x).denominator)
        names = ("pi", "u", *(f"e{i}" for i in range(_SHARES)))
        self.context = fmpq_mpoly_ctx.get(names, Ordering.lex)
        self.pi, self.u, *self.shares = self.context.gens()
        self.values, self.form, self.decided = values, form, dict(decided or {})
        self.used = 0
        if end is None:
            self.speed = self._plus(self._constant(start), _Quotient(self.u, self.one))
        else:
            share = _Quotient(self._share(), self.one)
            self.speed = self._plus(self._constant(start), self._times(self._constant(end - start), share))
        self.known: dict[Expr, _Quotient] = {}

    @property
    def one(self) -> Any:
        """1."""
        return self.context.constant(1)

    def _share(self) -> Any:
        if self.used == _SHARES:
            raise Unclear("too many transcendental parts")
        self.used += 1
        return self.shares[self.used - 1]

    def _constant(self, x: float | Fraction) -> _Quotient:
        return _Quotient(self.context.constant(self._number(x)), self.one)

    def _reduced(self, top: Any, bottom: Any) -> _Quotient:
        if len(top.to_dict()) > _MOST_TERMS:
            raise Unclear("too many terms")
        common = top.gcd(bottom)
        return _Quotient(top / common, bottom / common) if not common.is_one() else _Quotient(top, bottom)

    def _plus(self, a: _Quotient, b: _Quotient) -> _Quotient:
        return self._reduced(a.top * b.bottom + b.top * a.bottom, a.bottom * b.bottom)

    def _minus(self, a: _Quotient, b: _Quotient) -> _Quotient:
        return self._plus(a, _Quotient(-b.top, b.bottom))

    def _times(self, a: _Quotient, b: _Quotient) -> _Quotient:
        return self._reduced(a.top * b.top, a.bottom * b.bottom)

    def _over(self, a: _Quotient, b: _Quotient) -> _Quotient:
        if b.top.is_zero() or not self.signs(b).not_zero:
            raise Unclear("a divisor may be 0")
        return self._reduced(a.top * b.bottom, a.bottom * b.top)

    # -- conversion ------------------------------------------------------------------------------------------------

    def convert(self, expr: Expr) -> _Quotient:
        """The expression in this algebra.

        Raises:
            Unclear: it holds what cannot be treated.
        """
        if expr in self.known:
            return self.known[expr]
        found = self._where(expr) if expr.op == "where" else self._value(expr, [self.convert(a) for a in expr.args])
        self.known[expr] = found
        return found

    def _value(self, node: Expr, args: list[_Quotient]) -> _Quotient:
        if node.op == "symbol":
            return self.speed if node.value == "u" else self._constant(self.values[str(node.value)])
        if node.op == "constant":
            assert isinstance(node.value, float)
            return self._literal(node.value)
        if node.op in ("add", "sub", "mul", "div"):
            name = {"add": "_plus", "sub": "_minus", "mul": "_times", "div": "_over"}[node.op]
            return getattr(self, name)(*args)  # type: ignore[no-any-return]
        if node.op == "neg":
            return _Quotient(-args[0].top, args[0].bottom)
        if node.op in ("abs", "exp", "atan", "tanh", "sqrt"):
            return self._function(node.op, args[0])
        raise Unclear(f"{node.op} of a value")

    def _literal(self, x: float) -> _Quotient:
        multiple = multiple_of_pi(x)
        if multiple is None:
            return self._constant(x)
        ratio, above = multiple
        number = self.context.constant(self._number(ratio))
        return _Quotient(number * self.pi, self.one) if above else _Quotient(number, self.pi)

    def _function(self, op: str, x: _Quotient) -> _Quotient:
        signs = self.signs(x)
        if op == "sqrt":
            return self._root(x)
        if not (signs.not_negative or signs.not_positive):
            raise Unclear(f"{op} of a value whose sign changes")
        size = x if signs.not_negative else _Quotient(-x.top, x.bottom)
        if op == "abs":
            return size
        if op == "exp":
            if not signs.not_positive:
                raise Unclear("exp of a positive value")
            return _Quotient(self.one - self._share(), self.one)
        share = _Quotient(self._share(), self.one)
        if op == "tanh":
            found = share
        elif self.form == 1 and signs.not_zero:
            left = self._over(self._minus(self._constant(1), share), size)
            found = self._minus(self._times(self._constant(Fraction(1, 2)), _Quotient(self.pi, self.one)), left)
        else:
            found = self._times(_Quotient(self.pi, self.context.constant(2)), share)
        return found if signs.not_negative else _Quotient(-found.top, found.bottom)

    def _root(self, x: _Quotient) -> _Quotient:
        rest = self._minus(x, self._times(self.speed, self.speed))
        powers = rest.top.to_dict()
        if not rest.bottom.is_constant() or any(any(k) for k in powers) or not self.signs(rest).not_negative:
            raise Unclear("a root that is not sqrt(v^2 + r^2)")
        square = Fraction(0)
        if powers:
            c, d = next(iter(powers.values())), next(iter(rest.bottom.to_dict().values()))
            square = Fraction(int(c.p), int(c.q)) / Fraction(int(d.p), int(d.q))
        r = Fraction(float(np.nextafter(float(square) ** 0.5, np.inf)))
        while r * r < square:
            r *= 1 + Fraction(1, 2**50)
        return self._plus(self.speed, self._times(self._constant(r), _Quotient(self._share(), self.one)))

    def _where(self, node: Expr) -> _Quotient:
        condition, a, b = node.args
        holds = self._holds(condition, a, b)
        return self.convert(a if holds else b)

    def _holds(self, condition: Expr, a: Expr, b: Expr) -> bool:
        if condition in self.decided:
            return self.decided[condition]
        if condition.op not in ("lt", "le"):
            raise Unclear("a combined condition")
        less, more = (self.convert(x) for x in condition.args)
        difference = self._minus(less, more)
        signs = self.signs(difference)
        if signs.not_positive and (signs.not_zero or condition.op == "le"):
            return True
        if signs.not_negative and (signs.not_zero or condition.op == "lt"):
            return False
        if {a, b} <= set(condition.args) and (signs.not_positive or signs.not_negative):
            return signs.not_positive  # where both sides are equal, so are a and b
        raise Unclear("a condition that changes", condition, self._root_of(difference))

    def _root_of(self, x: _Quotient) -> Fraction | None:
        """The speed at which a value that is linear in u vanishes."""
        powers = x.top.to_dict()
        linear, rest = (0, 1, *([0] * _SHARES)), (0,) * (2 + _SHARES)
        if set(powers) != {linear, rest}:
            return None
        root = -powers[rest] / powers[linear]
        return Fraction(int(root.p), int(root.q))

    # -- signs -----------------------------------------------------------------------------------------------------

    def signs(self, x: _Quotient) -> Signs:
        """The sign of a value over the whole range, as far as it can be told."""
        if x.top.is_zero():
            return Signs(True, True, False)
        positive, negative, strict = True, False, True  # of the product of all factors so far: >= 0, <= 0, not 0
        for polynomial in (x.top, x.bottom):
            content, factors = polynomial.factor()
            if content < 0:
                positive, negative = negative, positive
            for factor, power in factors:
                s = self._polynomial(factor)
                strict = strict and s.not_zero
                if power % 2 == 0:
                    continue
                if s.not_negative:
                    continue
                if not s.not_positive:
                    return Signs(False, False, False)
                positive, negative = negative, positive
        return Signs(positive, negative, strict)

    def _polynomial(self, polynomial: Any) -> Signs:
        """The signs of a polynomial, from its Bernstein coefficients in the shares for each power of u."""
        by_power: dict[int, dict[tuple[int, ...], dict[int, Fraction]]] = {}
        for powers, c in polynomial.to_dict().items():
            of_pi, of_u, *shares = (int(k) for k in powers)
            in_pi = by_power.setdefault(of_u, {}).setdefault(tuple(shares), {})
            in_pi[of_pi] = in_pi.get(of_pi, Fraction(0)) + Fraction(int(c.p), int(c.q))
        low, high, strict = True, True, False
        for table in by_power.values():
            values = [_sign(c) for c in _bernstein(table)]
            low, high = low and min(values) >= 0, high and max(values) <= 0
            strict = strict or min(values) > 0 or max(values) < 0
        return Signs(low, high, strict and (low or high))


def _bernstein(table: Mapping[tuple[int, ...], Mapping[int, Fraction]]) -> list[dict[int, Fraction]]:
    degrees = [max(k[i] for k in table) for i in range(_SHARES)]
    found = []
    for corner in product(*(range(n + 1) for n in degrees)):
        total: dict[int, Fraction] = {}
        for powers, c in table.items():
            if any(p > i for p, i in zip(powers, corner, strict=True)):
                continue
            weight = Fraction(1)
            for i, p, n in zip(corner, powers, degrees, strict=True):
                weight *= Fraction(comb(i, p), comb(n, p))
            for k, x in c.items():
                total[k] = total.get(k, Fraction(0)) + weight * x
        found.append(total)
    return found


def _sign(c: Mapping[int, Fraction]) -> int:
    """The sign of a polynomial in pi; a coefficient that rounding cannot tell from 0 counts as both signs' enemy."""
    c = {k: x for k, x in c.items() if x}
    if not c:
        return 0
    if all(x > 0 for x in c.values()) or all(x < 0 for x in c.values()):
        return 1 if next(iter(c.values())) > 0 else -1
    from flint import arb, fmpq

    total = arb(0)
    for k, x in c.items():
        total += arb(fmpq(x.numerator, x.denominator)) * arb.pi() ** k
    if total > 0:
        return 1
    if total < 0:
        return -1
    raise Unclear("a coefficient too close to 0")


def sign_over_all(expr: Expr, values: Mapping[str, float], depth: int = 3) -> Signs:
    """The sign of an expression of u for all u > 0, with cases where a condition on u changes."""
    best = Signs(False, False, False)
    for form in (1, 2):
        try:
            found = _cases(expr, values, form, Fraction(0), None, {}, depth)
        except Unclear:
            continue
        if found.not_negative or found.not_positive:
            return found
    return best


def _cases(
    expr: Expr, values: Mapping[str, float], form: int, start: Fraction, end: Fraction | None,
    decided: Mapping[Expr, bool], depth: int,
) -> Signs:  # fmt: skip
    algebra = Algebra(values, start, end, form, decided)
    try:
        return algebra.signs(algebra.convert(expr))
    except Unclear as unclear:
        speed, condition = unclear.speed, unclear.condition
        inside = speed is not None and speed > start and (end is None or speed < end)
        if condition is None or speed is None or not inside or depth == 0:
            raise
        slow_first = _true_when_slow(condition, values)
    slow = _cases(expr, values, form, start, speed, {**decided, condition: slow_first}, depth - 1)
    fast = _cases(expr, values, form, speed, end, {**decided, condition: not slow_first}, depth - 1)
    return Signs(
        slow.not_negative and fast.not_negative,
        slow.not_positive and fast.not_positive,
        slow.not_zero and fast.not_zero,
    )


def _true_when_slow(condition: Expr, values: Mapping[str, float]) -> bool:
    """Whether a condition whose two sides cross at one speed holds below it."""
    inputs = {n: point(x) for n, x in values.items()} | {"u": point(1e-200)}
    known = Evaluator([condition]).all(inputs)
    return bool(known[condition].must)
