"""A law that contains another with fewer numbers cannot follow recordings worse: where its search ended so, it is searched
again from the smaller law's best numbers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate, paths
from stribeck.identify.actuator.estimate import BestPoint, beyond_noise, estimate, leftovers, prepared
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.solve import search
from stribeck.identify.models.memory import rows_together
from stribeck.identify.work import Work
from stribeck.scenario import Scenario

_WORSE = 1.01  # times what the smaller law leaves: more is another minimum
_WHITE = 1.5  # rows that err alike: white noise has 1
_EDGE = 1e-3  # of the bounds: a number so near to one ended there
_PLACES = 16  # of the numbers that the smaller law does not have
_ROUGH, _NEAR = 12, 1e-4  # of the search from these places


@dataclass
class OpenLaw:
    """A machine with one choice of laws, and its best point."""

    scenario: Scenario
    sought: list[MachineCoordinate]
    best: BestPoint

    @property
    def numbers(self) -> frozenset[str]:
        """The paths that are sought."""
        return paths(self.sought)


def left_more(one: BestPoint, other: BestPoint, times: float = 1.0) -> bool:
    """Whether one leaves more (so many times) of the recordings that both were fitted to than the other."""
    if one.windowed != other.windowed:
        return one.windowed  # it follows no whole recording
    first, second = leftovers(one.problem, one.u), leftovers(other.problem, other.u)
    ratios = [first[c][0] / second[c][0] for c in first if c in second and second[c][0] > 0]
    return bool(ratios) and not float(np.sqrt(np.mean(np.square(ratios)))) <= times


def doubtful(best: BestPoint) -> bool:
    """Whether more than noise is left, or noise that is not white, or a number ended at its bound: there may be a better
    minimum."""
    problem, u = best.problem, best.u
    asked = np.array([not c.nuisance for c in problem.sought], bool)
    edge = np.minimum(u - problem.low, problem.high - u) < _EDGE * (problem.high - problem.low)
    if best.missed() or beyond_noise(problem, u, best.found.agreeing) or (edge & asked).any():
        return True
    return rows_together(problem.residuals(u[None])[0]) > _WHITE


def mend(candidates: Sequence[OpenLaw], recordings: Sequence[tuple[int, Recording]], seed: int, work: Work) -> None:
    """Search again each of these that ended worse than one which it contains, or leaves more than noise, from the best of
    those."""
    for large in sorted(candidates, key=lambda each: len(each.numbers)):
        inside = [c for c in candidates if c.numbers < large.numbers]
        if not inside:
            continue
        small = inside[0]
        for c in inside[1:]:
            small = c if left_more(small.best, c.best) else small
        if left_more(large.best, small.best, _WORSE) or doubtful(large.best):
            other = again(large, small.best, recordings, seed, work)
            if not other.stopped and left_more(large.best, other):
                large.best = other


def again(
    large: OpenLaw, small: BestPoint, recordings: Sequence[tuple[int, Recording]], seed: int, work: Work
) -> BestPoint:
    """The best point from the smaller law's numbers, the further ones at several places within their bounds."""
    fitted = {i for i, _ in recordings}
    sought = [c for c in large.sought if c.log is None or c.log in fitted]
    runs, own = prepared(large.scenario, recordings, {c.name for c in sought} | large.numbers)
    problem = MachineProblem(runs, [*sought, *own], dict(small.problem.noise), work=work)
    points = _places(problem, small.values(), seed)
    found = search(problem, 1, seed, points[0], None, points[1:], wide=True, steps=_ROUGH, small=_NEAR)
    values = problem.values(found.u)
    return estimate(large.scenario, recordings, large.sought, 1, seed, work, values)


def _places(problem: MachineProblem, values: Mapping[str, float], seed: int) -> list[Array]:
    """Points with the numbers that are known, the others as guessed and at places spread over their bounds."""
    u = problem.start()
    new = [i for i, c in enumerate(problem.sought) if c.name not in values and not c.nuisance]
    for i, c in enumerate(problem.sought):
        if c.name in values:
            u[i] = c.inner(values[c.name])
    if not new:
        return [u]
    points = [u]
    for share in qmc.LatinHypercube(len(new), rng=np.random.default_rng(seed)).random(_PLACES - 1):
        x = u.copy()
        x[new] = problem.low[new] + share * (problem.high - problem.low)[new]
        points.append(x)
    return points
