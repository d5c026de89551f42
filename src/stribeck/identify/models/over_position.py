"""What the friction and the force of a record do over the position: reversals, and forces that repeat."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.data.filters import HIGHEST
from stribeck.identify.log import Log

_CELLS = 8  # of the shortest wave, into which the way is cut: they take 3 % of its amplitude away
_MOST_CELLS = 1 << 17  # a transform of so many takes some milliseconds
_FINER = 4  # points of the spectrum within the width of a peak: its top lies 3 % below the true one at most


def travel(position: Array, velocity: Array) -> float:
    """The travel between reversals: half of the total travel is in longer strokes."""
    moving = np.flatnonzero(np.sign(velocity))
    turn = moving[1:][np.diff(np.sign(velocity[moving])) != 0]
    ways = np.sort(abs(np.diff(position[turn]))) if len(turn) > 1 else np.array([np.ptp(position)])
    gone = np.cumsum(ways)
    return float(ways[np.searchsorted(gone, 0.5 * gone[-1])])


def direction_along(log: Log, way: float) -> Array:
    """Which part of the friction has which direction in each run of a record, see :func:`direction_within`."""
    first = [(run, float(log.velocity[run.start]), float(log.acceleration[run.start])) for run in log.runs()]
    return np.concatenate([direction_within(log.position[run], v, a, way) for run, v, a in first])


def direction_within(y: Array, v: float, a: float, way: float) -> Array:
    """Which part of the friction has which direction: from -1 (all of it that of motion backwards) to 1.

    Behind a reversal it changes in proportion to the way, and is turned round after ``way`` (the stop operator). Between two
    reversals of the position it is known in closed form, so that only these are gone through one by one.

    Args:
        y: the position; ``v``, ``a``: the first speed and acceleration. A body that speeds up came back a while ago, by
            its acceleration v^2/(2 a) before.
    """
    since = 0.5 * v * v / abs(a) if v * a > 0 else way
    state = [float(np.sign(v)) * min(2 * since / way - 1, 1.0)]
    turns = np.flatnonzero(np.diff(np.sign(np.diff(y)))) + 1
    first = np.concatenate([[0], turns])
    for before, now in pairwise(y[first].tolist()):
        state.append(min(max(state[-1] + 2 * (now - before) / way, -1.0), 1.0))
    part = np.searchsorted(turns, np.arange(len(y)), side="right")
    return np.asarray(np.clip(np.array(state)[part] + 2 * (y - y[first][part]) / way, -1.0, 1.0))


def ripple_range(log: Log, q: int) -> tuple[float, float] | None:
    """The fewest and the most waves (1/m) that a record, of which one row in ``q`` is compared, can show; None for none."""
    way, usual = float(np.ptp(log.position)), float(np.median(abs(log.velocity)))
    if not (way > 0 and usual > 0):
        return None
    low = 2 * np.pi / way  # less than one wave on the way determines none
    high = min(2 * np.pi * HIGHEST / (q * log.step * usual), 2 * np.pi * _MOST_CELLS / (_CELLS * way))
    return (low, high) if high > 2 * low else None


def ripple_waves(position: Array, left: Array, low: float, high: float, most: int) -> list[float]:
    """The waves, at most so many, of which a residual holds most, the largest first.

    The residual is summed up in cells of the way, whose spectrum, by a fast Fourier transform, is that of the rows.
    """
    way = float(np.ptp(position))
    cells = max(int(np.ceil(_CELLS * high * way / (2 * np.pi))), 1)
    where = np.minimum((cells * (position - position.min()) / way).astype(np.intp), cells - 1)
    count = _FINER * cells
    power = abs(np.fft.rfft(np.bincount(where, left - left.mean(), cells), count))
    waves = 2 * np.pi * np.arange(len(power)) * cells / (count * way)
    power = np.where((waves >= low) & (waves <= high), power, 0.0)
    wave_numbers: list[float] = []
    while len(wave_numbers) < most and power.any():
        wave_numbers.append(float(waves[int(np.argmax(power))]))
        power[abs(waves - wave_numbers[-1]) < 4 * np.pi / way] = 0.0
    return wave_numbers
