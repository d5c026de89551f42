"""Quotients of polynomials in u, w, pi and atoms: the normal form of an expression, however it was written.

An atom stands for what is no polynomial: exp(...), atan(...), a case that is not decided. Two atoms are one if their
operation and the normal forms of their arguments agree.
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from itertools import count

from stribeck.expressions.exact import tree_of
from stribeck.expressions.graph import Expr
from stribeck.properties.plain import Json, Polynomial

ATOMS = 20  # functions and branches in one expression; each is a variable of every polynomial
_serials = count()
_MOST_TERMS = 250  # of a polynomial: beyond, the region is cut instead
_FACTORED = 120  # terms up to which factors are looked for


class Unclear(Exception):
    """An expression that this algebra cannot treat."""


@dataclass(eq=False)
class Quotient:
    """top/bottom. ``bottom`` has been shown to be not 0 where it matters."""

    top: Polynomial
    bottom: Polynomial
    number: int
    _factors: dict[str, tuple[Polynomial, list[tuple[Polynomial, int]]]] = field(default_factory=dict)

    @cached_property
    def is_zero(self) -> bool:
        """Whether it is 0 identically."""
        return bool(self.top.is_zero())

    @cached_property
    def rational(self) -> Fraction | None:
        """The rational number that it is; None where it is none."""
        if self.is_zero:
            return Fraction(0)
        if not (self.top.is_constant() and self.bottom.is_constant()):
            return None
        value = self.top.leading_coefficient() / self.bottom.leading_coefficient()
        return Fraction(int(value.p), int(value.q))

    def factors(self, which: str) -> tuple[Polynomial, list[tuple[Polynomial, int]]]:
        """A number and factors with their powers: of ``top`` or of ``bottom``."""
        if which not in self._factors:
            polynomial = getattr(self, which)
            if len(polynomial) > _FACTORED:
                self._factors[which] = (1, [(polynomial, 1)])
            else:
                content, factors = polynomial.factor()
                self._factors[which] = (content, [(f, int(k)) for f, k in factors])
        return self._factors[which]


class Ring:
    """Normal forms with the given values of constants."""

    def __init__(self, values: dict[str, Fraction]) -> None:
        from flint import Ordering, fmpq, fmpq_mpoly_ctx

        self.values = values
        self.serial = next(_serials)
        self._fmpq = fmpq
        self.names = ("pi", "u", "w", *(f"x{i}" for i in range(ATOMS)))
        self.context = fmpq_mpoly_ctx.get(self.names, Ordering.lex)
        self.generators = self.context.gens()
        self.atoms: list[Expr] = []  # a node for each, for its certificate
        self._index: dict[Hashable, int] = {}
        self._known: dict[Hashable, Quotient] = {}
        self.one = self.constant(Fraction(1))
        self.zero = self.constant(Fraction(0))
        self.pi, self.u, self.w = (self._interned(g, self.one.top) for g in self.generators[:3])

    def _interned(self, top: Polynomial, bottom: Polynomial) -> Quotient:
        key = ("q", str(top), str(bottom))
        if key not in self._known:
            self._known[key] = Quotient(top, bottom, len(self._known))
        return self._known[key]

    def constant(self, x: Fraction) -> Quotient:
        """A rational number."""
        unity = self.context.constant(1)
        return self._interned(self.context.constant(self._fmpq(x.numerator, x.denominator)), unity)

    def number(self, x: float) -> Quotient:
        """A constant of an equation: the number that it stands for.

        Raises:
            Unclear: it is not finite, or not a rational function of pi.
        """
        return self._tree(tree_of(x))

    def _tree(self, tree: Json) -> Quotient:
        if tree == "pi":
            return self.pi
        if isinstance(tree, float):
            if tree - tree != 0:
                raise Unclear("a number that is not finite")
            return self.constant(Fraction(tree))
        op, *args = tree
        if op not in ("add", "sub", "mul", "div", "neg"):
            raise Unclear(f"{op} of a number")
        values = [self._tree(a) for a in args]
        if op == "div" and values[1].is_zero:
            raise Unclear("a division by 0")
        return self.apply(op, *values)

    def symbol(self, name: str) -> Quotient:
        """u, w or a constant."""
        return {"u": self.u, "w": self.w, "pi": self.pi}.get(name) or self.constant(self.values[name])

    def apply(self, op: str, *args: Quotient) -> Quotient:
        """add, sub, mul, div, neg; the divisor must not be 0."""
        key = (op, *(a.number for a in args))
        if key not in self._known:
            self._known[key] = self._applied(op, *args)
        return self._known[key]

    def _applied(self, op: str, a: Quotient, b: Quotient | None = None) -> Quotient:
        if op == "neg" or b is None:
            return self._interned(-a.top, a.bottom)
        if op in ("add", "sub"):
            if a.bottom == b.bottom:
                top = a.top + b.top if op == "add" else a.top - b.top
                return self.quotient(top, a.bottom)
            left, right = a.top * b.bottom, b.top * a.bottom
            return self.quotient(left + right if op == "add" else left - right, a.bottom * b.bottom)
        if op == "mul":
            return self.quotient(a.top * b.top, a.bottom * b.bottom)
        return self.quotient(a.top * b.bottom, a.bottom * b.top)

    def quotient(self, top: Polynomial, bottom: Polynomial) -> Quotient:
        """The quotient of two polynomials, without common factors."""
        if len(top) > _MOST_TERMS or len(bottom) > _MOST_TERMS:
            raise Unclear("too many terms")
        if top.is_zero():
            return self._interned(top, self.context.constant(1))
        if not bottom.is_constant():
            common = top.gcd(bottom)
            if not common.is_one():
                top, bottom = top / common, bottom / common
        # one form for each: the divisor's leading coefficient is 1
        lead = bottom.leading_coefficient()
        return self._interned(top / lead, bottom / lead)

    def atom(self, key: Hashable, node: Expr) -> Quotient:
        """The atom with this key; ``node`` shows what it is.

        Raises:
            Unclear: there are too many.
        """
        if key not in self._index:
            if len(self.atoms) == ATOMS:
                raise Unclear("too many transcendental parts")
            self._index[key] = len(self.atoms)
            self.atoms.append(node)
        return self._interned(self.generators[3 + self._index[key]], self.context.constant(1))

    def index(self, quotient: Quotient) -> int:
        """The index of the atom."""
        return int(next(i for i, power in enumerate(quotient.top.monoms()[0]) if power)) - 3
