"""Interval arithmetic with outward rounding.

A range is a pair of floats, exact if results are; functions come from python-flint's arb. A range may be unbounded; 0 times
an unbounded range is 0, as for sets of real numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

from stribeck.expressions.exact import tree_of
from stribeck.expressions.graph import Expr, ordered
from stribeck.expressions.ops import Value

Range = tuple[float, float]
INF = math.inf
EVERYTHING: Range = (-INF, INF)
_BITS = 80  # of arb: 27 more than a float's, so that its error is far below the outward rounding


def down(x: float) -> float:
    """The float below."""
    return math.nextafter(x, -INF)


def up(x: float) -> float:
    """The float above."""
    return math.nextafter(x, INF)


def add(a: Range, b: Range) -> Range:
    """a + b."""
    return _sum(a[0], b[0], True), _sum(a[1], b[1], False)


def _sum(x: float, y: float, lower: bool) -> float:
    s = x + y
    if s != s:
        return -INF if lower else INF
    if math.isinf(s):
        return (
            s
            if math.isinf(x) or math.isinf(y)
            else (math.copysign(1.7976931348623157e308, s) if lower == (s > 0) else s)
        )
    y_ = s - x
    error = (x - (s - y_)) + (y - y_)
    if error == 0:
        return s
    return (s if error > 0 else down(s)) if lower else (s if error < 0 else up(s))


def neg(a: Range) -> Range:
    """-a."""
    return -a[1], -a[0]


def _product(x: float, y: float) -> tuple[float, float]:
    if x == 0 or y == 0:
        return 0.0, 0.0
    p = x * y
    if abs(x) == 1 or abs(y) == 1 or math.isinf(x) or math.isinf(y):
        return p, p
    low, high = down(p), up(p)
    return (max(low, 0.0), high) if (x > 0) == (y > 0) else (low, min(high, 0.0))


def mul(a: Range, b: Range) -> Range:
    """a b; 0 times unbounded is 0."""
    ends = [_product(x, y) for x in a for y in b]
    return min(e[0] for e in ends), max(e[1] for e in ends)


def _quotient(x: float, y: float) -> tuple[float, float]:
    if x == 0 or (math.isinf(y) and not math.isinf(x)):
        return 0.0, 0.0
    if math.isinf(x) and math.isinf(y):
        return (0.0, INF) if (x > 0) == (y > 0) else (-INF, 0.0)
    q = x / y
    if abs(y) == 1 or math.isinf(x):
        return q, q
    low, high = down(q), up(q)
    return (max(low, 0.0), high) if (x > 0) == (y > 0) else (low, min(high, 0.0))


def div(a: Range, b: Range) -> Range:
    """a/b, for the b that are not 0."""
    if b[0] < 0 < b[1]:
        return EVERYTHING
    if b == (0.0, 0.0):
        return EVERYTHING
    if b[1] == 0:
        return div(neg(a), neg(b))
    if b[0] == 0:
        low = _quotient(a[0], b[1])[0] if a[0] >= 0 else -INF
        high = _quotient(a[1], b[1])[1] if a[1] <= 0 else INF
        return low, high
    ends = [_quotient(x, y) for x in a for y in b]
    return min(e[0] for e in ends), max(e[1] for e in ends)


@lru_cache(maxsize=20000)
def ends_of(name: str, x: float) -> Range:
    """A function's value at a float, between two floats."""
    if x == 0 and name in ("exp", "sin", "cos", "atan", "tanh", "sqrt"):
        return (1.0, 1.0) if name in ("exp", "cos") else (0.0, 0.0)
    if x == 1 and name == "log":
        return 0.0, 0.0
    import flint

    with flint.ctx.workprec(_BITS):
        y = getattr(flint.arb(x), name)()
        low, high = float(y.lower()), float(y.upper())
    if low != low or high != high:
        return EVERYTHING
    return down(low), up(high)


