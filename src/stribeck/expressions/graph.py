"""Expressions as a graph of shared nodes, with exact derivatives.

The nodes keep the order of operations of an equation, so that generated C and the NumPy evaluation of the same function
agree to rounding. Equal subexpressions are one node, so that common terms are computed once.
"""

from __future__ import annotations

import threading
import weakref
from collections.abc import Callable, Container, Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from stribeck.expressions import ops
from stribeck.expressions.exact import Exact, combined, function
from stribeck.expressions.ops import Value

if TYPE_CHECKING:
    from stribeck.expressions.names import Names

Number = int | float


class Expr:
    """A node: an operation on other nodes, a named symbol, or a constant. Equal nodes are the same object."""

    __slots__ = ("__weakref__", "args", "op", "value")

    op: str
    args: tuple[Expr, ...]
    value: float | str | None

    def __add__(self, other: Value) -> Expr:
        return _add(self, wrap(other))

    def __radd__(self, other: Value) -> Expr:
        return _add(wrap(other), self)

    def __sub__(self, other: Value) -> Expr:
        return _sub(self, wrap(other))

    def __rsub__(self, other: Value) -> Expr:
        return _sub(wrap(other), self)

    def __mul__(self, other: Value) -> Expr:
        return _mul(self, wrap(other))

    def __rmul__(self, other: Value) -> Expr:
        return _mul(wrap(other), self)

    def __truediv__(self, other: Value) -> Expr:
        return _div(self, wrap(other))

    def __rtruediv__(self, other: Value) -> Expr:
        return _div(wrap(other), self)

    def __neg__(self) -> Expr:
        return _neg(self)

    def __abs__(self) -> Expr:
        return _function("abs", self)

    def __pow__(self, power: Value) -> Expr:
        return _power(self, power)

    def __rpow__(self, base: Value) -> Expr:
        return _power(wrap(base), self)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Number):
            raise TypeError("equations cannot test for equality: use where(x <= 0, a, b) or sign(x)")
        return self is other

    __hash__ = object.__hash__
    __array_ufunc__ = None  # NumPy leaves arithmetic with nodes to them

    def __lt__(self, other: Value) -> Expr:
        return _node("lt", self, wrap(other))

    def __le__(self, other: Value) -> Expr:
        return _node("le", self, wrap(other))

    def __gt__(self, other: Value) -> Expr:
        return _node("lt", wrap(other), self)

    def __ge__(self, other: Value) -> Expr:
        return _node("le", wrap(other), self)

    def __bool__(self) -> bool:
        raise TypeError("the truth of an expression is not known while it is built: use where(condition, a, b)")

    def __repr__(self) -> str:
        if self.op in ("symbol", "constant"):
            return str(self.value)
        return f"{self.op}({', '.join(map(repr, self.args))})"


_nodes: weakref.WeakValueDictionary[tuple[Value, ...], Expr] = weakref.WeakValueDictionary()
_lock = threading.Lock()


def _node(op: str, *args: Expr, value: float | str | None = None) -> Expr:
    # repr distinguishes 0.0 and -0.0, which compare equal
    key = (op, args, repr(value), value.tree if isinstance(value, Exact) else None)
    with _lock:  # two threads must not make the same symbol twice
        node = _nodes.get(key)
        if node is None:
            node = Expr()
            node.op, node.args, node.value = op, args, value
            _nodes[key] = node
    return node


def symbol(name: str) -> Expr:
    """The input named ``name``."""
    return _node("symbol", value=name)


def constant(x: Number) -> Expr:
    """A number as a node."""
    return _node("constant", value=x if isinstance(x, Exact) else float(x))


def wrap(x: Value) -> Expr:
    """A number as a node; nodes pass through."""
    if isinstance(x, Expr):
        return x
    if isinstance(x, int | float | np.floating | np.integer):
        return constant(x if isinstance(x, Exact) else float(x))
    raise TypeError(f"{x!r} does not mix with expressions: {type(x).__name__}")


ZERO, ONE = constant(0.0), constant(1.0)


def is_zero(x: Expr) -> bool:
    """True for the constant 0: a structural zero."""
    return x.op == "constant" and x.value == 0.0


def _number(x: Expr) -> float | None:
    return x.value if x.op == "constant" and isinstance(x.value, float) else None


def _add(a: Expr, b: Expr) -> Expr:
    m, n = _number(a), _number(b)
    if m is not None and n is not None:
        return constant(combined("add", m, n))
    if m == 0.0:
        return b
    if n == 0.0:
        return a
    if b.op == "neg":
        return _sub(a, b.args[0])
    if a.op == "neg":
        return _sub(b, a.args[0])
    return _node("add", a, b)


def _sub(a: Expr, b: Expr) -> Expr:
    m, n = _number(a), _number(b)
    if m is not None and n is not None:
        return constant(combined("sub", m, n))
    if n == 0.0:
        return a
    if m == 0.0:
        return _neg(b)
    if b.op == "neg":
        return _add(a, b.args[0])
    return _node("sub", a, b)


