"""Interval arithmetic with outward rounding, for many boxes at once.

Sums, products and quotients of floats are rounded outward by their exact rounding error; exp, atan and the like come
from python-flint's arb. An interval may be unbounded; 0 times unbounded is 0, as for sets of real numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import comb
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.expressions import ranges
from stribeck.expressions.exact import Exact
from stribeck.expressions.graph import Expr, ordered
from stribeck.expressions.ops import Value

_BITS = 80  # of arb: 27 more than a float's
_SPLIT = 134217729.0  # 2^27 + 1: halves a float's digits (Dekker)


def _down(x: Array) -> Array:
    return np.nextafter(x, -np.inf)


def _up(x: Array) -> Array:
    return np.nextafter(x, np.inf)


def _sums(a: Array, b: Array) -> tuple[Array, Array]:
    s = a + b
    b_ = s - a
    low, high = _ends_of(s, (a - (s - b_)) + (b - b_))
    lost = np.isnan(s)
    return np.where(lost, -np.inf, low), np.where(lost, np.inf, high)


def _product_error(a: Array, b: Array, p: Array) -> Array:
    """a b - p exactly, or nan where it cannot be told; for zero and one it is 0."""
    c, d = _SPLIT * a, _SPLIT * b
    a1, b1 = c - (c - a), d - (d - b)
    a2, b2 = a - a1, b - b1
    error = ((a1 * b1 - p) + a1 * b2 + a2 * b1) + a2 * b2
    safe = (abs(p) > 1e-250) & (abs(p) < 1e250) & (abs(a) < 1e250) & (abs(b) < 1e250)
    exact = (a == 0) | (b == 0) | (abs(a) == 1) | (abs(b) == 1)
    return np.where(exact, 0.0, np.where(safe, error, np.nan))


def _ends_of(x: Array, error: Array) -> tuple[Array, Array]:
    """Rounded results and their errors as intervals."""
    return np.where(error >= 0, x, _down(x)), np.where(error <= 0, x, _up(x))


def _products(a: Array, b: Array) -> tuple[Array, Array]:
    p = np.where((a == 0) | (b == 0), 0.0, a * b)
    low, high = _ends_of(p, _product_error(a, b, p))
    same = (a < 0) == (b < 0)  # rounding does not change a sign
    return np.where(same & (low < 0), 0.0, low), np.where(~same & (high > 0), 0.0, high)


def _quotients(a: Array, b: Array) -> tuple[Array, Array]:
    """a/b for b that is not 0; where both are infinite 0, the smallest of what it can be."""
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
            one = touches & (far != 0)
            positive = np.where(far > 0, self.low >= 0, self.high <= 0)
            negative = np.where(far > 0, self.high <= 0, self.low >= 0)
            near = np.where(abs(self.low) < abs(self.high), self.low, self.high)
            down, up = _quotients(near, far)
            low = np.where(one, np.where(positive, down, -np.inf), low)
            high = np.where(one, np.where(negative, up, np.inf), high)
        inside = ((other.low < 0) & (other.high > 0)) | ((other.low == 0) & (other.high == 0))
        return Interval(np.where(inside, -np.inf, low), np.where(inside, np.inf, high))

    def __abs__(self) -> Interval:
        low = np.where(self.low > 0, self.low, np.where(self.high < 0, -self.high, 0.0))
        return Interval(low, np.maximum(abs(self.low), abs(self.high)))

    def within(self, other: Interval) -> Interval:
        """The intersection with an interval that is known to hold the same values."""
        return Interval(np.maximum(self.low, other.low), np.minimum(self.high, other.high))

    def hull(self, other: Interval) -> Interval:
        """The smallest interval around both."""
        return Interval(np.minimum(self.low, other.low), np.maximum(self.high, other.high))


@dataclass(frozen=True)
class Truth:
    """A condition on each box: it must hold, or at least may."""

    must: NDArray[np.bool_]
    may: NDArray[np.bool_]


def point(x: ArrayLike) -> Interval:
    """Intervals of one number each."""
    x = np.asarray(x, float)
    return Interval(x, x)


def interval(low: ArrayLike, high: ArrayLike) -> Interval:
    """Intervals from their ends."""
    return Interval(np.asarray(low, float), np.asarray(high, float))


@cache
def _flint() -> ModuleType:
    import flint

    flint.ctx.prec = _BITS
    return flint


def _ends(name: str, x: float) -> tuple[float, float]:
    """A function's value as an interval of floats, from arb."""
    flint = _flint()
    y = getattr(flint.arb(x), name)()
    low, high = float(y.lower()), float(y.upper())
    return np.nextafter(low, -np.inf), np.nextafter(high, np.inf)


