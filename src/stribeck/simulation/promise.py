"""The promised accuracy of a run, and the tolerances that achieve it.

The error of y and v is at most 100 solve.rtol of their peaks over the motion, that of F 10^4 solve.rtol. The peaks are
unknown before the motion, so the tolerances of a run follow its peaks so far, up to those of a motion of the machine's natural
scales. The solver measures the errors of its steps and of its dense output in F, too. If these are too large, or a state moves
far less than the others, the run is repeated with tolerances for the measured motion, and each row ends a step.
docs/explanation/solver.md states the rule.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.machine.system import MachineSystem
from stribeck.machine.table import joined
from stribeck.scenario import Scenario
from stribeck.simulation.result import Result

MOTION, FORCE = 1e2, 1e4  # times solve.rtol, of the peaks: the promised accuracy of y and v, and of F
# The tolerance of a state follows its peak so far, but it is at least this share of the largest state's, both in their natural
# scales (runtime/method.c, follow): below, it is too loose. A motion smaller than the second number is not followed.
_LEAST_PEAK, _LEAST_SIZE = 1e-3, 1e-9
# Shares of the promised accuracy. In F, the error of a step counts a hundred times, for the steps in which a stiff deflection
# keeps it, and the last term of the dense output ten times, for the terms that follow it (benchmarks/promise.py).
_STEP_IN_FORCE, _DENSE_IN_FORCE = 1e2, 1e3  # times solve.rtol
_ROUNDING = 1e3  # times solve.rtol: a tenth of the promised accuracy of F, as rounding of some steps adds up
# Passes with tighter tolerances: the first may measure a wrong peak of F, and the next one then starts from the right one.
MOST_PASSES = 3
_NOISE = 1e-12  # a motion of this share of the machine's largest, each in its natural scale, is rounding


@dataclass(frozen=True)
class Tolerances:
    """The tolerances of a run, with a row for each lane.

    Attributes:
        atol: absolute tolerances of the states.
        force: the largest error of a step in each friction force; None: any.
        rows_are_steps: whether every row of the output ends a step.
    """

    atol: Array
    force: Array | None = None
    rows_are_steps: bool = False


@dataclass(frozen=True)
class MeasuredMotion:
    """The numbers that the compiled solver measures (runtime/run.c, MEASURES), a row for each lane."""

    largest: Array
    states: int

    def _of_forces(self, i: int) -> Array:
        behind = self.largest[:, self.states :]
        forces = behind.shape[1] // 4
        return behind[:, i * forces : (i + 1) * forces]

    @property
    def peaks(self) -> Array:
        """The peaks of the states."""
        return self.largest[:, : self.states]

    @property
    def force(self) -> Array:
        """The peaks of the friction forces."""
        return self._of_forces(0)

    @property
    def step_in_force(self) -> Array:
        """The largest error of a step, in the friction forces."""
        return self._of_forces(1)

    @property
    def dense_in_force(self) -> Array:
        """The largest last term of the dense output within a step, in the friction forces."""
        return self._of_forces(2)

    @property
    def terms(self) -> Array:
        """The largest sum of the magnitudes of the friction forces' terms."""
        return self._of_forces(3)


def measures(scenario: Scenario) -> int:
    """The count of numbers that the compiled solver measures."""
    return len(scenario.system.states) + 4 * len(scenario.system.contacts)


def given(scenario: Scenario) -> NDArray[np.bool_]:
    """Whether the absolute tolerance of each state is the file's: it is never changed."""
    return np.array([state.name in scenario.solve.atol for state in scenario.system.states])


@lru_cache(maxsize=64)
def _moving(system: MachineSystem) -> NDArray[np.bool_]:
    """Whether each state is the position or the velocity of a body."""
    names = {joined(body.name, n) for body in system.bodies for n in "yv"}
    return np.array([state.name in names for state in system.states])


