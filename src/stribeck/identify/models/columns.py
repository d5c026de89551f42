"""The columns of a static model: what each of its coefficients multiplies, at the rows that are compared."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.data import filters
from stribeck.identify.features.sliding import Sliding
from stribeck.identify.log import Log
from stribeck.identify.models.terms import TERMS

Reduce = Callable[[Array], Array]
_BYTES = 256_000_000  # that columns once computed may take


class Columns:
    """Columns of the law and of the terms, kept once computed: trials of one record share them.

    Args:
        log: the record.
        sliding: the law's steady force.
        reduce: from all rows to those that are compared: filter and thin out, or the means of stretches.
    """

    def __init__(self, log: Log, sliding: Sliding, reduce: Reduce) -> None:
        self.log, self.sliding, self.reduce = log, sliding, reduce
        self.force = reduce(log.force)
        self.fastest = max(float(log.velocity.max()), -float(log.velocity.min()))
        self.names = list(sliding.linear)
        self._kept: OrderedDict[Any, Array] = OrderedDict()
        self._places: dict[float, _Place] = {}
        self._most = max(_BYTES // (8 * max(len(self.force), 1)), 24)

    def at(self, values: Mapping[str, float], terms: Sequence[str]) -> dict[str, Array]:
        """The column of each coefficient of the law and of the terms, for given other constants and delay."""
        own, delay = self.sliding.law.constants(), values.get("delay", 0.0)
        shape = tuple((n, v) for n, v in values.items() if n in own and n not in self.names)
        levels = [n for n in terms if TERMS[n].level]
        found = self._friction(shape, delay, levels)
        for name in terms:
            if TERMS[name].column is not None and not TERMS[name].level:
                late = 0.0 if name == "offset" else delay
                found[name] = self._keep(("term", name, late), self._maker(name, late))
        return found

    def _friction(self, shape: tuple[tuple[str, float], ...], delay: float, levels: Sequence[str]) -> dict[str, Array]:
        """What each coefficient of the law and of its level multiplies."""
        names = self.names or [""]
        keys = {n: ("law", n, shape, delay) for n in (*names, *levels)}
        if any(key not in self._kept for key in keys.values()):
            speeds, table = self.sliding.table(dict(shape), self.fastest, self.names)
            place = self._place(speeds, delay)
            for name, values in table.items():
                if keys[name] not in self._kept:
                    self._kept[keys[name]] = self.reduce(place.of(values))
            for name in levels:
                level = place.of(table["F_c"] + table.get("F_s", 0.0))
                self._kept[keys[name]] = self.reduce(level * self._moved(column(name, self.log), delay))
        found = {n: self._kept[key] for n, key in keys.items()}
        while len(self._kept) > self._most:
            self._kept.popitem(last=False)
        return found

    def _place(self, speeds: Array, delay: float) -> _Place:
        """Where the moved velocity lies among the speeds of the table, which are the same for all shapes."""
        if delay not in self._places:
            if len(self._places) > 3:
                self._places.pop(next(iter(self._places)))
            self._places[delay] = _Place(speeds, self._moved(self.log.velocity, delay))
        return self._places[delay]

    def _maker(self, name: str, late: float) -> Callable[[], Array]:
        return lambda: self.reduce(self._moved(column(name, self.log), late))

    def _keep(self, key: Any, make: Callable[[], Array]) -> Array:
        if key in self._kept:
            self._kept.move_to_end(key)
        else:
            self._kept[key] = make()
            while len(self._kept) > self._most:
                self._kept.popitem(last=False)
        return self._kept[key]

    def _moved(self, x: Array, delay: float) -> Array:
        if delay == 0:
            return x
        return np.concatenate([filters.shifted(x[rows], delay / self.log.step) for rows in self.log.runs()])


class _Place:
    """Straight lines between the points of a table, for several tables over the same speeds."""

    def __init__(self, speeds: Array, v: Array) -> None:
        self.low = np.clip(np.searchsorted(speeds, v) - 1, 0, len(speeds) - 2)
        self.share = (v - speeds[self.low]) / (speeds[self.low + 1] - speeds[self.low])

    def of(self, values: Array) -> Array:
        """The table's values at the speeds asked for."""
        return np.asarray(values[self.low] + self.share * np.diff(values)[self.low])


def column(name: str, log: Log) -> Array:
    """The column of the log that a term multiplies."""
    made = TERMS[name].column
    assert made is not None
    return made(log)
