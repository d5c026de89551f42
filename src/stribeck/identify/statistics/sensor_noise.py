"""What the noise of a measured position does to a fit of the force: the fit again, with as much noise once more.

The velocity that a simulation follows has the position's noise in it, which biases the bristles' stiffness and damping
towards what blurred motion shows; no residual tells that. Noise of the measured size is added to the motion once more and
passes the same filter: the optimum moves on by about as much as the first dose has moved it (simulation-extrapolation,
Cook and Stefanski, J. Am. Stat. Assoc. 89(428):1314-1328, 1994), and scatters as much.
"""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.data.filters import low_pass, spline_derivative
from stribeck.identify.log import Log
from stribeck.identify.models.dynamic_problem import VelocityProblem
from stribeck.identify.models.motion_problem import MotionProblem, raw, white_noise
from stribeck.identify.models.problem import Problem, linear_step

_DOSES = 4


def again_with_noise(problem: Problem, u: Array) -> tuple[Array, Array]:
    """How far the optimum ``u`` moves on the mean, and how much it scatters (inner coordinates); 0 where the motion was
    not filtered, so that its noise is not known."""
    nothing = np.zeros(len(u)), np.zeros(len(u))
    if not isinstance(problem, VelocityProblem) or problem.log.bandwidth is None:
        return nothing
    if problem.log.sources.get("unfiltered") is None:
        return nothing
    draw = np.random.default_rng(0)
    shifts = [found for _ in range(_DOSES) if (found := _moved(problem, u, draw)) is not None]
    if len(shifts) < 2:
        return nothing
    return np.mean(shifts, axis=0), np.std(shifts, axis=0, ddof=1)


def _moved(problem: VelocityProblem, u: Array, draw: np.random.Generator) -> Array | None:
    """The step of Gauss and Newton from the optimum to that with more noise."""
    noisy = problem.moving(_with_noise(problem.log, draw).velocity)
    slopes, misfit = noisy.sensitivities(u), noisy.misfit(u)
    if slopes is None or misfit is None:
        return None
    return np.asarray(-linear_step(slopes, misfit))


def again_with_force_noise(problem: MotionProblem, u: Array) -> Array:
    """How far the optimum of a fit of the motion moves on the mean where the measured force, and the motion by which weight
    and the like are told, have their noise once more."""
    deviation = white_noise(problem.log.force, list(problem.log.runs()))
    draw = np.random.default_rng(0)
    shifts = []
    for _ in range(_DOSES if deviation > 0 or problem.follows else 0):
        noisy = problem.driven(problem.with_force_noise(deviation, draw))
        if problem.follows:
            noisy = noisy.along(_with_noise(problem.log, draw))
        slopes, misfit = noisy.sensitivities(u), noisy.misfit(u)
        if slopes is not None and misfit is not None:
            shifts.append(-linear_step(slopes, misfit))
    return abs(np.asarray(np.mean(shifts, axis=0))) if len(shifts) > 1 else np.zeros(len(u))


def _with_noise(log: Log, draw: np.random.Generator) -> Log:
    """The record with noise of the measured size in its position and velocity once more, behind the same filter."""
    measured = log.sources.get("unfiltered")
    if measured is None or log.bandwidth is None:
        return log
    deviation = white_noise(raw(log, measured), list(log.runs()))
    position, velocity = log.position.copy(), log.velocity.copy()
    for rows in log.runs():
        noise = low_pass(deviation * draw.standard_normal(rows.stop - rows.start), log.bandwidth, log.step)
        if measured == "position":
            position[rows] += noise
        velocity[rows] += spline_derivative(noise, log.step) if measured == "position" else noise
    return log.with_columns(position=position, velocity=velocity)


def acceleration_of_full_band(problem: Problem, u: Array, slopes: Array) -> Array:
    """How far the optimum moves where the acceleration has all of the velocity's band: that of a fit is filtered lower,
    and its inertia lacks what break-aways and stops put into the force."""
    if not isinstance(problem, VelocityProblem) or problem.log.bandwidth is None:
        return np.zeros(len(u))
    log, mass = problem.log, problem.values(u).get("mass", 0.0)
    missing = np.zeros(len(log))
    for rows in log.runs():
        missing[rows] = mass * (spline_derivative(log.velocity[rows], log.step) - log.acceleration[rows])
    return np.asarray(abs(linear_step(slopes, missing[problem.rows])))