_LIMITS: dict[str, tuple[float, float, dict[float, float]]] = {
    "exp": (0.0, INF, {-INF: 0.0, INF: INF}),
    "atan": (down(-math.pi / 2), up(math.pi / 2), {-INF: down(-math.pi / 2), INF: up(math.pi / 2)}),
    "tanh": (-1.0, 1.0, {-INF: -1.0, INF: 1.0}),
    "log": (-INF, INF, {0.0: -INF, INF: INF}),
    "sqrt": (0.0, INF, {INF: INF}),
}


def rising(name: str, x: Range) -> Range:
    """exp, atan, tanh, log, sqrt."""
    if name in ("log", "sqrt") and x[0] < 0:
        return EVERYTHING
    least, most, known = _LIMITS[name]
    low = known[x[0]] if x[0] in known else ends_of(name, x[0])[0]
    high = known[x[1]] if x[1] in known else ends_of(name, x[1])[1]
    return max(low, least), min(high, most)


def _wave(name: str, x: Range) -> Range:
    if not x[1] - x[0] < 100:
        return -1.0, 1.0
    if x[0] == x[1]:
        return ends_of(name, x[0])
    import flint

    with flint.ctx.workprec(_BITS):
        y = getattr(flint.arb(x[0]).union(flint.arb(x[1])), name)()
        return max(down(float(y.lower())), -1.0), min(up(float(y.upper())), 1.0)


def power(a: Range, b: Range) -> Range:
    """a^b for a >= 0."""
    if a[0] < 0 or (a[0] == 0 and b[0] <= 0):
        return EVERYTHING
    if b == (0.0, 0.0):
        return 1.0, 1.0
    if b == (1.0, 1.0):
        return a
    result = rising("exp", mul(b, rising("log", a)))
    if a[0] == 0:
        return (0.0, rising("exp", mul(b, rising("log", (a[1], a[1]))))[1]) if a[1] > 0 else (0.0, 0.0)
    return result


PI: Range = (down(math.pi), up(math.pi))


def _tree(tree: Value) -> Range:
    if tree == "pi":
        return PI
    if isinstance(tree, float):
        return tree, tree
    op, *args = tree
    value: Range = _apply(op, [_tree(a) for a in args])
    return value


def _apply(op: str, args: list[Value]) -> Value:
    """An operation on ranges."""
    if op == "add":
        return add(*args)
    if op == "sub":
        return add(args[0], neg(args[1]))
    if op == "mul":
        return mul(*args)
    if op == "div":
        return div(*args)
    if op == "neg":
        return neg(args[0])
    if op == "abs":
        a, b = args[0]
        return (a, b) if a >= 0 else (-b, -a) if b <= 0 else (0.0, max(-a, b))
    if op == "sign":
        return tuple((x > 0) - (x < 0) + 0.0 for x in args[0])
    if op in _LIMITS:
        return rising(op, args[0])
    if op in ("sin", "cos"):
        return _wave(op, args[0])
    if op == "pow":
        return power(*args)
    if op == "lt":
        return True if args[0][1] < args[1][0] else False if args[0][0] >= args[1][1] else None
    if op == "le":
        return True if args[0][1] <= args[1][0] else False if args[0][0] > args[1][1] else None
    if op == "both":
        return False if False in args else True if args == [True, True] else None
    if op == "either":
        return True if True in args else False if args == [False, False] else None
    raise KeyError(op)


def number(x: float) -> Range:
    """The range of a constant: of the exact number that it represents."""
    return _tree(tree_of(x))


# -- expressions over boxes ---------------------------------------------------------------------------------------------


