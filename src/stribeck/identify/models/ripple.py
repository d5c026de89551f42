"""Where a ripple of the force over the position is looked for: how many waves, by what a residual shows of each."""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.log import Log

_FEWEST = 1.0  # waves on the way: less than one determines no wave
_BAND = 0.4  # of the rate of the rows that are compared: what passes their filter
_CELLS = 8  # of a wave, into which the way is cut
_MOST_CELLS = 1 << 17  # a transform of so many takes some milliseconds
_FINER = 4  # than the width of a peak


def range_of(log: Log, q: int) -> tuple[float, float] | None:
    """The fewest and the most waves (1/m) that a record, of which one row in ``q`` is compared, can show; None for none."""
    way, usual = float(np.ptp(log.position)), float(np.median(abs(log.velocity)))
    if not (way > 0 and usual > 0 and log.step):
        return None
    low = 2 * np.pi * _FEWEST / way
    high = min(2 * np.pi * _BAND / (q * log.step * usual), 2 * np.pi * _MOST_CELLS / (_CELLS * way))
    return (low, high) if high > 2 * low else None


def peaks(position: Array, left: Array, low: float, high: float, most: int) -> list[float]:
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
