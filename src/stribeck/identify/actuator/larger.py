"""Repeats the search of a law if a special case of it with fewer parameters fits better.

The larger law cannot fit worse at its optimum. The new search starts from the smaller law's optimum.
"""

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

_WORSE = 1.01  # times the smaller law's residual: a larger one is a local minimum
_WHITE = 1.5  # correlated rows: white noise has 1
_EDGE = 1e-3  # of the range between the bounds: a nearer value counts as at the bound
_PLACES = 16  # starts of the parameters that the smaller law does not have
_ROUGH, _NEAR = 12, 1e-4  # of the search from these places


@dataclass
class OpenLaw:
    """A machine with one choice of laws, and its best point."""

    scenario: Scenario
    sought: list[MachineCoordinate]
    best: BestPoint

    @property
    def numbers(self) -> frozenset[str]:
        """The paths of the fitted parameters."""
        return paths(self.sought)


def left_more(one: BestPoint, other: BestPoint, times: float = 1.0) -> bool:
    """Whether the residual of ``one`` exceeds ``times`` that of ``other``, on recordings fitted by both."""
    if one.windowed != other.windowed:
        return one.windowed  # it does not describe whole recordings
    first, second = leftovers(one.problem, one.u), leftovers(other.problem, other.u)
    ratios = [first[c][0] / second[c][0] for c in first if c in second and second[c][0] > 0]
    return bool(ratios) and not float(np.sqrt(np.mean(np.square(ratios)))) <= times


def doubtful(best: BestPoint) -> bool:
    """Whether there may be a better minimum.

    Signs are a residual above the noise, a residual that is not white, and a parameter at its bound.
    """
    problem, u = best.problem, best.u
    asked = np.array([not c.nuisance for c in problem.sought], bool)
    edge = np.minimum(u - problem.low, problem.high - u) < _EDGE * (problem.high - problem.low)
    if best.missed() or beyond_noise(problem, u, best.found.agreeing) or (edge & asked).any():
        return True
    return rows_together(problem.residuals(u[None])[0]) > _WHITE


def mend(candidates: Sequence[OpenLaw], recordings: Sequence[tuple[int, Recording]], seed: int, work: Work) -> None:
    """Repeat the search of each candidate that fits worse than a special case of it, or whose optimum is doubtful.

    The new search starts from the best special case.
    """
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
    """The best point from the smaller law's optimum, with several starts of the additional parameters."""
    fitted = {i for i, _ in recordings}
    sought = [c for c in large.sought if c.log is None or c.log in fitted]
    runs, own = prepared(large.scenario, recordings, {c.name for c in sought} | large.numbers)
    problem = MachineProblem(runs, [*sought, *own], dict(small.problem.noise), work=work)
    points = _places(problem, small.values(), seed)
    found = search(problem, 1, seed, points[0], None, points[1:], wide=True, steps=_ROUGH, small=_NEAR)
    values = problem.values(found.u)
    return estimate(large.scenario, recordings, large.sought, 1, seed, work, values)


def _places(problem: MachineProblem, values: Mapping[str, float], seed: int) -> list[Array]:
    """Points with the known values; the other parameters at their guess and at starts spread over their bounds."""
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
