"""One region of u = |v| and w = |z|: what holds on all of it, by Bernstein coefficients of normal forms."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from stribeck.expressions.graph import Expr, ordered
from stribeck.expressions.intervals import Box, Range
from stribeck.properties.plain import Json, Polynomial
from stribeck.properties.prover import atoms
from stribeck.properties.prover.bernstein import POSITIVE, UNIT, UNKNOWN, Signs, signs
from stribeck.properties.prover.region import Region
from stribeck.properties.prover.ring import ATOMS, Quotient, Ring, Unclear

_SHARES = 12  # unknowns in one region: 2**12 Bernstein coefficients at least, of the 20 000 that are computed
_LONG = 120  # terms beyond which denominators are not cleared


@dataclass(frozen=True)
class Rules:
    """How atoms are treated: "range", "far" (exp, atan, tanh), "tangent" (exp), "slope" (atan, tanh), "chord" (sqrt, pow);
    cases by "either" or "range"."""

    exp: str = "range"
    wave: str = "range"
    cases: str = "either"
    opaque: bool = False  # for identities: atoms need no range


@lru_cache(maxsize=1)
def _context() -> Polynomial:
    from flint import Ordering, fmpq_mpoly_ctx

    return fmpq_mpoly_ctx.get(("pi", "a", "b", *(f"c{i}" for i in range(_SHARES))), Ordering.lex)


class Leaf:
    """Proofs on a region with given rules for atoms."""

    def __init__(self, ring: Ring, region: Region, rules: Rules, inputs: Mapping[str, Range]) -> None:
        self.ring, self.region, self.rules = ring, region, rules
        self.context = _context()
        self.pi, *coordinates = self.context.gens()
        self.coordinates, self.free = coordinates[:2], list(enumerate(coordinates))[2:]
        self.kinds: list[str | None] = [None, None, *[UNIT] * _SHARES]
        self.opened = [False] * (2 + _SHARES)
        self.bounds = region.bounds()
        self.box = Box({**inputs, **self.bounds})
        self.places: list[Polynomial] = [None] * (3 + ATOMS)  # numerators of the generators
        self.below: list[Polynomial] = [None] * (3 + ATOMS)  # their denominators, None for 1
        self.places[0] = self.pi
        self._substitute_coordinates()
        self.listed: dict[int, list[Json]] = {}  # atoms used: rule and numbers
        self.sums = 0  # of coefficients, formed so far: work
        self._signs: dict[int, Signs] = {}
        self._factors: dict[str, Signs] = {}
        self._known: dict[Expr, Quotient] = {}
        self._unclear: dict[Expr, str] = {}  # what cannot be treated here, and why
        self._defined: dict[Expr, bool] = {}

    def number(self, x: Fraction) -> Polynomial:
        """A number as a polynomial of the coordinates."""
        from flint import fmpq

        return self.context.constant(fmpq(x.numerator, x.denominator))

    def _substitute_coordinates(self) -> None:
        """u and w as polynomials of the coordinates."""
        values = {}
        for i, axis in enumerate(self.region.axes):
            c = self.coordinates[i]
            if axis.high is None:
                values[axis.name] = self.number(axis.low) + c
                self.kinds[i] = POSITIVE
            else:
                values[axis.name] = self.number(axis.low) + self.number(axis.high - axis.low) * c
                self.kinds[i] = UNIT
            self.opened[i] = axis.low == 0 and (axis.high is None or axis.high > 0) and not self.region.closed
        if "p" in values:
            values["u"] = values["p"] * values["w"]
        if "q" in values:
            values["w"] = values["q"] * values["u"]
        for i, name in ((1, "u"), (2, "w")):
            self.places[i] = values.get(name)

    # -- normal forms ----------------------------------------------------------------------------------------------

    def convert(self, node: Expr) -> Quotient:
        """The normal form of an expression on this region.

        Raises:
            Unclear: it holds what cannot be treated here.
        """
        form = self._known.get(node)
        if form is None:
            if node in self._unclear:
                raise Unclear(self._unclear[node])
            try:
                form = self._known[node] = self._value(node)
            except Unclear as reason:  # kept: nested cases would ask for it again and again
                self._unclear[node] = str(reason)
                raise
        return form

    def _value(self, node: Expr) -> Quotient:
        op, ring = node.op, self.ring
        if op == "symbol":
            return ring.symbol(str(node.value))
        if op == "constant":
            assert isinstance(node.value, float)
            return ring.number(node.value)
        if op == "where":
            return self._where(node)
        if op in ("add", "sub", "mul", "div", "neg"):
            args = [self.convert(a) for a in node.args]
            if op == "div" and not self.signs(args[1])[2]:
                raise Unclear("a divisor may be 0")
            return ring.apply(op, *args)
        if op in ("abs", "sign"):
            return self._size(node, self.convert(node.args[0]))
        if op == "pow":
            return atoms.power(self, node, *(self.convert(a) for a in node.args))
        try:
            x = self.convert(node.args[0])
        except Unclear:
            if op == "exp":  # of what has no finite range, such as -|v|^delta
                return self._by_range(node)
            raise
        return atoms.function(self, node, x)

    def _by_range(self, node: Expr) -> Quotient:
        """An atom of which only the range is used; what it holds must have a value everywhere."""
        if not self.defined(node):
            raise Unclear(f"{node.op} may have no value somewhere")
        return atoms.ranged(self, self.ring.atom(("node", node), node), node)

    def defined(self, node: Expr) -> bool:
        """Whether no divisor, root, logarithm or power in an expression is singular, as far as ranges tell."""
        if node not in self._defined:
            self._defined[node] = self._has_value(node)
        return self._defined[node]

    def _has_value(self, node: Expr) -> bool:
        for each in ordered([node]):
            if each.op == "div":
                low, high = self.box(each.args[1])
                fine = low > 0 or high < 0
            elif each.op in ("sqrt", "log", "pow"):
                low, _ = self.box(each.args[0])
                fine = low > 0 or (low == 0 and each.op == "sqrt")
                fine = fine or (low == 0 and each.op == "pow" and self.box(each.args[1])[0] > 0)
            else:
                continue
            if not fine:
                return False
        return True

    def _size(self, node: Expr, x: Quotient) -> Quotient:
        above, below, strict = self.signs(x)
        if node.op == "abs" and (above or below):
            return x if above else self.ring.apply("neg", x)
        if x.is_zero:
            return self.ring.zero
        if node.op == "sign" and (above or below) and strict:
            return self.ring.one if above else self.ring.apply("neg", self.ring.one)
        if self.rules.cases == "range":
            return self._by_range(node)
        share = self._share(("le", self.ring.zero.number, x.number), node)
        twice = self.ring.apply("sub", self.ring.apply("mul", self.ring.constant(Fraction(2)), share), self.ring.one)
        return self.ring.apply("mul", x, twice) if node.op == "abs" else twice

    def _share(self, key: Hashable, node: Expr) -> Quotient:
        """The share of a condition that is not settled: between 0 and 1."""
        atom = self.ring.atom(("share", key), node)
        index = self.ring.index(atom)
        if index not in self.listed:
            self.listed[index] = ["either"]
            self.places[3 + index] = self.fresh()
        return atom

    def fresh(self, positive: bool = False) -> Polynomial:
        """A share in [0, 1]; or something >= 0.

        Raises:
            Unclear: there are too many.
        """
        if not self.free:
            raise Unclear("too many shares")
        i, generator = self.free.pop(0)
        self.kinds[i] = POSITIVE if positive else UNIT
        return generator

    def set_atom(self, index: int, top: Polynomial, bottom: Polynomial, *rule: Json) -> bool:
        """The value of an atom, and the rule that gives it."""
        self.places[3 + index], self.below[3 + index] = top, bottom
        self.listed[index] = list(rule)
        return True

    def _where(self, node: Expr) -> Quotient:
        condition, a, b = node.args
        holds = self.holds(condition)
        if holds is not None:
            return self.convert(a if holds else b)
        if condition.op in ("lt", "le"):
            less, more = (self.convert(x) for x in condition.args)
            x, y = self._try(a), self._try(b)
            if x is not None and y is not None:
                way = self.ring.apply("sub", more, less)
                above, below, _ = self.signs(way)
                if (above or below) and divides(
                    way, self.ring.apply("sub", x, y)
                ):  # x = y where the two sides are equal
                    return x if above else y
        if self.rules.cases == "range":
            return self._by_range(node)
        key: Hashable = condition
        if condition.op in ("lt", "le"):
            key = (condition.op, *(self.convert(a).number for a in condition.args))
        x, y = self.convert(a), self.convert(b)
        share = self._share(key, node)
        return self.ring.apply("add", y, self.ring.apply("mul", share, self.ring.apply("sub", x, y)))

    def _try(self, node: Expr) -> Quotient | None:
        try:
            return self.convert(node)
        except Unclear:
            return None

    def holds(self, condition: Expr) -> bool | None:
        """Whether a condition holds on the whole region, or nowhere on it; None where it is not settled."""
        by_range = self.box(condition)
        if by_range is not None and self.defined(condition):
            return bool(by_range)
        if condition.op in ("both", "either"):
            parts = [self.holds(a) for a in condition.args]
            if condition.op == "both":
                return False if False in parts else True if parts == [True, True] else None
            return True if True in parts else False if parts == [False, False] else None
        less, more = (self.convert(a) for a in condition.args)
        above, below, strict = self.signs(self.ring.apply("sub", more, less))
        if condition.op == "lt":
            return True if above and strict else False if below else None
        return True if above else False if below and strict else None

    # -- signs -----------------------------------------------------------------------------------------------------

    def signs(self, x: Quotient) -> Signs:
        """Whether a value is >= 0, <= 0, and not 0 on the whole region."""
        if x.is_zero:
            return True, True, False
        if x.number not in self._signs:
            self._signs[x.number] = self._product(x)
        return self._signs[x.number]

    def _product(self, x: Quotient) -> Signs:
        above, below, strict = True, False, True
        for which in ("top", "bottom"):
            content, factors = x.factors(which)
            if content < 0:
                above, below = below, above
            for factor, power in factors:
                p, n, s = self._factor(factor)
                strict = strict and s
                if power % 2 == 0:
                    if which == "bottom" and not s:
                        return UNKNOWN
                    continue
                if not (p or n) or (which == "bottom" and not s):
                    return UNKNOWN
                if n and not p:
                    above, below = below, above
                elif n and p:  # it is 0
                    return True, True, False
        return above, below, strict

    def _factor(self, factor: Polynomial) -> Signs:
        key = str(factor)
        if key not in self._factors:
            self._factors[key] = UNKNOWN
            if self._positive_atom(factor):
                self._factors[key] = True, False, True
                return self._factors[key]
            composed = self._composed(factor)
            if composed is not None:
                p, n, s = signs(composed[0].to_dict(), self.kinds, self.opened, self._spend)
                self._factors[key] = p, n, s
        return self._factors[key]

    def _spend(self, sums: int) -> None:
        self.sums += sums

    def _positive_atom(self, factor: Polynomial) -> bool:
        """Whether it is an atom that is > 0 by its nature: exp, or a root of something > 0."""
        if len(factor) != 1 or factor.leading_coefficient() != 1:
            return False
        powers = factor.monoms()[0]
        used = [i for i, power in enumerate(powers) if power]
        if len(used) != 1 or used[0] < 3 or powers[used[0]] != 1:
            return False
        node = self.ring.atoms[used[0] - 3]
        if node.op not in ("exp", "sqrt", "pow"):
            return False
        if node.op == "exp":
            return True
        try:
            above, _, strict = self.signs(self.convert(node.args[0]))
        except Unclear:
            return False
        return above and strict

    def composed_quotient(self, x: Quotient) -> tuple[Polynomial, Polynomial] | None:
        """Numerator and positive denominator in coordinates and shares."""
        top, bottom = self._composed(x.top), self._composed(x.bottom)
        if top is None or bottom is None:
            return None
        numerator, denominator = top[0] * bottom[1], bottom[0] * top[1]
        above, below, strict = signs(denominator.to_dict(), self.kinds, self.opened)
        if not strict or not (above or below):
            return None
        return (numerator, denominator) if above else (-numerator, -denominator)

    def _composed(self, polynomial: Polynomial) -> tuple[Polynomial, Polynomial] | None:
        """The polynomial in coordinates and shares, as numerator and (positive) denominator."""
        used = [i for i, d in enumerate(polynomial.degrees()) if d]
        if any(self.places[i] is None for i in used):
            return None
        uneven = [i for i in used if self.below[i] is not None]
        if uneven and len(polynomial) > _LONG:
            return None
        unity = self.number(Fraction(1))
        if not uneven:
            zero = self.number(Fraction(0))
            return polynomial.compose(*(self.places[i] if i in used else zero for i in range(len(self.places)))), unity
        degrees = polynomial.degrees()
        powers = {i: _powers(self.places[i], int(degrees[i]), unity) for i in used}
        under = {i: _powers(self.below[i], int(degrees[i]), unity) for i in uneven}
        total = self.number(Fraction(0))
        for k, c in polynomial.to_dict().items():
            term = unity * c
            for i in used:
                term = term * powers[i][int(k[i])]
                if i in under:
                    term = term * under[i][int(degrees[i]) - int(k[i])]
            total = total + term
        bottom = unity
        for i in uneven:
            bottom = bottom * under[i][int(degrees[i])]
        return total, bottom

    def certificate(self) -> list[tuple[Expr, list[Json]]]:
        """The atoms used, with their rules."""
        return [(self.ring.atoms[i], rule) for i, rule in self.listed.items()]


def divides(a: Quotient, b: Quotient) -> bool:
    """Whether b is 0 wherever a is, as a multiple of it."""
    return b.is_zero or (not a.is_zero and bool((a.top / a.top.gcd(b.top)).is_constant()))


def _powers(x: Polynomial, most: int, unity: Polynomial) -> list[Polynomial]:
    powers = [unity]
    for _ in range(most):
        powers.append(powers[-1] * x)
    return powers
