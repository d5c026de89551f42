"""Expressions of a certificate: read from its text, substituted, differentiated. Equal expressions are one node."""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping
from typing import Any

from flint import fmpq

Json = Any


class Refused(Exception):
    """What a certificate says could not be confirmed; the message says where."""


class Node:
    """An operation on other nodes, a name, or a rational number."""

    __slots__ = ("args", "op", "value")
    args: tuple[Node, ...]
    op: str
    value: Json


_RATIONAL = re.compile(r"(-?[0-9]+)(?:/([0-9]+))?")
_nodes: dict[Hashable, Node] = {}
UNARY = ("neg", "abs", "sign", "exp", "log", "sqrt", "sin", "cos", "atan", "tanh")
BINARY = ("add", "sub", "mul", "div", "pow")
CONDITIONS = ("lt", "le", "both", "either")
_BEGIN_NUMBERS = tuple("-0123456789")
_ARITY = {**dict.fromkeys(UNARY, 1), **dict.fromkeys((*BINARY, *CONDITIONS), 2), "where": 3}


def node(op: str, *args: Node, value: Json = None) -> Node:
    """The node of an operation."""
    key = (op, value if not isinstance(value, fmpq) else (int(value.p), int(value.q)), args)
    known = _nodes.get(key)
    if known is None:
        known = Node()
        known.op, known.args, known.value = op, args, value
        _nodes[key] = known
    return known


def number(x: fmpq | int) -> Node:
    """A rational number."""
    return node("number", value=fmpq(x))


def name(word: str) -> Node:
    """A name."""
    return node("name", value=word)


ZERO, ONE = number(0), number(1)
U, W, PI = name("u"), name("w"), name("pi")


def rational(text: Json) -> fmpq:
    """The rational number that a text states: digits, after a minus or none, and a divisor or none.

    Raises:
        Refused: the text is no rational number.
    """
    match = _RATIONAL.fullmatch(text) if isinstance(text, str) else None
    try:
        if match is not None:
            return fmpq(int(match[1]), int(match[2] or 1))
    except (ValueError, ZeroDivisionError):  # more digits than Python reads; a divisor of 0
        pass
    raise Refused(f"{text!r} is no rational number")


def read(data: Json, known: Mapping[str, Node], seen: dict[int, Node] | None = None) -> Node:
    """An expression in prefix form; ``known`` are the names that it may use, ``seen`` the lists that were read already."""
    seen = {} if seen is None else seen
    if isinstance(data, list) and id(data) in seen:
        return seen[id(data)]
    if isinstance(data, str):
        if data[:1] in _BEGIN_NUMBERS:
            return number(rational(data))
        if data not in known:
            raise Refused(f"unknown name {data!r}")
        return known[data]
    if not isinstance(data, list) or not data or _ARITY.get(data[0]) != len(data) - 1:
        raise Refused(f"no expression: {str(data)[:80]}")
    op, *rest = data
    args = tuple(read(x, known, seen) for x in rest)
    truth = [a.op in CONDITIONS for a in args]
    wanted = [True, False, False] if op == "where" else [op in ("both", "either")] * len(args)
    if truth != wanted:
        raise Refused(f"a condition stands where a number should, or the other way round: {str(data)[:80]}")
    seen[id(data)] = node(op, *args)
    return seen[id(data)]


def make(op: str, *args: Node) -> Node:
    """An operation, with what is plain about numbers 0 and 1 simplified (total for every finite argument)."""
    a = args[0]
    b = args[1] if len(args) > 1 else ZERO
    if op in ("add", "sub") and b is ZERO:
        return a
    if op == "add" and a is ZERO:
        return b
    if op == "mul" and ONE in (a, b):
        return b if a is ONE else a
    if op in ("neg", "abs", "sign") and a is ZERO:
        return ZERO
    if op == "neg" and a.op == "neg":
        return a.args[0]
    return node(op, *args)


def by_cases(op: str, a: Node) -> Node:
    """abs(a) or sign(a) as cases."""
    if op == "abs":
        return node("where", node("le", ZERO, a), a, node("neg", a))
    below = node("where", node("lt", a, ZERO), number(-1), ZERO)
    return node("where", node("lt", ZERO, a), ONE, below)


