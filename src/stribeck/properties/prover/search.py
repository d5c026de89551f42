"""Proofs over a whole region: a tree of parts, on each of which the sign is shown by a leaf."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from fractions import Fraction
from math import frexp, ldexp, log

from stribeck.expressions.graph import Expr, ordered
from stribeck.expressions.intervals import INF, Box, Range
from stribeck.properties.plain import Json
from stribeck.properties.prover.leaf import Leaf, Rules
from stribeck.properties.prover.region import Axis, End, Region
from stribeck.properties.prover.ring import Quotient, Ring, Unclear

Tree = list[Json]
_NARROW = 1e-9  # relative width at which halving ends
_DEEP = 60  # cuts on one path: two axes, each halved 30 times, to _NARROW of their width
_TERMS = 40  # of a polynomial: as much work again as a leaf
_SUMS = 350  # of Bernstein coefficients: likewise
_NONE: Mapping[str, int] = {}
_MANY_ATOMS = 8  # from earlier claims: then they are forgotten
_LEAP = 16  # where a range without end is cut, over its lower end: a decade a cut, as laws change over decades
_FARTHEST = 10**300  # of speeds and deflections that are looked at as floats


class Spent(Exception):
    """The work allowed is done."""


@dataclass
class Budget:
    """Work that may still be done, in leaves; it does not depend on the machine's speed."""

    left: float
    done: float = 0.0

    def take(self, amount: float = 1.0) -> None:
        """Spend some.

        Raises:
            Spent: none is left.
        """
        self.left -= amount
        self.done += amount
        if self.left < 0:
            raise Spent

    @contextmanager
    def limited(self, most: float) -> Iterator[Budget]:
        """At most so much of it; what is done within the context counts."""
        part = Budget(min(most, self.left))
        try:
            yield part
        finally:
            self.left -= part.done
            self.done += part.done


@dataclass(frozen=True)
class Hints:
    """Where speeds and deflections may be cut first."""

    speeds: tuple[Fraction, ...] = ()
    lengths: tuple[Fraction, ...] = ()


@dataclass
class Prover:
    """Shows signs of expressions of u and w; keeps normal forms between claims."""

    ring: Ring
    inputs: Mapping[str, Range]
    hints: Hints = field(default_factory=Hints)
    proved: dict[Hashable, Tree | None] = field(default_factory=dict)

    def show(
        self, expr: Expr, relation: str, ranges: Mapping[str, tuple[Fraction, End]], work: Budget, closed: bool = False,
        cones: bool = False,
    ) -> Tree | None:  # fmt: skip
        """A tree that shows the relation (">=0", ">0", "!=0", "=0") on the ranges of u and w; None where none was found."""
        axes = tuple(Axis(name, *ends) for name, ends in ranges.items())
        region = Region(axes, closed)
        key = (expr, relation, region)
        if key not in self.proved:
            if len(self.ring.atoms) > _MANY_ATOMS:
                self.ring = Ring(self.ring.values)
            shared = self._shared_form(expr, relation, region) or key
            if shared not in self.proved:
                self.proved[shared] = _Search(self, expr, relation, work, cones).root(region)
            self.proved[key] = self.proved[shared]
        return self.proved[key]

    def _shared_form(self, expr: Expr, relation: str, region: Region) -> Hashable:
        """The shared key of claims with the same normal form, such as those for (v, z) and for (-v, -z)."""
        try:
            value = Leaf(self.ring, region, Rules(opaque=True), self.inputs).convert(expr)
        except Unclear:
            return None
        return (str(value.top), str(value.bottom), self.ring.serial, relation, region)


