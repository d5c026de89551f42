"""Exact numbers: floats that carry the expression of the real number they approximate, such as pi or 0.1 + 0.2.

The evaluation of an equation needs a float; a proof about it needs the exact number. ``pi``, 2/pi and 0.1 + 0.2, which no
float equals, are floats with an expression. ``math.pi`` is an ordinary float, and means exactly that float.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Callable
from fractions import Fraction
from functools import partialmethod, reduce
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stribeck.expressions.ops import Value


Tree = Any  # a float, "pi", or (operation, Tree) or (operation, Tree, Tree)

_OPERATIONS: dict[str, Callable[..., float]] = {
    "add": operator.add, "sub": operator.sub, "mul": operator.mul, "div": operator.truediv,
}  # fmt: skip


class Exact(float):
    """A float with the exact number that it approximates, as a tree of operations on floats and pi."""

    tree: Tree
    __slots__ = ("tree",)

    def __new__(cls, value: float, tree: Tree) -> Exact:
        """A float and its exact number."""
        number = super().__new__(cls, value)
        number.tree = tree
        return number

    def __getnewargs__(self) -> tuple[float, Tree]:  # type: ignore[override]
        return float(self), self.tree

    def _with(self, op: str, other: Value, swapped: bool = False) -> Value:
        if type(other) not in (int, float, Exact):  # arrays and nodes have their own ways
            return NotImplemented
        a, b = (other, self) if swapped else (self, other)
        return combined(op, float(a) if type(a) is int else a, float(b) if type(b) is int else b)

    __add__, __radd__ = partialmethod(_with, "add"), partialmethod(_with, "add", swapped=True)
    __sub__, __rsub__ = partialmethod(_with, "sub"), partialmethod(_with, "sub", swapped=True)
    __mul__, __rmul__ = partialmethod(_with, "mul"), partialmethod(_with, "mul", swapped=True)
    __truediv__, __rtruediv__ = partialmethod(_with, "div"), partialmethod(_with, "div", swapped=True)

    def __neg__(self) -> Exact:
        return Exact(-float(self), ("neg", self.tree))

    def __pos__(self) -> Exact:
        return self

    def __abs__(self) -> Exact:
        return -self if self < 0 else self

    def __pow__(self, power: Value, modulo: None = None) -> Value:
        if type(power) is int and 0 < power <= 64:
            return Exact(float(self) ** power, reduce(lambda a, b: ("mul", a, b), [self.tree] * power))
        if type(power) in (int, float):
            return Exact(float(self) ** power, ("pow", self.tree, float(power)))
        return NotImplemented


pi = Exact(math.pi, "pi")


def tree_of(x: float) -> Tree:
    """The exact number that a number represents: itself, unless it is an :class:`Exact`."""
    return x.tree if isinstance(x, Exact) else float(x)


def combined(op: str, a: float, b: float) -> float:
    """A sum, difference, product or quotient of numbers; a plain float if that is exact."""
    x, y = float(a), float(b)
    value = _OPERATIONS[op](x, y)
    if not (math.isfinite(x) and math.isfinite(y) and math.isfinite(value)):
        return value
    if not (isinstance(a, Exact) or isinstance(b, Exact)) and _OPERATIONS[op](Fraction(x), Fraction(y)) == value:
        return value
    return Exact(value, (op, tree_of(a), tree_of(b)))


def function(op: str, x: float, value: float) -> float:
    """The rounded ``value`` of a function of x, with its exact number."""
    if op in ("abs", "sign") or not (math.isfinite(x) and math.isfinite(value)):
        return abs(x) if op == "abs" else value
    known = (
        (x == 0 and op != "log") or (op == "sqrt" and Fraction(value) ** 2 == Fraction(x)) or (op == "log" and x == 1)
    )
    if known and not isinstance(x, Exact):
        return value
    return Exact(value, (op, tree_of(x)))
