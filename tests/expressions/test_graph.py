"""Nodes of the graph: shared, simplified without changing results, differentiated exactly."""

from __future__ import annotations

import gc
import threading

import numpy as np
import pytest
import sympy
from hypothesis import assume, given
from hypothesis import strategies as st

from stribeck.expressions import graph, ops
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import Expr, constant, derivative, is_zero, symbol, symbols
from tests.expressions.trees import NAMES, QUICK, evaluate, node_of, trees

X, Y = symbol("x"), symbol("y")
NODES = {name: symbol(name) for name in NAMES}
POINTS = st.fixed_dictionaries({name: st.floats(0.1, 3.0) | st.floats(-3.0, -0.1) for name in NAMES})


def numbers(tree, point):
    """The value by NumPy; points where anything overflows or has no value are left out."""
    try:
        with np.errstate(all="raise", under="ignore"):
            value = float(evaluate(tree, {name: np.float64(x) for name, x in point.items()}))
    except (FloatingPointError, ZeroDivisionError):
        assume(False)
    assume(np.isfinite(value))
    return value


def value(node, point) -> float:
    with np.errstate(all="ignore"):
        return float(python_function(NAMES, [node])(*(np.float64(point[name]) for name in NAMES))[0])


@QUICK
@given(trees())
def test_equal_expressions_are_one_node(tree):
    assert node_of(tree, NODES) is node_of(tree, NODES)


def test_sharing():
    assert X + Y is X + Y
    assert X + Y is not Y + X  # the order of operations is kept
    assert symbol("x") is X
    assert constant(2) is constant(2.0)
    assert constant(0.0) is not constant(-0.0)
    assert ops.where(X < Y, X, Y) is ops.where(Y > X, X, Y)
    assert derivative(X * Y + ops.sin(X * Y), X) is derivative(X * Y + ops.sin(X * Y), X)


@pytest.mark.thorough
def test_nodes_that_nobody_holds_are_gone():
    gc.collect()
    before = len(graph._nodes)
    node = ops.sin(symbol("a name of this test") * 7.25) + 1
    assert len(graph._nodes) > before
    del node
    gc.collect()
    assert len(graph._nodes) == before


def test_threads_share_nodes():
    ready, result = threading.Barrier(8), []

    def build():
        ready.wait()
        result.append([symbol(f"thread {i}") + 1 for i in range(300)])

    threads = [threading.Thread(target=build) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(node is first for nodes in result for node, first in zip(nodes, result[0], strict=True))


@pytest.mark.parametrize(
    ("simplified", "expected"),
    [
        (X + 0, X), (0 + X, X), (X - 0, X), (0 - X, -X), (X * 1, X), (1 * X, X), (X * -1, -X), (X / 1, X),
        (0 * X, constant(0)), (X * 0.0, constant(0)), (0 / X, constant(0)), (-1 * -X, X), (X + -Y, X - Y), (-X + Y, Y - X),
        (X - -Y, X + Y), (-X * Y, -(X * Y)), (X / -Y, -(X / Y)), (X**0, constant(1)), (X**1, X), (X**2, X * X),
        (X**-1, 1 / X), (X**2.0, X * X), (X ** constant(2), X * X), (constant(2) * 3 + 4, constant(10)),
        (ops.exp(constant(0)), constant(1)), (abs(constant(-2)), constant(2)), (ops.where(X < Y, X, X), X),
        (ops.where(True, X, Y), X), (2**X, constant(2) ** X), (ops.both(True, X < Y), X < Y), (ops.both(X < Y, False), False),
        (ops.either(X < Y, True), True), (ops.either(np.bool_(False), X < Y), X < Y),
    ],
    ids=str,
)  # fmt: skip
def test_simplifications(simplified, expected):
    assert simplified is expected


@pytest.mark.parametrize("n", [0, 1, 2, 3, 7, 10, 64, -1, -5, 0.5, 2.5, 100])
def test_powers(n):
    assert value(X**n, {"x": 1.3, "y": 0, "k_v": 0}) == pytest.approx(1.3**n, rel=1e-13)
    assert value(derivative(X**n, X), {"x": 1.3, "y": 0, "k_v": 0}) == pytest.approx(n * 1.3 ** (n - 1), rel=1e-13)


@QUICK
@given(trees(), POINTS)
def test_simplification_keeps_every_bit(tree, point):
    assert value(node_of(tree, NODES), point) == numbers(tree, point)


@QUICK
@given(trees(smooth=True), POINTS, st.sampled_from(NAMES))
def test_derivative_is_sympys(tree, point, by):
    numbers(tree, point)
    exact = sympy.diff(evaluate(tree, {name: sympy.Symbol(name) for name in NAMES}), sympy.Symbol(by))
    result = value(derivative(node_of(tree, NODES), NODES[by]), point)
    expected = sympy.sympify(exact).evalf(30, subs={name: sympy.Float(x, 30) for name, x in point.items()})
    assume(expected.is_Float or expected.is_Integer)
    assume(abs(expected) < 1e12)
    # terms that cancel leave the rounding of the larger ones
    size = 1 + abs(numbers(tree, point)) + abs(float(expected))
    assert result == pytest.approx(float(expected), rel=1e-7, abs=1e-7 * size)


def test_derivatives_at_kinks():
    """What the solver and the Jacobian at rest rely on: |x| has the slope 0 at 0, and so has a root of it."""
    at_rest = {"x": 0.0, "y": 0.5, "k_v": 1.0}
    assert value(derivative(abs(X), X), at_rest) == 0.0
    assert value(derivative(ops.sign(X), X), at_rest) == 0.0
    assert value(derivative(abs(X) ** Y, X), at_rest) == 0.0
    assert value(derivative(abs(X) ** 0.5, X), at_rest) == 0.0
    assert value(derivative(ops.sqrt(abs(X)), X), at_rest) == 0.0
    assert value(derivative(ops.sqrt(X * X), X), at_rest) == 0.0
    assert value(derivative(X**Y, X), {**at_rest, "y": 1.0}) == 1.0
    for x, slope, share in ((0.25, 0.5, 1.0), (0.75, 3.0, 0.0)):
        cases = ops.where(X < Y, X * X, 3 * X)
        assert value(derivative(cases, X), {**at_rest, "x": x}) == slope
        assert [value(each, {**at_rest, "x": x}) for each in graph.partials(cases)] == [0.0, share, 1.0 - share]
    assert value(derivative(X**Y, X), {"x": -2.0, "y": -1.0, "k_v": 0.0}) == -0.25
    assert value(derivative(X**Y, Y), {"x": 2.0, "y": 3.0, "k_v": 0.0}) == pytest.approx(8 * np.log(2))


def test_structural_zeros():
    assert is_zero(derivative(Y * ops.sin(Y), X))
    assert is_zero(derivative(ops.where(X < Y, Y, 1.0), X))
    assert symbols([X * 2 + symbol("k_v")]) == {"x", "k_v"}


def test_numpy_numbers_mix():
    for two in (np.float64(2), np.float32(2), np.int64(2)):
        for node in (two * X, X * two, two + X, two - X, X / two, two / X, two < X):
            assert isinstance(node, Expr)
    assert np.float64(2) * X is 2 * X
    assert X ** np.int64(2) is X * X
    with pytest.raises(TypeError):
        np.exp(X)


@QUICK
@given(trees())
def test_substitution(tree):
    node = node_of(tree, NODES)
    swapped = node_of(tree, {**NODES, "x": Y, "y": X})
    assert graph.substitute([node], {X: Y, Y: X})[0] is swapped
    assert graph.rewrite([node], lambda n: n)[0] is node
