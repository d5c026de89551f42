"""Values that the exported C must reproduce: computed here by the law's NumPy equations and by SciPy."""

from __future__ import annotations

from typing import Any

import numpy as np

from stribeck.export.ccode import Equations
from stribeck.export.request import Request
from stribeck.expressions import ops
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import Expr, ordered, wrap
from stribeck.laws.base import Law


def cases(request: Request) -> dict[str, list[tuple[str, ...]]]:
    """Rows of numbers as C writes them, by function; the last number of a row is the sum of the absolute terms."""
    law, equations = request.law, Equations(request.law)
    scales, rng = law.scales(law.p), np.random.default_rng(1)
    speeds = scales.speed * np.array([0.0, 1e-9, -1e-3, 0.3, -1.0, 2.5, -30.0, 1e4])
    z = scales.length * rng.uniform(-1, 1, speeds.size) if law.has_z else np.zeros(speeds.size)
    v, z = (x.astype(np.float32).astype(float) for x in (speeds, z))  # the same numbers in single precision
    size = terms(equations, ("rate", "force"))
    rates, forces = law.rate(v, z), law.force(v, z)
    found: dict[str, list[tuple[str, ...]]] = {"points": [], "steps": []}
    for i in range(v.size):
        rate_terms, force_terms = size(v[i], z[i])
        row = (v[i], z[i], rates[i], rate_terms, forces[i], force_terms, law.steady_force(v[i]))
        found["points"].append(_row(row))
    for i in range(1, v.size - 1):
        dt = float(np.float32(0.05 * scales.length / abs(v[i])))
        after = advance(law, v[i], z[i], dt)
        found["steps"].append(_row((v[i], z[i], dt, after, scales.length)))
    return found


def terms(equations: Equations, names: tuple[str, ...]) -> Any:
    """A function (v, z) -> for each expression the sum of its absolute terms: what its rounding is measured by."""
    known: dict[Expr, Expr] = {}
    outputs = [equations.expressions[name] for name in names]
    for node in ordered(outputs):
        known[node] = _magnitude(node, known)
    p = equations.law
    symbols = [n for n, x in vars(p.symbolic(str, p.structure)).items() if x is not None]
    function = python_function([*symbols, "v", "z"], [known[node] for node in outputs])
    values = [p.values[name] for name in symbols]

    def at(v: float, z: float) -> tuple[float, ...]:
        with np.errstate(all="ignore"):
            return tuple(float(x) for x in function(*values, v, z))

    return at


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
    """z after dt with v held, by SciPy at tolerances near rounding."""
    from scipy.integrate import solve_ivp

    if not law.has_z:
        return z
    length = law.scales(law.p).length
    solution = solve_ivp(
        lambda t, x: [float(law.rate(v, x[0]))], (0, dt), [z], method="DOP853", rtol=1e-13, atol=1e-13 * length
    )
    return float(solution.y[0, -1])


def _row(numbers: Any) -> tuple[str, ...]:
    return tuple(repr(float(x)) for x in numbers)
