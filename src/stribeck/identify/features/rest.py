"""Rest: stretches in which the body stands and only noise moves, and what force it was held by there."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.log import Log

Mask = NDArray[np.bool_]
_WINDOW, _SHORTEST = 0.02, 10  # s, rows: of a look
_WINDOWS = 3  # in a row make a rest
_SLOW = 0.02  # of the fastest speed: what noise may reach at rest
_NOISES = 4.0


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
        peak, mean = np.max(abs(v), axis=1), abs(np.mean(v, axis=1))
        still = (peak <= min(_NOISES * noise, _SLOW * fastest)) & (
            mean <= _NOISES * noise / np.sqrt(window) + noise / 3
        )
        still |= peak == 0
        long = _long(still)
        out[rows.start : rows.start + count * window] = np.repeat(long, window)
    return out


def _long(still: Mask) -> Mask:
    """The looks of one kind that stand in a row of at least three."""
    edges = np.flatnonzero(np.diff(still, prepend=False, append=False))
    out = np.zeros(len(still), bool)
    for first, last in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if last - first >= _WINDOWS:
            out[first:last] = True
    return out


def _noise(log: Log) -> float:
    """The standard deviation of the velocity's noise: from the raw motion's floor, and from the velocity itself."""
    v = log.velocity
    white = float(1.4826 * np.median(abs(np.diff(v[:2_000_000], 3))) / np.sqrt(20.0)) if len(v) > 10 else 0.0
    if log.spectrum is None or not log.bandwidth:
        return white
    floor, edge = log.spectrum[2], log.bandwidth
    if "differences" in log.sources.get("velocity", ""):
        told = np.sqrt(floor * (2 * np.pi) ** 2 * edge**3 / 3)
    else:
        told = np.sqrt(floor * edge)
    return float(max(white, told))


def held_force(log: Log, rest: Mask, beside: Array | float = 0.0) -> float | None:
    """The largest force that friction held at rest, N; None where the body never rests.

    Args:
        beside: what of the force is not friction's, such as an offset or gravity.
    """
    if int(rest.sum()) < _WINDOWS * _SHORTEST:
        return None
    force = abs(log.force - beside)[rest]
    return float(np.quantile(force, 0.98))
