"""Interval arithmetic with outward rounding, for one box (floats) and for many at once (arrays).

Ends are floats, exact if results are; functions come from python-flint's arb. An interval may be unbounded; 0 times an
unbounded interval is 0, as for sets of real numbers. A :class:`Range` is a pair of floats, fast for a single box. An
:class:`Interval` holds arrays, and rounds sums, products and quotients by their exact rounding error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from math import comb

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.expressions.exact import Exact, tree_of
from stribeck.expressions.graph import Expr, ordered
from stribeck.expressions.ops import Value

Range = tuple[float, float]
INF = math.inf
EVERYTHING: Range = (-INF, INF)
_BITS = 80  # of arb: 27 more than a float's, so that its error is far below the outward rounding
_SPLIT = 134217729.0  # 2^27 + 1: halves a float's digits (Dekker)


# -- one box: pairs of floats -------------------------------------------------------------------------------------------


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
    """An operation on single ranges."""
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


# -- many boxes: arrays -------------------------------------------------------------------------------------------------


def _below(x: Array) -> Array:
    return np.nextafter(x, -np.inf)


def _above(x: Array) -> Array:
    return np.nextafter(x, np.inf)


def _sums(a: Array, b: Array) -> tuple[Array, Array]:
    s = a + b
    b_ = s - a
    low, high = _ends_of(s, (a - (s - b_)) + (b - b_))
    undefined = np.isnan(s)
    return np.where(undefined, -np.inf, low), np.where(undefined, np.inf, high)


def _product_error(a: Array, b: Array, p: Array) -> Array:
    """a b - p exactly; nan if it cannot be computed without overflow or underflow; 0 for factors 0 and +-1."""
    c, d = _SPLIT * a, _SPLIT * b
    a1, b1 = c - (c - a), d - (d - b)
    a2, b2 = a - a1, b - b1
    error = ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2
    safe = (abs(p) > 1e-250) & (abs(p) < 1e250) & (abs(a) < 1e250) & (abs(b) < 1e250)
    exact = (a == 0) | (b == 0) | (abs(a) == 1) | (abs(b) == 1)
    return np.where(exact, 0.0, np.where(safe, error, np.nan))


def _ends_of(x: Array, error: Array) -> tuple[Array, Array]:
    """Rounded results and their errors as intervals."""
    return np.where(error >= 0, x, _below(x)), np.where(error <= 0, x, _above(x))


def _products(a: Array, b: Array) -> tuple[Array, Array]:
    p = np.where((a == 0) | (b == 0), 0.0, a * b)
    low, high = _ends_of(p, _product_error(a, b, p))
    same = (a < 0) == (b < 0)  # rounding does not change a sign
    return np.where(same & (low < 0), 0.0, low), np.where(~same & (high > 0), 0.0, high)


def _quotients(a: Array, b: Array) -> tuple[Array, Array]:
    """a/b for b other than 0; 0 if both are infinite, the smallest possible value."""
    q = np.where(np.isinf(a) & np.isinf(b), 0.0, a / b)
    p = q * b
    rest = (a - p) - _product_error(q, b, p)  # a - q b, exact where a - p is, which is so for a rounded quotient
    return _ends_of(q, np.where((a == 0) | (abs(b) == 1) | np.isinf(b), 0.0, rest * np.sign(b)))


def _corners(a: Interval, b: Interval) -> tuple[Array, Array]:
    """Every pair of ends, along a new first axis."""
    ends = np.broadcast_arrays(a.low, a.high, b.low, b.high)
    return np.stack([ends[0], ends[0], ends[1], ends[1]]), np.stack([ends[2], ends[3], ends[2], ends[3]])


@dataclass(frozen=True)
class Interval:
    """Intervals [low, high], one for each box."""

    low: Array
    high: Array

    def __add__(self, other: Interval) -> Interval:
        return Interval(_sums(self.low, other.low)[0], _sums(self.high, other.high)[1])

    def __neg__(self) -> Interval:
        return Interval(-self.high, -self.low)

    def __sub__(self, other: Interval) -> Interval:
        return self + (-other)

    def __mul__(self, other: Interval) -> Interval:
        low, high = _products(*_corners(self, other))
        return Interval(low.min(axis=0), high.max(axis=0))

    def __truediv__(self, other: Interval) -> Interval:
        lows, highs = _quotients(*_corners(self, other))
        low, high = lows.min(axis=0), highs.max(axis=0)
        if not np.any((other.low <= 0) & (other.high >= 0)):
            return Interval(low, high)
        # the divisor reaches 0 from one side: the quotient is unbounded on one side, and bounded by the far end
        for far, touches in ((other.high, other.low == 0), (other.low, other.high == 0)):
            one_sided = touches & (far != 0)
            positive = np.where(far > 0, self.low >= 0, self.high <= 0)
            negative = np.where(far > 0, self.high <= 0, self.low >= 0)
            near = np.where(abs(self.low) < abs(self.high), self.low, self.high)
            down, up = _quotients(near, far)
            low = np.where(one_sided, np.where(positive, down, -np.inf), low)
            high = np.where(one_sided, np.where(negative, up, np.inf), high)
        inside = ((other.low < 0) & (other.high > 0)) | ((other.low == 0) & (other.high == 0))
        return Interval(np.where(inside, -np.inf, low), np.where(inside, np.inf, high))

    def __abs__(self) -> Interval:
        low = np.where(self.low > 0, self.low, np.where(self.high < 0, -self.high, 0.0))
        return Interval(low, np.maximum(abs(self.low), abs(self.high)))

    def within(self, other: Interval) -> Interval:
        """The intersection with an interval that is known to contain the same values."""
        return Interval(np.maximum(self.low, other.low), np.minimum(self.high, other.high))

    def hull(self, other: Interval) -> Interval:
        """The smallest interval around both."""
        return Interval(np.minimum(self.low, other.low), np.maximum(self.high, other.high))


@dataclass(frozen=True)
class Truth:
    """A condition on each box: whether it must hold, and whether it may."""

    must: NDArray[np.bool_]
    may: NDArray[np.bool_]


def point(x: ArrayLike) -> Interval:
    """Intervals of one number each."""
    x = np.asarray(x, float)
    return Interval(x, x)


def interval(low: ArrayLike, high: ArrayLike) -> Interval:
    """Intervals from their ends."""
    return Interval(np.asarray(low, float), np.asarray(high, float))


def _by_box(function: Callable[..., Range], *args: Interval) -> Interval:
    """A function of single ranges, box by box; equal boxes once."""
    ends = np.broadcast_arrays(*(end for x in args for end in (x.low, x.high)))
    rows = np.stack([end.ravel() for end in ends], axis=-1)
    unique, back = np.unique(rows, axis=0, return_inverse=True)
    results = np.array([function(*zip(row[::2], row[1::2], strict=True)) for row in unique.tolist()])
    table = results[back.ravel()].reshape(*ends[0].shape, 2)
    return Interval(table[..., 0], table[..., 1])


def _rising(name: str) -> Callable[[Interval], Interval]:
    """exp, atan, tanh, log: each end by itself, equal ends once."""

    def ends(x: Array, side: int) -> Array:
        unique, back = np.unique(x, return_inverse=True)
        results = np.array([rising(name, (end, end))[side] for end in unique.tolist()])
        return results[back.ravel()].reshape(x.shape)

    def apply(x: Interval) -> Interval:
        return Interval(ends(x.low, 0), np.where((x.low < 0) & (name == "log"), np.inf, ends(x.high, 1)))

    return apply


def _root(x: Interval) -> Interval:
    """The square root, which NumPy rounds correctly."""
    with np.errstate(all="ignore"):
        low, high = np.sqrt(np.maximum(x.low, 0.0)), np.sqrt(np.maximum(x.high, 0.0))
    bad = x.low < 0
    least = np.where((low == 0) | (low == 1), low, np.maximum(_below(low), 0.0))
    most = np.where((high == 0) | (high == 1), high, _above(high))
    return Interval(np.where(bad, -np.inf, least), np.where(bad, np.inf, most))


_OF_ARRAYS: dict[str, Callable[..., Value]] = {
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
    "neg": lambda a: -a, "abs": abs, **{name: _rising(name) for name in ("exp", "atan", "tanh", "log")}, "sqrt": _root,
    "sin": lambda a: _by_box(lambda x: _wave("sin", x), a), "cos": lambda a: _by_box(lambda x: _wave("cos", x), a),
    "sign": lambda a: Interval(np.sign(a.low), np.sign(a.high)), "pow": lambda a, b: _by_box(power, a, b),
    "lt": lambda a, b: Truth(a.high < b.low, a.low < b.high),
    "le": lambda a, b: Truth(a.high <= b.low, a.low <= b.high),
    "both": lambda a, b: Truth(a.must & b.must, a.may & b.may),
    "either": lambda a, b: Truth(a.must | b.must, a.may | b.may),
}  # fmt: skip


Polynomial = tuple[Expr, tuple[Fraction, ...]]


def polynomials(outputs: Iterable[Expr]) -> dict[Expr, Polynomial]:
    """The nodes that are polynomials, of degree 2 or more with literal coefficients, in one other node."""
    known: dict[Expr, Polynomial | Fraction] = {}
    for node in ordered(outputs):
        args = [known[a] for a in node.args] if node.op in ("add", "sub", "mul", "neg", "div") else []
        x = node.value
        if isinstance(x, float) and np.isfinite(x) and not isinstance(x, Exact):
            known[node] = Fraction(x)
        else:
            known[node] = _combined(node, args) or (node, (Fraction(0), Fraction(1)))
    candidates = {n: p for n, p in known.items() if isinstance(p, tuple) and len(p[1]) > 2}
    # polynomials inside a larger one are not needed, and single powers have exact ranges already
    inner = {a for n in candidates for a in n.args if a in candidates and candidates[a][0] is candidates[n][0]}
    return {n: p for n, p in candidates.items() if n not in inner and sum(c != 0 for c in p[1]) > 1}


def _combined(node: Expr, args: list[Value]) -> Polynomial | None:
    leaves = {a[0] for a in args if isinstance(a, tuple)}
    if len(leaves) != 1:
        return None
    leaf = leaves.pop()
    lists = [a[1] if isinstance(a, tuple) else (a,) for a in args]
    if node.op == "neg":
        return leaf, tuple(-c for c in lists[0])
    left, right = lists
    if node.op == "div":
        return (leaf, tuple(c / right[0] for c in left)) if len(right) == 1 and right[0] else None
    if node.op == "mul":
        product = [Fraction(0)] * (len(left) + len(right) - 1)
        for i, a in enumerate(left):
            for j, b in enumerate(right):
                product[i + j] += a * b
        return leaf, tuple(product)
    side = 1 if node.op == "add" else -1
    size = max(len(left), len(right))
    pad = [(*x, *([Fraction(0)] * (size - len(x)))) for x in (left, right)]
    return leaf, tuple(a + side * b for a, b in zip(*pad, strict=True))


@cache
def _fraction(x: Fraction) -> Interval:
    return (
        point(float(x.numerator)) / point(float(x.denominator))
        if abs(x.numerator) < 2**53 > x.denominator
        else interval(down(float(x)), up(float(x)))
    )


def bernstein(coefficients: tuple[Fraction, ...], x: Interval) -> Interval:
    """The range of a polynomial on bounded intervals, by its Bernstein coefficients; all reals on unbounded ones."""
    n = len(coefficients) - 1
    start, width = point(x.low), interval(x.high, x.high) - point(x.low)
    width = Interval(np.maximum(width.low, 0.0), width.high)
    scaled, power = [], point(np.ones_like(x.low))
    for j in range(n + 1):  # p^(j)(low)/j! width^j
        value = point(np.zeros_like(x.low))
        for k in range(n, j - 1, -1):
            value = value * start + _fraction(coefficients[k] * comb(k, j))
        scaled.append(value * power)
        power = power * width
    range_: Interval | None = None
    for i in range(n + 1):
        b = point(np.zeros_like(x.low))
        for j in range(i + 1):
            b = b + scaled[j] * point(float(comb(i, j))) / point(float(comb(n, j)))  # whole numbers: often exact
        range_ = b if range_ is None else range_.hull(b)
    assert range_ is not None
    bounded = np.isfinite(x.low) & np.isfinite(x.high)
    return Interval(np.where(bounded, range_.low, -np.inf), np.where(bounded, range_.high, np.inf))


# -- expressions over boxes ---------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Carrier:
    """The kind of value on which an expression is evaluated: single ranges, or arrays of them.

    Attributes:
        free: an infinite end.
        number, apply: the value of a constant, and of an operation.
        ends, bounds: an interval from its ends, and the ends of an interval.
        meet: the intersection of two intervals that contain the same value.
        choose: the value of a condition's cases, which are evaluated when needed.
    """

    free: Value
    number: Callable[[float], Value]
    apply: Callable[[str, list[Value]], Value]
    ends: Callable[[Value, Value], Value]
    bounds: Callable[[Value], tuple[Value, Value]]
    meet: Callable[[Value, Value], Value]
    choose: Callable[[Value, Callable[[], Value], Callable[[], Value]], Value]


def _meet(a: Range, b: Range) -> Range:
    low, high = max(a[0], b[0]), min(a[1], b[1])
    return (low, high) if low <= high else a


def _choose(truth: bool | None, if_true: Callable[[], Range], if_false: Callable[[], Range]) -> Range:
    if truth is not None:
        return if_true() if truth else if_false()
    x, y = if_true(), if_false()
    return min(x[0], y[0]), max(x[1], y[1])


def _choose_each(truth: Truth, if_true: Callable[[], Interval], if_false: Callable[[], Interval]) -> Interval:
    x, y = if_true(), if_false()
    either = x.hull(y)
    low = np.where(truth.must, x.low, np.where(truth.may, either.low, y.low))
    return Interval(low, np.where(truth.must, x.high, np.where(truth.may, either.high, y.high)))


_SINGLE = _Carrier(INF, number, _apply, lambda low, high: (low, high), lambda x: x, _meet, _choose)
_MANY = _Carrier(
    np.asarray(np.inf), lambda x: interval(*number(x)), lambda op, args: _OF_ARRAYS[op](*args), Interval,
    lambda x: (x.low, x.high), Interval.within, _choose_each,
)  # fmt: skip


def _value(on: _Carrier, node: Expr, known: Mapping[Expr, Value], inputs: Mapping[str, Value]) -> Value:
    """The range of a node, from the ranges of its arguments."""
    if node.op == "symbol":
        return inputs[str(node.value)]
    if node.op == "constant":
        assert isinstance(node.value, float)
        return on.number(node.value)
    if node.op == "where":
        return _where(on, node, known, {})
    args = [known[a] for a in node.args]
    if node.op == "mul" and node.args[0] is node.args[1]:
        args = [on.apply("abs", args[:1])] * 2
    return on.apply(node.op, args)


def _where(on: _Carrier, node: Expr, known: Mapping[Expr, Value], limits: Mapping[Expr, Value]) -> Value:
    """The range of a node, narrowed by the limits that enclosing conditions set on some nodes."""
    if node in limits:
        return on.meet(known[node], limits[node])
    if node.op != "where":
        return known[node]
    condition, a, b = node.args
    yes: dict[Expr, Value] = {}
    no: dict[Expr, Value] = {}
    if condition.op in ("lt", "le"):
        smaller, larger = condition.args
        (s_low, s_high), (l_low, l_high) = on.bounds(known[smaller]), on.bounds(known[larger])
        yes = {smaller: on.ends(-on.free, l_high), larger: on.ends(s_low, on.free)}
        no = {smaller: on.ends(l_low, on.free), larger: on.ends(-on.free, s_high)}

    def side(x: Expr, says: Mapping[Expr, Value]) -> Value:
        joined = {n: on.meet(limits[n], y) if n in limits else y for n, y in says.items()}
        return _where(on, x, known, {**limits, **joined})

    return on.choose(known[condition], lambda: side(a, yes), lambda: side(b, no))


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
                    self.known[each] = _value(_SINGLE, each, self.known, self.inputs)
        return self.known[node]


class Evaluator:
    """Ranges of expressions over boxes; made once for the expressions, called for many boxes."""

    def __init__(self, outputs: Iterable[Expr]) -> None:
        self.outputs = list(outputs)
        self.nodes = ordered(self.outputs)
        self.polynomials = polynomials(self.outputs)

    def __call__(self, inputs: Mapping[str, Interval]) -> list[Interval]:
        """The range of each output, from that of each symbol."""
        known: dict[Expr, Value] = {}
        with np.errstate(all="ignore"):
            for node in self.nodes:
                known[node] = _value(_MANY, node, known, inputs)
                if node in self.polynomials:
                    leaf, coefficients = self.polynomials[node]
                    known[node] = known[node].within(bernstein(coefficients, known[leaf]))
        return [known[node] for node in self.outputs]
