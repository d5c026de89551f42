"""Expressions written out as code compute what the expressions mean, in Python and in C."""

from __future__ import annotations

import ctypes
import subprocess
from importlib.resources import files

import numpy as np
import pytest
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from stribeck.expressions import ops
from stribeck.expressions.emit import PYTHON, C, Writer, python_function
from stribeck.expressions.graph import constant, symbol
from stribeck.simulation import compiler
from tests.expressions.trees import NAMES, QUICK, node_of, trees

NODES = {name: symbol(name) for name in NAMES}
X, Y, K = (NODES[name] for name in NAMES)
GRID = dict(zip(NAMES, np.random.default_rng(0).uniform(-3, 3, (3, 50)), strict=True))
PRECEDENCE = [
    X - (Y - K), X - (Y + K), (X - Y) - K, X / (Y * K), X / (Y / K), (X / Y) / K, X * (Y / K), X * (Y + K), -(X + Y), -(X * Y),
    (-X) / Y - -K, X - -(Y - K), -2.0 * X, X * -2.0, X - -2.0, -2.0 - X, -(-2.0 - X), abs(-X) - -abs(Y), X ** (Y * Y) * K,
    (X * X) ** (Y + K), ops.where(X < Y, X, Y) + K, K - ops.where(X < Y, X, Y), ops.where(X + Y < Y - K, X, Y) * K,
    ops.where(ops.where(X < Y, X, K) < Y, X, ops.where(X < K, 1.0, Y)), -ops.where(X < Y, X, Y),
    ops.where(ops.both(X < Y, ops.either(Y < K, K < X)), X, Y), ops.where(ops.either(ops.both(X < Y, Y < K), K < X), X, Y),
    ops.where(ops.both(ops.either(X < Y, Y < K), K < X), X, Y), ops.exp(-(X * X)) / -Y, (-X) ** 3, -(X**3),
]  # fmt: skip


def by_hand(node, values):
    """The meaning of a node, one operation at a time."""
    if node.op == "symbol":
        return values[node.value]
    if node.op == "constant":
        return node.value
    args = [by_hand(arg, values) for arg in node.args]
    names = {
        "add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide, "neg": np.negative, "pow": np.power,
    }  # fmt: skip
    names |= {"lt": np.less, "le": np.less_equal, "abs": np.abs}
    return (names.get(node.op) or getattr(ops, node.op))(*args)


def same(found, expected):
    return np.array_equal(np.broadcast_to(found, (50,)), np.broadcast_to(expected, (50,)), equal_nan=True)


@QUICK
@given(st.lists(trees(), min_size=1, max_size=3))
def test_python_code(expressions):
    nodes = [node_of(tree, NODES) for tree in expressions]
    with np.errstate(all="ignore"):
        outcome = python_function(NAMES, nodes)(*GRID.values())
        assert all(same(a, by_hand(node, GRID)) for a, node in zip(outcome, nodes, strict=True))
        single = {name: x[0] for name, x in GRID.items()}
        numbers = python_function(NAMES, nodes)(*single.values())
        assert all(np.ndim(x) == 0 for x in numbers)


def c_function(expressions):
    """Compile the expressions as C functions, and return a Python function of an array of inputs."""
    writer_inputs = {name: f"x[{i}]" for i, name in enumerate(NAMES)}
    bodies = []
    for i, node in enumerate(expressions):
        lines = Writer(C, writer_inputs, taken=("x", "out")).write([(f"out[{i}]", node)])
        bodies.append(f"static void f{i}(const double *x, double *out) {{\n" + "\n".join(lines) + "\n}\n")
    calls = "".join(f"f{i}(x, out); " for i in range(len(expressions)))
    operations = files("stribeck.codegen.runtime").joinpath("scalar.c").read_text()
    operations = f"#include <math.h>\n#define UNUSED __attribute__((unused))\n{operations}"
    return f"{operations}\n{''.join(bodies)}\nvoid all(const double *x, double *out) {{ {calls} }}\n"


@pytest.fixture(scope="module")
def compiled(tmp_path_factory):
    """A function that evaluates expressions in C at the points of the grid."""
    outcome = compiler.find()
    if outcome is None:
        pytest.skip("no C compiler")
    folder, count = tmp_path_factory.mktemp("c"), iter(range(100))

    def evaluate_all(expressions):
        source, library = folder / f"{(i := next(count))}.c", folder / f"{i}.so"
        source.write_text(c_function(expressions))
        options = ["-std=c99", "-Wall", "-Werror", "-Wno-unused", "-ffp-contract=off", "-fPIC", "-shared"]
        command = [*outcome.command, *options, "-o", str(library), str(source), "-lm"]
        result = subprocess.run(command, capture_output=True, text=True, check=False)
        assert result.returncode == 0, result.stderr
        function, out = ctypes.CDLL(str(library)).all, np.empty((50, len(expressions)))
        for row, point in zip(out, np.ascontiguousarray(np.array(list(GRID.values())).T), strict=True):
            function(point.ctypes.data_as(ctypes.c_void_p), row.ctypes.data_as(ctypes.c_void_p))
        return out.T

    return evaluate_all


@settings(QUICK, max_examples=3, phases=[Phase.generate], suppress_health_check=list(HealthCheck))
@given(st.lists(trees(), min_size=40, max_size=40))
def test_c_code(compiled, expressions):
    nodes = [*PRECEDENCE, *(node_of(tree, NODES) for tree in expressions)]
    with np.errstate(all="ignore"):
        for outcome, node in zip(compiled(nodes), nodes, strict=True):
            expected = np.broadcast_to(by_hand(node, GRID), (50,))
            close = np.isclose(outcome, expected, rtol=1e-9, atol=1e-9, equal_nan=True)
            assert close.mean() > 0.9, node  # what depends on the last bit may differ at some points


def test_special_values_in_c(compiled):
    huge, nothing = constant(float("inf")), constant(float("nan"))
    nodes = [X * 0 + huge, -huge + 0 * X, nothing + X, ops.exp(-1e6 * abs(X)), ops.atan(1e300 * X), ops.sign(X - X)]
    outcome = compiled(nodes)
    assert np.all(outcome[0] == np.inf)
    assert np.all(outcome[1] == -np.inf)
    assert np.all(np.isnan(outcome[2]))
    assert np.all(outcome[3] == 0)
    assert outcome[4] == pytest.approx(np.sign(GRID["x"]) * np.pi / 2)
    assert np.all(outcome[5] == 0)
    assert np.all(np.isnan(python_function(NAMES, [nothing + X])(*GRID.values())[0]))


def test_long_expressions_are_cut_into_lines():
    total = X
    for i in range(200):
        total = total * Y + i
    written = Writer(PYTHON, {name: name for name in NAMES}).write([("r0", total)])
    assert 10 < len(written) < 200
    assert max(map(len, written)) < 200
    assert python_function(NAMES, [total])(1.0, 1.0, 0.0)[0] == 1 + sum(range(200))
