"""The motion behind a lower cut-off: what a form may lack that is the filter's."""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.data.filters import low_pass
from stribeck.identify.log import Log

_LOWER = float(np.sqrt(0.5))


def smoother_log(log: Log) -> Log:
    """The log with position, velocity and acceleration of a lower cut-off."""
    position = _smoothed(log, log.position, False, log.bandwidth)
    differences = "differences" in log.sources.get("acceleration", "")
    acceleration = _smoothed(log, log.acceleration, differences, log.acceleration_bandwidth or log.bandwidth)
    return log.with_columns(position=position, velocity=_smoother(log), acceleration=acceleration)


def _smoother(log: Log) -> Array:
    """The velocity with a lower cut-off, as it is at the ends of runs."""
    return _smoothed(log, log.velocity, "differences" in log.sources.get("velocity", ""), log.bandwidth)


def _smoothed(log: Log, x: Array, differences: bool, bandwidth: float | None) -> Array:
    """A column of this bandwidth with a lower cut-off; differences with their error, of the second order, once more."""
    assert bandwidth is not None
    found = x.copy()
    edge = round(1 / (bandwidth * log.step))
    for rows in log.runs():
        inside = slice(rows.start + edge, rows.stop - edge)
        if inside.stop - inside.start > edge:
            found[inside] = low_pass(x[rows], _LOWER * bandwidth, log.step)[edge:-edge]
            if differences:
                found[inside][1:-1] += np.diff(found[inside], 2) / 6
    return found
