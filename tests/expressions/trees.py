"""Random equations: nested tuples that can be evaluated on numbers, arrays, graph nodes and SymPy symbols alike."""

from __future__ import annotations

import operator

import numpy as np
from hypothesis import assume, settings
from hypothesis import strategies as st

from stribeck.expressions import ops
from stribeck.expressions.graph import is_zero, ordered, wrap

QUICK = settings(deadline=None, derandomize=True, database=None, max_examples=150)
NAMES = ("x", "y", "k_v")

_BINARY = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}
_UNARY = {"neg": operator.neg, "sin": ops.sin, "cos": ops.cos, "atan": ops.atan, "tanh": ops.tanh}
_UNARY |= {
    "exp": lambda x: ops.exp(-x * x),
    "sqrt": lambda x: ops.sqrt(1 + x * x),
    "log": lambda x: ops.log(2 + ops.sin(x)),
}
_KINKED = {"abs": abs, "sign": ops.sign}
_COMPARE = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}
_JOIN = {"both": ops.both, "either": ops.either}

_leaves = st.sampled_from(NAMES) | st.sampled_from((0.5, 1.0, 2.0, 3.0, -1.0, -2.5, 1e-3, 7))


def trees(smooth: bool = False) -> st.SearchStrategy:
    """Expressions; ``smooth`` ones have derivatives everywhere."""

    def grow(inner: st.SearchStrategy) -> st.SearchStrategy:
        unary = st.tuples(st.sampled_from(sorted(_UNARY)), inner)
        powers = st.tuples(st.just("**"), inner, st.sampled_from((2, 3, -1)))
        grown = st.tuples(st.sampled_from(sorted(_BINARY)), inner, inner) | unary | powers
        if smooth:
            return grown
        simple = st.tuples(st.sampled_from(sorted(_COMPARE)), inner, inner)
        condition = simple | st.tuples(st.sampled_from(sorted(_JOIN)), simple, simple)
        deep = condition | st.tuples(st.sampled_from(sorted(_JOIN)), condition, condition)
        choice = st.tuples(st.just("where"), deep, inner, inner)
        return grown | st.tuples(st.sampled_from(sorted(_KINKED)), inner) | choice

    return st.recursive(_leaves, grow, max_leaves=12)


def evaluate(tree, values: dict):
    """The expression on whatever the values are."""
    if isinstance(tree, str):
        return values[tree]
    if not isinstance(tree, tuple):
        return tree
    op, *rest = tree
    if op == "**":
        return power(evaluate(rest[0], values), rest[1])
    args = [evaluate(each, values) for each in rest]
    if op == "where":
        return ops.where(*args)
    return {**_BINARY, **_UNARY, **_KINKED, **_COMPARE, **_JOIN}[op](*args)


def node_of(tree, values: dict):
    """The expression as a node of the graph; those in which constants divide by zero are left out."""
    try:
        with np.errstate(divide="raise"):
            node = wrap(evaluate(tree, values))
    except (ZeroDivisionError, FloatingPointError):
        assume(False)
    assume(not any(n.op == "div" and is_zero(n.args[1]) for n in ordered([node])))
    return node


def power(x, n: int):
    """Whole powers of numbers as the products that the graph makes of them, so that results agree to the last bit."""
    if isinstance(x, float | int | np.ndarray | np.generic):
        return {2: lambda: x * x, 3: lambda: x * (x * x), -1: lambda: 1 / x}[n]()
    return x**n