def _monotone(name: str, x: Interval, low: float, high: float, exact: Mapping[float, float]) -> Interval:
    """A rising function with values in [low, high]; ``exact`` holds values that are known."""

    def end(ends: Array, lower: bool) -> Array:
        unique, back = np.unique(ends, return_inverse=True)
        values = [exact[e] if e in exact else _ends(name, e)[0 if lower else 1] for e in unique.tolist()]
        return np.asarray(values)[back].reshape(ends.shape)

    return Interval(np.maximum(end(x.low, True), low), np.minimum(end(x.high, False), high))


def pi() -> Interval:
    """The number pi."""
    flint = _flint()
    y = flint.arb.pi()
    return interval(np.nextafter(float(y.lower()), 0), np.nextafter(float(y.upper()), 4))


def _exp(x: Interval) -> Interval:
    return _monotone("exp", x, 0.0, np.inf, {0.0: 1.0, -np.inf: 0.0, np.inf: np.inf})


def _atan(x: Interval) -> Interval:
    half = float(np.nextafter(pi().high / 2, 4))
    return _monotone("atan", x, -half, half, {0.0: 0.0, -np.inf: -half, np.inf: half})


def _tanh(x: Interval) -> Interval:
    return _monotone("tanh", x, -1.0, 1.0, {0.0: 0.0, -np.inf: -1.0, np.inf: 1.0})


def _log(x: Interval) -> Interval:
    low = np.maximum(x.low, 0.0)
    found = _monotone(
        "log", Interval(low, np.maximum(x.high, 0.0)), -np.inf, np.inf, {0.0: -np.inf, np.inf: np.inf, 1.0: 0.0}
    )
    return Interval(np.where(x.low < 0, -np.inf, found.low), np.where(x.low < 0, np.inf, found.high))


def _sqrt(x: Interval) -> Interval:
    with np.errstate(all="ignore"):
        low, high = np.sqrt(np.maximum(x.low, 0.0)), np.sqrt(np.maximum(x.high, 0.0))
    bad = x.low < 0
    down = np.where((low == 0) | (low == 1), low, np.maximum(_down(low), 0.0))
    up = np.where((high == 0) | (high == 1), high, _up(high))
    return Interval(np.where(bad, -np.inf, down), np.where(bad, np.inf, up))


def _wave(name: str) -> Callable[[Interval], Interval]:
    """sin or cos."""

    def ends(low: float, high: float) -> tuple[float, float]:
        if not high - low < 100:
            return -1.0, 1.0
        flint = _flint()
        ball = flint.arb(low).union(flint.arb(high))
        y = getattr(ball, name)()
        return max(np.nextafter(float(y.lower()), -2), -1.0), min(np.nextafter(float(y.upper()), 2), 1.0)

    def of(x: Interval) -> Interval:
        low, high = np.broadcast_arrays(x.low, x.high)
        values = [ends(a, b) for a, b in zip(low.ravel().tolist(), high.ravel().tolist(), strict=True)]
        table = np.asarray(values).reshape(*low.shape, 2)
        return Interval(table[..., 0], table[..., 1])

    return of


def _sign(x: Interval) -> Interval:
    return Interval(np.sign(x.low), np.sign(x.high))


def _pow(a: Interval, b: Interval) -> Interval:
    """a^b = exp(b log a) for a >= 0; 0^b = 0 for b > 0."""
    found = _exp(b * _log(a))
    known = (a.low >= 0) & ((a.low > 0) | (b.low > 0))
    return Interval(np.where(known, found.low, -np.inf), np.where(known, found.high, np.inf))


_FUNCTIONS: dict[str, Callable[..., Value]] = {
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
    "neg": lambda a: -a, "abs": abs, "exp": _exp, "atan": _atan, "tanh": _tanh, "log": _log, "sqrt": _sqrt,
    "sin": _wave("sin"), "cos": _wave("cos"), "sign": _sign, "pow": _pow,
    "lt": lambda a, b: Truth(a.high < b.low, a.low < b.high),
    "le": lambda a, b: Truth(a.high <= b.low, a.low <= b.high),
    "both": lambda a, b: Truth(a.must & b.must, a.may & b.may),
    "either": lambda a, b: Truth(a.must | b.must, a.may | b.may),
}  # fmt: skip


