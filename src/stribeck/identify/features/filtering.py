"""Variants of a log that show the effect of noise and of the filter on estimates."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.data.filters import low_pass, spline_derivative
from stribeck.identify.log import MOTION, Log

_LOWER = float(np.sqrt(0.5))  # of the cut-off: doubles a filter's bias, which goes with its inverse square
_MEDIAN = 0.6745  # of the absolute value of a normal variable, in standard deviations
_DRAWS = 6  # of the motion's noise: six draws give a standard deviation to 30 %


def other_motions(log: Log) -> dict[str, list[Log]]:
    """Variants of a log with a filtered motion, by cause: noise added once more, and a lower cut-off."""
    if log.bandwidth is None:
        return {}
    rng, deviation = np.random.default_rng(0), math.sqrt((log.noise or 0.0) / (2 * log.step))  # of white noise
    return {
        "noise of the motion": [_noisier(log, deviation, rng) for _ in range(_DRAWS)],
        "filter of the motion": [smoother_log(log)],
    }


def roughness(parts: Sequence[Array], order: int = 3, typical: bool = False) -> float:
    """The noise of a column's pieces from their differences of this order, of which a higher one removes more of the motion.

    ``typical``: by the median, which outliers do not move.
    """
    differences = np.concatenate([np.diff(x, order) for x in parts])
    if not len(differences):
        return 0.0
    size = np.median(abs(differences)) / _MEDIAN if typical else np.sqrt(np.mean(differences**2))
    return float(size) / math.sqrt(math.comb(2 * order, order))


def _noisier(log: Log, deviation: float, rng: np.random.Generator) -> Log:
    """The log with filtered noise of the same density added to its motion."""
    assert log.bandwidth is not None
    position, velocity, acceleration = log.position.copy(), log.velocity.copy(), log.acceleration.copy()
    by_position = log.sources.get("unfiltered") == "position"
    for rows in log.runs():
        if rows.stop - rows.start <= round(1 / (log.bandwidth * log.step)):
            continue  # shorter than the filter
        noise = low_pass(deviation * rng.standard_normal(rows.stop - rows.start), log.bandwidth, log.step, log.order)
        of_velocity = spline_derivative(noise, log.step) if by_position else noise
        of_acceleration = spline_derivative(of_velocity, log.step)
        position[rows] += noise if by_position else 0.0
        velocity[rows] += of_velocity
        acceleration[rows] += of_acceleration
    return log.with_columns(position=position, velocity=velocity, acceleration=acceleration)


def smoother_log(log: Log) -> Log:
    """The log with position, velocity and acceleration at a lower cut-off."""
    assert log.bandwidth is not None
    motion = {n: _smoothed(log, getattr(log, n), log.bandwidth) for n in MOTION}
    return log.with_columns(**motion, bandwidth=_LOWER * log.bandwidth)


def _smoothed(log: Log, x: Array, bandwidth: float) -> Array:
    """A column of this bandwidth at a lower cut-off; the ends of runs stay unchanged."""
    smoothed = x.copy()
    edge = round(1 / (bandwidth * log.step))
    for rows in log.runs():
        inside = slice(rows.start + edge, rows.stop - edge)
        if inside.stop - inside.start > edge:
            smoothed[inside] = low_pass(x[rows], _LOWER * bandwidth, log.step)[edge:-edge]
    return smoothed
