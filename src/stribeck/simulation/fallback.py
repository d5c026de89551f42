"""The same equations solved by SciPy's Radau, where there is no C compiler: as right, and some hundred times slower."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.control.sampled import Log
from stribeck.errors import needed
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import derivative, symbol
from stribeck.scenario import Scenario
from stribeck.simulation.result import Result, ended, legs, piecewise

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
        self._place = {key: i for i, key in enumerate(system.parameters)}
        self._values = [np.float64(values[key]) for key in system.parameters]
        self.piece: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def change(self, values: dict[tuple[str, str], float]) -> None:
        """Take other values for some constants."""
        for key, value in values.items():
            self._values[self._place[key]] = np.float64(value)

    def rates(self, t: float, x: Array) -> Array:
        return np.array(self._rates(*self._values, *self.piece, t, *x), float)

    def jacobian(self, t: float, x: Array) -> Array:
        return np.array(self._jacobian(*self._values, *self.piece, t, *x), float).reshape(len(x), len(x))


def solve(scenario: Scenario, progress: Callable[[float], None] | None = None) -> Result:
    """Integrate the scenario with SciPy's Radau; ``progress`` is told the share of time done."""
    run, log, reached = _Run(scenario, progress), Log(), 0.0
    starts, levels, slopes = piecewise(scenario.signal)
    ends = [*starts[1:], scenario.end]
    stretches = legs(scenario, log)
    leg = next(stretches, None)
    with np.errstate(all="ignore"):
        while leg is not None and run.reason is None:
            until, changes = leg
            run.equations.change(changes)
            for start, last, *piece in zip(starts, ends, levels, slopes, strict=True):
                if (end := min(last, until)) > (begin := max(start, reached)) and run.reason is None:
                    run.equations.piece = (start, piece[0], piece[1])
                    run.advance(begin, end)
            reached = until
            try:
                leg = stretches.send(run.x)
            except StopIteration:
                leg = None
    stats: dict[str, Any] = {**run.count, "smallest_step": None, "largest_step": None, "solver": "scipy-radau"}
    return Result(run.out[: run.row], run.events, run.reason, stats, log if log.t else None)


class _Run:
    """A run as far as it has come: the state, the rows filled, the events met."""

    def __init__(self, scenario: Scenario, progress: Callable[[float], None] | None) -> None:
        self.scenario, self.progress, self.equations = scenario, progress, _Equations(scenario)
        names = [state.name for state in scenario.system.states]
        atol = scenario.atol()
        self.atol: Any = np.array([atol[name] for name in names])  # the stubs know only one number
        self.x = np.array([scenario.initial.get(name, 0.0) for name in names])
        self.speed = names.index("v") if "v" in names and scenario.threshold > 0 else None
        self.rows = np.arange(scenario.rows) * scenario.output.step
        self.out, self.row = np.empty((scenario.rows, len(names))), 0
        self.reason: str | None = None
        self.events: list[tuple[float, bool]] = []
        self.count = {"accepted": 0, "rejected": 0, "rates": 0, "jacobians": 0}

    def advance(self, begin: float, end: float) -> None:
        """Integrate from ``begin`` to ``end``, within one piece of the signal."""
        with needed("solving without a C compiler"):
            from scipy.integrate import Radau

        scenario, equations, rows = self.scenario, self.equations, self.rows
        solver: Any = Radau(
            equations.rates, begin, self.x, end, jac=equations.jacobian, rtol=max(scenario.solve.rtol, 1e-13),
            atol=self.atol, max_step=scenario.signal.longest_step,
        )  # fmt: skip
        while solver.status == "running" and self.reason is None:
            try:
                message = solver.step()
            except ValueError:  # its linear algebra refuses what is not finite
                self.reason = f"after t = {solver.t:.9g} s the equations are no longer finite"
                break
            if solver.status == "failed":
                self.reason = f"at t = {solver.t:.9g} s SciPy's Radau failed: {message}"
                break
            self.count["accepted"] += 1
            dense = solver.dense_output()
            stop = int(np.searchsorted(rows, solver.t, side="right"))
            if stop > self.row:
                self.out[self.row : stop] = dense(rows[self.row : stop]).T
                self.row = stop
            if self.speed is not None:
                self.events += _events(dense, self.speed, scenario.threshold)
            if not np.isfinite(solver.y).all():
                self.reason = f"after t = {solver.t_old:.9g} s the equations are no longer finite"
            elif self.count["accepted"] >= scenario.solve.max_steps:
                self.reason = (
                    f"gave up at t = {solver.t:.9g} s after solve.max_steps = {scenario.solve.max_steps} steps"
                )
            if self.progress is not None:
                self.progress(solver.t / scenario.end)
        self.reason = (ended(scenario, solver.t, solver.y) if self.reason else None) or self.reason
        self.x = solver.y
        self.count["rates"] += solver.nfev
        self.count["jacobians"] += solver.njev


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
