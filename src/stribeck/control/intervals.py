"""Expressions over intervals: bounds that hold for every value of the inputs, rounding included."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from stribeck.expressions.graph import Expr, ordered

Interval = tuple[float, float]


def enclose(expr: Expr, inputs: Mapping[str, Interval]) -> Interval:
    """An interval that holds the expression's value for all inputs within theirs.

    Raises:
        NotImplementedError: the expression holds an operation without a rule here.
    """
    found: dict[Expr, Interval] = {}
    for node in ordered([expr]):
        args = [found[a] for a in node.args]
        if node.op == "symbol":
            found[node] = inputs[str(node.value)]
        elif node.op == "constant":
            assert isinstance(node.value, float)
            found[node] = (node.value, node.value)
        elif node.op == "mul" and node.args[0] is node.args[1]:
            found[node] = _square(args[0])
        elif node.op in _RULES:
            found[node] = _RULES[node.op](*args)
        else:
            raise NotImplementedError(f"no interval rule for {node.op}")
    return found[expr]


def _out(low: float, high: float, ulps: int = 1) -> Interval:
    for _ in range(ulps):
        low, high = math.nextafter(low, -math.inf), math.nextafter(high, math.inf)
    return low, high


def _mul(a: Interval, b: Interval) -> Interval:
    products = [x * y if x and y else 0.0 for x in a for y in b]
    return _signed(_out(min(products), max(products)), min(products) >= 0, max(products) <= 0)


def _signed(x: Interval, positive: bool, negative: bool) -> Interval:
    """Rounding outward does not change a sign that is known."""
    return max(x[0], 0.0) if positive else x[0], min(x[1], 0.0) if negative else x[1]


def _square(a: Interval) -> Interval:
    ends = [x * x for x in a]
    low, high = _out(0.0 if a[0] <= 0 <= a[1] else min(ends), max(ends))
    return max(low, 0.0), high


def _div(a: Interval, b: Interval) -> Interval:
    if b[0] <= 0 <= b[1]:
        return -math.inf, math.inf
    return _mul(a, _out(1 / b[1], 1 / b[0]))


def _monotone(f: Callable[[float], float]) -> Callable[[Interval], Interval]:
    """A rising odd function of the C library, which errs by less than four units in the last place."""
    return lambda a: _signed(_out(f(a[0]), f(a[1]), 4), a[0] >= 0, a[1] <= 0)


def _abs(a: Interval) -> Interval:
    return (0.0 if a[0] <= 0 <= a[1] else min(abs(a[0]), abs(a[1]))), max(abs(a[0]), abs(a[1]))


def _exp(a: Interval) -> Interval:
    low, high = _out(math.exp(min(a[0], 700.0)), math.exp(a[1]) if a[1] < 700 else math.inf, 4)
    return max(low, 0.0), high


_RULES: dict[str, Callable[..., Interval]] = {
    "add": lambda a, b: _out(a[0] + b[0], a[1] + b[1]),
    "sub": lambda a, b: _out(a[0] - b[1], a[1] - b[0]),
    "neg": lambda a: (-a[1], -a[0]),
    "mul": _mul, "div": _div, "abs": _abs, "exp": _exp, "atan": _monotone(math.atan), "tanh": _monotone(math.tanh),
    "sqrt": lambda a: _out(math.sqrt(max(a[0], 0.0)), math.sqrt(a[1])),
}  # fmt: skip
