"""Searches whole recordings from many starts, guided along the measured motion and then freed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate, paths
from stribeck.identify.actuator.guided import Guides
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.residuals import beyond_noise, leftovers
from stribeck.identify.actuator.solve import Found, agreeing, search
from stribeck.identify.actuator.starts import prepared
from stribeck.identify.work import Stopped, Work
from stribeck.scenario import Scenario

_FOLLOWED = 0.1  # of a column's changes: with a larger residual, the simulation does not follow the recording
_LOOSE = 1e-6  # rtol far from the optimum
_STEP = 1e-3  # of a coordinate: step of the differences far from the optimum
_SMALL = 1e-4  # relative reduction of the cost below which a search far from the optimum ends
_ROUGH = 12  # steps of the comparison of starts
_ENOUGH = 6  # recordings for this comparison
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
    """Starts are compared under the loosest guide with which the simulation follows the recordings.

    From the best, the guide is loosened as far as the simulation follows. If the residual of the freely simulated recordings
    exceeds the noise, the search is repeated under stiffer guides, until several ends agree.
    """

    scenario: Scenario
    recordings: Sequence[tuple[int, Recording]]
    sought: Sequence[MachineCoordinate]
    noise: dict[str, float]
    work: Work
    keep: Keep | None = None
    _problems: dict[int, MachineProblem] = field(default_factory=dict)

    def __post_init__(self) -> None:
        rtol = max(self.scenario.solve.rtol, _LOOSE)
        self.scenario = self.scenario.with_changes({"solve.rtol": rtol})
        self.guides = Guides(self.scenario, _some(self.recordings))

    def reached(self, starts: int, seed: int, first: dict[str, float]) -> Reached:
        """The best end from ``first``, where given, and from other starts; Ctrl-C returns the best so far."""
        ends, agreed = [Reached(first, first)], 1
        try:
            for level, found in self._places(starts, seed, first):
                end = self._freed(level, found)
                ends.append(end)
                agreed = max(
                    agreed, found.agreeing, agreeing(np.array([x.cost for x in ends]), min(x.cost for x in ends))
                )
                whole = self._problem(0)
                if end.stopped or not beyond_noise(whole, whole.point(end.values), agreed):
                    break
        except (KeyboardInterrupt, Stopped):
            self.work.stop()
        best = min(ends, key=lambda each: each.cost)
        return replace(best, agreeing=agreed, stopped=self.work.stopped)

    def _places(self, starts: int, seed: int, first: dict[str, float]) -> Iterator[tuple[int, Found]]:
        """The best starts under each guide, from the loosest that suffices; then the others under the stiffest."""
        top = len(self.guides.bandwidths) - 1
        begin = self._loosest(top, first)
        for level in range(begin, (top if starts > 1 else begin) + 1):
            problem = self._problem(level)
            found = Found(problem.point(first), np.inf)
            if starts > 1:
                found = search(
                    problem,
                    starts,
                    seed + level,
                    found.u,
                    kept(self._problem(level), self.keep),
                    wide=True,
                    steps=_ROUGH,
                    small=_SMALL,
                )
            yield level, found
        for u in found.others:
            yield top, replace(found, u=u)

    def _freed(self, level: int, found: Found) -> Reached:
        """The end of a search that loosens the guide from a level on."""
        values = guided = self._problem(level).values(found.u)
        while not found.stopped:
            problem = self._problem(level)
            found = search(problem, 1, 0, problem.point(values), kept(self._problem(level), self.keep), small=_SMALL)
            values = values | problem.values(found.u)
            if not level:
                break
            guided, level = values, self._loosest(level - 1, values)
        return Reached(values, guided, found.cost, found.agreeing, found.stopped)

    def _loosest(self, most: int, values: dict[str, float]) -> int:
        """The loosest guide with which the simulation follows the recordings, or the one at ``most``."""
        return next((level for level in range(most) if self._follows(level, values)), most)

    def _follows(self, level: int, values: dict[str, float]) -> bool:
        problem = self._problem(level)
        return all(left <= _FOLLOWED * size for left, size in leftovers(problem, problem.point(values)).values())

    def _problem(self, level: int) -> MachineProblem:
        """The problem under a guide; without one, of all recordings."""
        if level not in self._problems:
            scenario, some = self.guides.with_guide(level) if level else (self.scenario, self.recordings)
            runs, own = prepared(scenario, some, {c.name for c in self.sought} | paths(self.sought))
            sought = [*self.sought, *own]
            self._problems[level] = MachineProblem(runs, sought, dict(self.noise), work=self.work, step=_STEP)
        return self._problems[level]


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
