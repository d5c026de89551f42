"""One region of u = |v| and w = |z|: what holds on all of it, by Bernstein coefficients of normal forms."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any

from stribeck.expressions.graph import Expr, ordered, rebuild
from stribeck.expressions.ranges import INF, PI, Box, Range, ends_of
from stribeck.properties.prover.bernstein import POSITIVE, UNIT, UNKNOWN, Signs, signs
from stribeck.properties.prover.ring import ATOMS, Quotient, Ring, Unclear

_SHARES = 12
_LONG = 120  # terms beyond which denominators are not cleared
_FAR = Fraction(10) ** 300
End = Fraction | None  # None: no end


@dataclass(frozen=True)
class Axis:
    """A coordinate and its range."""

    name: str
    low: Fraction
    high: End


@dataclass(frozen=True)
class Region:
    """A part of the domain. ``axes`` are some of u and w, or (w, p) with u = p w, or (u, q) with w = q u.

    Attributes:
        limits: the ranges of u and w that the claim is about.
        closed: u = 0 and w = 0 belong to it, where a range begins with 0.
    """

    axes: tuple[Axis, ...]
    limits: tuple[Axis, ...]
    closed: bool = False

    def axis(self, name: str) -> Axis | None:
        """The axis of that name."""
        return next((a for a in self.axes if a.name == name), None)

    def split(self, name: str, at: Fraction) -> tuple[Region, Region]:
        """Below and above ``at``."""
        parts = []
        for low in (True, False):
            cut = [a if a.name != name else Axis(name, a.low, at) if low else Axis(name, at, a.high) for a in self.axes]
            parts.append(Region(tuple(cut), self.limits, self.closed))
        return parts[0], parts[1]

    def with_axes(self, *axes: Axis) -> Region:
        """The same claim in other coordinates."""
        return Region(axes, self.limits, self.closed)

    def bounds(self) -> dict[str, Range]:
        """The ranges of u and w, as floats rounded outward."""
        found: dict[str, Range] = {}
        for axis in self.axes:
            found[axis.name] = _floats(axis)
        for share, of, by in (("p", "u", "w"), ("q", "w", "u")):
            if share in found:
                a, b = found.pop(share), found[by]
                low, high = _down(Fraction(a[0]) * Fraction(b[0])), INF
                if a[1] < INF and b[1] < INF:
                    high = _up(Fraction(a[1]) * Fraction(b[1]))
                found[of] = (low, high)
        for axis in self.limits:
            least, most = _floats(axis)
            if axis.name in found:
                a = found[axis.name]
                found[axis.name] = (max(a[0], least), max(min(a[1], most), max(a[0], least)))
        return found


def _down(x: Fraction) -> float:
    from math import nextafter

    f = float(x) if abs(x) < _FAR else (1e300 if x > 0 else -INF)
    return f if Fraction(f) <= x else nextafter(f, -INF)


def _up(x: Fraction) -> float:
    from math import nextafter

    f = float(x) if abs(x) < _FAR else (INF if x > 0 else -1e300)
    return f if f == INF or Fraction(f) >= x else nextafter(f, INF)


def _floats(axis: Axis) -> Range:
    return _down(axis.low), INF if axis.high is None else _up(axis.high)


@dataclass(frozen=True)
class Rules:
    """How atoms are treated: "range" or "far" (exp, atan, tanh), "slope" (atan, tanh), "either" or "range" (cases)."""

    exp: str = "range"
    wave: str = "range"
    cases: str = "either"
    opaque: bool = False  # for identities: atoms need no range


@lru_cache(maxsize=1)
def _context() -> Any:
    from flint import Ordering, fmpq_mpoly_ctx

    return fmpq_mpoly_ctx.get(("pi", "a", "b", *(f"c{i}" for i in range(_SHARES))), Ordering.lex)


class Leaf:
    """What can be shown on a region with certain rules for atoms."""

    def __init__(self, ring: Ring, region: Region, rules: Rules, inputs: Mapping[str, Range]) -> None:
        self.ring, self.region, self.rules = ring, region, rules
        self.context = _context()
        self.pi, *coordinates = self.context.gens()
        self.coordinates, self.free = coordinates[:2], list(coordinates[2:])
        self.kinds: list[str | None] = [None, None, *[UNIT] * _SHARES]
        self.opened = [False] * (2 + _SHARES)
        self.bounds = region.bounds()
        self.box = Box({**inputs, **self.bounds})
        self.places: list[Any] = [None] * (3 + ATOMS)  # numerators of the generators
        self.below: list[Any] = [None] * (3 + ATOMS)  # their denominators, None for 1
        self.places[0] = self.pi
        self._place()
        self.listed: dict[int, list[Any]] = {}  # atoms used: rule and numbers
        self._signs: dict[int, Signs] = {}
        self._factors: dict[Any, Signs] = {}
        self._known: dict[Expr, Quotient] = {}
        self._defined: dict[Expr, bool] = {}

    def _number(self, x: Fraction) -> Any:
        from flint import fmpq

        return self.context.constant(fmpq(x.numerator, x.denominator))

    def _place(self) -> None:
        """u and w as polynomials of the coordinates."""
        values = {}
        for i, axis in enumerate(self.region.axes):
            c = self.coordinates[i]
            if axis.high is None:
                values[axis.name] = self._number(axis.low) + c
                self.kinds[i] = POSITIVE
            else:
                values[axis.name] = self._number(axis.low) + self._number(axis.high - axis.low) * c
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
        found = self._known.get(node)
        if found is None:
            found = self._known[node] = self._value(node)
        return found

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
            return self._power(node, *(self.convert(a) for a in node.args))
        try:
            x = self.convert(node.args[0])
        except Unclear:
            if op == "exp":  # of what has no finite range, such as -|v|^delta
                return self._by_range(node)
            raise
        return self._function(node, x)

    def _by_range(self, node: Expr) -> Quotient:
        """An atom of which only the range is used; what it holds must have a value everywhere."""
        if not self.defined(node):
            raise Unclear(f"{node.op} may have no value somewhere")
        return self._ranged(self.ring.atom(("node", node), node), node)

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

    def _share(self, key: Any, node: Expr) -> Quotient:
        """The share of a condition that is not settled: between 0 and 1."""
        found = self.ring.atom(("share", key), node)
        index = self.ring.index(found)
        if index not in self.listed:
            self.listed[index] = ["either"]
            self.places[3 + index] = self._fresh()
        return found

    def _fresh(self) -> Any:
        if not self.free:
            raise Unclear("too many shares")
        return self.free.pop(0)

    def _where(self, node: Expr) -> Quotient:
        condition, a, b = node.args
        holds = self.holds(condition)
        if holds is not None:
            return self.convert(a if holds else b)
        if condition.op in ("lt", "le"):
            less, more = (self.convert(x) for x in condition.args)
            x, y = self._try(a), self._try(b)
            if x is not None and y is not None and {x.number, y.number} == {less.number, more.number}:
                above, below, _ = self.signs(self.ring.apply("sub", more, less))
                if above or below:
                    return x if above else y
        if self.rules.cases == "range":
            return self._by_range(node)
        key = self._key(condition)
        x, y = self.convert(a), self.convert(b)
        share = self._share(key, node)
        return self.ring.apply("add", y, self.ring.apply("mul", share, self.ring.apply("sub", x, y)))

    def _try(self, node: Expr) -> Quotient | None:
        try:
            return self.convert(node)
        except Unclear:
            return None

    def _key(self, condition: Expr) -> Any:
        if condition.op in ("lt", "le"):
            return (condition.op, *(self.convert(a).number for a in condition.args))
        return condition

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

    def _power(self, node: Expr, base: Quotient, power: Quotient) -> Quotient:
        if power.top.is_constant() and power.bottom.is_constant():
            value = Fraction(0) if power.is_zero else _rational(power)
            if value.denominator == 1 and abs(value) <= 16:
                if value <= 0 and not self.signs(base)[2]:
                    raise Unclear("a power of what may be 0")
                found = self.ring.one
                for _ in range(abs(int(value))):
                    found = self.ring.apply("mul", found, base)
                return found if value >= 0 else self.ring.apply("div", self.ring.one, found)
        if base.is_zero and self.signs(power)[0] and self.signs(power)[2]:
            return self.ring.zero
        if not self.signs(base)[0]:
            raise Unclear("a power of what may be negative")
        atom = self.ring.atom(("pow", base.number, power.number), node)
        return self._ranged(atom, node)

    def _function(self, node: Expr, x: Quotient) -> Quotient:
        op = node.op
        if x.is_zero:
            if op == "log":
                raise Unclear("the logarithm of 0")
            return self.ring.one if op in ("exp", "cos") else self.ring.zero
        if op in ("sin", "cos") and (wave := _quarter(self.ring, op, x)) is not None:
            return self.ring.constant(Fraction(wave))
        if op in ("atan", "tanh", "sin", "cos") and _leads_negative(x):  # odd, but for cos: one atom for x and -x
            found = self._function(_opposite(node), self.ring.apply("neg", x))
            return found if op == "cos" else self.ring.apply("neg", found)
        if op in ("sqrt", "log"):
            above, _, strict = self.signs(x)
            if not above or (op == "log" and not strict):
                raise Unclear(f"{op} of what may be negative")
        atom = self.ring.atom((op, x.number), node)
        index = self.ring.index(atom)
        if self.places[3 + index] is not None:
            return atom
        if op in ("atan", "tanh", "exp") and self._special(op, index, x, node):
            return atom
        if op == "sqrt" and self.rules.wave == "far" and self._root(index, x):
            return atom
        return self._ranged(atom, node)

    def _set(self, index: int, top: Any, bottom: Any, *rule: Any) -> bool:
        self.places[3 + index], self.below[3 + index] = top, bottom
        self.listed[index] = list(rule)
        return True

    def _special(self, op: str, index: int, x: Quotient, node: Expr) -> bool:
        """The rules "far" and "slope"."""
        above, below, strict = self.signs(x)
        rule = self.rules.exp if op == "exp" else self.rules.wave
        if rule == "range" or not (below if op == "exp" else above) or (op == "atan" and not strict):
            return False
        top, bottom = self._composed(x.top), self._composed(x.bottom)
        if top is None or bottom is None:
            return False
        (top, d), (bottom, e) = top, bottom
        top, bottom = top * e, bottom * d
        share = self._fresh()
        if rule == "slope":
            if op == "exp":
                return False
            y = self.box(node.args[0])
            low, high = _falling(op, y)
            value = top * (self._number(low) + self._number(high - low) * share)
            return self._set(index, value, bottom, "slope", low, high)
        if op == "atan":
            return self._set(index, self.pi * top - 2 * (1 - share) * bottom, 2 * top, "far")
        if op == "tanh":
            return self._set(index, bottom + top - share * bottom, bottom + top, "far")
        square = bottom * bottom
        return self._set(index, 2 * share * square, 2 * square - 2 * top * bottom + top * top, "far")

    def _root(self, index: int, x: Quotient) -> bool:
        """sqrt(x) = y + r c, for x = (k u)^2 + r^2."""
        rest = self.ring.apply("sub", x, self.ring.apply("mul", self.ring.u, self.ring.u))
        if not (rest.top.is_constant() and rest.bottom.is_constant() and self.signs(rest)[0]) or self.places[1] is None:
            return False
        square = _rational(rest) if not rest.is_zero else Fraction(0)
        r = Fraction(ends_of("sqrt", _up(square))[1])
        share = self._fresh()
        return self._set(index, self.places[1] + self._number(r) * share, None, "root", "u", r)

    def _ranged(self, atom: Quotient, node: Expr) -> Quotient:
        index = self.ring.index(atom)
        if self.places[3 + index] is not None:
            return atom
        low, high = self.box(node)
        if not (low > -INF and high < INF):
            if self.rules.opaque:
                return atom
            raise Unclear(f"{node.op} has no finite range here")
        if node.op == "atan" and self.free:
            low_share, high_share = _of_half_pi(low, False), _of_half_pi(high, True)
            value = self.pi * (self._number(low_share) + self._number(high_share - low_share) * self._fresh())
            self._set(index, value, self._number(Fraction(2)), "pi range", low_share, high_share)
            return atom
        a, b = Fraction(low), Fraction(high)
        if self.rules.opaque and not self.free:
            return atom
        share = self._fresh() if b > a else 0
        self._set(index, self._number(a) + self._number(b - a) * share, None, "range", a, b)
        return atom

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

    def _factor(self, factor: Any) -> Signs:
        key = str(factor)
        if key not in self._factors:
            self._factors[key] = UNKNOWN
            if self._positive_atom(factor):
                self._factors[key] = True, False, True
                return self._factors[key]
            composed = self._composed(factor)
            if composed is not None:
                p, n, s = signs(composed[0].to_dict(), self.kinds, self.opened)
                self._factors[key] = p, n, s
        return self._factors[key]

    def _positive_atom(self, factor: Any) -> bool:
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

    def _composed(self, polynomial: Any) -> tuple[Any, Any] | None:
        """The polynomial in coordinates and shares, as numerator and (positive) denominator."""
        used = [i for i, d in enumerate(polynomial.degrees()) if d]
        if any(self.places[i] is None for i in used):
            return None
        uneven = [i for i in used if self.below[i] is not None]
        if uneven and len(polynomial) > _LONG:
            return None
        one = self._number(Fraction(1))
        if not uneven:
            zero = self._number(Fraction(0))
            return polynomial.compose(*(self.places[i] if i in used else zero for i in range(len(self.places)))), one
        degrees = polynomial.degrees()
        powers = {i: _powers(self.places[i], int(degrees[i]), one) for i in used}
        under = {i: _powers(self.below[i], int(degrees[i]), one) for i in uneven}
        total = self._number(Fraction(0))
        for k, c in polynomial.to_dict().items():
            term = one * c
            for i in used:
                term = term * powers[i][int(k[i])]
                if i in under:
                    term = term * under[i][int(degrees[i]) - int(k[i])]
            total = total + term
        bottom = one
        for i in uneven:
            bottom = bottom * under[i][int(degrees[i])]
        return total, bottom

    def certificate(self, nodes: set[int] | None = None) -> list[tuple[Expr, list[Any]]]:
        """The atoms used, with their rules."""
        return [(self.ring.atoms[i], rule) for i, rule in self.listed.items()]


def _powers(x: Any, most: int, one: Any) -> list[Any]:
    found = [one]
    for _ in range(most):
        found.append(found[-1] * x)
    return found


def _rational(x: Quotient) -> Fraction:
    a, b = x.top.leading_coefficient(), x.bottom.leading_coefficient()
    value = a / b
    return Fraction(int(value.p), int(value.q))


def _of_half_pi(x: float, upper: bool) -> Fraction:
    """A bound of atan as a share of pi/2."""
    if abs(x) >= PI[0] / 2:
        return Fraction(1 if x > 0 else -1)
    low, high = sorted((Fraction(x) * 2 / Fraction(PI[0]), Fraction(x) * 2 / Fraction(PI[1])))
    share = high if upper else low
    rounded = Fraction(_up(share) if upper else _down(share))
    return max(min(rounded, Fraction(1)), Fraction(-1))


def _falling(op: str, y: Range) -> tuple[Fraction, Fraction]:
    """The range of f(y)/y, which falls with y."""
    low, high = Fraction(0), Fraction(1)
    if y[1] < INF and y[1] > 0:
        low = max(Fraction(_down(Fraction(ends_of(op, y[1])[0]) / Fraction(y[1]))), Fraction(0))
    if y[0] > 0:
        high = min(Fraction(_up(Fraction(ends_of(op, y[0])[1]) / Fraction(y[0]))), Fraction(1))
    return low, high


def _quarter(ring: Ring, op: str, x: Quotient) -> int | None:
    """sin or cos of a whole multiple of pi/2."""
    ratio = ring.apply("div", ring.apply("mul", x, ring.constant(Fraction(2))), ring.pi)
    if not (ratio.top.is_constant() and ratio.bottom.is_constant()):
        return None
    value = _rational(ratio)
    if value.denominator != 1:
        return None
    return (0, 1, 0, -1)[(int(value) + (1 if op == "cos" else 0)) % 4]


def _leads_negative(x: Quotient) -> bool:
    return bool(x.top.leading_coefficient() < 0)


def _opposite(node: Expr) -> Expr:
    """The same function of minus its argument."""
    return rebuild(node, (-node.args[0],))