class Box:
    """One box: the ranges of symbols, and of expressions of them."""

    def __init__(self, inputs: Mapping[str, Range]) -> None:
        self.inputs = inputs
        self.known: dict[Expr, Value] = {}

    def __call__(self, node: Expr) -> Value:
        """The range of an expression; True, False or None (undecided) for a condition."""
        if node not in self.known:
            for each in ordered([node]):
                if each not in self.known:
                    self.known[each] = self._value(each)
        return self.known[node]

    def _value(self, node: Expr) -> Value:
        """The range of a node, from the ranges of its arguments."""
        if node.op == "symbol":
            return self.inputs[str(node.value)]
        if node.op == "constant":
            assert isinstance(node.value, float)
            return number(node.value)
        if node.op == "where":
            return self._where(node, {})
        args = [self.known[a] for a in node.args]
        if node.op == "mul" and node.args[0] is node.args[1]:
            args = [_apply("abs", args[:1])] * 2
        return _apply(node.op, args)

    def _where(self, node: Expr, limits: Mapping[Expr, Range]) -> Value:
        """The range of a node, narrowed by the limits that enclosing conditions set on some nodes."""
        if node in limits:
            return _meet(self.known[node], limits[node])
        if node.op != "where":
            return self.known[node]
        condition, a, b = node.args
        yes: dict[Expr, Range] = {}
        no: dict[Expr, Range] = {}
        if condition.op in ("lt", "le"):
            smaller, larger = condition.args
            (s_low, s_high), (l_low, l_high) = self.known[smaller], self.known[larger]
            yes = {smaller: (-INF, l_high), larger: (s_low, INF)}
            no = {smaller: (l_low, INF), larger: (-INF, s_high)}

        def side(x: Expr, says: Mapping[Expr, Range]) -> Value:
            joined = {n: _meet(limits[n], y) if n in limits else y for n, y in says.items()}
            return self._where(x, {**limits, **joined})

        truth = self.known[condition]
        if truth is not None:
            return side(a, yes) if truth else side(b, no)
        x, y = side(a, yes), side(b, no)
        return min(x[0], y[0]), max(x[1], y[1])


def _meet(a: Range, b: Range) -> Range:
    """The intersection of two ranges that contain the same value."""
    low, high = max(a[0], b[0]), min(a[1], b[1])
    return (low, high) if low <= high else a


# -- proofs on a line ---------------------------------------------------------------------------------------------------

_MOST = 50_000  # parts: the search gives up beyond
_WIDE = 4.0  # a part whose ends have a larger ratio is cut on a logarithmic scale
_LEAP = 16.0  # a part from 0 is cut at its end over this; a part to infinity at its end times this, or at 1
_NARROW = 1e-13  # relative width below which a part is undecided: some 500 floats, where rounding decides


@dataclass(frozen=True)
class Cover:
    """The result of a proof.

    Attributes:
        holds: whether the bound is proved.
        parts: the number of parts examined.
        where: otherwise a part where it is not proved.
        reason: otherwise the reason.
        negative: whether the bound is known to be negative in that part.
    """

    holds: bool
    parts: int
    where: Range | None = None
    reason: str = ""
    negative: bool = False


def not_negative(bound: Callable[[Range], Range], parts: Sequence[Range]) -> Cover:
    """Prove that ``bound`` is nowhere negative on the parts of a line, which are halved where it is undecided.

    A point where ``bound`` is negative ends the search.

    Args:
        bound: a function of a part.
        parts: the first parts, none with 0 inside; they may be infinite.
    """
    count = 0
    while parts:
        count += len(parts)
        undecided = [(low, high, _cut(low, high)) for low, high in parts if not bound((low, high))[0] >= 0]
        for low, high, cut in undecided:
            below = bound((cut, cut))[1] < 0
            if below or not low < cut < high or high - low < _NARROW * max(abs(low), abs(high)):
                return Cover(False, count, (low, high), "it is negative" if below else "parts became too small", below)
        if undecided and count > _MOST:
            return Cover(False, count, undecided[0][:2], "too many parts")
        parts = [(low, cut) for low, _, cut in undecided] + [(cut, high) for _, high, cut in undecided]
    return Cover(True, count)


def _cut(low: float, high: float) -> float:
    """The place to cut a part on one side of 0."""
    small, size = sorted((abs(low), abs(high)))
    side = 1.0 if high > 0 else -1.0
    if size == INF:
        return side * max(_LEAP * small, 1.0)
    if small == 0:
        return side * size / _LEAP
    return side * math.sqrt(small) * math.sqrt(size) if size > _WIDE * small else 0.5 * low + 0.5 * high
