"""What the cut-off of the motion does to a fit: one that rounds off ramps and reversals is raised."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.data.filters import low_pass

_RAISE = 2.5  # from one cut-off that is tried to the next
_HIGHEST = 0.4  # of the sampling rate
_CLEARLY = 0.8  # of what is missed with the lower cut-off: less is worth a higher one
_AS_GOOD = 1.1  # of the least that is missed
_ENDS = 5.0  # periods of the lowest cut-off left out at both ends
_BAND = 1.0  # of the lowest cut-off, in which the force is compared
_BENDS = 8  # of the free curve of the speed
_FEWEST, _MOST = 400, 100_000  # rows that are compared

Run = tuple[Array, Array]


def by_effect(runs: Sequence[Run], position: bool, cutoff: float, step: float) -> float:
    """The cut-off, raised where a plain regression of the force misses clearly less with a higher one.

    The force is compared in one band whatever the cut-off, so that only what the filter does to the motion makes the difference:
    noise of the speed and the acceleration above, rounded ramps and reversals below.

    Args:
        runs: measured motion and force of each.
        position: the motion is a position, not a speed.
        cutoff: Hz, the lowest to be tried; ``step``: between samples, s.
    """
    tried = [cutoff]
    while tried[-1] * _RAISE < _HIGHEST / step:
        tried.append(tried[-1] * _RAISE)
    edge = int(_ENDS / (cutoff * step))
    chosen = _some([r for r in runs if len(r[1]) - 2 * edge >= 2 * edge + 2])
    if len(tried) < 2 or sum(len(f) - 2 * edge for _, f in chosen) < _FEWEST:
        return cutoff
    missed = [_missed(chosen, position, c, cutoff, step, edge) for c in tried]
    least = min(missed)
    if least > _CLEARLY * missed[0]:
        return cutoff
    return next(c for c, m in zip(tried, missed, strict=True) if m <= _AS_GOOD * least)


def _some(runs: Sequence[Run]) -> list[Run]:
    """Runs evenly out of all, of few enough rows together."""
    every, found = max(sum(len(f) for _, f in runs) // _MOST, 1), []
    for motion, force in runs[::every]:
        found.append((motion[:_MOST], force[:_MOST]))
    return found


def _missed(runs: Sequence[Run], position: bool, cutoff: float, lowest: float, step: float, edge: int) -> float:
    """What a regression on acceleration, a free odd curve of the speed and a constant misses of the force."""
    motions = []
    for motion, _ in runs:
        x = low_pass(motion, cutoff, step)
        v = np.gradient(x, step) if position else x
        motions.append((v, np.gradient(v, step)))
    speeds = np.abs(np.concatenate([v[edge:-edge] for v, _ in motions]))
    knots = np.unique(np.quantile(speeds, np.linspace(0, 1, _BENDS + 1)))
    matrix, force = [], []
    for (v, a), (_, f) in zip(motions, runs, strict=True):
        bends = [np.interp(abs(v), knots, unit) * np.sign(v) for unit in np.eye(len(knots))]
        passed = [low_pass(x, _BAND * lowest, step)[edge:-edge] for x in (a, *bends, f)]
        matrix.append(np.column_stack([*passed[:-1], np.ones(len(passed[0]))]))
        force.append(passed[-1])
    columns, target = np.concatenate(matrix), np.concatenate(force)
    size = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-300)
    found = np.linalg.lstsq(columns / size, target, rcond=1e-9)[0]
    return float(np.linalg.norm(target - columns / size @ found))
