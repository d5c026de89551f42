"""The promised accuracy of a run, and the tolerances that achieve it.

The error of y and v is at most 100 solve.rtol of their peaks over the motion, that of F 10^4 solve.rtol. The peaks are
unknown before the motion. So the tolerances of a run follow its peaks so far, up to those of a motion of the machine's
natural scales. The solver measures the errors of its steps and of its dense output in F, too. If these are too large, or a
state moves far less than the others, the run is repeated. It then has tolerances for the measured motion, and each row
ends a step.

The errors of all steps add up, and grow where neighboring motions diverge. If bodies break away from each other, they grow
by many orders of magnitude. The solver propagates them by the linearized equations. If they exceed the promise, the run is
repeated with smaller tolerances. If rounding alone grows beyond the promise, a note says so.
docs/explanation/solver.md states the rule.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from typing import Self

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.expressions.ops import Value, clip, larger, smaller
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
_MARGIN = 0.3  # the share of the promise that a pass with finer tolerances aims at
# The errors of all steps fall with this power of the tolerances: single ones in proportion, and there are more
_FALL = 0.8
_TOO_LARGE = 1e3  # times: by so much the errors carried on are too large at most (benchmarks/promise.py)
# Passes with tighter tolerances: the first may measure a wrong peak of F, and the next one then starts from the right one.
MOST_PASSES = 3
_NOISE = 1e-12  # a motion of this share of the machine's largest, each in its natural scale, is rounding
# The error of one step, as a share of the tolerances: the errors of many steps add up, and the solution must still meet the
# tolerances. benchmarks/promise.py counts by how much.
_STEP_SHARE = 0.02
# The same under a sampled controller: each output restarts the motion, with many short steps that are mostly better than
# required. The effect of an encoder's counts does not shrink with the tolerances, so loose ones need a smaller share.
SAMPLED_SHARE = 0.1, 0.5, 0.35  # at solve.rtol = 1e-6 and above; at 1e-8 and below; the power of 1/rtol between
_WELL_DAMPED, _LEAST_DAMPED = 0.05, 1e-4  # damping ratio from which the share is not reduced; its smallest factor
RTOL_SMALLEST = 1e-13  # below, rounding is the larger error: 500 times the spacing of floats


class _OfLanes:
    """A data class whose arrays have a row for each lane."""

    def part(self, lanes: NDArray[np.int64]) -> Self:
        """The same of some lanes."""
        rows = {
            name: x[lanes] if isinstance(x, np.ndarray) else x.part(lanes) if isinstance(x, _OfLanes) else x
            for name, x in vars(self).items()
        }
        return type(self)(**rows)


@dataclass(frozen=True)
class Tolerances(_OfLanes):
    """The tolerances of a run, with a row for each lane.

    Attributes:
        atol: absolute tolerances of the states.
        scale: factor of these and of the relative tolerance.
        force: the largest error of a step in each friction force; None: any.
        rows_are_steps: whether every row of the output ends a step.
    """

    atol: Array
    scale: Array
    force: Array | None = None
    rows_are_steps: bool = False


@dataclass(frozen=True)
class MeasuredMotion(_OfLanes):
    """The numbers that the compiled solver measures (runtime/run.c, MEASURES), a row for each lane.

    Attributes:
        peaks, force: the peaks of the states, and of the friction forces.
        step_in_force: the largest error of a step, in the friction forces.
        dense_in_force: the largest last term of the dense output within a step, in the friction forces.
        terms: the largest sum of the magnitudes of the friction forces' terms.
        carried, carried_in_force: the largest errors by those of all steps before, in states and friction forces.
    """

    peaks: Array
    force: Array
    step_in_force: Array
    dense_in_force: Array
    terms: Array
    carried: Array
    carried_in_force: Array

    @classmethod
    def of(cls, largest: Array, states: int) -> MeasuredMotion:
        """The measured numbers of a system with so many states, by their meaning."""
        forces = (largest.shape[1] - 2 * states) // 5
        counts = [states, forces, forces, forces, forces, states, forces]
        ends = np.cumsum([0, *counts]).tolist()
        return cls(*(largest[:, begin:end] for begin, end in pairwise(ends)))


@dataclass(frozen=True)
class Pass(_OfLanes):
    """A run of all lanes.

    Attributes:
        tolerances: those that it was given.
        measured: the numbers that the solver measured.
        states: the rows of the states, shape (lanes, rows, states).
    """

    tolerances: Tolerances
    measured: MeasuredMotion
    states: Array


def measures(scenario: Scenario) -> int:
    """The count of numbers that the compiled solver measures."""
    return 2 * len(scenario.system.states) + 5 * len(scenario.system.contacts)


def given(scenario: Scenario) -> NDArray[np.bool_]:
    """Whether the absolute tolerance of each state is the file's: it is never changed."""
    return np.array([state.name in scenario.solve.atol for state in scenario.system.states])