def without_roots(top: Node) -> Node:
    """The expression with sqrt(x^2) as |x| and (x^2)^c as |x|^(2 c), where squares are plain."""
    new: dict[Node, Node] = {}
    for x in ordered(top):
        args = tuple(new[a] for a in x.args)
        new[x] = x if args == x.args else node(x.op, *args)
        if x.op == "sqrt" and (root := _square_root(args[0])) is not None:
            new[x] = node("abs", root)
        elif x.op == "pow" and args[1].op == "number" and (root := _square_root(args[0])) is not None:
            power = 2 * args[1].value
            new[x] = node("abs", root) if power == 1 else node("pow", node("abs", root), number(power))
    return new[top]


def _square_root(x: Node) -> Node | None:
    """A root of a product or quotient of squares; None where an expression is written otherwise."""
    if x.op == "mul" and x.args[0] is x.args[1]:
        return x.args[0]
    if x.op in ("mul", "div"):
        first, second = (_square_root(a) for a in x.args)
        return None if first is None or second is None else node(x.op, first, second)
    return None


def ordered(top: Node) -> list[Node]:
    """The node and all below it, arguments first."""
    order: dict[Node, None] = {}
    stack = [top]
    while stack:
        at = stack.pop()
        if at in order:
            continue
        if all(map(order.__contains__, at.args)):
            order[at] = None
        else:
            stack.append(at)
            stack.extend(at.args)
    return list(order)


def replace(top: Node, by: Mapping[Node, Node]) -> Node:
    """The node with others in place of the keys of ``by``."""
    new: dict[Node, Node] = {}
    for at in ordered(top):
        if at in by:
            new[at] = by[at]
        else:
            args = tuple(new[a] for a in at.args)
            new[at] = at if args == at.args else make(at.op, *args)
    return new[top]


def names(top: Node) -> set[str]:
    """The names in an expression."""
    return {at.value for at in ordered(top) if at.op == "name"}


def derivative(top: Node, by: Node) -> Node:
    """The derivative by a name, within the cases that hold: abs has the slope sign, sign and conditions none."""
    d: dict[Node, Node] = {}
    for x in ordered(top):
        if x is by:
            d[x] = ONE
        elif x.op in ("number", "name", "sign", *CONDITIONS) or all(d[a] is ZERO for a in x.args):
            d[x] = ZERO
        else:
            d[x] = _chain(x, d)
    return d[top]


def _chain(x: Node, d: Mapping[Node, Node]) -> Node:
    a = x.args[0]
    if x.op in ("add", "sub"):
        return make(x.op, d[a], d[x.args[1]])
    if x.op == "mul":
        return make("add", _times(d[a], x.args[1]), _times(a, d[x.args[1]]))
    if x.op == "div":
        b = x.args[1]
        return make("sub", make("div", d[a], b), _times(make("div", x, b), d[b]))
    if x.op == "where":
        return make("where", a, d[x.args[1]], d[x.args[2]])
    if x.op == "neg":
        return make("neg", d[a])
    if x.op == "pow":
        b = x.args[1]
        if d[b] is not ZERO:
            return _times(x, make("add", _times(d[b], make("log", a)), make("div", _times(b, d[a]), a)))
        return _times(make("mul", b, make("pow", a, make("sub", b, ONE))), d[a])
    return _times(_slope(x, a), d[a])


def _slope(x: Node, a: Node) -> Node:
    """The derivative of a function by its argument."""
    one = {"exp": x, "abs": node("sign", a), "cos": make("neg", node("sin", a)), "sin": node("cos", a)}
    if x.op in one:
        return one[x.op]
    if x.op == "log":
        return make("div", ONE, a)
    if x.op == "sqrt":
        return make("div", ONE, make("mul", number(2), x))
    if x.op == "atan":
        return make("div", ONE, make("add", ONE, make("mul", a, a)))
    if x.op == "tanh":
        return make("sub", ONE, make("mul", x, x))
    raise Refused(f"no derivative of {x.op}")


def _times(a: Node, b: Node) -> Node:
    return ZERO if ZERO in (a, b) else make("mul", a, b)
