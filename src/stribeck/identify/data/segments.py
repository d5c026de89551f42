"""Stretches of constant speed, found in a log."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stribeck.identify.log import Log

Array = NDArray[np.float64]
_SHORTEST = 40  # rows
_SPREAD = 0.04  # of the speed: what it may vary by within a stretch
_SETTLING = 0.3  # of a stretch, left out at its start
_SLOWEST = 1e-3  # of the fastest: below, the body counts as at rest


def constant_speed(log: Log) -> list[slice]:
    """The stretches in which the speed stays within 4 % (and the noise), without their settling."""
    v = log.velocity
    fastest = float(np.quantile(abs(v), 0.99))
    noise = 3 * float(np.median(abs(np.diff(v, 2)))) if len(v) > 2 else 0.0
    found = []
    for rows in log.runs():
        values = v[rows].tolist()
        first, low, high = 0, values[0], values[0]
        for i in range(1, len(values) + 1):
            if i < len(values):
                low, high = min(low, values[i]), max(high, values[i])
                room = _SPREAD * abs(low + high) / 2 + noise
                if high - low <= room:
                    continue
            if i - first >= _SHORTEST and abs(sum(values[first:i]) / (i - first)) > _SLOWEST * fastest:
                start = first + int(_SETTLING * (i - first))
                found.append(slice(rows.start + start, rows.start + i))
            if i < len(values):
                first, low, high = i, values[i], values[i]
    return found


def distinct_speeds(log: Log, segments: list[slice]) -> int:
    """How many different speeds there are, those within 10 % being one."""
    speeds = np.sort([abs(float(np.mean(log.velocity[s]))) for s in segments])
    return int(np.sum(np.diff(np.log(speeds)) > np.log(1.1))) + 1 if len(speeds) else 0
