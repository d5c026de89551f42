"""A motion that is measured late: how late it may be, which force belongs to it, and a first value.

``delay`` is the time by which the measured motion lags the force (:data:`stribeck.identify.models.terms.TERMS`): the motion at
a row belongs to the force of ``delay`` before.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from stribeck.arrays import Array
from stribeck.identify.data.filters import FARTHEST_SAMPLE, shifted
from stribeck.identify.log import Log

STEPS = (0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0)  # delays that are tried
_LONGEST_STEPS, _LONGEST = 50, 0.1  # s
_SHARE = 0.1  # of the longest run: so much of it may lack its force at either end
_MOVES = 0.3  # of the largest speed: slower rows show presliding and the Stribeck bend rather than plain friction
_BETTER = 0.99  # of the squares: a delay that takes less away is none


def longest(step: float) -> float:
    """The longest delay that is tried with samples ``step`` apart, s."""
    return float(min(_LONGEST_STEPS * step, max(_LONGEST, 2 * step)))


def longest_of(log: Log) -> float:
    """The same for a fit by simulation, whose rows are a record's: s."""
    rows = max(run.stop - run.start for run in log.runs())
    return float(min(longest(log.step), _SHARE * rows * log.step))


def later(log: Log, x: Array, by: float) -> Array:
    """A column of the record at times later by so many seconds; the ends of runs are held."""
    if not by:
        return x
    found = np.empty(len(log))
    for rows in log.runs():
        found[rows] = shifted(x[rows], by / log.step)
    return found


def force_of_motion(log: Log, force: Array, delay: float) -> Array:
    """The force, given at each row, that belongs to the motion there: that of ``delay`` before."""
    return later(log, force, -delay)


def within(log: Log, delay: float) -> list[slice]:
    """The rows of each run whose motion has its force in the record, whatever the delay is up to this size, s."""
    aside = int(np.ceil(abs(delay) / log.step)) + FARTHEST_SAMPLE if delay else 0
    return [slice(run.start + aside, max(run.stop - aside, run.start + aside)) for run in log.runs()]


def likely(log: Log, columns: Sequence[Array], most: float) -> float:
    """The delay, up to ``most`` s, with which least squares on these columns of the motion leave least of the force; 0 where
    none leaves clearly less."""
    rows = np.concatenate([np.arange(len(log))[run] for run in within(log, most)])
    rows = rows[abs(log.velocity[rows]) > _MOVES * float(np.max(abs(log.velocity), initial=0.0))]
    if len(rows) <= 2 * len(columns):
        return 0.0
    matrix = np.array([x[rows] for x in columns]).T
    basis = np.linalg.qr(matrix / np.maximum(np.linalg.norm(matrix, axis=0), 1e-300))[0]

    def left(delay: float) -> float:
        force = force_of_motion(log, log.force, delay)[rows]
        return float(force @ force - np.sum((basis.T @ force) ** 2))

    near = sorted({0.0, *(s * x * log.step for x in STEPS for s in (1, -1) if x * log.step <= most)})
    tried = [left(x) for x in near]
    best = int(np.argmin(tried))
    ends = near[max(best - 1, 0)], near[min(best + 1, len(near) - 1)]
    found = minimize_scalar(left, bounds=ends, method="bounded", options={"xatol": 0.01 * log.step})
    lowest = float(found.x) if found.fun < tried[best] else near[best]
    return lowest if min(float(found.fun), tried[best]) < _BETTER * tried[near.index(0.0)] else 0.0
