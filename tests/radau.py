"""The same equations solved by SciPy's Radau, with event search and sampling of its own: a reference for tests."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np

from stribeck.arrays import Array
from stribeck.expressions.emit import python_function
from stribeck.scenario import Scenario
from stribeck.simulation.rates import RateFunctions
from stribeck.simulation.result import Result, Stats, ended, held_back
from stribeck.waveforms.pieces import JUMP, SMOOTH

_SAME_TIME = 1e-12  # as in runtime/run.c


class _Controllers:
    """The sampled controllers: when they sample, what they remember, and which outputs wait."""

    def __init__(self, scenario: Scenario, equations: RateFunctions) -> None:
        system, self.equations = scenario.system, equations
        samples, self.timing = system.samples(), scenario.elements.sampling()
        self.noise = held_back(scenario.end, [self.timing])[1]
        inputs = [f"{owner}.{name}" for owner, name in system.parameters]
        inputs += [f"segment.{name}" for name in (*system.piece_fields, *system.held)] + [
            "t",
            *equations.states,
            "noise",
        ]
        self._functions = [
            python_function([*inputs, *(f"memory.{n}" for n in each.memory)], [each.output, *each.memory.values()])
            for each in samples
        ]
        self.memory, self._shown = [[0.0] * len(each.memory) for each in samples], len(system.shown)
        self.waiting: list[list[float]] = [[] for _ in samples]
        self.sampled, self.acted = [0] * len(samples), [0] * len(samples)

    @property
    def shown(self) -> list[float]:
        """What of the memory the output has."""
        return [x for each in self.memory for x in each][: self._shown]

    def next_stop(self) -> float:
        """The next time at which one samples or acts."""
        times = [inf]
        for i, timing in enumerate(self.timing):
            times += [
                self.sampled[i] * timing["period"],
                self.acted[i] * timing["period"] + timing["delay"],
            ]
        return min(times)

    def pass_(self, t: float, x: Array) -> None:
        """Sample and act where it is due at t."""
        now = t * (1 + _SAME_TIME)
        for i, timing in enumerate(self.timing):
            while self.sampled[i] * timing["period"] <= now:
                k = self.sampled[i]
                noise = self.noise[i][k] if k < self.noise.shape[1] else 0.0
                at = self.equations.arguments(k * timing["period"], x)
                u, *self.memory[i] = (float(v) for v in self._functions[i](*at, noise, *self.memory[i]))
                self.waiting[i].append(u)
                self.sampled[i] += 1
            while self.waiting[i] and self.acted[i] * timing["period"] + timing["delay"] <= now:
                self.equations.held[i] = self.waiting[i].pop(0)
                self.acted[i] += 1


def solve(scenario: Scenario, progress: Callable[[float], None] | None = None) -> Result:
    """Integrate the scenario with SciPy's Radau; ``progress`` is told the share of time done."""
    run, end = _Run(scenario, progress), scenario.end
    with np.errstate(all="ignore"):
        run.begin()
        while run.t < end and run.reason is None:
            run.advance(run.t, min(run.next_stop(), end))
    run.stats.update({"smallest_step": None, "largest_step": None, "solver": "scipy-radau"})
    return Result(run.out[: run.row], run.events, run.reason, run.stats)


