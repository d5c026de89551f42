"""Levenberg-Marquardt least squares from many starts, with all trials simulated in parallel.

SciPy's ``least_squares`` takes one start and one step at a time. Here the Jacobians of all starts, and several dampings of
each step, are simulated together. The worst starts are given up after each step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.work import Stopped

_DAMPINGS = np.array([1e-4, 1e-2, 1.0, 30.0, 1e3])  # of the present one: a search may both slow down and speed up
_KEEP = (10, 10, 6, 4, 3, 2, 2, 1)  # starts that take each step: a poor one seldom wins later
_WIDE = 4  # starts that a comparison converges: the next best may lead to a better minimum
_STEPS, ROUGH_STEPS = 40, 12  # of a search, and of one that only compares
SMALL, ROUGHLY = 1e-7, 1e-4  # relative reduction of the cost below which a search ends; far from the optimum
HUGE = 1e300  # the cost of a point that cannot be simulated: it compares, and is no infinity
_CHANGE = 3.0  # deviations, by which a step of differences changes the residuals: there the cost is still a parabola
_SHORTEST, _LONGEST = 1e-5, 2e-2  # steps of a coordinate: above the solver's noise, below the next minimum
_SETTLING, _PARTS = 20, (1.0, 0.25, 0.06)  # final steps; tried parts of each
# Dampings: parameters correlated to within 1e-6 form a valley, along which only small dampings step.
_FAINT = (1e-9, 1e-6, 1e-4, 1e-2)
_CLOSE = 0.25  # standard deviations from the optimum: they cost less than one percent of an interval's coverage
_AT_BOUND = 1e-6  # of a coordinate's bounds
_PLACES = 8  # along a coordinate: over its bounds of four decades a factor of 3 apart


@dataclass(frozen=True)
class Found:
    """The end of a search: the point, its cost, the number of starts that agree, and whether it was stopped."""

    u: Array
    cost: float
    agreeing: int = 1
    stopped: bool = False
    others: tuple[Array, ...] = ()  # where other starts ended


def half_squares(r: Array) -> Array:
    """Half the sum of squares of each row, infinite where a simulation failed."""
    with np.errstate(all="ignore"):
        total = 0.5 * np.sum(np.square(r), axis=-1)
    return np.where(np.isfinite(total), total, HUGE)


def search(
    problem: MachineProblem, first: Array | None = None, starts: int = 1, seed: int = 0, wide: bool = False,
    steps: int = _STEPS, small: float = SMALL,
) -> Found:  # fmt: skip
    """The best point from several starts: ``first`` (or the machine's), and others spread over the bounds.

    Args:
        starts: number of starts.
        wide: converge several starts.
        small: relative reduction of the cost below which the search ends.

    Ctrl-C, and ``Work.stop``, end the search with the best point so far.
    """
    begin = problem.start() if first is None else first
    if not problem.sought:  # a machine without its friction, for comparison
        return Found(begin, float(half_squares(problem.residuals(begin[None]))[0]))
    best = Found(begin, HUGE, 1, True)
    try:
        U = problem.repaired(_spread_over_bounds(problem, begin, starts, seed))
        costs = half_squares(problem.residuals(U))
        order = np.argsort(costs)[: _KEEP[0]]
        if 0 not in order:
            order = np.append(order[:-1], 0)
        U, costs = U[order], costs[order]
        damping, quiet = np.full(len(U), 1e-2), np.zeros(len(U), int)
        apart = np.full(U.shape[1], problem.step)
        for step in range(steps):
            i = int(np.argmin(costs))
            best = Found(U[i].copy(), float(costs[i]), agreeing(costs, costs[i]), True)
            if costs[i] >= HUGE and step:
                break
            U, new, damping, apart = _step(problem, U, costs, damping, apart)
            fall = costs - new
            quiet = np.where(fall > small * new, 0, quiet + np.where(fall > 0, 2, 1))
            most = _KEEP[min(step + 1, len(_KEEP) - 1)]
            going = np.argsort(new)[: max(most, _WIDE) if wide else most]
            U, costs, damping, quiet = U[going], new[going], damping[going], quiet[going]
            if quiet[int(np.argmin(costs))] >= 2:
                break
        i, *others = np.argsort(costs)
        same = max(best.agreeing, agreeing(costs, costs[i]))
        return Found(U[i], float(costs[i]), same, False, tuple(U[j] for j in others))
    except (KeyboardInterrupt, Stopped):
        problem.work.stop()
        return best


def _spread_over_bounds(problem: MachineProblem, begin: Array, starts: int, seed: int) -> Array:
    """The first start, and others anywhere within the bounds of the machine's numbers."""
    if starts == 1:
        return begin[None]
    spread = qmc.LatinHypercube(len(problem.sought), rng=np.random.default_rng(seed)).random(starts - 1)
    local = np.array([c.nuisance or c.output is not None for c in problem.sought])
    U = problem.low + spread * (problem.high - problem.low)
    U[:, local] = begin[local]  # known roughly already
    return np.concatenate([begin[None], U])


def agreeing(costs: Array, least: float) -> int:
    """The number of starts with as low a cost. In a flat valley their points may differ."""
    return int(np.sum(costs < 1.01 * least + 1e-12))


def _step(
    problem: MachineProblem, U: Array, costs: Array, damping: Array, apart: Array
) -> tuple[Array, Array, Array, Array]:
    """One step of each start: the best of several dampings. ``apart``: steps of the differences, now and next."""
    r, J = problem.slopes(U, apart)
    trials, trial_costs = _tried(problem, U, r, J, damping[:, None] * _DAMPINGS, 1.0)
    points, lanes, i = U.copy(), np.arange(len(U)), np.argmin(trial_costs, axis=1)
    least = trial_costs[lanes, i]
    better = least < costs
    points[better] = trials[lanes, i][better]
    after = np.where(better, np.clip(damping * _DAMPINGS[i], 1e-9, 1e6), np.minimum(damping * 1e3, 1e9))
    return points, np.where(better, least, costs), after, steps_of(J[int(np.argmin(costs))], problem.step)


def _tried(problem: MachineProblem, U: Array, r: Array, J: Array, dampings: Array, part: float) -> tuple[Array, Array]:
    """Trial points of each start by damping, and their costs.

    Narrow valleys are bent. So each trial is corrected once, by the difference of its residuals from their linear
    prediction. With the same Jacobian, this is a chord step, or geodesic acceleration at full length.
    """
    count, n = dampings.shape[1], U.shape[1]
    base = [(p, d) for p in range(len(U)) for d in dampings[p]]
    points = problem.repaired(np.array([U[p] + part * direction(r[p], J[p], U[p], problem, d) for p, d in base]))
    residuals = problem.residuals(points)
    again = [
        x + direction(y - r[p] - J[p] @ (x - U[p]), J[p], x, problem, d)
        for (p, d), x, y in zip(base, points, residuals, strict=True)
    ]
    corrected = problem.repaired(np.array(again))
    costs = np.stack([half_squares(residuals), half_squares(problem.residuals(corrected))])
    better = costs[1] < costs[0]
    points[better] = corrected[better]
    return points.reshape(len(U), count, n), costs.min(axis=0).reshape(len(U), count)


def steps_of(J: Array, most: float) -> Array:
    """Steps of differences that change the residuals by some deviations, with the other coordinates fixed.

    A longer step errs by the curvature: parameters that compensate each other by a factor of 1000 need columns accurate to
    less than its inverse.
    """
    size = np.sqrt(np.sum(J**2, axis=-2))
    steps = 2.0 ** np.floor(np.log2(_CHANGE / np.maximum(size, 1e-300)))  # the same points again after a new weighting
    return np.asarray(np.clip(steps, _SHORTEST, most))


def fine_slopes(problem: MachineProblem, u: Array, near: Array | None = None) -> Array:
    """The Jacobian at one point by central differences, whose steps are those of the Jacobian ``near`` it, where known.

    A test shows that exact slopes would move estimates by less than 2 % of their deviation. Sensitivity equations would need
    a new compiled system for each set of fitted parameters.

    A sampled controller that rounds its encoder makes the residuals jump. Over a short step the jumps look like a steep slope,
    so that the next step would be shorter still. Steps grow until the residuals change by as much as they should.
    """
    J = problem.slopes(u[None])[1][0] if near is None else near
    step = np.zeros(len(u))
    while np.any((longer := steps_of(J, _LONGEST)) > step):
        step = np.maximum(step, longer)
        J = problem.central(u, step)
    return J


def spread(J: Array, width: Array) -> Array:
    """The standard deviation of each coordinate, which is known to within its ``width`` without the residuals."""
    return np.sqrt(np.diag(covariance(J.T @ J + np.diag(width**-2.0))))


def covariance(A: Array) -> Array:
    """The inverse of a matrix of information, which may be singular."""
    size = np.sqrt(np.maximum(np.diag(A), 1e-30))
    values, vectors = np.linalg.eigh(A / np.outer(size, size))
    return np.asarray((vectors / np.maximum(values, 1e-12)) @ vectors.T / np.outer(size, size))


def left_step(problem: MachineProblem, u: Array, r: Array, J: Array) -> Array:
    """The step to the optimum of the linearized problem."""
    return direction(r, J, u, problem, _FAINT[0])


def settled(problem: MachineProblem, u: Array) -> Array:
    """The optimum near a point: from there, a step would move every fitted number by little of its deviation.

    The steps use central differences: errors of one-sided ones end a search beside the optimum, if a valley is many
    standard deviations long. Initial states may still creep along a valley that moves no fitted number.
    """
    if not problem.sought:
        return u
    asked = np.array([not c.nuisance for c in problem.sought])
    cost, J = float(half_squares(problem.residuals(u[None]))[0]), None
    for _ in range(_SETTLING):
        r, J = problem.residuals(u[None])[0], fine_slopes(problem, u, J)
        if np.all(abs(left_step(problem, u, r, J)) <= _CLOSE * spread(J, problem.high - problem.low), where=asked):
            break
        for part in _PARTS:
            trials, costs = _tried(problem, u[None], r[None], J[None], np.array([_FAINT]), part)
            best = int(np.argmin(costs))
            if costs[0, best] < cost:
                u, cost = trials[0, best], float(costs[0, best])
                break
        else:
            break
    return u


def moved_over(problem: MachineProblem, u: Array) -> Array:
    """A point at least as good: coordinates that lie at a bound, or bend a law's curve, are put elsewhere in their bounds.

    From there, all coordinates make a step. The bend of a Stribeck curve has minima at several places, and a coordinate at
    its bound may belong to another minimum.
    """
    width = problem.high - problem.low
    for i, c in enumerate(problem.sought):
        inside = _AT_BOUND * width[i] < u[i] - problem.low[i] < (1 - _AT_BOUND) * width[i]
        if c.nuisance or (inside and not c.bends):
            continue
        starts = np.repeat(u[None], _PLACES, axis=0)
        starts[:, i] = problem.low[i] + width[i] * (np.arange(_PLACES) + 0.5) / _PLACES
        starts = problem.repaired(starts)
        r, J = problem.slopes(starts)
        tried, costs = _tried(problem, starts, r, J, np.tile(_FAINT, (_PLACES, 1)), 1.0)
        best = np.unravel_index(int(np.argmin(costs)), costs.shape)
        if costs[best] < half_squares(problem.residuals(u[None]))[0]:
            u = tried[best]
    return u


def direction(r: Array, J: Array, u: Array, problem: MachineProblem, damping: float) -> Array:
    """The damped Gauss-Newton step. Coordinates that would leave their bounds are fixed."""
    if not (np.isfinite(r).all() and np.isfinite(J).all()):
        return np.zeros(len(u))
    A, g = J.T @ J, J.T @ r
    room = 1e-9 * (problem.high - problem.low)
    free = ~(((u <= problem.low + room) & (g > 0)) | ((u >= problem.high - room) & (g < 0)))
    while free.any():
        inner = A[np.ix_(free, free)]
        scale = np.sqrt(np.maximum(np.diag(inner), 1e-12 * max(float(np.diag(inner).max()), 1e-300)))
        inner = inner / np.outer(scale, scale) + damping * np.eye(int(free.sum()))
        step = np.zeros(len(u))
        step[free] = -np.linalg.lstsq(inner, g[free] / scale, rcond=1e-14)[0] / scale
        # a step that is cut at a bound need not descend where parameters compensate each other: solve for the others anew
        out = ((u <= problem.low + room) & (step < 0)) | ((u >= problem.high - room) & (step > 0))
        if not out.any():
            return step
        free &= ~out
    return np.zeros(len(u))
