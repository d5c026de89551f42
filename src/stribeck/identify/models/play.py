"""Friction that turns round over a way behind a reversal: play in a gear or a spindle, or a contact that yields."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.log import Log


def turned(log: Log, way: float) -> Array:
    """Which part of the friction has which direction: from -1 (all of it that of motion backwards) to 1.

    Behind a reversal it changes in proportion to the way, and is turned round after ``way`` (the stop operator). Between two
    reversals of the position it is known in closed form, so that only these are gone through one by one.
    """
    share = np.empty(len(log))
    for run in log.runs():
        y = log.position[run]
        turns = np.flatnonzero(np.diff(np.sign(np.diff(y)))) + 1
        first = np.concatenate([[0], turns])
        at = y[first].tolist()
        state = [_at_start(float(log.velocity[run.start]), float(log.acceleration[run.start]), way)]
        for before, now in pairwise(at):
            state.append(min(max(state[-1] + 2 * (now - before) / way, -1.0), 1.0))
        part = np.searchsorted(turns, np.arange(len(y)), side="right")
        share[run] = np.clip(np.array(state)[part] + 2 * (y - y[first][part]) / way, -1.0, 1.0)
    return share


def _at_start(v: float, a: float, way: float) -> float:
    """The state in which a run begins: a body that speeds up came back a while ago, by its acceleration v^2/(2 a) before."""
    since = 0.5 * v * v / abs(a) if v * a > 0 else way
    return float(np.sign(v)) * min(2 * since / way - 1, 1.0)
