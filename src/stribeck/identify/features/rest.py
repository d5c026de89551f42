"""Rest: rows of a log in which the body stands still and the velocity is noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_opening

from stribeck.arrays import Array
from stribeck.identify.features.filtering import roughness
from stribeck.identify.log import MANY_ROWS, Log, stretches, thinned

Mask = NDArray[np.bool_]
_WINDOW, _SHORTEST = 0.02, 10  # s, rows of a window: shorter than a stop of an axis, with enough rows for a mean
_WINDOWS = 3  # consecutive windows that make a rest: a single one may be a slow reversal
_SLOW = 0.02  # of the fastest speed: largest noise at rest
_NOISES = 4.0  # standard deviations: noise alone does not reach it in a window of tens of rows


def at_rest(log: Log) -> Mask:
    """The rows in which the body stands still: displacement and speed do not exceed their noise.

    Slow steady motion and the moment of a reversal are not rest.
    """
    out = np.zeros(len(log), bool)
    fastest = float(np.quantile(abs(thinned(log).velocity), 0.99))
    noise = _noise(log)
    window = max(_SHORTEST, round(_WINDOW / log.step))
    if log.bandwidth:  # at least the length of the filter's response
        window = max(window, round(1.0 / (log.bandwidth * log.step)))
    for rows in log.runs():
        count = (rows.stop - rows.start) // window
        if count < _WINDOWS:
            continue
        v = log.velocity[rows][: count * window].reshape(count, window)
        peak, mean = np.max(abs(v), axis=1), _with_neighbors(np.mean(v, axis=1))
        limit = min(_NOISES * noise, _SLOW * fastest)
        still = (peak <= limit) & (abs(mean) <= _NOISES * noise / np.sqrt(window) + noise / 3)
        still |= peak == 0
        long = np.repeat(binary_opening(still, np.ones(_WINDOWS, bool)), window)  # of consecutive windows only
        out[rows.start : rows.start + len(long)] = long
        if long.any():
            _to_its_ends(out[rows], log.velocity[rows], limit, 2 * window)
        for one, speed in ((out[rows], log.velocity[rows]), (out[rows][::-1], log.velocity[rows][::-1])):
            _at_an_edge(one, speed, limit, window)
    return out


def _at_an_edge(rest: Mask, v: Array, limit: float, window: int) -> None:
    """Mark rest at the start of a run, in place.

    The settling of the filter may have left less than a window there. Rows before a rest are an effect of the filter, and
    are rest too.
    """
    moves = abs(v[:window]) > limit
    rest[: int(np.argmax(moves)) if moves.any() else 0] = True
    resting = np.flatnonzero(rest[: window + 1])
    rest[: int(resting[-1]) if len(resting) else 0] = True


def _with_neighbors(mean: Array) -> Array:
    """The mean over three consecutive windows: filtered noise hardly changes within one, so one mean is too noisy."""
    padded = np.concatenate([mean[:1], mean, mean[-1:]])
    return np.asarray((padded[:-2] + padded[1:-1] + padded[2:]) / 3)


def _to_its_ends(rest: Mask, v: Array, limit: float, window: int) -> None:
    """Extend each rest of a run, in place, by adjacent rows that are as slow, by one window at most."""
    for first, last in stretches(rest).tolist():
        before, behind = abs(v[max(first - window, 0) : first])[::-1] > limit, abs(v[last : last + window]) > limit
        rest[first - (int(np.argmax(before)) if before.any() else len(before)) : first] = True
        rest[last : last + (int(np.argmax(behind)) if behind.any() else len(behind))] = True


def _noise(log: Log) -> float:
    """The standard deviation of the velocity's noise, from the noise floor of the raw motion and from the velocity."""
    white = roughness([log.velocity[: 2 * MANY_ROWS]], typical=True)
    if log.noise is None or not log.bandwidth:
        return white
    edge = log.bandwidth  # noise of a position is multiplied by the square of the angular frequency
    by_rate = (2 * np.pi) ** 2 * edge**3 / 3 if log.sources.get("unfiltered") == "position" else edge
    return float(max(white, np.sqrt(log.noise * by_rate)))