@lru_cache(maxsize=64)
def _moving(system: MachineSystem) -> NDArray[np.bool_]:
    """Whether each state is the position or the velocity of a body."""
    names = {joined(body.name, n) for body in system.bodies for n in "yv"}
    return np.array([state.name in names for state in system.states])


@dataclass(frozen=True)
class Missed(_OfLanes):
    """Where a run may miss the promise, with a row for each lane.

    Attributes:
        loose: the states whose tolerance is too loose for their motion.
        wrong: the friction forces in which single steps err too much.
        states: the errors of the states, by those of all steps, as shares of the promise; 0 if nothing is promised.
        forces: the same of the friction forces.
    """

    loose: NDArray[np.bool_]
    wrong: NDArray[np.bool_]
    states: Array
    forces: Array

    @property
    def share(self) -> Array:
        """The largest error of each lane as a share of the promise."""
        return np.asarray(
            np.maximum(np.max(self.states, axis=1, initial=0.0), np.max(self.forces, axis=1, initial=0.0))
        )

    def corrected(self, by: Array) -> Missed:
        """The same with errors by those of the run before: in each lane it was ``by`` of its estimate."""
        return replace(self, states=by[:, None] * self.states, forces=by[:, None] * self.forces)

    @property
    def lanes(self) -> NDArray[np.bool_]:
        """Whether a lane misses anything."""
        return np.asarray(self.loose.any(axis=1) | self.wrong.any(axis=1) | (self.share > 1))


