"""What a run promises, and the tolerances that keep it.

y and v are right to 100 solve.rtol of their peaks over the motion, F to 10^4 solve.rtol. Nobody knows the peaks before the
motion is known. So a run begins with tolerances for a motion of the machine's natural scales, and the solver measures: the
peaks, and what the errors of its steps and of its dense output amount to in F. Where that is too much it runs once more,
with the tolerances that the measured motion asks for, each row at the end of a step. docs/explanation/solver.md states the rule.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.machine.table import joined
from stribeck.scenario import Scenario
from stribeck.simulation.result import Result

MOTION, FORCE = 1e2, 1e4  # times solve.rtol, of the peaks: what is promised of y and v, and of F
# As shares of what is promised. A step's error is a tenth of an absolute tolerance at most, and a hundred steps' errors may
# add up: so a peak of 1e-3 of the scale that a tolerance is made for leaves a margin of 10. The error of a step is counted
# in F a hundred times for the steps on which a stiff deflection keeps it, the last term of the dense output ten times for
# the terms that follow it (benchmarks/promise.py).
_LEAST_PEAK = 1e-3
_STEP_IN_FORCE, _DENSE_IN_FORCE = 1e2, 1e3  # times solve.rtol
_DENSE = 0.4 * MOTION  # of the last term: those that follow may amount to more than it
_ROUNDING = 1e3  # times solve.rtol: a tenth of what is promised of F, as rounding of some steps adds up
# Passes with tighter tolerances: the first may measure a wrong peak of F, the next one then starts from the right one.
MOST_PASSES = 3
_NOISE = 1e-12  # a motion of this share of the machine's largest, each in its natural scale, is rounding


@dataclass(frozen=True)
class Tolerances:
    """What the solver is given, a row for each lane: absolute tolerances of the states, the largest error of a step in
    each friction force (None: any), and whether every row of the output ends a step."""

    atol: Array
    force: Array | None = None
    rows_are_steps: bool = False


@dataclass(frozen=True)
class MeasuredMotion:
    """The numbers that the compiled solver measures (runtime/run.c, MEASURES), a row for each lane."""

    largest: Array
    states: int

    @cached_property
    def _parts(self) -> list[Array]:
        forces = (self.largest.shape[1] - 2 * self.states) // 4
        return np.split(self.largest, [self.states, *(2 * self.states + forces * np.arange(4))], axis=1)

    @property
    def peaks(self) -> Array:
        """Of the states."""
        return self._parts[0]

    @property
    def dense(self) -> Array:
        """The largest last term of the dense output within a step, in the states."""
        return self._parts[1]

    @property
    def force(self) -> Array:
        """The peaks of the friction forces."""
        return self._parts[2]

    @property
    def step_in_force(self) -> Array:
        """The largest error of a step, in the friction forces."""
        return self._parts[3]

    @property
    def dense_in_force(self) -> Array:
        """The largest last term of the dense output within a step, in the friction forces."""
        return self._parts[4]

    @property
    def terms(self) -> Array:
        """The largest sum of the magnitudes of what the friction forces are sums of."""
        return self._parts[5]


def measures(scenario: Scenario) -> int:
    """How many numbers the compiled solver measures."""
    return 2 * len(scenario.system.states) + 4 * len(scenario.system.contacts)


@dataclass(frozen=True)
class Promise:
    """What is promised of a scenario."""

    scenario: Scenario

    @property
    def _rtol(self) -> float:
        return self.scenario.solve.rtol

    @cached_property
    def _promised(self) -> NDArray[np.bool_]:
        """Which states are promised: positions and velocities whose tolerance the file does not give."""
        bodies = self.scenario.system.bodies
        names = {joined(body.name, n) for body in bodies for n in "yv"} - self.scenario.solve.atol.keys()
        return np.array([state.name in names for state in self.scenario.system.states])

    def _still(self, now: Tolerances, found: MeasuredMotion) -> NDArray[np.bool_]:
        """The states that do not move, but for rounding."""
        with np.errstate(over="ignore"):
            moved: Array = found.peaks / now.atol
        return np.asarray(moved <= _NOISE * np.max(moved, axis=1, keepdims=True))

    def broken(self, now: Tolerances, found: MeasuredMotion) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """In each lane: the states, and the friction forces, that may be off by more than is promised."""
        loose = self._promised & ~self._still(now, found) & (0.1 * self._rtol * found.peaks < _LEAST_PEAK * now.atol)
        wrong = found.step_in_force > _STEP_IN_FORCE * self._rtol * found.force
        if not now.rows_are_steps:
            loose |= self._promised & (found.dense > _DENSE * self._rtol * found.peaks)
            wrong |= found.dense_in_force > _DENSE_IN_FORCE * self._rtol * found.force
        return loose, wrong

    def rounded(self, found: MeasuredMotion) -> NDArray[np.bool_]:
        """In each lane: the friction forces that are so small a difference of large terms that rounding breaks the promise."""
        return found.terms * np.finfo(float).eps > _ROUNDING * self._rtol * found.force

    def tightened(self, now: Tolerances, found: MeasuredMotion) -> Tolerances:
        """The tolerances that the measured motion asks for."""
        given = np.array([state.name in self.scenario.solve.atol for state in self.scenario.system.states])
        wanted = np.where(given | self._still(now, found), now.atol, 0.1 * self._rtol * found.peaks)
        force = np.where(found.force > 0, 0.5 * _STEP_IN_FORCE * self._rtol * found.force, np.inf)
        return Tolerances(np.minimum(now.atol, wanted), force, rows_are_steps=True)

    def part(self, now: Tolerances, lanes: NDArray[np.int64]) -> Tolerances:
        """The tolerances of some lanes."""
        return replace(now, atol=now.atol[lanes], force=None if now.force is None else now.force[lanes])

    def remark(self, loose: NDArray[np.bool_], wrong: NDArray[np.bool_]) -> str:
        """What of one lane is not reached, in words."""
        system = self.scenario.system
        names = [s.name for s, x in zip(system.states, loose, strict=True) if x]
        forces = [joined(c.name, "F") for c, x in zip(system.contacts, wrong, strict=True) if x]
        told = [f"{', '.join(names)} to {MOTION * self._rtol:g}"] if names else []
        told += [f"{', '.join(forces)} to {FORCE * self._rtol:g}"] if forces else []
        return f"accuracy not reached: {' and '.join(told)} of the peak; rounding allows no smaller steps"


def first(scenario: Scenario) -> Tolerances:
    """The tolerances that a scenario asks for, before its motion is known."""
    atol = scenario.atol()
    return Tolerances(np.array([[atol[state.name] for state in scenario.system.states]]))


def _most_attempts(accepted: int, rows: int) -> int:
    """The attempts at steps that a pass with tighter tolerances may take: what tolerances 1e-3 times as large cost
    (1e3^(1/5) = 4), and each row a step, with room. Where rounding is larger than the tolerance, steps never get longer."""
    return 100 * (accepted + rows) + 10_000


def kept(scenario: Scenario, once: Callable[[Tolerances, int], tuple[Result, MeasuredMotion]]) -> Result:
    """The result of a scenario, solved once, and again where its motion needs other tolerances.

    Args:
        scenario: what is solved.
        once: solves it with these tolerances, in so many attempts at steps at most.
    """
    promise, most, now = Promise(scenario), scenario.solve.max_steps, first(scenario)
    result, measured = once(now, most)
    loose, wrong = promise.broken(now, measured)
    if result.reason is not None or not (loose.any() or wrong.any()):
        return result
    for _ in range(MOST_PASSES):
        wanted = promise.tightened(now, measured)
        found, again = once(wanted, min(most, _most_attempts(result.stats["accepted"], scenario.rows)))
        if found.reason is not None:
            break
        result, measured, now = found, again, wanted
        loose, wrong = promise.broken(now, measured)
        if not (loose.any() or wrong.any()):
            break
    wrong |= promise.rounded(measured)
    if loose.any() or wrong.any():
        result.remarks.append(promise.remark(loose[0], wrong[0]))
    return result
