"""The problem of a static fit: which rows are compared, and what the force is made of there."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from stribeck.identify.data import filters
from stribeck.identify.features.sliding import Sliding
from stribeck.identify.log import Log
from stribeck.identify.models.problem import Coordinate, Problem, Tie
from stribeck.identify.models.terms import TERMS

Array = NDArray[np.float64]
Reduce = Callable[[Array], Array]
_POWER_KEPT = 0.999  # of the force's, by the band that is fitted
_RATES = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)
_MOST_ROWS = 500_000


class StaticProblem(Problem):
    """Measured motion in, force out, without memory: friction at the speed of the moment, and the body's terms.

    Args:
        log: the record.
        sliding: the law's steady force.
        coordinates, fixed, tied: as in :class:`Problem`.
        body: the terms beside friction.
        reduce: from all rows to those that are compared: filter and thin out, or the means of stretches.
        weight: of the rows compared; all alike where None.
    """

    def __init__(
        self,
        log: Log,
        sliding: Sliding,
        coordinates: Sequence[Coordinate],
        fixed: Mapping[str, float],
        tied: Mapping[str, Tie],
        body: Sequence[str],
        reduce: Reduce,
        weight: Array | None = None,
    ) -> None:
        self.log, self.sliding, self.terms, self.reduce = log, sliding, tuple(body), reduce
        self.force = reduce(log.force)
        self.fastest = max(float(log.velocity.max()), -float(log.velocity.min()))
        self.weight = np.ones(len(self.force)) if weight is None else weight
        size = float(np.sqrt(np.mean(self.force**2)))
        super().__init__(sliding.law, coordinates, fixed, tied, self.weight * self.force, size)
        self.names = list(sliding.linear)
        self.of_friction = lru_cache(maxsize=8)(self._of_friction)
        self.of_body = lru_cache(maxsize=3 * len(self.terms) + 3)(self._of_body)

    def reweighted(self, weight: Array) -> StaticProblem:
        """The same problem with other weights of the rows."""
        other = StaticProblem.__new__(StaticProblem)
        other.__dict__.update(self.__dict__)
        other.reweigh(weight)
        return other

    def reweigh(self, weight: Array) -> None:
        """Give the rows other weights."""
        self.weight, self.measured = weight, weight * self.force

    def _moved(self, column: Array, delay: float) -> Array:
        if delay == 0:
            return column
        parts = [filters.shifted(column[rows], delay / self.log.step) for rows in self.log.runs()]
        return np.concatenate(parts)

    def _of_friction(self, shape: tuple[tuple[str, float], ...], delay: float) -> dict[str, Array]:
        """What each coefficient of the law and of its level multiplies, for given other constants and delay."""
        v = self._moved(self.log.velocity, delay)
        speeds, table = self.sliding.table(dict(shape), self.fastest, self.names)
        found = {name: self.reduce(np.interp(v, speeds, x)) for name, x in table.items()}
        levels = [name for name in self.terms if TERMS[name].level]
        if levels:
            level = np.interp(v, speeds, table["F_c"] + table.get("F_s", 0.0))
            found |= {name: self.reduce(level * self._moved(self._column(name), delay)) for name in levels}
        return found

    def _of_body(self, name: str, delay: float) -> Array:
        return self.reduce(self._moved(self._column(name), 0.0 if name == "offset" else delay))

    def _column(self, name: str) -> Array:
        column = TERMS[name].column
        assert column is not None
        return column(self.log)

    def columns_at(self, values: Mapping[str, float]) -> dict[str, Array]:
        """The columns for all constants by name."""
        own, delay = self.law.constants(), values.get("delay", 0.0)
        shape = tuple((n, v) for n, v in values.items() if n in own and n not in self.names)
        body = [n for n in self.terms if TERMS[n].column is not None and not TERMS[n].level]
        return {**self.of_friction(shape, delay), **{n: self.of_body(n, delay) for n in body}}

    def model(self, values: Mapping[str, float]) -> Array:
        """The force at the rows that are compared."""
        columns = self.columns_at(values)
        return np.asarray(sum(values.get(name, 1.0) * x for name, x in columns.items()))

    def outputs(self, points: Array) -> Array | None:
        """The weighted force at the rows that are compared."""
        return np.array([self.weight * self.model(self.values(u)) for u in points])


# -- rows ------------------------------------------------------------------------------------------------------------


def decimation(log: Log) -> tuple[int, str]:
    """By what the rate can be lowered and still hold the force's band; and why."""
    longest = max(log.runs(), key=lambda r: r.stop - r.start)
    x = log.force[longest.start : min(longest.stop, longest.start + (1 << 18))]
    f, p = signal.welch(x - x.mean(), 1 / log.step, nperseg=min(len(x), 4096))
    share = np.cumsum(p) / max(float(np.sum(p)), 1e-300)
    band = max(float(f[np.searchsorted(share, _POWER_KEPT)]), float(f[1]))
    q = max((r for r in _RATES if r <= max(0.4 / (band * log.step), 1)), default=1)
    shortest = min(r.stop - r.start for r in log.runs())
    while q > 1 and shortest < 30 * q:
        q = _RATES[_RATES.index(q) - 1]
    while len(log) / q > _MOST_ROWS:
        q = next(r for r in _RATES if r > q)
    return q, f"{100 * _POWER_KEPT:g} % of the force's power lies below {band:.3g} Hz: one row in {q} is fitted"


def thinning(log: Log, q: int) -> Reduce:
    """Filter and decimation of each run."""
    filters.stages(q)
    rows = list(log.runs())
    return lambda x: x if q == 1 else np.concatenate([filters.decimate(x[r], q) for r in rows])


def kept_rows(log: Log, q: int) -> NDArray[np.intp]:
    """The rows of the log that :func:`thinning` keeps."""
    return np.concatenate([r.start + filters.decimated_rows(r.stop - r.start, q) for r in log.runs()])


def averaging(segments: Sequence[slice]) -> Reduce:
    """The mean of each stretch."""
    return lambda x: np.array([float(np.mean(x[s])) for s in segments])
