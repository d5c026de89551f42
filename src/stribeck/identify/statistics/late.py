"""A delay that a fit by simulation was not asked for: whether its residual asks for one, and where that would put the numbers.

A motion that lags the force by a part of a sample already leaves more than a good sensor's noise, and it is made up for by
the numbers that are free: damping falls with it, and the bristles' stiffness moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.methods.blockwise import solve_blocks
from stribeck.identify.models.dynamic_problem import VelocityProblem
from stribeck.identify.models.motion_problem import MotionProblem
from stribeck.identify.models.problem import Problem
from stribeck.identify.statistics.correlated import covariance, noise_memory

_SURE = 3.0  # deviations: a delay that is told worse is none
_SHARE = 0.005  # of the squared residual: a delay that takes less away is not spoken of
_TOLERANCE, _EVALUATIONS = 1e-5, 40
_REACH = 1.5  # of the shift: intervals reach beyond where a fit with the delay puts the numbers
_MOST = 0.2  # of the logarithm: what the delay moves farther is not told


@dataclass(frozen=True)
class Late:
    """The delay, s, that a residual asks for; the share of its square that it would take away; by how much each coordinate
    of the fit would move."""

    delay: float
    share: float
    shift: Array

    @property
    def bias(self) -> Array:
        """How far each coordinate may be off without it."""
        return _REACH * abs(self.shift)

    @property
    def told(self) -> str:
        """In words, for a note; nothing where it takes hardly any of the residual away."""
        if self.share <= _SHARE:
            return ""
        return (
            f"a delay of {1e3 * self.delay:.3g} ms of the motion would take {self.share:.0%} of the squared residual away, "
            "and move the others: fit it as a term"
        )

    def doubt(self, k: int, log: bool) -> str:
        """Why a coordinate is not told, or nothing."""
        if not log or abs(self.shift[k]) <= _MOST:
            return ""
        return f"a delay that was not fitted would shift it by {np.expm1(abs(self.shift[k])):.0%}"


def asked(problem: Problem, u: Array) -> Late | None:
    """The delay that the residual at the optimum ``u`` asks for; None where it is a term, or none is asked for."""
    inverse = problem.inverse if isinstance(problem, MotionProblem) else problem
    if not isinstance(inverse, VelocityProblem) or inverse.late:
        return None
    made = inverse.with_delay()
    if made is None:
        return None
    with_it, first = made
    wider: Problem = with_it
    if isinstance(problem, MotionProblem):
        wider = problem.with_inverse(with_it)
    k = [c.name for c in wider.coordinates].index("delay")
    values = {**problem.values(u), "delay": 0.0}
    start = wider.from_values(values) if isinstance(wider, MotionProblem) else wider.point(values)
    none = solve_blocks(wider, start, _TOLERANCE, _EVALUATIONS, held=[k])
    found = none
    for delay in dict.fromkeys((0.0, first)):
        there = none.point.copy()
        there[k] = wider.coordinates[k].inner(delay)
        some = solve_blocks(wider, there, _TOLERANCE, _EVALUATIONS)
        found = some if some.cost < found.cost else found
    share, delay = 1 - found.cost / max(none.cost, 1e-300), wider.coordinates[k].outer(float(found.point[k]))
    if share <= 0 or abs(delay) < _SURE * _deviation(wider, found.point, k):
        return None
    moved = {c.name: float(x) for c, x in zip(wider.coordinates, found.point - none.point, strict=True)}
    own = [0.0 if c.nuisance else moved[c.name] for c in problem.coordinates]
    return Late(delay, share, np.array(own))


def _deviation(problem: Problem, u: Array, k: int) -> float:
    """The standard deviation of a coordinate's value, by the residual and what it remembers; infinite where it fails."""
    slopes, misfit = problem.sensitivities(u), problem.misfit(u)
    if slopes is None or misfit is None:
        return float("inf")
    variance = float(misfit @ misfit) / max(len(misfit) - len(u), 1)
    inner = covariance(slopes, variance, noise_memory(misfit))[k, k]
    return float(np.sqrt(inner)) * problem.coordinates[k].scale if inner > 0 else float("inf")
