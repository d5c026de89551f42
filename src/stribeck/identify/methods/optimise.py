"""Least squares from many starts, and whether the result is to be believed."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import qmc

from stribeck.identify.models.problem import Problem

Array = NDArray[np.float64]
_FIRST_LOOK = 12  # evaluations after which the better half of the starts goes on
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

    @property
    def verdict(self) -> str:
        """For a reader, in a line."""
        if not self.converged:
            return f"not converged: {self.reason}"
        found = f"{self.agreeing} of the {self.finished} best of {self.starts} starts ended in this minimum"
        alone = self.starts > 1 and self.agreeing < 2
        return found + ("; a lower one may exist: give more starts" if alone else "")


@dataclass(frozen=True)
class _Run:
    point: Array
    cost: float
    converged: bool
    reason: str


def starting_points(problem: Problem, given: Array, low: Array, high: Array, count: int, seed: int) -> list[Array]:
    """``given`` and points that fill the box from ``low`` to ``high`` evenly (Sobol), all of them allowed."""
    sampler = qmc.Sobol(len(given), seed=seed)
    draws = sampler.random_base2(max(int(np.ceil(np.log2(max(8 * count, 2)))), 1))
    points = (low + (high - low) * draw for draw in draws)
    return [given, *(u for u in points if problem.allowed(u))][:count]


def multistart(problem: Problem, starts: Sequence[Array], workers: int | None = None) -> Optimum:
    """The best minimum from the starts: a first look from each, then the better ones to the end."""
    with ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:

        def each(points: Sequence[Array], tolerance: float, evaluations: int) -> list[_Run]:
            runs = pool.map(lambda u: descend(problem, u, tolerance, evaluations), points)
            return sorted(runs, key=lambda run: run.cost)

        looks = each(starts, _ROUGH, _FIRST_LOOK)
        kept = max(min(3, len(looks)), (len(looks) + 3) // 4)
        done = each([run.point for run in looks[:kept]], _MIDDLE, 200)
    best = descend(problem, done[0].point, _FINE, 200)
    agreeing = sum(run.cost <= best.cost * (1 + _SAME) + 1e-12 for run in done)
    return Optimum(
        problem.nearest(best.point), best.cost, len(starts), len(done), agreeing, best.converged, best.reason
    )


def descend(problem: Problem, start: Array, tolerance: float, evaluations: int) -> _Run:
    """Least squares from one start, with bounds (SciPy's trust-region reflective)."""
    low, high = problem.bounds
    inside = np.clip(start, low + 1e-9 * (high - low), high - 1e-9 * (high - low))
    found = least_squares(
        problem.residual, inside, problem.jacobian, bounds=(low, high), method="trf",
        ftol=tolerance, xtol=tolerance, gtol=1e-15, max_nfev=evaluations,
    )  # fmt: skip
    return _Run(found.x, float(found.cost), found.status > 0, str(found.message))