@dataclass(frozen=True)
class Promise:
    """The promised accuracy of a scenario.

    Attributes:
        scenario: the scenario.
        growth: whether errors that grow along the motion count.
    """

    scenario: Scenario
    growth: bool = True

    @cached_property
    def _finest(self) -> float:
        """The least factor of the scenario's tolerances that rounding allows."""
        return min(1.0, RTOL_SMALLEST / (step_share(self.scenario) * self._rtol))

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

    def missed(self, tolerances: Tolerances, measured: MeasuredMotion) -> Missed:
        """Possible violations of the promise in each lane."""
        rtol, peaks, force = self._rtol, measured.peaks, measured.force
        sizes = rtol * peaks / tolerances.atol
        followed = np.max(sizes, axis=1, keepdims=True).clip(_LEAST_SIZE, 1.0)
        loose = self._promised & (sizes < _LEAST_PEAK * followed)
        if loose.any():  # seldom: rest is only looked for then
            loose &= ~self._at_rest(tolerances, measured)
        wrong = measured.step_in_force > _STEP_IN_FORCE * rtol * force
        if not tolerances.rows_are_steps:
            wrong |= measured.dense_in_force > _DENSE_IN_FORCE * rtol * force
        return Missed(loose, wrong, *self._carried(tolerances, measured))

    def _carried(self, tolerances: Tolerances, measured: MeasuredMotion) -> tuple[Array, Array]:
        """The errors of states and friction forces as shares of the promise; 0 where a tolerance of the file decides them."""
        rtol, states, forces = self._rtol, measured.carried, measured.carried_in_force
        kept = (states <= MOTION * rtol * measured.peaks) | ~self._promised
        kept_in_force = (forces <= FORCE * rtol * measured.force) | (measured.force == 0)
        if not self.growth or (kept.all() and kept_in_force.all()) or given(self.scenario).any():
            return np.zeros_like(states), np.zeros_like(forces)
        kept |= self._at_rest(tolerances, measured)
        with np.errstate(divide="ignore", invalid="ignore"):
            states = np.where(kept, 0.0, states / (MOTION * rtol * measured.peaks))
            forces = np.where(kept_in_force, 0.0, forces / (FORCE * rtol * measured.force))
        return np.nan_to_num(states, nan=np.inf), np.nan_to_num(forces, nan=np.inf)

    def rounded(self, measured: MeasuredMotion) -> NDArray[np.bool_]:
        """The friction forces, in each lane, that are so small a difference of large terms that rounding breaks the promise."""
        return measured.terms * np.finfo(float).eps > _ROUNDING * self._rtol * measured.force

    def _scale(self, tolerances: Tolerances, missed: Missed) -> Array:
        """The scale with which the errors of all steps keep the promise; as it is where rounding allows none so small."""
        share, now = missed.share, tolerances.scale
        if not np.any(share > 1):
            return now
        reached = (share > 1) & (share * (self._finest / now) ** _FALL <= _TOO_LARGE)
        with np.errstate(divide="ignore"):
            return np.where(reached, np.maximum((_MARGIN / share) ** (1 / _FALL) * now, self._finest), now)

    def mends(self, tolerances: Tolerances, missed: Missed) -> NDArray[np.bool_]:
        """The lanes that another pass may mend."""
        finer = self._scale(tolerances, missed) < tolerances.scale
        return np.asarray(missed.loose.any(axis=1) | missed.wrong.any(axis=1) | finer)

    def tightened(self, tolerances: Tolerances, measured: MeasuredMotion, missed: Missed) -> Tolerances:
        """The tolerances for the measured motion."""
        kept = given(self.scenario) | self._at_rest(tolerances, measured)
        wanted = np.where(kept, tolerances.atol, 0.1 * self._rtol * measured.peaks)
        force = np.where(measured.force > 0, 0.5 * _STEP_IN_FORCE * self._rtol * measured.force, np.inf)
        return Tolerances(
            np.minimum(tolerances.atol, wanted), self._scale(tolerances, missed), force, rows_are_steps=True
        )

    def after(self, missed: Missed, coarse: Pass, fine: Pass) -> Missed:
        """Possible violations of the promise after a run with finer tolerances, whose rows measure the errors of the run before.

        Args:
            missed: the same before that run.
            coarse: the run before.
            fine: the run with finer tolerances.
        """
        now = self.missed(fine.tolerances, fine.measured)
        off = np.max(abs(fine.states - coarse.states), axis=1, initial=0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            share = off / (MOTION * self._rtol * fine.measured.peaks)
            share = np.max(np.where(self._promised & (fine.measured.peaks > 0), share, 0.0), axis=1, initial=0.0)
            by = share / missed.share
        return now.corrected(np.where(fine.tolerances.scale < coarse.tolerances.scale, by, 1.0))

    def beyond(self, missed: Missed, measured: MeasuredMotion) -> NDArray[np.bool_]:
        """The lanes that do not reach the promise after their last run, rounding included."""
        return missed.lanes | self.rounded(measured).any(axis=1)

    def remark(self, missed: Missed, measured: MeasuredMotion) -> str:
        """The accuracy that one lane does not reach, in words; empty if it reaches all."""
        system = self.scenario.system
        loose = (missed.loose | (missed.states > 1))[0]
        wrong = (missed.wrong | self.rounded(measured) | (missed.forces > 1))[0]
        names = [s.name for s, x in zip(system.states, loose, strict=True) if x]
        forces = [joined(c.name, "F") for c, x in zip(system.contacts, wrong, strict=True) if x]
        words = [f"{', '.join(names)} to {MOTION * self._rtol:g}"] if names else []
        words += [f"{', '.join(forces)} to {FORCE * self._rtol:g}"] if forces else []
        if not words:
            return ""
        why = "small errors grow too much here, and " if missed.share[0] > 1 else ""
        return f"accuracy not reached: {' and '.join(words)} of the peak; {why}rounding allows no smaller steps"


def step_share(scenario: Scenario) -> float:
    """The allowed error of one step, as a share of the scenario's tolerances."""
    return float(larger(_wanted_share(scenario), smaller(1.0, RTOL_SMALLEST / scenario.solve.rtol)))


def doubts(scenario: Scenario) -> list[str]:
    """Notes on tolerances that cannot be reached, because rounding is the larger error."""
    rtol, finest = scenario.solve.rtol, RTOL_SMALLEST / _wanted_share(scenario)
    if rtol < RTOL_SMALLEST / _STEP_SHARE:
        least = RTOL_SMALLEST / _STEP_SHARE
        return [f"solve.rtol: {rtol:g}: rounding is the larger error below {least:g}; solved as with that"]
    if rtol < finest * (1 - 1e-9):
        ratio = f"damping ratio {float(scenario.elements.damping()):.2g}"
        return [
            f"the contact is hardly damped ({ratio}) and rings: the error of v may exceed the promise of solve.rtol = {rtol:g}"
        ]
    return []


def _wanted_share(scenario: Scenario) -> float:
    """The share before the limit of rounding; a poorly damped contact swings many times, and the errors add up."""
    if scenario.system.held:
        return sampled_share(scenario.solve.rtol)
    return float(share_of(scenario.elements.damping()))


def sampled_share(rtol: float) -> float:
    """The allowed error of one step under a sampled controller; exports/templates/machine.c has this line too."""
    low, high, power = SAMPLED_SHARE
    return float(min(max(low * (1e-6 / rtol) ** power, low), high))


def share_of(damping: Value) -> Value:
    """The allowed error of one step by the damping ratio: a number, or an expression."""
    return _STEP_SHARE * clip(smaller(damping / _WELL_DAMPED, 1.0) ** 2, _LEAST_DAMPED, 1.0)


def first(scenario: Scenario) -> Tolerances:
    """The tolerances of a scenario before its motion is known."""
    atol = scenario.atol()
    return Tolerances(np.array([[atol[state.name] for state in scenario.system.states]]), np.ones(1))


def solve_to_promise(scenario: Scenario, once: Callable[[Tolerances, int], tuple[Result, MeasuredMotion]]) -> Result:
    """The result of a scenario, solved again if its motion needs tighter tolerances.

    Args:
        scenario: the scenario.
        once: solves it with given tolerances, in at most a number of attempted steps.
    """
    promise, most, tolerances = Promise(scenario), scenario.solve.max_steps, first(scenario)

    def run(tolerances: Tolerances, most: int) -> tuple[Result, Pass]:
        result, measured = once(tolerances, most)
        return result, Pass(tolerances, measured, result.states[None, :, : measured.peaks.shape[1]])

    result, coarse = run(tolerances, most)
    if result.reason is not None:
        return result
    missed = promise.missed(tolerances, coarse.measured)
    if not missed.lanes[0]:
        return result
    for _ in range(MOST_PASSES):
        if not promise.mends(coarse.tolerances, missed)[0]:
            break
        wanted = promise.tightened(coarse.tolerances, coarse.measured, missed)
        # tolerances 1e-3 times as large need 1e3^(1/5) = 4 times the steps, and each row ends one; where rounding is larger
        # than a tolerance, steps never get longer, and the pass ends here
        finer, fine = run(wanted, min(most, 100 * (result.stats["accepted"] + scenario.rows) + 10_000))
        if finer.reason is not None:
            break
        missed = promise.after(missed, coarse, fine)
        result, coarse = finer, fine
    if remark := promise.remark(missed, coarse.measured):
        result.remarks.append(remark)
    return result
