"""Least squares from many starts, and whether the result is to be believed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import qmc

from stribeck.arrays import Array
from stribeck.identify.methods.blockwise import Solved, solve_blocks
from stribeck.identify.models.problem import Problem
from stribeck.identify.work import Stopped, Work
from stribeck.simulation.lanes import threads_of_this_machine

STOPPED = "stopped by Ctrl-C: the best values so far"
_MANY = 200  # evaluations
_FIRST_LOOK = 12  # evaluations after which the better starts go on
_KEPT = 3  # of the starts up to one's own
_SAME = 1e-3  # relative difference of costs that are one minimum
_ROUGH, _MIDDLE, _FINE = 1e-4, 1e-6, 1e-8


@dataclass(frozen=True)
class Optimum:
    """The best point found.

    Attributes:
        point: inner coordinates.
        cost: half the sum of squared residuals there.
        starts: how many were tried; ``agreeing``: how many of those that went to the end found this minimum.
        finished: how many went to the end.
        converged: whether the last step fulfilled the tolerances; ``reason``: why it stopped.
    """

    point: Array
    cost: float
    starts: int
    finished: int
    agreeing: int
    converged: bool
    reason: str
    exhausted: bool = False  # it leaves no more than the measurement's noise: there is nothing better

    @property
    def verdict(self) -> str:
        """For a reader, in a line."""
        if not self.converged:
            return self.reason if self.reason == STOPPED else f"not converged: {self.reason}"
        if self.exhausted:
            return f"one of {self.starts} starts led down to the noise of the measurement: more starts could find no better"
        found = f"{self.agreeing} of the {self.finished} best of {self.starts} starts ended in this minimum"
        alone = self.starts > 1 and self.agreeing < 2
        return found + ("; a lower one may exist: give more starts" if alone else "")


def starting_points(problem: Problem, given: Array, low: Array, high: Array, count: int, seed: int) -> list[Array]:
    """``given`` and points that fill the box from ``low`` to ``high`` evenly (Sobol), all of them allowed."""
    sampler = qmc.Sobol(len(given), seed=seed)
    draws = sampler.random_base2(max(int(np.ceil(np.log2(max(8 * count, 2)))), 1))
    points = (low + (high - low) * draw for draw in draws)
    return [given, *(u for u in points if problem.allowed(u))][:count]


def multistart(
    problem: Problem, starts: Sequence[Array], work: Work | None = None, enough: float = 0.0, most: int = _MANY
) -> Optimum:
    """The best minimum from the starts: a first look from each, then the better ones to the end.

    What becomes of a start hangs on those before it alone, so that more starts never find less: it goes to the end where
    it is among the best few up to its own place.

    Args:
        work: told how far this is, and asked whether to stop.
        enough: a cost with which nothing better is looked for: the measurement's own noise.
        most: evaluations of a descent.

    Raises:
        KeyboardInterrupt: nothing was found before it.
    """
    work = work or Work()
    best = _Best()
    watched = _Watched(problem, work, best)
    batch, tried = max(threads_of_this_machine(), 2), 0
    done: list[tuple[int, Solved]] = []  # and from which start
    looks, met = list[Solved](), list[int]()

    def to_the_end(run: Solved) -> Solved:
        near = from_afar(watched, run.point, _MIDDLE, most)
        last = solve_blocks(watched, near.point, _MIDDLE, most)
        return last if last.cost < near.cost else near

    try:
        while tried < len(starts) and not work.stopped:
            some = starts[tried : tried + (1 if not tried else batch)]
            chosen = []
            for run in filter(None, work.each(lambda u: from_afar(watched, u, _ROUGH, _FIRST_LOOK), some)):
                looks.append(run)
                if sum(other.cost <= run.cost for other in looks) <= _KEPT:
                    chosen.append((len(looks), run))
            ended = work.each(lambda each: to_the_end(each[1]), chosen)
            done += [(place, run) for (place, _), run in zip(chosen, ended, strict=True) if run]
            tried += len(some)
            work.done(tried / len(starts))
            # the first that met it counts, and nothing after it, however many ran beside it
            if met := [place for place, run in done if run.cost <= enough]:
                tried = met[0]
                done = [(place, run) for place, run in done if place <= tried]
                break
        if not work.stopped:
            first = done[-1][1] if met else min((run for _, run in done), key=lambda run: run.cost)
            last = solve_blocks(watched, first.point, _FINE, most)
    except (KeyboardInterrupt, Stopped):
        work.stop()
    if work.stopped:
        if best.point is None:
            raise KeyboardInterrupt
        return Optimum(problem.nearest(best.point), best.cost, tried, len(done), 0, False, STOPPED)
    final = last if last.cost <= first.cost else first
    agreeing = sum(run.cost <= final.cost * (1 + _SAME) + 1e-12 for _, run in done)
    return Optimum(
        problem.nearest(final.point), final.cost, tried, len(done), agreeing, final.converged, final.reason,
        final.cost <= enough,
    )  # fmt: skip


@dataclass
class _Best:
    """The best point so far."""

    cost: float = np.inf
    point: Array | None = None


class _Watched:
    """A problem whose best point is kept, and which ends when the work is to stop."""

    def __init__(self, problem: Problem, work: Work, best: _Best) -> None:
        self.problem, self.work, self.best = problem, work, best
        self.coordinates, self.bounds, self.lanes = problem.coordinates, problem.bounds, problem.lanes
        self.jacobian, self.slopes, self.wall = problem.jacobian, problem.slopes, problem.wall

    def residual(self, u: Array) -> Array:
        """The problem's."""
        self.work.check()
        self.work.tick()
        found = self.problem.residual(u)
        cost = 0.5 * float(found @ found)
        if cost < self.best.cost:
            self.best.cost, self.best.point = cost, u.copy()
        return found


def from_afar(problem: _Watched, start: Array, tolerance: float, evaluations: int) -> Solved:
    """Least squares from a start that may be far from any minimum (SciPy's trust-region reflective, which keeps clear of the
    bounds)."""
    low, high = problem.bounds
    inside = np.clip(start, low + 1e-9 * (high - low), high - 1e-9 * (high - low))
    found = least_squares(
        problem.residual, inside, problem.jacobian, bounds=(low, high), method="trf",
        ftol=tolerance, xtol=tolerance, gtol=1e-15, max_nfev=evaluations,
    )  # fmt: skip
    return Solved(found.x, float(found.cost), found.status > 0, str(found.message))
