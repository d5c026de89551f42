"""Reference values for the exported C, computed from the law's NumPy equations and by SciPy."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, arg, needed
from stribeck.exports.c.ccode import LawCode
from stribeck.exports.request import Request
from stribeck.expressions import ops
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import BOUND, Expr, ordered, partials, slope_at, substitute, wrap
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law


def cases(request: Request) -> dict[str, list[tuple[str, ...]]]:
    """Rows of numbers as C writes them, by function; the last number of a row is the sum of the absolute terms.

    Raises:
        InputError: single precision cannot represent the tested motion, or a value is not finite.
    """
    with np.errstate(all="ignore"):
        return _cases(request)


def _cases(request: Request) -> dict[str, list[tuple[str, ...]]]:
    law = at_a_load(request.law)
    equations = LawCode(law)
    scales, rng = law.scales(law.p), np.random.default_rng(1)
    speeds = scales.speed * np.array([0.0, 1e-9, -1e-3, 0.3, -1.0, 2.5, -30.0, 1e4])
    z = scales.length * rng.uniform(-1, 1, speeds.size) if law.has_z else np.zeros(speeds.size)
    v, z = _single(speeds), _single(z)
    size = terms(equations, ("rate", "force"))
    rates, forces = law.rate(v, z), law.force(v, z)
    tables: dict[str, list[tuple[str, ...]]] = {"points": [], "steps": []}
    tables["load"] = [_row(law.values[name] or 0.0 for name in law.inputs)]
    for i in range(v.size):
        rate_terms, force_terms = size(v[i], z[i])
        row = (v[i], z[i], rates[i], rate_terms, forces[i], force_terms, float(law.steady_force(v[i])))
        tables["points"].append(_row(row))
    for i in range(1, v.size - 1):
        dt = float(_single(np.array(min(0.05 * scales.length / abs(v[i]), _settled(law, v[i], scales.length)))))
        after = advance(law, v[i], z[i], dt)
        tables["steps"].append(_row((v[i], z[i], dt, after, scales.length)))
    return tables


def at_a_load(law: Law) -> Law:
    """The law with values for its inputs: loads near its natural force, and half of its natural length."""
    force = float(law.scales(law.p).force) or 1.0
    given = {n: 1.25 if n.startswith("factor_") else 0.5 * float(law.scales(law.p).length) for n in law.inputs}
    given |= {n: (1 - 1.75 * (i % 2)) * force for i, n in enumerate(law.inputs) if n.startswith("load_")}
    return law.replace(**{n: float(np.float32(x)) for n, x in given.items()})


def _single(numbers: Array) -> Array:
    """The numbers rounded to single precision, so that C with floats has the same inputs."""
    small, size = np.finfo(np.float32), abs(numbers)
    wrong = numbers[~((numbers == 0) | ((size >= small.tiny) & (size <= small.max)))]
    if wrong.size:
        text = (
            f"the check of these constants needs {wrong[0]:g}, which single precision does not hold (1.2e-38 to 3.4e38)"
        )
        raise InputError(f"{arg('self_test')}: {text}")
    return numbers.astype(np.float32).astype(float)


def _settled(law: Law, v: float, length: float) -> float:
    """A time after which z has settled at a speed, s; an explicit solver would take minutes for longer ones."""
    fastest = max(abs(float(law.rate(v, z + 1e-6 * length) - law.rate(v, z))) for z in (-length, 0.0, length)) / (
        1e-6 * length
    )
    return 100 / fastest if fastest else np.inf


def terms(equations: LawCode, names: tuple[str, ...]) -> Value:
    """A function of (v, z) for the sum of absolute terms of each expression, the measure of its rounding."""
    known: dict[Expr, Expr] = {}
    outputs = [equations.expressions[name] for name in names]
    for node in ordered(outputs):
        known[node] = _magnitude(node, known)
    p = equations.law
    symbols = list(p.numbers(p.form))
    function = python_function([*symbols, "v", "z"], [known[node] for node in outputs])
    values = [p.values[name] for name in symbols]

    def sums(v: float, z: float) -> tuple[float, ...]:
        with np.errstate(all="ignore"):
            return tuple(float(x) for x in function(*values, v, z))

    return sums


def output_spread(outputs: list[Expr]) -> list[Expr]:
    """The sensitivity of each output to relative errors of every symbol and constant, to first order.

    It is the sum of absolute terms, carried through functions, and is the measure of rounding.
    """
    known: dict[Expr, Expr] = {}
    for node in ordered(outputs):
        total = wrap(0.0)
        for slope, argument in zip(partials(node), node.args, strict=False):
            total = total + abs(slope) * known[argument]
        if node.op == "root":
            total = substitute([known[node.args[0]]], {BOUND: node})[0] / abs(slope_at(node))
        known[node] = total if node.args else abs(node)
    return [known[node] for node in outputs]


def _magnitude(node: Expr, known: dict[Expr, Expr]) -> Expr:
    parts = [known[arg] for arg in node.args]
    if node.op in ("add", "sub"):
        return parts[0] + parts[1]
    if node.op == "mul":
        return parts[0] * parts[1]
    if node.op == "div":
        return parts[0] / abs(node.args[1])
    if node.op == "neg":
        return parts[0]
    if node.op == "where":
        return wrap(ops.where(node.args[0], parts[1], parts[2]))
    return node if node.op in ("lt", "le", "both", "either") else abs(node)


def advance(law: Law, v: float, z: float, dt: float) -> float:
    """z after dt at constant v, by SciPy at tolerances near rounding."""
    with needed("a self-test", "fmu"):
        from scipy.integrate import solve_ivp

    if not law.has_z:
        return z
    length = law.scales(law.p).length
    solution = solve_ivp(
        lambda t, x: [float(law.rate(v, x[0]))], (0, dt), [z], method="DOP853", rtol=1e-13, atol=1e-13 * length
    )
    return float(solution.y[0, -1])


def _row(numbers: Iterable[float]) -> tuple[str, ...]:
    values = [float(x) for x in numbers]
    if not np.all(np.isfinite(values)):
        raise InputError(f"{arg('self_test')}: a value to check by is not finite with these constants")
    return tuple(map(repr, values))
