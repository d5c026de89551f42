"""Searches whole recordings from many starts, guided along the measured motion and then freed.

Recordings are as coarse as the outputs' noise allows. A start whose simulation takes many times the steps of the first one is
no candidate.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coarse import coarser
from stribeck.identify.actuator.coordinates import MachineCoordinate, paths
from stribeck.identify.actuator.guided import Guides
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.residuals import beyond_noise, floor_of, leftovers, noise_of
from stribeck.identify.actuator.solve import Found, agreeing, half_squares, moved_over, search
from stribeck.identify.actuator.starts import prepared
from stribeck.identify.work import Stopped, Work
from stribeck.scenario import Scenario

_FOLLOWED = 0.1  # of a column's changes: with a larger residual, the simulation does not follow the recording
_VISIBLE = 10.0  # times the noise: errors of first values, a third of the friction; 3 % of it then equal the noise
_LOOSE = 1e-6  # rtol far from the optimum
_STEP = 1e-3  # of a coordinate: step of the differences far from the optimum
SMALL_AFAR = 1e-4  # relative reduction of the cost below which a search far from the optimum ends
_ROUGH = 12  # steps of the comparison of starts
_ENOUGH = 6  # recordings for this comparison
_UNSEEN = 0.3  # of a column's noise: a change by coarser inputs that adds 5 % to it
_DEARER = 10  # times the solver's steps at the first values: what a start may take
Keep = Callable[[dict[str, float], float], None]


@dataclass(frozen=True)
class Reached:
    """The end of a search: its values by name, its cost, the number of agreeing ends, and whether it was stopped.

    ``guided``: the values of the last guided fit, before the recordings were simulated freely.
    """

    values: dict[str, float]
    guided: dict[str, float]
    cost: float = np.inf
    agreeing: int = 1
    stopped: bool = False


@dataclass
class GuidedSearch:
    """Starts are compared under the stiffest guide that lets errors of the friction stand out of the noise.

    A stiff guide leaves the fewest minima. From the best start, the guide is loosened step by step. The next starts
    follow until an end leaves no more than noise, or two come to the same end.
    """

    scenario: Scenario
    recordings: Sequence[tuple[int, Recording]]
    sought: Sequence[MachineCoordinate]
    noise: dict[str, float]
    work: Work
    keep: Keep | None = None
    factor: int = 1  # one of so many samples is compared
    _problems: dict[int, MachineProblem] = field(default_factory=dict)

    def __post_init__(self) -> None:
        rtol = max(self.scenario.solve.rtol, _LOOSE)
        self.scenario = self.scenario.with_changes({"solve.rtol": rtol})
        self.guides = Guides(self.scenario, _some(self.recordings))
        self._named = {c.name for c in self.sought} | paths(self.sought)
        runs, self._begun = prepared(self.scenario, self.recordings, self._named)
        self._starts = {run.log: run.start for run in runs}

    def reached(self, starts: int, seed: int, first: dict[str, float], rough: bool = False) -> Reached:
        """The best end from ``first``, where given, and from other starts; Ctrl-C returns the best so far.

        Args:
            rough: follow only the best start.
        """
        ends, agreed = [Reached(first, first)], 1
        try:
            level, found = self._compared(starts, seed, first)
            for u in (found.u, *found.others):
                ends.append(self._freed(level, u))
                agreed = max(found.agreeing, agreeing(np.array([x.cost for x in ends]), min(x.cost for x in ends)))
                whole = self._problem(0)
                if rough or self.work.stopped or not beyond_noise(whole, whole.point(ends[-1].values), agreed):
                    break
        except (KeyboardInterrupt, Stopped):
            self.work.stop()
        best = min(ends, key=lambda each: each.cost)
        if not (rough or self.work.stopped):
            best = self._elsewhere(best)
        return replace(best, agreeing=agreed, stopped=self.work.stopped)

    def _elsewhere(self, end: Reached) -> Reached:
        """The end of a search from other places of the numbers that may lie at several; the same end if that is better."""
        whole = self._problem(0)
        u = whole.point(end.values)
        try:
            other = moved_over(whole, u)
            if other is u:
                return end
            found = search(whole, 1, 0, other, kept(whole, self.keep), small=SMALL_AFAR)
        except (KeyboardInterrupt, Stopped):
            self.work.stop()
            return end
        return replace(end, values=end.values | whole.values(found.u), cost=found.cost)

    def _compared(self, starts: int, seed: int, first: dict[str, float]) -> tuple[int, Found]:
        """The best starts, and the guide under which they were compared."""
        level = self._stiffest(first)
        self.factor = self._coarsest(level, first)
        self._problems.clear()
        problem = self._limited(level, first)
        u = problem.point(first)
        if starts == 1:
            return level, Found(u, np.inf)
        keep = kept(problem, self.keep)
        return level, search(problem, starts, seed, u, keep, wide=True, steps=_ROUGH, small=SMALL_AFAR)

    def _freed(self, level: int, u: Array) -> Reached:
        """The end of searches under looser and looser guides, the last one without."""
        values = guided = self._problem(level).values(u)
        for at in range(level, -1, -1):
            problem = self._limited(at, values)
            u = problem.point(values)
            problem.noise = {
                c: max(left, floor_of(problem, c)) or 1.0 for c, (left, _) in leftovers(problem, u).items()
            }
            u = search(problem, 1, 0, u, kept(problem, self.keep), small=SMALL_AFAR).u
            if at and not self._follows(at, problem.values(u)):
                continue
            values = values | problem.values(u)
            guided = values if at else guided
        problem.noise = dict(self.noise)
        return Reached(values, guided, float(half_squares(problem.residuals(u[None]))[0]))

    def _stiffest(self, values: dict[str, float]) -> int:
        """The stiffest guide under which the errors of first values stand out of the noise."""
        for level in range(len(self.guides.bandwidths) - 1, 0, -1):
            problem = self._problem(level)
            left = leftovers(problem, problem.point(values))
            if any(_VISIBLE * noise_of(problem, c) < x < np.inf for c, (x, _) in left.items()):
                return level
        return min(1, len(self.guides.bandwidths) - 1)

    def _follows(self, level: int, values: dict[str, float]) -> bool:
        problem = self._problem(level)
        return all(left <= _FOLLOWED * size for left, size in leftovers(problem, problem.point(values)).values())

    def _coarsest(self, level: int, values: dict[str, float]) -> int:
        """The largest power of two of samples for one that moves no output by much of its noise, with the first values."""
        exact, factor = self._problem(level), 1
        known = [exact.predicted(run, k, exact.point(values)[None]) for k, run in enumerate(exact.runs)]
        while (coarse := self._made(level, 2 * factor)) is not None:
            for k, (run, own) in enumerate(zip(exact.runs, coarse.runs, strict=True)):
                found = coarse.predicted(own, k, coarse.point(values)[None])
                for now, then, x, y in zip(run.targets, own.targets, known[k], found, strict=True):
                    off = y[0] - np.interp(then.t, now.t, x[0])
                    if not np.sqrt(np.mean(off**2)) <= _UNSEEN * noise_of(exact, now.column):
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
        """The problem under a guide; without one, of all recordings."""
        if level not in self._problems:
            made = self._made(level, self.factor)
            assert made is not None
            self._problems[level] = made
        return self._problems[level]

    def _made(self, level: int, factor: int) -> MachineProblem | None:
        """The problem with one of so many samples; None if a recording would be left with too few."""
        scenario, some = self.guides.with_guide(level) if level else (self.scenario, self.recordings)
        if factor > 1:
            fewer = [(i, coarser(recording, factor)) for i, recording in some]
            some = [(i, recording) for i, recording in fewer if recording is not None]
            if len(some) < len(fewer):
                return None
        runs, own = prepared(scenario, some, self._named)
        if factor > 1:  # they begin as all samples say
            runs = [replace(run, start=self._starts[run.log]) for run in runs]
            own = [c for c in self._begun if c.log in {i for i, _ in some}]
        return MachineProblem(runs, [*self.sought, *own], dict(self.noise), work=self.work, step=_STEP)


def kept(problem: MachineProblem, keep: Keep | None) -> Callable[[Array, float], None] | None:
    """What a search calls with each better point: ``keep`` with the point's values by name."""
    return None if keep is None else lambda u, cost: keep(problem.values(u), cost)


def _some(recordings: Sequence[tuple[int, Recording]]) -> list[tuple[int, Recording]]:
    """At most ``_ENOUGH`` recordings, one of each load if possible."""
    some: list[tuple[int, Recording]] = []
    left = list(recordings)
    while left and len(some) < _ENOUGH:
        loads = [each[1].known for each in left]
        first = [i for i, known in enumerate(loads) if known not in loads[:i]]
        some += [left[i] for i in first]
        left = [each for i, each in enumerate(left) if i not in first]
    return sorted(some[:_ENOUGH], key=lambda each: each[0])
