"""Profiles of the likelihood: how the fit worsens when one coordinate is held and the others adapt."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2

from stribeck.arrays import Array
from stribeck.identify.methods.blockwise import solve_blocks
from stribeck.identify.models.problem import Problem
from stribeck.identify.result import Profile

THRESHOLD = float(chi2.ppf(0.95, 1))
_NOTICEABLE = 0.05  # of twice the log-likelihood
_EXACT, _COARSEST = 1e-3, 1e-4  # of twice the log-likelihood; of the cost: to which a point of a profile is found
_MOST_EVALUATIONS = 20  # for it
_FARTHEST = 4.0  # of the logarithm, to which a profile is followed
_STRAIGHT = 0.05  # what the root of the fall may differ by from that of a parabola


class Lower(Exception):
    """A profile came to a lower cost than the optimum's."""

    def __init__(self, point: Array) -> None:
        super().__init__()
        self.point = point


def straight(
    problem: Problem, u: Array, inner: Array, deviations: Array, units: Array, wanted: list[int]
) -> dict[int, tuple[float, float, Profile]]:
    """The intervals of the coordinates whose profile is a parabola as far as their ends: these are where the covariance
    puts them, which the cost there, the others moved along, confirms.

    Args:
        problem: the problem.
        u: its optimum.
        inner: the covariance there.
        deviations: of each coordinate.
        units: what twice the cost rises by, for each coordinate, where twice the log-likelihood falls by one.
        wanted: the coordinates that are asked for.
    """
    low, high = problem.bounds
    shares = (-1.0, -0.5, 0.5, 1.0)
    points, owners = [u], []
    for k in wanted:
        if inner[k, k] <= 0 or deviations[k] <= 0:
            continue
        along = inner[:, k] / inner[k, k] * np.sqrt(THRESHOLD) * deviations[k]
        ends = [u + share * along for share in shares]
        if all((low < x).all() and (x < high).all() and problem.allowed(x) for x in ends):
            points += ends
            owners.append(k)
    if not owners:
        return {}
    found = problem.outputs(np.array(points))
    if found is None:
        return {}
    costs = np.sum((found - problem.measured) ** 2, axis=1) / problem.scale**2
    result = {}
    for i, k in enumerate(owners):
        fall = (costs[1 + 4 * i : 5 + 4 * i] - costs[0]) / units[k]
        if fall.min() < -_NOTICEABLE:
            raise Lower(points[1 + 4 * i + int(np.argmin(fall))])
        root = np.sqrt(np.maximum(fall, 0.0))
        expected = np.sqrt(THRESHOLD) * abs(np.array(shares))
        if (abs(root - expected) < _STRAIGHT * expected[0]).all():
            c = problem.coordinates[k]
            reach = np.sqrt(THRESHOLD) * deviations[k] * expected[[0, 3]] / root[[0, 3]]
            x = np.array([u[k] + s * np.sqrt(THRESHOLD) * deviations[k] for s in (-1.0, -0.5, 0.0, 0.5, 1.0)])
            curve = Profile(np.array([c.outer(each) for each in x]), np.insert(np.maximum(fall, 0.0), 2, 0.0))
            result[k] = float(u[k] - reach[0]), float(u[k] + reach[1]), curve
    return result


def profile(
    problem: Problem, u: Array, k: int, deviation: float, variance: float, inner: Array
) -> tuple[float | None, float | None, Profile]:
    """The 95 % interval of a coordinate (inner) by its profile likelihood, an open side being None; and the profile."""
    base = _cost(problem, u)
    unit = variance / problem.scale**2  # of twice the cost
    tried: list[tuple[float, float]] = [(float(u[k]), 0.0)]
    ends = [_end(problem, u, k, side, deviation, base, unit, inner, tried) for side in (-1, 1)]
    tried.sort()
    c = problem.coordinates[k]
    curve = Profile(np.array([c.outer(x) for x, _ in tried]), np.array([fall for _, fall in tried]))
    return ends[0], ends[1], curve


def _end(
    problem: Problem, u: Array, k: int, side: int, deviation: float, base: float, unit: float, inner: Array,
    tried: list[tuple[float, float]],
) -> float | None:  # fmt: skip
    """Where twice the log-likelihood has fallen by the threshold, going from the optimum to one side."""
    low, high = problem.bounds
    edge = high[k] if side > 0 else low[k]
    coordinate = problem.coordinates[k]
    farthest = u[k] + side * _FARTHEST if coordinate.log else edge
    limit = min(edge, farthest) if side > 0 else max(edge, farthest)
    root = np.sqrt(THRESHOLD)
    near, far = (0.0, 0.0), None  # distance, root of the fall
    distance = root * deviation
    # where the others go along, as far as the data tell that
    along = np.where(np.diag(inner) < 1.0, inner[:, k] / inner[k, k], 0.0)
    for _ in range(12):
        distance = min(distance, abs(limit - u[k]))
        x = float(u[k] + side * distance)
        start = u + along * (x - u[k])
        found, best = _cost_at(problem, start, k, x, max(_EXACT * unit / base, 1e-8) if base > 0 else 1e-8)
        fall = 2 * (found - base) / unit
        if fall < -_NOTICEABLE:
            raise Lower(best)
        fall = max(fall, 0.0)
        tried.append((x, fall))
        here = (distance, float(np.sqrt(fall)))
        if abs(here[1] - root) < 0.02:
            return x
        if here[1] < root:
            near = here
            if distance >= abs(limit - u[k]) * (1 - 1e-9):
                return None
        else:
            far = here
        if far is None:
            distance = min(distance * max(root / max(here[1], 1e-3), 1.05), 3 * distance)
        else:
            share = (root - near[1]) / max(far[1] - near[1], 1e-12)
            distance = near[0] + min(max(share, 0.1), 0.9) * (far[0] - near[0])
    return float(u[k] + side * distance)


def _cost(problem: Problem, u: Array) -> float:
    r = problem.residual(u)
    return 0.5 * float(r @ r)


def _cost_at(problem: Problem, start: Array, k: int, value: float, tolerance: float) -> tuple[float, Array]:
    """The smallest cost with one coordinate held, to a share of it, and the point."""
    begin = np.array(start)
    begin[k] = value
    found = solve_blocks(problem, begin, min(tolerance, _COARSEST), _MOST_EVALUATIONS, held=[k])
    return found.cost, found.point