class _Search:
    def __init__(self, prover: Prover, expr: Expr, relation: str, work: Budget, cones: bool) -> None:
        self.prover, self.expr, self.relation, self.work, self.cones = prover, expr, relation, work, cones
        ops = {node.op for node in ordered([expr])}
        self.cased = bool(ops & {"where", "abs", "sign"})
        self.exps, self.waves = "exp" in ops, bool(ops & {"atan", "tanh", "sqrt", "pow"})
        self.powers = "pow" in ops
        anywhere = Box({**prover.inputs, "u": (0.0, INF), "w": (0.0, INF)})
        exps = [node for node in ordered([expr]) if node.op == "exp"]
        self.rising = any(anywhere(node.args[0])[1] > 0 for node in exps)  # exp(y) with y > 0 somewhere

    def root(self, region: Region) -> Tree | None:
        """The whole region at once, in other coordinates, or part by part; None also where the work is spent."""
        try:
            if (tree := self.leaf(region)) is not None:
                return tree
            if self.cones and self.relation == ">=0" and (tree := self._polar(region)) is not None:
                return tree
            return self.divide(region) if self.relation != "=0" or self.cones else None
        except Spent:
            return None

    def _polar(self, region: Region) -> Tree | None:
        """A tree for all u, w > 0 in the coordinates u and q = w/u, with a third of the work."""
        u, w = region.axis("u"), region.axis("w")
        if u is None or w is None or u.low != 0 or w.low != 0 or u.high is not None or w.high is not None:
            return None
        whole, tree = self.work, None
        with suppress(Spent), whole.limited(whole.left / 3) as self.work:
            tree = self.divide(region.with_axes(u, Axis("q", Fraction(0), None)))
        self.work = whole
        return ["polar u", tree] if tree is not None else None

    def divide(self, region: Region, cuts: Mapping[str, int] = _NONE) -> Tree | None:
        """A tree for a region; ``cuts``: how often each axis was cut."""
        tree = self.leaf(region)
        if tree is not None:
            return tree
        if (tree := self._corner(region)) is not None:
            return tree
        if sum(cuts.values()) > _DEEP or self.refuted(region):
            return None
        cut = self.cut(region, cuts)
        if cut is None:
            return None
        name, place = cut
        below, above = region.split(name, place)
        cuts = {**cuts, name: cuts.get(name, 0) + 1}
        second = self.divide(above, cuts)
        if second is None:
            return None
        first = self.divide(below, cuts)
        return ["split", name, str(place), first, second] if first is not None else None

    def _corner(self, region: Region) -> Tree | None:
        """Both triangles of a rectangle at the origin."""
        u, w = region.axis("u"), region.axis("w")
        if not (u and w and u.low == w.low == 0 and u.high and w.high and self.cones and self.relation == ">=0"):
            return None
        first = self.leaf(region.with_axes(u, Axis("q", Fraction(0), w.high / u.high)))
        if first is None:
            return None
        second = self.leaf(region.with_axes(w, Axis("p", Fraction(0), u.high / w.high)))
        return ["diagonal", first, second] if second is not None else None

    def rules(self, region: Region) -> Iterator[Rules]:
        """The ways to treat atoms that are worth trying here."""
        if self.relation == "=0":
            yield Rules("range", "range", "either", True)
            if self.cased:
                yield Rules("range", "range", "range", True)
            return
        endless = any(a.high is None for a in region.axes)
        zero = any(a.low == 0 for a in region.axes)
        waves = (
            (["far"] if endless else []) + ["range"] + (["slope"] if zero else []) + (["chord"] if self.powers else [])
        )
        exps = (["range", "far"] if endless else ["range"]) + (["tangent"] if self.rising else [])
        for cases in ("range", "either") if self.cased else ("either",):
            for wave in waves if self.waves else ("range",):
                for e in exps if self.exps and cases == ("range" if self.cased else "either") else ("range",):
                    yield Rules(e, wave, cases)

    def leaf(self, region: Region) -> Tree | None:
        """One leaf that shows the relation on the region."""
        for rules in self.rules(region):
            self.work.take()
            leaf = Leaf(self.prover.ring, region, rules, self.prover.inputs)
            try:
                value = leaf.convert(self.expr)
                self.work.take(len(value.top) / _TERMS)
                if self.holds(leaf, value):
                    return ["leaf", leaf.certificate()]
            except Unclear:
                continue
            finally:
                self.work.take(leaf.sums / _SUMS)
        return None

    def holds(self, leaf: Leaf, value: Quotient) -> bool:
        """Whether the value has the sign asked for."""
        if self.relation == "=0":
            return value.is_zero
        above, below, strict = leaf.signs(value)
        if self.relation == ">=0":
            return above
        return strict and (above or (below and self.relation == "!=0"))

    def refuted(self, region: Region) -> bool:
        """Whether the relation fails at a point of the region, by interval arithmetic."""
        if self.relation == "=0":
            return False
        point: dict[str, Fraction] = {}
        for a in region.axes:
            if a.high is None:
                point[a.name] = a.low * 4 if a.low else Fraction(1)
            else:
                point[a.name] = (a.low + a.high) / 2
        if "p" in point:
            point["u"] = point.pop("p") * point["w"]
        if "q" in point:
            point["w"] = point.pop("q") * point["u"]
        if max(point.values(), default=0) > _FARTHEST:
            return False
        box = {n: (float(x), float(x)) for n, x in point.items()}
        value: Range = Box({**self.prover.inputs, **box})(self.expr)
        return value[1] < 0 if self.relation in (">=0", ">0") else value == (0.0, 0.0)

    def cut(self, region: Region, cuts: Mapping[str, int]) -> tuple[str, Fraction] | None:
        """Where the region is cut next: the side of the largest relative width, and not always the same."""
        best: tuple[float, str, Fraction] | None = None
        for a in region.axes:
            marks = {"u": self.prover.hints.speeds, "w": self.prover.hints.lengths}.get(a.name, ())
            inside = [x for x in marks if a.low < x and (a.high is None or x < a.high)]
            width, place = _width(a, inside)
            width /= 1 + 0.5 * cuts.get(a.name, 0)
            if place is not None and (best is None or width > best[0]):
                best = width, a.name, place
        return None if best is None else (best[1], best[2])


def _width(a: Axis, inside: Sequence[Fraction]) -> tuple[float, Fraction | None]:
    """A measure of the width of a side, and where it is to be cut."""
    if a.low > _FARTHEST or (a.high is not None and a.high > _FARTHEST):  # no float: not cut
        return 0.0, None
    if a.high is None:
        if inside:
            return 60.0 + len(inside), inside[len(inside) // 2]
        if a.low == 0:
            return 50.0, Fraction(1)
        return 6.0, _short(a.low * _LEAP)
    if a.high == a.low:
        return 0.0, None
    if inside:
        return 20.0 + len(inside), inside[len(inside) // 2]
    if a.low == 0:
        return 4.0, _short(a.high / 4)
    if a.low < 0 < a.high:
        return 3.0, Fraction(0)
    ratio = float(a.high / a.low) if a.low > 0 else float(a.low / a.high)
    if ratio - 1 < _NARROW:
        return 0.0, None
    middle = (a.low + a.high) / 2
    if ratio > 4 and a.low > 0:
        middle = _short(Fraction(float(a.low) ** 0.5 * float(a.high) ** 0.5))
        middle = middle if a.low < middle < a.high else (a.low + a.high) / 2
    else:
        short = _short(middle)
        middle = short if a.low < short < a.high else middle
    return log(ratio), middle


def _short(x: Fraction) -> Fraction:
    """A number near x with few binary digits, which keeps the arithmetic quick."""
    m, e = frexp(float(x))
    return Fraction(ldexp(round(m * 64), e - 6)) if m else x
