"""Quotients of polynomials with rational coefficients, and their signs over boxes by Bernstein coefficients."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from math import comb
from typing import Any

from flint import arb, ctx, fmpq, fmpq_mpoly_ctx, fmpq_poly

from stribeck_verify.expressions import Refused

Polynomial = Any  # flint's fmpq_mpoly
_PRECISION = 400  # bits, for the sign of polynomials in pi
_MOST = 50_000  # Bernstein coefficients of one polynomial


@dataclass(frozen=True)
class Quotient:
    """above/below; ``below`` is not 0 where it is used."""

    above: Polynomial
    below: Polynomial

    def same(self, other: Quotient) -> bool:
        """Whether the two are equal as rational functions."""
        return bool((self.above * other.below - other.above * self.below) == 0)


@dataclass(frozen=True)
class Variable:
    """A generator: ``unit`` (in [0, 1]) or else >= 0; ``strict``: > 0."""

    unit: bool
    strict: bool


class Ring:
    """Polynomials in pi and in variables of known ranges."""

    def __init__(self, variables: Iterable[Variable]) -> None:
        self.variables = list(variables)
        names = ["pi", *(f"x{i}" for i in range(len(self.variables)))]
        self.context = fmpq_mpoly_ctx.get(names, "lex")
        pi, *self.generators = self.context.gens()
        self.one = self.context.constant(1)
        self.pi = Quotient(pi, self.one)
        self._signs: dict[Hashable, tuple[int, bool] | None] = {}

    def number(self, x: fmpq | int) -> Quotient:
        """A rational number."""
        return Quotient(self.context.constant(fmpq(x)), self.one)

    def variable(self, i: int) -> Quotient:
        """The variable of that number."""
        return Quotient(self.generators[i], self.one)

    def reduced(self, above: Polynomial, below: Polynomial) -> Quotient:
        """The quotient without common factors."""
        if above == 0:
            return Quotient(above, self.one)
        if not below.is_constant():
            common = above.gcd(below)
            if not common.is_constant():
                above, below = above / common, below / common
        if below.is_constant():
            above, below = above / below, self.one
        return Quotient(above, below)

    def add(self, a: Quotient, b: Quotient, sign: int = 1) -> Quotient:
        """a + sign b."""
        if a.below == b.below:
            return self.reduced(a.above + sign * b.above, a.below)
        return self.reduced(a.above * b.below + sign * b.above * a.below, a.below * b.below)

    def mul(self, a: Quotient, b: Quotient) -> Quotient:
        """a b."""
        return self.reduced(a.above * b.above, a.below * b.below)

    def div(self, a: Quotient, b: Quotient) -> Quotient:
        """a/b, where b was shown to be not 0."""
        if b.above == 0:
            raise Refused("a divisor is 0")
        return self.reduced(a.above * b.below, a.below * b.above)

    # -- signs ---------------------------------------------------------------------------------------------------------

    def sign(self, x: Quotient) -> tuple[int, bool] | None:
        """(1, strict) where x >= 0 (> 0) everywhere, (-1, strict) where <= 0 (< 0), (0, False) where it is 0."""
        above, below = self.polynomial_sign(x.above), self.polynomial_sign(x.below)
        if above is None or below is None or not below[1]:
            return None
        return above[0] * below[0], above[1]

    def polynomial_sign(self, p: Polynomial) -> tuple[int, bool] | None:
        """As :meth:`sign`, of a polynomial."""
        if p == 0:
            return 0, False
        key = tuple(sorted((m, (int(c.p), int(c.q))) for m, c in p.to_dict().items()))
        if key not in self._signs:
            self._signs[key] = self._factors_sign(p)
        return self._signs[key]

    def _factors_sign(self, p: Polynomial) -> tuple[int, bool] | None:
        rest, strict = self._without_monomial(p)
        direct = self._bernstein(rest)
        if direct is not None and direct[1]:
            return direct[0], strict
        number, factors = rest.factor()
        if len(factors) == 1 and factors[0][1] == 1:
            return None if direct is None else (direct[0], False)
        sign = 1 if number > 0 else -1
        for factor, times in factors:
            factor_sign = self._bernstein(factor)
            if factor_sign is None and times % 2 == 0:
                strict = False
                continue
            if factor_sign is None:
                return None if direct is None else (direct[0], False)
            sign, strict = sign * factor_sign[0] ** times, strict and factor_sign[1]
        return sign, strict

    def _without_monomial(self, p: Polynomial) -> tuple[Polynomial, bool]:
        """p without powers of variables, and whether these are > 0."""
        least = [min(exponents) for exponents in zip(*p.monoms(), strict=True)]
        strict = all(v.strict for v, n in zip(self.variables, least[1:], strict=True) if n)
        if any(least):
            terms = {tuple(e - n for e, n in zip(m, least, strict=True)): c for m, c in p.to_dict().items()}
            p = self.context.from_dict(terms)
        return p, strict

    def _bernstein(self, p: Polynomial) -> tuple[int, bool] | None:
        """The sign of a polynomial that is not 0, by its Bernstein coefficients."""
        units = [i for i, v in enumerate(self.variables) if v.unit and p.degrees()[i + 1] > 0]
        degrees = [p.degrees()[i + 1] for i in units]
        count = 1
        for n in degrees:
            count *= n + 1
        if count > _MOST:
            return None
        groups: dict[tuple[int, ...], dict[tuple[int, ...], dict[int, fmpq]]] = {}
        for exponents, c in p.to_dict().items():
            positive = tuple(0 if v.unit else e for v, e in zip(self.variables, exponents[1:], strict=True))
            unit = tuple(exponents[i + 1] for i in units)
            groups.setdefault(positive, {}).setdefault(unit, {})[exponents[0]] = c
        sign, strict = 0, False
        for positive, terms in groups.items():
            signs = self._coefficient_signs(terms, degrees)
            if signs is None:
                return None
            low, high = min(signs), max(signs)
            if low < 0 < high or (sign and sign in (-low, -high)):
                return None
            sign = sign or low or high
            everywhere = all(v.strict for v, e in zip(self.variables, positive, strict=True) if e)
            strict = strict or (everywhere and low == high != 0)
        return sign, strict

    @staticmethod
    def _coefficient_signs(terms: dict[tuple[int, ...], dict[int, fmpq]], degrees: list[int]) -> set[int] | None:
        plain = all(set(powers) == {0} for powers in terms.values())
        values: list[Polynomial] = []
        for index in product(*(range(n + 1) for n in degrees)):
            powers = terms.get(index, {})
            if plain:
                values.append(powers.get(0, fmpq(0)))
            else:
                values.append(fmpq_poly([powers.get(k, fmpq(0)) for k in range(max(powers, default=0) + 1)]))
        stride = 1
        for n in reversed(degrees):
            matrix, done = _to_bernstein(n), list(values)
            for start in range(len(values)):
                if start // stride % (n + 1) == 0:
                    old = [values[start + i * stride] for i in range(n + 1)]
                    for j, row in enumerate(matrix):
                        done[start + j * stride] = sum((c * x for c, x in zip(row, old, strict=True) if c), 0 * old[0])
            values, stride = done, stride * (n + 1)
        signs = set()
        for x in values:
            sign = (x > 0) - (x < 0) if plain else _pi_sign(x)
            if sign is None:
                return None
            signs.add(int(sign))
        return signs


@lru_cache(maxsize=64)
def _to_bernstein(n: int) -> list[list[fmpq]]:
    """The matrix from the coefficients of powers to those of Bernstein's polynomials."""
    return [[fmpq(comb(j, i), comb(n, i)) for i in range(n + 1)] for j in range(n + 1)]


def _pi_sign(p: fmpq_poly) -> int | None:
    """The sign of a polynomial at pi."""
    if not p.coeffs():
        return 0
    with ctx.workprec(_PRECISION):
        x, power = arb(0), arb(1)
        for c in p.coeffs():
            x, power = x + arb(c) * power, power * arb.pi()
    return 1 if x > 0 else (-1 if x < 0 else None)
