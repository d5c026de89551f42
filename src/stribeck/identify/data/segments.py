"""Stretches of constant speed, found in a log."""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.log import Log

_SHORTEST = 60  # rows
_BLOCK = 20  # rows whose mean is looked at: ripple and noise average out
_SPREAD = 0.04  # of the speed: what a block's mean may be off
_NOISES = 4.0
_SETTLING = 0.3  # of a stretch, left out at its start
_SLOWEST = 1e-3  # of the fastest: below, the body counts as at rest


def constant_speed(log: Log) -> list[slice]:
    """The stretches in which the speed, averaged over twenty rows, stays within 4 % (and its noise), without their
    settling."""
    fastest = float(np.quantile(abs(log.velocity), 0.99))
    found = []
    for rows in log.runs():
        count = (rows.stop - rows.start) // _BLOCK
        if count * _BLOCK < _SHORTEST:
            continue
        means = log.velocity[rows][: count * _BLOCK].reshape(count, _BLOCK).mean(axis=1)
        noise = _NOISES * float(np.median(abs(np.diff(means, 2)))) / 2 if count > 2 else 0.0
        ends = [*_stretches(means, noise)]
        for first, last in ends:
            stop = rows.stop if last == count else rows.start + last * _BLOCK
            start = rows.start + first * _BLOCK
            if stop - start >= _SHORTEST and abs(float(means[first:last].mean())) > _SLOWEST * fastest:
                found.append(slice(start + int(_SETTLING * (stop - start)), stop))
    return found


def _stretches(means: Array, noise: float) -> list[tuple[int, int]]:
    """First and last block of each stretch whose blocks agree with the mean of those before."""
    values = means.tolist()
    found, first, total = [], 0, values[0]
    for i in range(1, len(values) + 1):
        middle = total / (i - first)
        if i < len(values) and abs(values[i] - middle) <= _SPREAD * abs(middle) + noise:
            total += values[i]
            continue
        found.append((first, i))
        if i < len(values):
            first, total = i, values[i]
    return found


def distinct_speeds(log: Log, segments: list[slice]) -> int:
    """How many different speeds there are, those within 10 % being one."""
    speeds = np.sort([abs(float(np.mean(log.velocity[s]))) for s in segments])
    return int(np.sum(np.diff(np.log(speeds)) > np.log(1.1))) + 1 if len(speeds) else 0
