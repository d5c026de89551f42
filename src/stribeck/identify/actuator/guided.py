"""Searches whole recordings from many starts, guided along the measured motion and then freed.

One slip more or less changes all later samples, so the cost of a whole recording has many local minima. Under a stiff guide,
the distance from the measured motion is the error of the forces, filtered, and its cost has few minima. No derivative of a
noisy position is needed: the speed in the friction is the simulated one.

Far from the optimum, recordings are as coarse as the outputs' noise and the residual allow. The solver takes steps at every
sample of a noisy input. Most of this noise moves no output by more than the output's own noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.interpolate import LSQUnivariateSpline
from scipy.special import ndtri

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.drawn import above_noise
from stribeck.identify.actuator.guides import Guides
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.identify.actuator.residuals import floor_of, leftovers, noise_of, weigh
from stribeck.identify.actuator.solve import (
    ROUGH_STEPS,
    ROUGHLY,
    Found,
    agreeing,
    fine_slopes,
    half_squares,
    moved_over,
    search,
    spread,
)
from stribeck.identify.actuator.starts import prepared
from stribeck.identify.data.quality import EVEN
from stribeck.identify.work import Stopped, Work
from stribeck.scenario import Scenario

FOLLOWED = 0.1  # of a column's changes: with a larger residual, the simulation does not follow the recording
_VISIBLE = 10.0  # times the noise: errors of first values, a third of the friction; 3 % of it then equal the noise
_LOOSE = 1e-6  # rtol far from the optimum
_STEP = 1e-3  # of a coordinate: step of the differences far from the optimum
_ENOUGH = 6  # recordings that tell minima apart
_UNSEEN = 0.3  # of a column's noise: a change by coarser inputs that adds 5 % to it
_FEWEST = 500  # samples of a coarse recording
_CHANCE = 0.05  # that two estimates of the same numbers seem apart in any of them
_DEARER = 10  # times the solver's steps at the first values: what a start may take


# -- fewer samples ---------------------------------------------------------------------------------------------------------


def coarser(recording: Recording, factor: int) -> Recording | None:
    """A recording with one of ``factor`` samples; None if its samples are uneven or too few would be left."""
    t, gaps = recording.t, np.diff(recording.t)
    if len(t) < _FEWEST * factor or np.ptp(gaps) > EVEN * gaps[0]:
        return None
    every = t[::factor]
    outputs = {name: _fewer(c, every) for name, c in recording.outputs.items()}
    inputs = {path: _smoother(c, every) for path, c in recording.inputs.items()}
    return replace(recording, t=every, outputs=outputs, inputs=inputs, as_well={})


def _fewer(channel: Channel, t: Array) -> Channel:
    """An output at the samples nearest to these times."""
    if len(channel.t) <= len(t):
        return channel
    rows = np.unique(np.clip(np.searchsorted(channel.t, t - 0.5 * np.diff(channel.t).min()), 0, len(channel.t) - 1))
    return channel.rows(rows)


def _smoother(channel: Channel, t: Array) -> Channel:
    """An input as the nearest signal of its kind with these samples: cubic, straight or held in between."""
    inside = channel.bridged.t <= t[-1]
    if len(inside) <= 2 * len(t):
        return channel
    times, x = channel.bridged.t[inside], channel.bridged.x[inside]
    if channel.held:
        first = np.searchsorted(times, t - 0.5 * (times[1] - times[0]))
        return replace(channel, t=t, x=np.add.reduceat(x, first) / np.diff([*first, len(times)]))
    return replace(channel, t=t, x=LSQUnivariateSpline(times, x, t[1:-1], k=3 if channel.smooth else 1)(t))


# -- the search ------------------------------------------------------------------------------------------------------------


UnderGuide = dict[str, tuple[float, float]]  # by name: a coordinate under a guide, and its deviation


@dataclass(frozen=True)
class Reached:
    """The end of a search: its values by name, its cost, and whether it was stopped.

    ``under``: by the bandwidths of guides, the values there. The stiffest one is that under which starts were compared.
    """

    values: dict[str, float]
    under: dict[float, dict[str, float]]
    cost: float = np.inf
    stopped: bool = False

    def at(self, bandwidth: float) -> dict[str, float]:
        """The values to begin with under the guide of a bandwidth: those under the next stiffer one."""
        stiffer = [x for x in self.under if x > 0.99 * bandwidth]  # guides along fewer recordings differ a little
        return self.under[min(stiffer, default=max(self.under))] if self.under else self.values


@dataclass
class GuidedSearch:
    """Starts are compared under the stiffest guide that lets errors of the friction stand out of the noise.

    A stiff guide leaves the fewest minima. From the best start, the guide is loosened step by step. The next starts
    follow until an end leaves no more than noise, or two come to the same end. A start whose simulation takes many times
    the steps of the first one is no candidate. A few recordings tell minima apart: the optimum over all of them is left to
    the searches that follow.
    """

    scenario: Scenario
    recordings: Sequence[tuple[int, Recording]]
    sought: Sequence[MachineCoordinate]
    noise: dict[str, float]
    work: Work
    factor: int = 1  # one of so many samples is compared
    _problems: dict[int, MachineProblem] = field(default_factory=dict)

    def __post_init__(self) -> None:
        rtol = max(self.scenario.solve.rtol, _LOOSE)
        self.scenario = self.scenario.with_changes({"solve.rtol": rtol})
        self.recordings = [(i, replace(r, as_well={})) for i, r in _of_each_load(self.recordings)]
        self.guides = Guides(self.scenario, self.recordings)
        runs, self._starts = prepared(self.scenario, self.recordings, self.sought)
        self._begins = {run.log: run.start for run in runs}

    def reached(self, starts: int, seed: int, first: dict[str, float]) -> Reached:
        """The end of the best start: ``first``, where given, or another; Ctrl-C returns the best so far."""
        end = Reached(first, {})
        try:
            self._level, self._compared = self._best_starts(starts, seed, first)
            end = Reached(self._problem(self._level).values(self._compared.u), {})
            end = self._freed(self._level, self._compared.u)
        except (KeyboardInterrupt, Stopped):
            self.work.stop()
        return replace(end, stopped=self.work.stopped)

    def followed(self, end: Reached) -> Reached:
        """The best of an ``end`` and, if it leaves more than noise, those of the next starts; Ctrl-C returns the best so far."""
        ends, whole, compared = [end], self._problem(0), self._compared
        try:
            for u in compared.others:
                costs = np.array([x.cost for x in ends])
                agreed = max(compared.agreeing, agreeing(costs, costs.min())) > 1
                if agreed or not above_noise(whole, whole.point(ends[-1].values)):
                    break
                ends.append(self._freed(self._level, u))
            best = min(ends, key=lambda x: x.cost)
            u = whole.point(best.values)
            if (other := moved_over(whole, u)) is not u:  # numbers that may lie at several places
                better = search(whole, other, small=ROUGHLY)
                ends.append(replace(best, values=best.values | whole.values(better.u), cost=better.cost))
        except (KeyboardInterrupt, Stopped):
            self.work.stop()
        return replace(min(ends, key=lambda x: x.cost), stopped=self.work.stopped)

    def _best_starts(self, starts: int, seed: int, first: dict[str, float]) -> tuple[int, Found]:
        """The guide under which starts were compared, and the best of them."""
        level = self._stiffest(first)
        self.factor = self._coarsest(level, first)
        self._problems.clear()
        problem = self._limited(level, first)
        u = problem.point(first)
        if starts == 1:
            return level, Found(u, np.inf)
        return level, search(problem, u, starts, seed, wide=True, steps=ROUGH_STEPS, small=ROUGHLY)

    def _freed(self, level: int, u: Array) -> Reached:
        """The end of searches under looser and looser guides, the last one without."""
        values, under = self._problem(level).values(u), dict[float, dict[str, float]]()
        for looser in range(level, -1, -1):
            problem = self._limited(looser, values)
            u = problem.point(values)
            problem.noise = {
                c: max(left, floor_of(problem, c)) or 1.0 for c, (left, _) in leftovers(problem, u).items()
            }
            u = search(problem, u, small=ROUGHLY).u
            followed = all(left <= FOLLOWED * size for left, size in leftovers(problem, u).values())
            if followed or not looser:
                values = values | problem.values(u)
            if looser and (followed or looser == level):
                under[self.guides.bandwidths[looser]] = problem.values(u)
        problem.noise = dict(self.noise)
        return Reached(values, under, float(half_squares(problem.residuals(u[None]))[0]))

    def under_guide(self, near: Reached) -> UnderGuide:
        """The coordinates that the prediction errors give under the first guide, and their deviations; {} without a guide."""
        if not near.under:
            return {}
        stiffest = max(near.under)
        problem = self._limited(self.guides.bandwidths.index(stiffest), near.under[stiffest])
        u = problem.point(near.under[stiffest])
        weigh(problem, u)
        u = search(problem, u, small=ROUGHLY).u
        weigh(problem, u)
        width = spread(fine_slopes(problem, u), problem.high - problem.low)
        return {
            c.name: (x, s) for c, x, s in zip(problem.sought, u.tolist(), width.tolist(), strict=True) if not c.nuisance
        }

    def _stiffest(self, values: dict[str, float]) -> int:
        """The stiffest guide under which the errors of first values stand out of the noise."""
        for level in range(len(self.guides.bandwidths) - 1, 0, -1):
            problem = self._problem(level)
            left = leftovers(problem, problem.point(values))
            if any(_VISIBLE * noise_of(problem, c) < x < np.inf for c, (x, _) in left.items()):
                return level
        return min(1, len(self.guides.bandwidths) - 1)

    def _coarsest(self, level: int, values: dict[str, float]) -> int:
        """The largest power of two of samples for one that moves no output by much.

        That is, by much of its noise or of a tenth of its residual with the first values.
        """
        exact, factor = self._problem(level), 1
        u = exact.point(values)
        known = [exact.predicted(run, k, u[None]) for k, run in enumerate(exact.runs)]
        allowed = {c: max(noise_of(exact, c), left / _VISIBLE) for c, (left, _) in leftovers(exact, u).items()}
        while (coarse := self._coarse_problem(level, 2 * factor)) is not None:
            for k, (run, fewer) in enumerate(zip(exact.runs, coarse.runs, strict=True)):
                predicted = coarse.predicted(fewer, k, coarse.point(values)[None])
                for now, then, x, y in zip(run.targets, fewer.targets, known[k], predicted, strict=True):
                    off = y[0] - np.interp(then.t, now.t, x[0])
                    if not np.sqrt(np.mean(off**2)) <= _UNSEEN * allowed[now.column]:
                        return factor
            factor *= 2
        return factor

    def _limited(self, level: int, values: dict[str, float]) -> MachineProblem:
        """The problem under a guide, with the solver's steps limited by those at some values."""
        problem = self._problem(level)
        if not problem.runs[0].attempts and np.isfinite(problem.residuals(problem.point(values)[None])).all():
            for run in problem.runs:
                most = min(_DEARER * max(run.attempts, run.scenario.rows), run.scenario.solve.max_steps)
                run.scenario = run.scenario.with_changes({"solve.max_steps": most})
        return problem

    def _problem(self, level: int) -> MachineProblem:
        """The problem under a guide, or without one."""
        if level not in self._problems:
            problem = self._coarse_problem(level, self.factor)
            assert problem is not None
            self._problems[level] = problem
        return self._problems[level]

    def _coarse_problem(self, level: int, factor: int) -> MachineProblem | None:
        """The problem with one of so many samples; None if a recording would be left with too few."""
        guided = self.guides.at(self.guides.bandwidths[level])
        recordings = guided.recordings
        if factor > 1:
            fewer = [(i, coarser(recording, factor)) for i, recording in recordings]
            if any(recording is None for _, recording in fewer):
                return None
            recordings = [(i, recording) for i, recording in fewer if recording is not None]
        runs, starts = prepared(guided.scenario, recordings, self.sought)
        if factor > 1:  # they begin as all samples say
            runs = [replace(run, start=self._begins[run.log]) for run in runs]
            starts = [c for c in self._starts if c.log in {i for i, _ in recordings}]
        return MachineProblem(runs, [*self.sought, *starts], dict(self.noise), work=self.work, step=_STEP)


