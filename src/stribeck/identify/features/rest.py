"""Rest: stretches in which the body stands and only noise moves, and what force it was held by there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_opening

from stribeck.arrays import Array
from stribeck.identify.features.filtering import typical_roughness
from stribeck.identify.log import MANY_ROWS, Log

Mask = NDArray[np.bool_]
_WINDOW, _SHORTEST = 0.02, 10  # s, rows of a look: shorter than any stop of an axis, and enough rows for a mean
_WINDOWS = 3  # looks in a row make a rest: one alone may be a slow reversal
_SLOW = 0.02  # of the fastest speed: what noise may reach at rest
_NOISES = 4.0  # standard deviations: of a look's tens of rows, noise alone reaches it in none


def at_rest(log: Log) -> Mask:
    """The rows in which the body stands: no way is made beyond the noise, and the speed is no more than its noise.

    A motion that is slow but steady makes way, and is none; neither is the moment of a reversal.
    """
    out = np.zeros(len(log), bool)
    fastest = float(np.quantile(abs(log.velocity[:: max(len(log) // 200_000, 1)]), 0.99))
    noise = _noise(log)
    window = max(_SHORTEST, round(_WINDOW / log.step) if log.step else _SHORTEST)
    if log.bandwidth and log.step:  # what a filter has smeared is one look
        window = max(window, round(1.0 / (log.bandwidth * log.step)))
    for rows in log.runs():
        count = (rows.stop - rows.start) // window
        if count < _WINDOWS:
            continue
        v = log.velocity[rows][: count * window].reshape(count, window)
        peak, mean = np.max(abs(v), axis=1), _with_neighbours(np.mean(v, axis=1))
        limit = min(_NOISES * noise, _SLOW * fastest)
        still = (peak <= limit) & (abs(mean) <= _NOISES * noise / np.sqrt(window) + noise / 3)
        still |= peak == 0
        long = np.repeat(binary_opening(still, np.ones(_WINDOWS, bool)), window)  # those in a row
        out[rows.start : rows.start + len(long)] = long
        if long.any():
            _to_its_ends(out[rows], log.velocity[rows], limit, 2 * window)
        for one, speed in ((out[rows], log.velocity[rows]), (out[rows][::-1], log.velocity[rows][::-1])):
            _at_an_edge(one, speed, limit, window)
    return out


def _at_an_edge(rest: Mask, v: Array, limit: float, window: int) -> None:
    """Rest at the start of a run (in place), of which the settling of the filter may have left less than a look; and where rest
    is found behind, what the filter makes of the edge."""
    moves = abs(v[:window]) > limit
    rest[: int(np.argmax(moves)) if moves.any() else 0] = True
    resting = np.flatnonzero(rest[: window + 1])
    rest[: int(resting[-1]) if len(resting) else 0] = True


def _with_neighbours(mean: Array) -> Array:
    """The mean over three looks in a row: a filter's noise hardly changes in one, so that its own mean is noisy."""
    padded = np.concatenate([mean[:1], mean, mean[-1:]])
    return np.asarray((padded[:-2] + padded[1:-1] + padded[2:]) / 3)


def _to_its_ends(rest: Mask, v: Array, limit: float, window: int) -> None:
    """Widen each rest of a run, in place, by the rows next to it that are as slow, a window at most."""
    edges = np.flatnonzero(np.diff(rest, prepend=False, append=False)).tolist()
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        before, behind = abs(v[max(first - window, 0) : first])[::-1] > limit, abs(v[last : last + window]) > limit
        rest[first - (int(np.argmax(before)) if before.any() else len(before)) : first] = True
        rest[last : last + (int(np.argmax(behind)) if behind.any() else len(behind))] = True


def _noise(log: Log) -> float:
    """The standard deviation of the velocity's noise: from the raw motion's floor, and from the velocity itself."""
    v = log.velocity
    white = typical_roughness([v[: 2 * MANY_ROWS]])
    if log.spectrum is None or not log.bandwidth:
        return white
    floor, edge = log.spectrum[2], log.bandwidth
    if "differences" in log.sources.get("velocity", ""):
        colored = np.sqrt(floor * (2 * np.pi) ** 2 * edge**3 / 3)
    else:
        colored = np.sqrt(floor * edge)
    return float(max(white, colored))
