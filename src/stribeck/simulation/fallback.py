"""The same equations solved by SciPy's Radau, where there is no C compiler: as right, and some hundred times slower."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import derivative, symbol
from stribeck.scenario import Scenario
from stribeck.simulation.result import Result, piecewise

Array = NDArray[np.float64]


class _Equations:
    """The system's rates and Jacobian as functions of (t, x) for solve_ivp, within one piece of the signal."""

    def __init__(self, scenario: Scenario) -> None:
        system, values = scenario.system, scenario.values()
        names = [state.name for state in system.states]
        inputs = [f"{owner}.{name}" for owner, name in system.parameters]
        inputs += ["segment.start", "segment.value", "segment.slope", "t", *names]
        rates = system.rates()
        jacobian = [derivative(rate, symbol(name)) for rate in rates for name in names]
        self._rates, self._jacobian = python_function(inputs, rates), python_function(inputs, jacobian)
        self._values = [np.float64(values[key]) for key in system.parameters]
        self.piece: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def rates(self, t: float, x: Array) -> Array:
        return np.array(self._rates(*self._values, *self.piece, t, *x), float)

    def jacobian(self, t: float, x: Array) -> Array:
        return np.array(self._jacobian(*self._values, *self.piece, t, *x), float).reshape(len(x), len(x))


def solve(scenario: Scenario, progress: Callable[[float], None] | None = None) -> Result:
    """Integrate the scenario with SciPy's Radau; ``progress`` is told the share of time done."""
    from scipy.integrate import Radau

    equations, atol = _Equations(scenario), scenario.atol()
    starts, levels, slopes = piecewise(scenario.signal)
    x = np.array([scenario.initial.get(state.name, 0.0) for state in scenario.system.states])
    names = [state.name for state in scenario.system.states]
    speed = names.index("v") if "v" in names and scenario.threshold > 0 else None
    rows = np.arange(scenario.rows) * scenario.output.step
    out, row, reason = np.empty((scenario.rows, len(x))), 0, None
    events: list[tuple[float, bool]] = []
    count = {"accepted": 0, "rejected": 0, "rates": 0, "jacobians": 0}
    ends = [*(min(s, scenario.end) for s in starts[1:]), scenario.end]
    with np.errstate(all="ignore"):
        for begin, end, *piece in zip([0.0, *ends[:-1]], ends, starts, levels, slopes, strict=True):
            if end <= begin:
                continue
            equations.piece = (piece[0], piece[1], piece[2])
            tolerances: Any = np.array([atol[name] for name in names])  # the stubs know only one number
            solver: Any = Radau(
                equations.rates, begin, x, end, jac=equations.jacobian, rtol=max(scenario.solve.rtol, 1e-13),
                atol=tolerances, max_step=scenario.signal.longest_step,
            )  # fmt: skip
            while solver.status == "running" and reason is None:
                try:
                    message = solver.step()
                except ValueError:  # its linear algebra refuses what is not finite
                    reason = f"after t = {solver.t:.9g} s the equations are no longer finite"
                    break
                if solver.status == "failed":
                    reason = f"at t = {solver.t:.9g} s SciPy's Radau failed: {message}"
                    break
                count["accepted"] += 1
                dense = solver.dense_output()
                stop = int(np.searchsorted(rows, solver.t, side="right"))
                if stop > row:
                    out[row:stop] = dense(rows[row:stop]).T
                    row = stop
                if speed is not None:
                    events += _events(dense, speed, scenario.threshold)
                if not np.isfinite(solver.y).all():
                    reason = f"after t = {solver.t_old:.9g} s the equations are no longer finite"
                elif count["accepted"] >= scenario.solve.max_steps:
                    reason = f"gave up at t = {solver.t:.9g} s after solve.max_steps = {scenario.solve.max_steps} steps"
                if progress is not None:
                    progress(solver.t / scenario.end)
            x = solver.y
            count["rates"] += solver.nfev
            count["jacobians"] += solver.njev
            if reason:
                break
    stats: dict[str, Any] = {**count, "smallest_step": None, "largest_step": None, "solver": "scipy-radau"}
    return Result(out[:row], events, reason, stats)


def _events(dense: Any, speed: int, threshold: float) -> list[tuple[float, bool]]:
    """Where |v| passes the threshold within a step; the cubic is looked at in ten parts."""
    from scipy.optimize import brentq

    times = np.linspace(dense.t_old, dense.t, 11)
    found = []
    for sign in (1.0, -1.0):
        over = sign * dense(times)[speed] - threshold
        for i in np.flatnonzero((over[:-1] >= 0) != (over[1:] >= 0)):
            t = brentq(
                lambda t, s=sign: s * dense(t)[speed] - threshold, times[i], times[i + 1], xtol=1e-14, rtol=1e-14
            )
            found.append((float(t), bool(over[i + 1] >= 0)))
    return sorted(found)