def steps_apart(problem: MachineProblem, u: Array, other: UnderGuide) -> Array:
    """The steps to another estimate of the same coordinates, less what its own deviations explain.

    Under a guide, a slip does not displace what follows. Where the two estimates disagree, the free one may be at a local
    minimum, or the model lacks something (Hausman, Econometrica 46, 1978).
    """
    steps = np.zeros(len(u))
    likely = -ndtri(_CHANCE / 2 / max(len(other), 1))  # deviations that none exceeds (Bonferroni)
    for i, c in enumerate(problem.sought):
        if c.name in other:
            there, deviation = other[c.name]
            steps[i] = np.sign(there - u[i]) * max(abs(there - u[i]) - likely * deviation, 0.0)
    return steps


def _of_each_load(recordings: Sequence[tuple[int, Recording]]) -> list[tuple[int, Recording]]:
    """At most ``_ENOUGH`` recordings, one of each load if possible."""
    some: list[tuple[int, Recording]] = []
    left = list(recordings)
    while left and len(some) < _ENOUGH:
        loads = [each[1].known for each in left]
        first = [i for i, known in enumerate(loads) if known not in loads[:i]]
        some += [left[i] for i in first]
        left = [each for i, each in enumerate(left) if i not in first]
    return sorted(some[:_ENOUGH], key=lambda each: each[0])