class _Run:
    """A run as far as it has come: the state, the rows filled, the events met."""

    def __init__(self, scenario: Scenario, progress: Callable[[float], None] | None) -> None:
        self.scenario, self.progress, self.equations = scenario, progress, RateFunctions(scenario)
        self.controllers = _Controllers(scenario, self.equations)
        names = self.equations.states
        atol = scenario.atol()
        self.atol: Any = np.array([atol[name] for name in names])  # the stubs know only one number
        self.x = np.array([scenario.initial.get(name, 0.0) for name in names])
        self.thresholds = np.array(scenario.elements.thresholds())
        self.moved = names.index("E_in") if scenario.system.moved_energy() is not None else None
        self.rows = np.arange(scenario.rows) * scenario.output.step
        more = len(self.equations.held) + len(scenario.system.shown)
        self.out, self.row = np.empty((scenario.rows, len(names) + more)), 0
        self.pieces, self.piece, self.t = scenario.pieces(), 0, 0.0
        self.reason: str | None = None
        self.events: list[tuple[float, int]] = []
        self.stats: Stats = {"accepted": 0, "rejected": 0, "rates": 0, "jacobians": 0}

    def begin(self) -> None:
        """The first row."""
        self.equations.piece = self.pieces.rows[0]
        self._pass(first=True)
        self._put_rows(0.0)

    def next_stop(self) -> float:
        """Until when nothing jumps."""
        more = self.piece + 1 < len(self.pieces.start)
        return min(float(self.pieces.start[self.piece + 1]) if more else inf, self.controllers.next_stop())

    def _put_rows(self, until: float) -> None:
        while self.row < len(self.rows) and self.rows[self.row] <= until:
            self.out[self.row] = [*self.x, *self.equations.held, *self.controllers.shown]
            self.row += 1

    def _pass(self, first: bool = False) -> None:
        """Go on to the pieces that have begun, and to the outputs of controllers; note what jumps there."""
        e = self.equations
        before, energy, why = e.watch(self.t, self.x), e.moved(self.t, self.x), SMOOTH
        now, held = self.t * (1 + _SAME_TIME), e.held.copy()
        while self.piece + 1 < len(self.pieces.start) and self.pieces.start[self.piece + 1] <= now:
            self.piece += 1
            why = JUMP if self.pieces.restart[self.piece] == JUMP else why
        e.piece = self.pieces.rows[self.piece]
        self.controllers.pass_(self.t, self.x)
        if first:
            return
        if self.moved is not None:
            self.x[self.moved] += e.moved(self.t, self.x) - energy
        if why == JUMP or (held != e.held).any():
            after = e.watch(self.t, self.x)
            for j, threshold in enumerate(self.thresholds):
                for side, sign in ((0, 1.0), (2, -1.0)):
                    if threshold > 0 and (sign * before[j] >= threshold) != (over := sign * after[j] >= threshold):
                        self.events.append((self.t, 4 * j + side + (not over)))

    def advance(self, begin: float, end: float) -> None:
        """Integrate from ``begin`` to ``end``, within one piece of the signals."""
        from scipy.integrate import Radau

        scenario, equations, rows = self.scenario, self.equations, self.rows
        solver: Any = Radau(
            equations.rates, begin, self.x, end, jac=equations.jacobian, rtol=max(scenario.solve.rtol, 1e-13),
            atol=self.atol, max_step=scenario.elements.longest_step,
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
            self.stats["accepted"] += 1
            dense = solver.dense_output()
            last = end * (1 - _SAME_TIME) if solver.t >= end else inf
            stop = min(
                int(np.searchsorted(rows, solver.t, side="right")), int(np.searchsorted(rows, last, side="left"))
            )
            if stop > self.row:
                self.out[self.row : stop, : len(self.x)] = dense(rows[self.row : stop]).T
                self.out[self.row : stop, len(self.x) :] = [*equations.held, *self.controllers.shown]
                self.row = stop
            self.events += self._events(dense)
            if not np.isfinite(solver.y).all():
                self.reason = f"after t = {solver.t_old:.9g} s the equations are no longer finite"
            elif self.stats["accepted"] >= scenario.solve.max_steps:
                self.reason = (
                    f"gave up at t = {solver.t:.9g} s after solve.max_steps = {scenario.solve.max_steps} steps"
                )
            if self.progress is not None:
                self.progress(solver.t / scenario.end)
        self.reason = (ended(scenario, solver.t, solver.y) if self.reason else None) or self.reason
        self.x, self.t = solver.y, solver.t
        self.stats["rates"] += solver.nfev
        self.stats["jacobians"] += solver.njev
        if self.reason is None:
            self._pass()
            self._put_rows(self.t * (1 + _SAME_TIME))

    def _events(self, dense: Any) -> list[tuple[float, int]]:
        """Where a watched quantity passes its threshold within a step; the cubic is looked at in ten parts."""
        from scipy.optimize import brentq

        if not (self.thresholds > 0).any():
            return []
        times = np.linspace(dense.t_old, dense.t, 11)
        values = np.array([self.equations.watch(t, x) for t, x in zip(times, dense(times).T, strict=True)])
        found = []
        for j, threshold in enumerate(self.thresholds):
            for side, sign in ((0, 1.0), (2, -1.0)) if threshold > 0 else ():
                over = sign * values[:, j] - threshold

                def passed(t: float, j: int = j, sign: float = sign, threshold: float = threshold) -> float:
                    return float(sign * self.equations.watch(t, dense(t))[j] - threshold)

                for i in np.flatnonzero((over[:-1] >= 0) != (over[1:] >= 0)):
                    t = brentq(passed, times[i], times[i + 1], xtol=1e-14, rtol=1e-14)
                    found.append((float(t), 4 * j + side + int(over[i + 1] < 0)))
        return sorted(found)