def _mul(a: Expr, b: Expr) -> Expr:
    m, n = _number(a), _number(b)
    if m is not None and n is not None:
        return constant(combined("mul", m, n))
    if m == 0.0 or n == 0.0:
        return ZERO
    if m == 1.0:
        return b
    if n == 1.0:
        return a
    if m == -1.0:
        return _neg(b)
    if n == -1.0:
        return _neg(a)
    if a.op == "neg":
        return _neg(_mul(a.args[0], b))
    if b.op == "neg":
        return _neg(_mul(a, b.args[0]))
    return _node("mul", a, b)


def _div(a: Expr, b: Expr) -> Expr:
    m, n = _number(a), _number(b)
    if m is not None and n:
        return constant(combined("div", m, n))
    if m == 0.0:
        return ZERO
    if n == 1.0:
        return a
    if a.op == "neg":
        return _neg(_div(a.args[0], b))
    if b.op == "neg":
        return _neg(_div(a, b.args[0]))
    return _node("div", a, b)


def _neg(a: Expr) -> Expr:
    n = _number(a)
    if n is not None:
        return constant(-n)
    return a.args[0] if a.op == "neg" else _node("neg", a)


def _power(base: Expr, power: Value) -> Expr:
    """Whole powers become products, as a person would compute them; others stay powers."""
    if isinstance(power, Expr) and power.op == "constant":
        power = power.value
    if isinstance(power, Expr) or float(power) != int(power) or abs(power) > 64:
        return _node("pow", base, wrap(power))
    if power < 0:
        return _div(ONE, _power(base, -power))
    result, square, rest = ONE, base, int(power)
    while rest:
        if rest & 1:
            result = _mul(result, square)
        square, rest = _mul(square, square), rest >> 1
    return result


def _function(op: str, x: Expr) -> Expr:
    n = _number(x)
    if n is None:
        return _node(op, x)
    with np.errstate(all="ignore"):
        return constant(function(op, n, float(abs(n) if op == "abs" else getattr(ops, op)(float(n)))))


class _Graph:
    """The operations of :mod:`stribeck.expressions.ops` on nodes."""

    def __getattr__(self, op: str) -> Callable[[Value], Expr]:
        return lambda x: _function(op, wrap(x))

    @staticmethod
    def where(condition: Expr, a: Value, b: Value) -> Expr:
        if isinstance(condition, bool | np.bool_):
            return wrap(a if condition else b)
        a, b = wrap(a), wrap(b)
        return a if a is b else _node("where", condition, a, b)

    @staticmethod
    def both(a: Value, b: Value) -> Value:
        known, other = (a, b) if isinstance(a, bool | np.bool_) else (b, a)
        if isinstance(known, bool | np.bool_):
            return other if known else False
        return _node("both", a, b)

    @staticmethod
    def either(a: Value, b: Value) -> Value:
        known, other = (a, b) if isinstance(a, bool | np.bool_) else (b, a)
        if isinstance(known, bool | np.bool_):
            return True if known else other
        return _node("either", a, b)


ops.register("stribeck", _Graph())


def _finite(infinite: Expr, slope: Expr) -> Expr:
    """A slope, or 0 where it is infinite: the slope of |x|^0.5 at 0 is then 0, as that of |x| is, instead of 0 * inf."""
    return _Graph.where(infinite, 0.0, slope)


# The partial derivatives of an operation by its arguments: given the node and its arguments.
_PARTIALS: dict[str, Callable[..., tuple[Value, ...]]] = {
    "add": lambda n, a, b: (1, 1),
    "sub": lambda n, a, b: (1, -1),
    "mul": lambda n, a, b: (b, a),
    "div": lambda n, a, b: (1 / b, -n / b),
    "neg": lambda n, a: (-1,),
    "pow": lambda n, a, b: (
        _finite(ops.both(abs(a) <= 0, b < 1), b * a ** (b - 1)),
        0 if b.op == "constant" else n * ops.log(a),
    ),
    "sqrt": lambda n, a: (_finite(n <= 0, 0.5 / n),),
    "exp": lambda n, a: (n,),
    "log": lambda n, a: (1 / a,),
    "sin": lambda n, a: (ops.cos(a),),
    "cos": lambda n, a: (-ops.sin(a),),
    "atan": lambda n, a: (1 / (1 + a * a),),
    "tanh": lambda n, a: (1 - n * n,),
    "abs": lambda n, a: (ops.sign(a),),
    "sign": lambda n, a: (0,),
    "floor": lambda n, a: (0,),
}


def partials(node: Expr) -> list[Expr]:
    """The partial derivatives of a node by its arguments; an empty list if it has no derivative."""
    if node.op == "where":
        return [ZERO, _Graph.where(node.args[0], ONE, ZERO), _Graph.where(node.args[0], ZERO, ONE)]
    return [wrap(x) for x in _PARTIALS[node.op](node, *node.args)] if node.op in _PARTIALS else []


