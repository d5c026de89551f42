"""Levenberg-Marquardt least squares from many starts, with all trials simulated in parallel.

SciPy's ``least_squares`` takes one start and one step at a time. Here the Jacobians of all starts, and several dampings of
each step, are simulated together. The worst starts are given up after each step.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.work import Stopped

_DAMPINGS = np.array([1e-4, 1e-2, 1.0, 30.0, 1e3])
_KEEP = (10, 6, 4, 3, 2, 2, 1)  # starts that continue after each step
_WIDE = 4
_STEPS = 40
SMALL = 1e-7  # relative reduction of the cost below which the search ends
_HUGE = 1e300
_OF_DEVIATION, _BETWEEN = 0.3, (1e-5, 2e-2)  # steps of central differences: of a standard deviation, within limits
_SETTLING, _PARTS = 20, (1.0, 0.5, 0.25)  # final steps; tried parts of each
_FAINT = (
    1e-9,
    1e-6,
    1e-4,
    1e-2,
)  # dampings: parameters correlated to within 1e-6 form a valley, along which only small dampings step
_TENTH = 0.5 * 0.1**2  # reduction of half the sum of squares by a move of a tenth of a standard deviation


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
    return np.where(np.isfinite(total), total, _HUGE)


def search(
    problem: MachineProblem, starts: int, seed: int, first: Array | None = None,
    keep: Callable[[Array, float], None] | None = None, more: Sequence[Array] = (), wide: bool = False, steps: int = _STEPS,
    small: float = SMALL,
) -> Found:  # fmt: skip
    """The best point from several starts: ``first`` (or the machine's), ``more``, and others spread over the bounds.

    Args:
        starts: number of starts without ``more``.
        wide: converge several starts.
        small: relative reduction of the cost below which the search ends.

    Ctrl-C, and ``Work.stop``, end the search with the best point so far.
    """
    begin = [problem.start() if first is None else first]
    if not problem.sought:  # a machine without its friction, for comparison
        return Found(begin[0], float(half_squares(problem.residuals(begin[0][None]))[0]))
    best = Found(begin[0], _HUGE, 1, True)
    try:
        if starts > 1:
            spread = qmc.LatinHypercube(len(problem.sought), rng=np.random.default_rng(seed)).random(starts - 1)
            local = np.array([c.nuisance or c.output is not None for c in problem.sought])
            U = problem.low + spread * (problem.high - problem.low)
            U[:, local] = begin[0][local]  # known roughly already
            U = np.concatenate([np.array(begin), U])
        else:
            U = np.array(begin)
        U = problem.repaired(np.concatenate([U, *(x[None] for x in more)]))
        costs = half_squares(problem.residuals(U))
        order = np.argsort(costs)[: _KEEP[0]]
        if 0 not in order:
            order = np.append(order[:-1], 0)
        U, costs = U[order], costs[order]
        damping, quiet = np.full(len(U), 1e-2), np.zeros(len(U), int)
        for step in range(steps):
            i = int(np.argmin(costs))
            best = Found(U[i].copy(), float(costs[i]), agreeing(costs, costs[i]), True)
            if keep is not None:
                keep(best.u, best.cost)
            if costs[i] >= _HUGE and step:
                break
            U, new, damping = _step(problem, U, costs, damping)
            fall = costs - new
            quiet = np.where(fall > small * new, 0, quiet + np.where(fall > 0, 2, 1))
            costs = new
            most = _KEEP[min(step, len(_KEEP) - 1)]
            going = np.argsort(costs)[: max(most, _WIDE) if wide else most]
            U, costs, damping, quiet = U[going], costs[going], damping[going], quiet[going]
            if quiet[int(np.argmin(costs))] >= 2:
                break
        i = int(np.argmin(costs))
        rest = tuple(U[j] for j in np.argsort(costs)[1:])
        return Found(U[i], float(costs[i]), max(best.agreeing, agreeing(costs, costs[i])), False, rest)
    except (KeyboardInterrupt, Stopped):
        problem.work.stop()
        return best


def agreeing(costs: Array, least: float) -> int:
    """The number of starts with as low a cost. In a flat valley their points may differ."""
    return int(np.sum(costs < 1.01 * least + 1e-12))


def _step(problem: MachineProblem, U: Array, costs: Array, damping: Array) -> tuple[Array, Array, Array]:
    """One step of each start: the best of several dampings."""
    n = U.shape[1]
    r, J = problem.slopes(U, np.full(n, problem.step))
    trials = [
        U[p] + direction(r[p], J[p], U[p], problem, damping[p] * share) for p in range(len(U)) for share in _DAMPINGS
    ]
    tried = problem.repaired(np.array(trials))
    found = half_squares(problem.residuals(tried)).reshape(len(U), -1)
    tried = tried.reshape(len(U), -1, n)
    new, out, after = costs.copy(), U.copy(), damping.copy()
    for p in range(len(U)):
        i = int(np.argmin(found[p]))
        if found[p, i] < costs[p]:
            out[p], new[p] = tried[p, i], found[p, i]
            after[p] = float(np.clip(damping[p] * _DAMPINGS[i], 1e-9, 1e6))
        else:
            after[p] = min(damping[p] * 1e3, 1e9)
    return out, new, after


def fine_slopes(problem: MachineProblem, u: Array) -> Array:
    """The Jacobian at one point by central differences, with steps below each coordinate's standard deviation."""
    J = problem.slopes(u[None], np.full(len(u), problem.step))[1][0]
    size = np.sqrt(np.maximum(np.sum(J**2, axis=0), 1e-300))
    variance = np.diag(np.linalg.pinv((J / size).T @ (J / size), rcond=1e-12, hermitian=True)) / size**2
    return problem.central(u, np.clip(_OF_DEVIATION * np.sqrt(np.maximum(variance, 0.0)), *_BETWEEN))


def settled(problem: MachineProblem, u: Array) -> tuple[Array, bool]:
    """The point from which no further step gains a tenth of a standard deviation, and whether it was reached.

    The steps use central differences. Errors of one-sided differences end a search beside the optimum, if a valley is
    many standard deviations long. In a narrow, bent valley each step is short, and the last one may still gain.
    """
    cost = float(half_squares(problem.residuals(u[None]))[0])
    for _ in range(_SETTLING):
        r, J = problem.residuals(u[None])[0], fine_slopes(problem, u)
        trials = np.array([u + part * direction(r, J, u, problem, d) for d in _FAINT for part in _PARTS])
        trials = problem.repaired(trials)
        costs = half_squares(problem.residuals(trials))
        best = int(np.argmin(costs))
        if not costs[best] < cost - _TENTH:
            return u, True
        u, cost = trials[best], float(costs[best])
    return u, False


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
