"""How far the estimates hang on the filter of the measured motion.

A cut-off that is too low rounds off reversals, one that is too high leaves noise and encoder steps in the velocity; both
bias what the bristles' damping shows, and neither is seen in the residuals. With a cut-off lower by the square root of
two the first error about doubles and the second falls to a third, so that either shows as a shift of the estimates.
"""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from stribeck.arrays import Array
from stribeck.identify.data.filters import low_pass
from stribeck.identify.log import Log
from stribeck.identify.models.dynamic_problem import VelocityProblem
from stribeck.identify.models.motion_problem import MotionProblem
from stribeck.identify.models.problem import Problem, linear_step

_FEWEST = 8  # samples of a run
_LOWER = float(np.sqrt(0.5))
_COARSER = 0.6  # of the shift by twice the step: halving it takes three fifths or more of the error away
_WHOLE = 1.5  # of the shift: the error of the motion as it is, by noise; more than it, by rounding off


def filter_bias(problem: Problem, u: Array, slopes: Array) -> Array:
    """How far each inner coordinate may be off because of the motion's filter; 0 where there was none.

    One step of Gauss and Newton from the optimum ``u`` with its ``slopes`` towards that of the smoother motion.
    """
    nothing, other = np.zeros(len(u)), problem
    if isinstance(problem, VelocityProblem) and problem.log.bandwidth is not None:
        other = problem.moving(_smoother(problem.log))
    elif isinstance(problem, MotionProblem) and problem.follows and problem.log.bandwidth is not None:
        other = problem.along(smoother_log(problem.log))
    else:
        return nothing
    before, after = problem.outputs(u[None, :]), other.outputs(u[None, :])
    if before is None or after is None:
        return nothing
    shift = linear_step(slopes, after[0] - before[0])
    return np.asarray(_WHOLE * abs(shift))


def sampling(problem: Problem, u: Array, slopes: Array) -> Array:
    """How far each inner coordinate may be off because of what happens between samples, such as where a body stops: from
    the shift with every second sample alone, velocity and acceleration by splines between them."""
    if not isinstance(problem, VelocityProblem):
        return np.zeros(len(u))
    log = problem.log
    velocity, acceleration = log.velocity.copy(), log.acceleration.copy()
    for rows in log.runs():
        if rows.stop - rows.start < _FEWEST:
            continue
        t = log.step * np.arange(rows.stop - rows.start)
        at_every_second = CubicSpline(t[::2], log.position[rows][::2])
        velocity[rows] = at_every_second(t, 1)
        acceleration[rows] = CubicSpline(t[::2], velocity[rows][::2])(t, 1)
    before, after = problem.outputs(u[None, :]), problem.moving(velocity).outputs(u[None, :])
    if before is None or after is None:
        return np.zeros(len(u))
    inertia = problem.values(u).get("mass", 0.0) * (acceleration - log.acceleration)[problem.rows]
    shift = linear_step(slopes, after[0] - before[0] + inertia)
    return np.asarray(_COARSER * abs(shift))


def smoother_log(log: Log) -> Log:
    """The log with position, velocity and acceleration of a lower cut-off."""
    position = _smoothed(log, log.position, False)
    acceleration = _smoothed(log, log.acceleration, "differences" in log.sources.get("acceleration", ""))
    return log.with_columns(position=position, velocity=_smoother(log), acceleration=acceleration)


def _smoother(log: Log) -> Array:
    """The velocity with a lower cut-off, as it is at the ends of runs."""
    return _smoothed(log, log.velocity, "differences" in log.sources.get("velocity", ""))


def _smoothed(log: Log, x: Array, differences: bool) -> Array:
    """A column with a lower cut-off; differences with their error, of the second order, once more."""
    assert log.bandwidth is not None
    found = x.copy()
    edge = round(1 / (log.bandwidth * log.step))
    for rows in log.runs():
        inside = slice(rows.start + edge, rows.stop - edge)
        if inside.stop - inside.start > edge:
            found[inside] = low_pass(x[rows], _LOWER * log.bandwidth, log.step)[edge:-edge]
            if differences:
                found[inside][1:-1] += np.diff(found[inside], 2) / 6
    return found
