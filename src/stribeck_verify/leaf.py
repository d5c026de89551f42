"""One leaf of a tree: an expression of u and w on a small region, as a quotient of polynomials with shares in [0, 1]."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

from flint import fmpq
from flint.utils.flint_exceptions import DomainError

from stribeck_verify import intervals
from stribeck_verify.expressions import CONDITIONS, PI, ZERO, Json, Node, Refused, U, W, by_cases, node, read
from stribeck_verify.intervals import Range
from stribeck_verify.rational import Quotient, Ring, Variable
from stribeck_verify.rules import ENDLESS_RULES, Atom, value

FUNCTIONS = ("exp", "log", "sqrt", "sin", "cos", "atan", "tanh", "pow")
_ODD = ("sin", "atan", "tanh")
_MOST = 16  # the largest whole power that is multiplied out


@dataclass(frozen=True)
class Region:
    """Ranges of coordinates by name (u, w, p = u/w, q = w/u), the claim's own u and w, and whether u, w > 0 is known."""

    axes: dict[str, Range]
    given: dict[str, Range]
    open: bool

    def box(self) -> dict[str, Range]:
        """The ranges of u and w."""
        ranges = {n: r for n, r in self.axes.items() if n in self.given}
        for ratio, of, by in (("p", "u", "w"), ("q", "w", "u")):
            if ratio in self.axes:
                lo, hi = intervals.mul(self.axes[ratio], self.axes[by])
                within = self.given[of]
                assert within[0] is not None
                low = within[0] if lo is None else max(lo, within[0])
                ranges[of] = (low, hi if within[1] is None else (within[1] if hi is None else min(hi, within[1])))
        return ranges