def number(x: float) -> Interval:
    """A constant of an equation: the number that it stands for, pi where pi was written."""
    low, high = ranges.number(x)
    return interval(low, high)


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
    found = {n: p for n, p in known.items() if isinstance(p, tuple) and len(p[1]) > 2}
    # those within a larger one are not wanted for themselves, and powers are ranged as such
    inner = {a for n in found for a in n.args if a in found and found[a][0] is found[n][0]}
    return {n: p for n, p in found.items() if n not in inner and sum(c != 0 for c in p[1]) > 1}


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
        else interval(np.nextafter(float(x), -np.inf), np.nextafter(float(x), np.inf))
    )


def bernstein(coefficients: tuple[Fraction, ...], x: Interval) -> Interval:
    """The range of a polynomial by its Bernstein coefficients on bounded intervals; all reals on others."""
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
    found: Interval | None = None
    for i in range(n + 1):
        b = point(np.zeros_like(x.low))
        for j in range(i + 1):
            b = b + scaled[j] * point(float(comb(i, j))) / point(float(comb(n, j)))  # whole numbers: often exact
        found = b if found is None else found.hull(b)
    assert found is not None
    bounded = np.isfinite(x.low) & np.isfinite(x.high)
    return Interval(np.where(bounded, found.low, -np.inf), np.where(bounded, found.high, np.inf))


def _where(node: Expr, known: Mapping[Expr, Value], limits: Mapping[Expr, Interval]) -> Interval:
    """The range of a node, with what the conditions around it say of some nodes."""
    if node in limits:
        return known[node].within(limits[node])  # type: ignore[no-any-return]
    if node.op != "where":
        return known[node]  # type: ignore[no-any-return]
    condition, a, b = node.args
    truth = known[condition]
    yes, no = {}, {}
    if condition.op in ("lt", "le"):
        less, more = condition.args
        free = np.asarray(np.inf)
        yes = {less: Interval(-free, known[more].high), more: Interval(known[less].low, free)}
        no = {less: Interval(known[more].low, free), more: Interval(-free, known[less].high)}
    if_true, if_false = (_where(x, known, _joined(limits, says)) for x, says in ((a, yes), (b, no)))
    either = if_true.hull(if_false)
    low = np.where(truth.must, if_true.low, np.where(truth.may, either.low, if_false.low))
    return Interval(low, np.where(truth.must, if_true.high, np.where(truth.may, either.high, if_false.high)))


def _joined(a: Mapping[Expr, Interval], b: Mapping[Expr, Interval]) -> dict[Expr, Interval]:
    return {**a, **{node: x.within(a[node]) if node in a else x for node, x in b.items()}}


class Evaluator:
    """Ranges of expressions over boxes; made once for the expressions, called for many boxes."""

    def __init__(self, outputs: Iterable[Expr]) -> None:
        self.outputs = list(outputs)
        self.nodes = ordered(self.outputs)
        self.polynomials = polynomials(self.outputs)

    def __call__(self, inputs: Mapping[str, Interval]) -> list[Interval]:
        """The range of each output, given that of each symbol."""
        return [self.all(inputs)[node] for node in self.outputs]

    def all(self, inputs: Mapping[str, Interval]) -> dict[Expr, Value]:
        """The range of every node: an :class:`Interval`, or a :class:`Truth` for conditions."""
        known: dict[Expr, Value] = {}
        with np.errstate(all="ignore"):
            for node in self.nodes:
                known[node] = self._value(node, known, inputs)
        return known

    def _value(self, node: Expr, known: dict[Expr, Value], inputs: Mapping[str, Interval]) -> Value:
        if node.op == "symbol":
            return inputs[str(node.value)]
        if node.op == "constant":
            assert isinstance(node.value, float)
            return number(node.value)
        args = [known[a] for a in node.args]
        if node.op == "where":
            return _where(node, known, {})
        if node.op == "mul" and args[0] is args[1]:
            args = [abs(args[0])] * 2
        value = _FUNCTIONS[node.op](*args)
        if node in self.polynomials:
            leaf, coefficients = self.polynomials[node]
            value = value.within(bernstein(coefficients, known[leaf]))
        return value