@dataclass(frozen=True)
class Promise:
    """The promised accuracy of a scenario."""

    scenario: Scenario

    @property
    def _rtol(self) -> float:
        return self.scenario.solve.rtol

    @cached_property
    def _promised(self) -> NDArray[np.bool_]:
        """The states with a promised accuracy: positions and velocities whose tolerance is not in the file."""
        moving = _moving(self.scenario.system)
        return moving & ~given(self.scenario) if self.scenario.solve.atol else moving

    def _at_rest(self, tolerances: Tolerances, measured: MeasuredMotion) -> NDArray[np.bool_]:
        """The states that move by no more than rounding."""
        with np.errstate(over="ignore"):
            moved: Array = measured.peaks / tolerances.atol
        return np.asarray(moved <= _NOISE * np.max(moved, axis=1, keepdims=True))

    def broken(self, tolerances: Tolerances, measured: MeasuredMotion) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """The states, and the friction forces, whose error may exceed the promise, in each lane."""
        rtol, peaks, force = self._rtol, measured.peaks, measured.force
        sizes = rtol * peaks / tolerances.atol
        followed = np.max(sizes, axis=1, keepdims=True).clip(_LEAST_SIZE, 1.0)
        loose = self._promised & (sizes < _LEAST_PEAK * followed)
        if loose.any():  # seldom: rest is only looked for then
            loose &= ~self._at_rest(tolerances, measured)
        wrong = measured.step_in_force > _STEP_IN_FORCE * rtol * force
        if not tolerances.rows_are_steps:
            wrong |= measured.dense_in_force > _DENSE_IN_FORCE * rtol * force
        return loose, wrong

    def rounded(self, measured: MeasuredMotion) -> NDArray[np.bool_]:
        """The friction forces, in each lane, that are so small a difference of large terms that rounding breaks the promise."""
        return measured.terms * np.finfo(float).eps > _ROUNDING * self._rtol * measured.force

    def tightened(self, tolerances: Tolerances, measured: MeasuredMotion) -> Tolerances:
        """The tolerances for the measured motion."""
        kept = given(self.scenario) | self._at_rest(tolerances, measured)
        wanted = np.where(kept, tolerances.atol, 0.1 * self._rtol * measured.peaks)
        force = np.where(measured.force > 0, 0.5 * _STEP_IN_FORCE * self._rtol * measured.force, np.inf)
        return Tolerances(np.minimum(tolerances.atol, wanted), force, rows_are_steps=True)

    def part(self, tolerances: Tolerances, lanes: NDArray[np.int64]) -> Tolerances:
        """The tolerances of some lanes."""
        return replace(
            tolerances, atol=tolerances.atol[lanes], force=None if tolerances.force is None else tolerances.force[lanes]
        )

    def remark(self, loose: NDArray[np.bool_], wrong: NDArray[np.bool_]) -> str:
        """The accuracy that one lane does not reach, in words."""
        system = self.scenario.system
        names = [s.name for s, x in zip(system.states, loose, strict=True) if x]
        forces = [joined(c.name, "F") for c, x in zip(system.contacts, wrong, strict=True) if x]
        missed = [f"{', '.join(names)} to {MOTION * self._rtol:g}"] if names else []
        missed += [f"{', '.join(forces)} to {FORCE * self._rtol:g}"] if forces else []
        return f"accuracy not reached: {' and '.join(missed)} of the peak; rounding allows no smaller steps"


def first(scenario: Scenario) -> Tolerances:
    """The tolerances of a scenario before its motion is known."""
    atol = scenario.atol()
    return Tolerances(np.array([[atol[state.name] for state in scenario.system.states]]))


def _most_attempts(accepted: int, rows: int) -> int:
    """The most attempted steps of a pass with tighter tolerances.

    Tolerances 1e-3 times as large need 1e3^(1/5) = 4 times the steps, and each row ends a step; a margin is added. If
    rounding is larger than the tolerance, steps never get longer, and the pass ends here.
    """
    return 100 * (accepted + rows) + 10_000


def solve_to_promise(scenario: Scenario, once: Callable[[Tolerances, int], tuple[Result, MeasuredMotion]]) -> Result:
    """The result of a scenario, solved again if its motion needs tighter tolerances.

    Args:
        scenario: the scenario.
        once: solves it with given tolerances, in at most a number of attempted steps.
    """
    promise, most, tolerances = Promise(scenario), scenario.solve.max_steps, first(scenario)
    result, measured = once(tolerances, most)
    loose, wrong = promise.broken(tolerances, measured)
    if result.reason is not None or not (loose.any() or wrong.any()):
        return result
    for _ in range(MOST_PASSES):
        wanted = promise.tightened(tolerances, measured)
        finer, again = once(wanted, min(most, _most_attempts(result.stats["accepted"], scenario.rows)))
        if finer.reason is not None:
            break
        result, measured, tolerances = finer, again, wanted
        loose, wrong = promise.broken(tolerances, measured)
        if not (loose.any() or wrong.any()):
            break
    wrong |= promise.rounded(measured)
    if loose.any() or wrong.any():
        result.remarks.append(promise.remark(loose[0], wrong[0]))
    return result