class Leaf:
    """Decides signs of expressions on a region with the atoms that a certificate names."""

    def __init__(self, region: Region, atoms: Sequence[Json]) -> None:
        self.box = region.box()
        self.inside = intervals.Evaluation(self.box, region.open)
        self.names = {"u": U, "w": W, "pi": PI}
        axes = list(region.axes.items())
        variables = [Variable(unit=hi is not None, strict=region.open and lo == 0) for _, (lo, hi) in axes]
        self.atoms: list[Atom] = []
        seen: dict[int, Node] = {}
        for i, atom in enumerate(atoms):
            if not isinstance(atom, list) or len(atom) < 2:
                raise Refused(f"no atom: {str(atom)[:80]}")
            expression, rule, *rest = atom
            self.atoms.append(Atom(read(expression, self.names, seen), str(rule), rest, len(axes) + i))
        shares = [Variable(unit=atom.rule not in ENDLESS_RULES, strict=False) for atom in self.atoms]
        self.ring = Ring([*variables, *shares])
        self.values: dict[Node, Quotient] = {}
        self._open: set[Node] = set()
        quotients: dict[str, Quotient] = {}
        for i, (name, (lo, hi)) in enumerate(axes):
            assert lo is not None
            x = self.ring.variable(i)
            scale = x if hi is None else self.ring.mul(self.ring.number(hi - lo), x)
            quotients[name] = self.ring.add(self.ring.number(lo), scale)
        for ratio, of, by in (("p", "u", "w"), ("q", "w", "u")):
            if ratio in quotients:
                quotients[of] = self.ring.mul(quotients[ratio], quotients[by])
        for name, x in quotients.items():
            if name in ("u", "w"):
                self.values[self.names[name]] = x

    # -- the question ------------------------------------------------------------------------------------------------

    def holds(self, top: Node, relation: str) -> bool:
        """Whether the expression has the relation to 0 all over the region.

        Raises:
            Refused: it could not be written as a quotient.
        """
        if relation == ">=0":
            with suppress(Refused):
                lo = self.inside(top)[0]
                if lo is not None and lo >= 0:
                    return True
        x = self(top)
        if relation == "=0":
            return bool(x.above == 0)
        sign_of_top = self.ring.sign(x)
        if sign_of_top is None:
            return False
        sign, strict = sign_of_top
        return {">=0": sign >= 0, ">0": sign > 0 and strict, "!=0": strict}[relation]

    # -- conversion -----------------------------------------------------------------------------------------------------

    def __call__(self, x: Node) -> Quotient:
        """The expression as a quotient."""
        if x not in self.values:
            if x in self._open:  # an atom that is compared with what it is a part of
                raise Refused("an expression within itself")
            self._open.add(x)
            try:
                self.values[x] = self._convert(x)
            finally:
                self._open.discard(x)
        return self.values[x]

    def _convert(self, x: Node) -> Quotient:
        ring = self.ring
        if x.op == "number":
            return ring.number(x.value)
        if x is PI:
            return ring.pi
        if x.op == "name":
            raise Refused(f"{x.value} has no range here")
        if x.op == "where":
            return self._where(x)
        if x.op in ("abs", "sign"):
            return self._abs_or_sign(x)
        if x.op in FUNCTIONS:
            return self._atom(x)
        if x.op == "mul" and x.args[0] is not x.args[1] and self._zero(x.args[1]) and self._finite(x.args[0]):
            return ring.number(0)
        a = self(x.args[0])
        if x.op == "neg":
            return Quotient(-a.above, a.below)
        if x.op == "mul" and a.above == 0 and self._finite(x.args[1]):
            return a
        if x.op == "div" and a.above == 0 and self._apart_from_0(x.args[1]):
            return a
        b = self(x.args[1])
        if x.op == "mul":
            return ring.mul(a, b)
        if x.op == "div":
            divisor_sign = ring.sign(b)
            if (divisor_sign is None or not divisor_sign[1]) and not self._apart_from_0(x.args[1]):
                raise Refused("a divisor may be 0")
            return ring.div(a, b)
        return ring.add(a, b, 1 if x.op == "add" else -1)

    def _finite(self, x: Node) -> bool:
        """Whether intervals show that an expression has a value."""
        try:
            self.inside(x)
        except Refused:
            return False
        return True

    def _zero(self, x: Node) -> bool:
        """Whether an expression is 0 on the region, and simple enough to say so."""
        try:
            return bool(self(x).above == 0)
        except Refused:
            return False

    def _apart_from_0(self, x: Node) -> bool:
        try:
            lo, hi = self.inside(x)
        except Refused:
            return False
        return bool((lo is not None and lo > 0) or (hi is not None and hi < 0))

    def sign_of(self, x: Node) -> tuple[int, bool] | None:
        """The sign of an expression on the region, by intervals or algebra; None where it is not known."""
        with suppress(Refused):
            lo, hi = self.inside(x)
            if lo is not None and lo > 0:
                return 1, True
            if hi is not None and hi < 0:
                return -1, True
        try:
            return self.ring.sign(self(x))
        except Refused:
            return None

    def condition(self, c: Node) -> bool | None:
        """Whether a condition holds; None where that is not known."""
        if c.op in ("both", "either"):
            return intervals.joined(c.op, [self.condition(x) for x in c.args])
        with suppress(Refused):
            by_range = self.inside.condition(c)
            if by_range is not None:
                return by_range
        sign = self.sign_of(node("sub", c.args[1], c.args[0]))
        if sign is None:
            return None
        if c.op == "lt":
            return True if sign == (1, True) else (False if sign[0] <= 0 else None)
        return True if sign[0] >= 0 else (False if sign == (-1, True) else None)

    def _where(self, x: Node) -> Quotient:
        c, a, b = x.args
        known = self.condition(c)
        if known is not None:
            return self(a if known else b)
        if c.op in ("lt", "le"):
            weak = self._weak(c, a, b)
            if weak is not None:
                return weak
        opposite = node("where", c, node("neg", a), node("neg", b))
        for atom in self.atoms:
            if atom.rule in ("range", "above", "below") and atom.node.op == "where":
                if self._equal(atom.node, x):
                    return value(self, x, atom)
                if self._equal(atom.node, opposite):
                    other = value(self, opposite, atom)
                    return Quotient(-other.above, other.below)
        share = self._share_of(c)
        if share is None and c.op == "both":
            return self(node("where", c.args[0], node("where", c.args[1], a, b), b))
        if share is None and c.op == "either":
            return self(node("where", c.args[0], a, node("where", c.args[1], a, b)))
        if share is None:
            raise Refused("a condition that is not decided has no atom")
        self._has_value(c)
        ring, first, second = self.ring, self(a), self(b)
        return ring.add(second, ring.mul(share, ring.add(first, second, -1)))

    def _has_value(self, c: Node) -> None:
        """The sides of comparisons must have values, even where it does not matter which is larger."""
        for x in c.args:
            if x.op in CONDITIONS:
                self._has_value(x)
                continue
            try:
                self.inside(x)
            except Refused:
                self(x)

    def _weak(self, c: Node, a: Node, b: Node) -> Quotient | None:
        """The value of cases that agree where l = r, as their difference is a multiple of r - l, if l <= r or r <= l."""
        try:
            left, right, first, second = self(c.args[0]), self(c.args[1]), self(a), self(b)
        except Refused:
            return None
        ring = self.ring
        way, apart = ring.add(right, left, -1), ring.add(first, second, -1)
        if apart.above != 0 and (way.above == 0 or not (way.above / way.above.gcd(apart.above)).is_constant()):
            return None
        sign = self.sign_of(node("sub", c.args[1], c.args[0]))
        if sign is None:
            return None
        return first if sign[0] >= 0 else second  # where l = r the two are the same

    def _abs_or_sign(self, x: Node) -> Quotient:
        a = x.args[0]
        known_sign = self.sign_of(a)
        ring = self.ring
        if x.op == "abs" and known_sign is not None:
            value = self(a)
            return value if known_sign[0] >= 0 else Quotient(-value.above, value.below)
        if x.op == "sign" and known_sign is not None and (known_sign[1] or known_sign[0] == 0):
            return ring.number(known_sign[0])
        if x.op == "sign":  # sign(0) = 0 is neither end: it has a share of its own, not that of a condition
            share = self._share_of(x)
            if share is not None:
                return ring.add(ring.mul(ring.number(2), share), ring.number(1), -1)
        return self(by_cases(x.op, a))

    # -- atoms -------------------------------------------------------------------------------------------------------------

    def _share_of(self, c: Node) -> Quotient | None:
        """The share of a condition (or of a sign) that is listed as an atom of the rule ``either``."""
        for atom in self.atoms:
            if atom.rule != "either":
                continue
            x = atom.node
            conditions = {"where": x.args[0], "abs": node("le", ZERO, x.args[0])}
            listed = conditions.get(x.op, x)
            if self._equal(listed, c):
                return self.ring.variable(atom.share)
        return None

    def _equal(self, a: Node, b: Node) -> bool:
        """Whether two expressions or conditions are the same: as nodes, or as functions of equal arguments."""
        if a is b:
            return True
        if a.op != b.op or len(a.args) != len(b.args):
            return False
        if a.op in ("lt", "le"):
            try:
                ring = self.ring
                sides = [ring.add(self(x.args[1]), self(x.args[0]), -1) for x in (a, b)]
            except Refused:
                return all(self._same_value(x, y) for x, y in zip(a.args, b.args, strict=True))
            return sides[0].same(sides[1]) or self._positive_multiple(*sides)
        if a.op in CONDITIONS:
            return all(self._equal(x, y) for x, y in zip(a.args, b.args, strict=True))
        if a.op in FUNCTIONS or a.op in ("sign", "abs", "where"):
            return all(self._same_value(x, y) for x, y in zip(a.args, b.args, strict=True))
        return False

    def _positive_multiple(self, a: Quotient, b: Quotient) -> bool:
        """Whether a is b times something > 0, such as u: then a < 0 and b < 0 are one condition."""
        return bool(a.above != 0 and b.above != 0) and self.ring.sign(self.ring.div(a, b)) == (1, True)

    def _same_value(self, a: Node, b: Node) -> bool:
        """Whether two arguments are equal: as quotients, else as they are written."""
        if a is b or a.op in CONDITIONS or b.op in CONDITIONS:
            return self._equal(a, b)
        try:
            return self(a).same(self(b))
        except Refused:
            same = a.op == b.op and len(a.args) == len(b.args) > 0
            return same and all(self._same_value(x, y) for x, y in zip(a.args, b.args, strict=True))

    def _atom(self, x: Node) -> Quotient:
        with suppress(Refused):
            lo, hi = self.inside(x)
            if lo is not None and lo == hi:
                return self.ring.number(lo)
        if x.op in ("sin", "cos"):
            quarters = self._quarters(x.args[0])
            if quarters is not None:
                return self.ring.number((0, 1, 0, -1)[(quarters + (x.op == "cos")) % 4])
        if x.op == "pow" and (parts := self._parts(x)) is not None:
            return parts
        if x.op == "sqrt" and (root := self._root(x.args[0])) is not None:
            return root
        opposite = node(x.op, node("neg", x.args[0])) if x.op in (*_ODD, "cos") else x
        for atom in self.atoms:
            if atom.rule == "either":
                continue
            if self._equal(atom.node, x):
                return value(self, x, atom)
            if opposite is not x and self._equal(atom.node, opposite):
                other = value(self, opposite, atom)
                return other if x.op == "cos" else Quotient(-other.above, other.below)
        raise Refused(f"{x.op} has no atom")

    def _root(self, y: Node) -> Quotient | None:
        """The root of what is the square of something of known sign."""
        try:
            square = self(y)
            root = Quotient(square.above.sqrt(), square.below.sqrt())
        except (Refused, DomainError):
            return None
        sign = self.ring.sign(root)
        return None if sign is None else root if sign[0] >= 0 else Quotient(-root.above, root.below)

    def _parts(self, x: Node) -> Quotient | None:
        """y^(n + f) as y^n y^f, where n is whole and 0 <= f < 1, y^(1/2) as a root; None where it is y^f already."""
        y, power = x.args
        with suppress(Refused):
            e = self(power)
            if not (e.above.is_constant() and e.below.is_constant()) or e.above == 0:
                return None
            exact = fmpq(e.above.leading_coefficient())  # Ring.reduced leaves no constant divisor but 1
            n = int(exact.floor())
            rest = exact - n
            if not -_MOST <= n <= _MOST or (n == 0 and rest != fmpq(1, 2)):
                return None
            sign, ring = self.sign_of(y), self.ring
            if sign is None or sign[0] < 0 or (n < 0 and sign != (1, True)):
                return None
            product, base = ring.number(1), self(y)
            for _ in range(abs(n)):
                product = ring.mul(product, base)
            product = product if n >= 0 else ring.div(ring.number(1), product)
            if rest == 0:
                return product
            root = node("sqrt", y) if rest == fmpq(1, 2) else node("pow", y, node("number", value=rest))
            return ring.mul(product, self(root))
        return None

    def _quarters(self, x: Node) -> int | None:
        """n where an argument is n pi/2."""
        with suppress(Refused):
            ring = self.ring
            n = ring.div(ring.mul(ring.number(2), self(x)), ring.pi)
            if n.above.is_constant() and n.below.is_constant():
                whole = fmpq(n.above.leading_coefficient() if n.above != 0 else 0)
                return int(whole.p) if whole.q == 1 else None
        return None
