"""A law's own equations as plain data, and whether those of a certificate are the same.

A law is ``{"law": its name, "constants": {NAME: number}, "dz_dt": tree, "force": tree, "Z": tree, "scales": {"speed": number,
"length": number}}``. A tree is a number (a float, taken exactly), a name (``v``, ``z``, ``dz_dt``, ``pi`` or a constant's),
or a list of an operation and its trees.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, isinf

from flint import fmpq

from stribeck_verify import intervals
from stribeck_verify.expressions import Json, Node, Refused, name, names, node, number
from stribeck_verify.identities import Normal

_ROUNDING = fmpq(1, 2**50)  # of a Z that is no rational function of the constants


def compare(law: Mapping[str, Json], dz_dt: Node, force: Node) -> None:
    """Confirm that equations are those of a law with its constants.

    Raises:
        Refused: they differ.
    """
    for what, stated, formula in (("dz/dt", dz_dt, law["dz_dt"]), ("F", force, law["force"])):
        if not _Comparison(law["constants"])(stated, formula):
            raise Refused(f"the equation of {what} is not that of the law {law['law']!r}")


class _Comparison:
    """Node by node, with the values of constants in place of their names; parts without v and z by their values."""

    def __init__(self, constants: Mapping[str, float]) -> None:
        self.constants = constants
        self.known: dict[tuple[Node, int], bool] = {}

    def __call__(self, a: Node, b: Json) -> bool:
        if not isinstance(b, list):
            return self._leaf(a, b)
        if (a, id(b)) not in self.known:
            self.known[a, id(b)] = self._compared(a, *b)
        return self.known[a, id(b)]

    def _leaf(self, a: Node, b: float | str) -> bool:
        x = self.constants.get(b, b) if isinstance(b, str) else b
        if isinstance(x, str):
            return a.op == "name" and a.value == x
        return not (isinf(x) or x != x) and _equal(a, number(exactly(x)))

    def _compared(self, a: Node, op: str, *b: Json) -> bool:
        if op == "where" and (decided := endless(b[0])) is not None:
            return self(a, b[1 if decided else 2])
        if op in ("both", "either"):
            for x, other in (b, b[::-1]):
                if endless(x) is (op == "both"):  # it decides nothing
                    return self(a, other)
        if a.op == op and len(a.args) == len(b) and all(self(x, y) for x, y in zip(a.args, b, strict=True)):
            return True
        try:
            formula = to_node([op, *b], self.constants)
        except Refused:
            return False
        return not names(formula) - {"pi"} and _equal(a, formula)


def _equal(a: Node, b: Node) -> bool:
    """Whether two numbers, which pi may occur in, are equal."""
    if a is b:
        return True
    if names(a) - {"pi"}:
        return False
    try:
        normal = Normal()
        return bool(normal.zero(node("sub", a, b)))
    except Refused:
        return False


def exactly(x: float) -> fmpq:
    """A finite float as the rational number that it is."""
    return fmpq(*float(x).as_integer_ratio())


def endless(c: Json) -> bool | None:
    """The truth of a condition that comparisons with infinite numbers decide; None where they do not."""
    op, *args = c
    if op in ("both", "either"):
        parts = [endless(x) for x in args]
        decisive = op == "either"
        return decisive if decisive in parts else None if None in parts else not decisive
    if op not in ("lt", "le"):
        return None
    for side, x in enumerate(args):
        if x in (inf, -inf):
            return bool(x > 0) == (side == 1)
    return None


def to_node(tree: Json, constants: Mapping[str, float]) -> Node:
    """A tree as a node, with the values of constants in place of their names.

    Raises:
        Refused: it holds a number that is not finite.
    """
    known: dict[int, Node] = {}

    def converted(x: Json) -> Node:
        if isinstance(x, list):
            if id(x) not in known:
                decided = endless(x[1]) if x[0] == "where" else None
                known[id(x)] = (
                    converted(x[2 if decided else 3]) if decided is not None else node(x[0], *map(converted, x[1:]))
                )
            return known[id(x)]
        if isinstance(x, str) and x not in constants:
            return name(x)
        value = constants[x] if isinstance(x, str) else x
        if isinf(value) or value != value:
            raise Refused(f"the law holds the number {value}")
        return number(exactly(value))

    return converted(tree)


def compare_bound(law: Mapping[str, Json], Z: fmpq) -> None:
    """Confirm that Z is the law's own, exactly where rational arithmetic gives it.

    Raises:
        Refused: it differs.
    """
    lo, hi = intervals.evaluate(to_node(law["Z"], law["constants"]), {})
    if lo is None or hi is None or not (lo == hi == Z or (lo < hi and _near(lo, Z) and _near(hi, Z))):
        raise Refused(f"Z is {intervals.nearest(Z)!r}, the law's is {None if lo is None else intervals.nearest(lo)!r}")


def _near(computed: fmpq, Z: fmpq) -> bool:
    return bool(abs(Z - computed) <= computed * _ROUNDING)