# The variable of a root, the number of times that its bracket is halved, and the bracket's reach: from a factor of 2^128
# between its ends to the spacing of floats, 2^-52.
BOUND, ROOT_STEPS, ROOT_REACH = symbol("root z"), 60, 2.0**64


def root(falls: Expr, start: Expr) -> Expr:
    """The first z > 0 at which an expression of :data:`BOUND` falls through 0, within a factor 2^64 of ``start``.

    The bracket is halved on a logarithmic scale, so that the root is exact to rounding at any magnitude.
    """
    return _node("root", falls, start)


def slope_at(node: Expr) -> Expr:
    """The slope, at a root, of the expression that is 0 there."""
    (slope,) = substitute([derivative(node.args[0], BOUND)], {BOUND: node})
    return slope


def _root_derivative(node: Expr, falls: Expr) -> Expr:
    """The derivative of a root, by the implicit function theorem; 0 where the expression is flat."""
    if is_zero(falls):
        return ZERO
    (change,) = substitute([falls], {BOUND: node})
    slope = slope_at(node)
    return _Graph.where(slope < 0, -change / slope, ZERO)


def derivative(expression: Expr, variable: Expr, known: dict[Expr, Expr] | None = None) -> Expr:
    """The derivative of a node by a symbol; ``known`` keeps results between calls with the same ``by``."""
    known = {} if known is None else known
    for node in ordered([expression]):
        if node in known:
            continue
        if node is variable:
            known[node] = ONE
        elif node.op == "where":
            known[node] = _Graph.where(node.args[0], known[node.args[1]], known[node.args[2]])
        elif node.op == "root":
            known[node] = _root_derivative(node, known[node.args[0]])
        elif node.op in _PARTIALS and not all(is_zero(known[a]) for a in node.args):
            total = ZERO
            for partial, arg in zip(partials(node), node.args, strict=True):
                total = total + partial * known[arg]
            known[node] = total
        else:
            known[node] = ZERO
    return known[expression]


def total_derivative(expression: Expr, rates: Mapping[Expr, Expr]) -> Expr:
    """The derivative of a node along a motion: its partial derivatives times the rates of the symbols."""
    total = ZERO
    for by, rate in rates.items():
        total = total + derivative(expression, by) * rate
    return total


def ordered(outputs: Iterable[Expr], known: Container[Expr] = ()) -> list[Expr]:
    """All nodes of the outputs, each after its arguments; without ``known`` ones, and what only these need."""
    order: dict[Expr, None] = {}
    stack = list(outputs)[::-1]
    while stack:
        node = stack.pop()
        if node in order or node in known:
            continue
        for arg in node.args:
            if arg not in order and arg not in known:  # it and the others first, then the node again
                stack.append(node)
                stack.extend(node.args[::-1])
                break
        else:
            order[node] = None
    return list(order)


def rebuild(node: Expr, args: tuple[Expr, ...]) -> Expr:
    """The same operation on other arguments, simplified again."""
    if args == node.args:
        return node
    build: dict[str, Callable[..., Expr]] = {
        "add": _add, "sub": _sub, "mul": _mul, "div": _div, "neg": _neg, "pow": _power, "where": _Graph.where,
    }  # fmt: skip
    if node.op in build:
        return build[node.op](*args)
    if node.op in ("lt", "le", "both", "either", "root"):
        return _node(node.op, *args)
    return _function(node.op, *args)


def _unnamed(old: Expr, new: Expr) -> Expr:
    return new


def rewrite(outputs: Iterable[Expr], rule: Callable[[Expr], Expr], names: Names | None = None) -> list[Expr]:
    """The outputs with ``rule`` applied to every node, arguments first; new nodes keep their ``names``."""
    outputs, hand_on = list(outputs), _unnamed if names is None else names.hand_on
    new: dict[Expr, Expr] = {}
    for node in ordered(outputs):
        new[node] = rule(hand_on(node, rebuild(node, tuple(new[a] for a in node.args))))
    return [new[node] for node in outputs]


def substitute(outputs: Iterable[Expr], values: Mapping[Expr, Expr], names: Names | None = None) -> list[Expr]:
    """The outputs with the nodes that are keys of ``values`` replaced; new nodes keep their ``names``."""
    outputs, hand_on = list(outputs), _unnamed if names is None else names.hand_on
    new: dict[Expr, Expr] = dict(values)
    for node in ordered(outputs):
        if node not in new:
            new[node] = hand_on(node, rebuild(node, tuple(new[a] for a in node.args)))
    return [new[node] for node in outputs]


def symbols(outputs: Iterable[Expr]) -> set[str]:
    """The names of the symbols that the outputs depend on."""
    return {str(node.value) for node in ordered(outputs) if node.op == "symbol"}
