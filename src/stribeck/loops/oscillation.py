"""Amplitude and period of a sustained oscillation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array


def amplitude_and_period(t: Array, y: Array) -> tuple[Array, Array]:
    """Half of peak to peak, and the mean time between upward crossings of the middle, interpolated between rows.

    Times are along the last axis of ``y``, which may contain several trajectories. The period is nan if there are fewer
    than two upward crossings.
    """
    highest, lowest = y.max(axis=-1), y.min(axis=-1)
    if len(t) < 2:
        return 0.5 * (highest - lowest), np.full(y.shape[:-1], np.nan)[()]
    over = np.atleast_2d(y - (0.5 * (highest + lowest))[..., np.newaxis])
    up = (over[:, :-1] < 0) & (over[:, 1:] >= 0)
    count, lanes = up.sum(axis=1), np.arange(len(over))

    def crossing(i: NDArray[np.intp]) -> Array:
        before, after = over[lanes, i], over[lanes, i + 1]
        with np.errstate(all="ignore"):  # lanes without a crossing
            return np.asarray(t[i] + (t[i + 1] - t[i]) * before / (before - after))

    first, last = crossing(up.argmax(axis=1)), crossing(up.shape[1] - 1 - up[:, ::-1].argmax(axis=1))
    period = np.where(count > 1, (last - first) / np.maximum(count - 1, 1), np.nan)
    return 0.5 * (highest - lowest), period.reshape(y.shape[:-1])[()]
