"""The columns of a static model: what each of its coefficients multiplies, at the rows that are compared."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.data import filters
from stribeck.identify.features.sliding import Sliding
from stribeck.identify.log import Log
from stribeck.identify.models import play
from stribeck.identify.models.terms import TERMS, column

Reduce = Callable[[Array], Array]
_How = tuple[float, float]  # the delay of the motion, and the way over which friction turns round
_BYTES = 256_000_000  # that columns once computed may take
_CURVES = 12  # whose columns are kept for curves that are the same
_NOTHING: Mapping[str, float] = {}
_ROUNDING = 1e-12  # of the largest value of a curve


class Columns:
    """Columns of the law and of the terms, kept once computed: trials of one record share them.

    Args:
        log: the record.
        sliding: the law's steady force.
        reduce: from all rows to those that are compared, linear: filter and thin out, or the means of stretches.
    """

    def __init__(self, log: Log, sliding: Sliding, reduce: Reduce) -> None:
        self.log, self.sliding, self.reduce = log, sliding, reduce
        self.force = reduce(log.force)
        self.fastest = max(float(log.velocity.max()), -float(log.velocity.min()))
        self.names = list(sliding.linear)
        self._kept: OrderedDict[object, Array] = OrderedDict()
        self._last: OrderedDict[object, tuple[Array, Array]] = OrderedDict()
        self._places: dict[_How, _Place | _Turned] = {}
        self._most = max(_BYTES // (8 * max(len(self.force), 1)), 24)

    def at(self, values: Mapping[str, float], terms: Sequence[str]) -> dict[str, Array]:
        """The column of each coefficient of the law and of the terms, for given other constants and delay."""
        own, delay = self.sliding.law.constants(), values.get("delay", 0.0)
        shape = tuple((n, v) for n, v in values.items() if n in own and n not in self.names)
        levels = [n for n in terms if TERMS[n].level]
        found = self._friction(shape, (delay, values.get("play", 0.0)), levels)
        for name in terms:
            if TERMS[name].column is not None and not TERMS[name].level:
                on = {of: values[of]} if (of := TERMS[name].of) else {}
                found[name] = self._late(name, 0.0 if name == "offset" else delay, on)
        return found

    def _friction(self, shape: tuple[tuple[str, float], ...], how: _How, levels: Sequence[str]) -> dict[str, Array]:
        """What each coefficient of the law and of its level multiplies."""
        names = self.names or [""]
        keys = {n: ("law", n, shape, how) for n in (*names, *levels)}
        if any(key not in self._kept for key in keys.values()):
            speeds, table = self.sliding.table(dict(shape), self.fastest, self.names)
            for name, made in self._of_law(speeds, table, how, levels).items():
                self._kept[keys[name]] = made
        found = {n: self._kept[key] for n, key in keys.items()}
        for key in keys.values():
            self._kept.move_to_end(key)
        self._forget()
        return found

    def _of_law(self, speeds: Array, table: Mapping[str, Array], how: _How, levels: Sequence[str]) -> dict[str, Array]:
        """The columns of a table. What is proportional to the speed, and the sign, into which F_c's and F_s's columns add
        up, are the same for all curves: they are filtered once, as the filter is linear."""
        curves = dict(table)
        if "F_c" in table and "F_s" in table:
            curves["F_c"] = table["F_c"] + table["F_s"]
        found = {name: self._of_curve(name, speeds, curve, how) for name, curve in curves.items()}
        for name in levels:
            found[name] = self._once(name, curves["F_c"], how, partial(self._level, name, speeds, how))
        if "F_c" in table and "F_s" in table:
            found["F_c"] = found["F_c"] - found["F_s"]
        return found

    def _of_curve(self, name: str, speeds: Array, curve: Array, how: _How) -> Array:
        slope = curve[-1] / speeds[-1]
        if _alike(curve, slope * speeds):
            return np.asarray(slope * self._late("velocity", how[0]))
        return self._once(name, curve, how, lambda values: self.reduce(self._place(speeds, how).of(values)))

    def _level(self, name: str, speeds: Array, how: _How, curve: Array) -> Array:
        return self.reduce(self._place(speeds, how).of(curve) * self._moved(column(name, self.log, {}), how[0]))

    def _once(self, name: str, curve: Array, how: _How, make: Callable[[Array], Array]) -> Array:
        """The column of a curve; the last one, where that was of the same curve."""
        last = self._last.get((name, how))
        if last is None or not _alike(curve, last[0]):
            last = self._last[name, how] = curve, make(curve)
        self._last.move_to_end((name, how))
        while len(self._last) > _CURVES:
            self._last.popitem(last=False)
        return last[1]

    def _place(self, speeds: Array, how: _How) -> _Place | _Turned:
        """Where the moved velocity lies among the speeds of the table, which are the same for all shapes."""
        if how not in self._places:
            if len(self._places) > 3:
                self._places.pop(next(iter(self._places)))
            (delay, way), log = how, self.log
            v = self._moved(log.velocity, delay)
            turned = self._moved(play.turned(log, way), delay) if way > 0 else None
            self._places[how] = _Place(speeds, v) if turned is None else _Turned(speeds, v, turned)
        return self._places[how]

    def _late(self, name: str, delay: float, on: Mapping[str, float] = _NOTHING) -> Array:
        """A column of the log or of a term, later by a delay: columns moved by whole rows, filtered once each, put together."""
        parts, key = filters.whole_shifts(delay / self.log.step if delay else 0.0), tuple(on.values())
        return _sum_of(
            parts,
            lambda by: self._keep(("late", name, by, key), lambda: self.reduce(self._held(self._raw(name, on), by))),
        )

    def _raw(self, name: str, on: Mapping[str, float]) -> Array:
        return self.log.velocity if name == "velocity" else column(name, self.log, on)

    def _keep(self, key: object, make: Callable[[], Array]) -> Array:
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        made = self._kept[key] = make()
        self._forget()
        return made

    @cached_property
    def position(self) -> Array:
        """Where the rows that are compared lie."""
        return self.reduce(self.log.position)

    def _forget(self) -> None:
        while len(self._kept) > self._most:
            self._kept.popitem(last=False)

    def _moved(self, x: Array, delay: float) -> Array:
        """x later by a delay; the ends of runs are held."""
        parts = filters.whole_shifts(delay / self.log.step if delay else 0.0)
        return _sum_of(parts, lambda by: self._held(x, by))

    def _held(self, x: Array, by: int) -> Array:
        """x later by whole rows; the ends of runs are held."""
        if by == 0:
            return x
        first, last = self._ends
        return np.asarray(x[np.clip(np.arange(by, len(x) + by), first, last)])

    @cached_property
    def _ends(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """The first and the last row of each row's run."""
        runs = list(self.log.runs())
        lengths = [r.stop - r.start for r in runs]
        return np.repeat([r.start for r in runs], lengths), np.repeat([r.stop - 1 for r in runs], lengths)


def _sum_of(parts: Mapping[int, float], column_at: Callable[[int], Array]) -> Array:
    """The weighted sum of columns; a single column of weight 1 as it is."""
    if list(parts.values()) == [1.0]:
        return column_at(next(iter(parts)))
    return np.asarray(sum(weight * column_at(by) for by, weight in parts.items()))


def _alike(one: Array, other: Array) -> bool:
    """Whether two curves differ by rounding alone."""
    return bool(np.max(abs(one - other)) <= _ROUNDING * np.max(abs(one)))


class _Place:
    """Straight lines between the points of a table, for several tables over the same speeds."""

    def __init__(self, speeds: Array, v: Array) -> None:
        self.low = np.clip(np.searchsorted(speeds, v) - 1, 0, len(speeds) - 2)
        self.share = (v - speeds[self.low]) / (speeds[self.low + 1] - speeds[self.low])

    def of(self, values: Array) -> Array:
        """The table's values at the speeds asked for."""
        return np.asarray(values[self.low] + self.share * np.diff(values)[self.low])


class _Turned:
    """The same where friction turns round over a way: of its two branches, forwards and backwards, at the speed of the moment."""

    def __init__(self, speeds: Array, v: Array, turned: Array) -> None:
        self.forwards, self.backwards, self.turned = _Place(speeds, abs(v)), _Place(speeds, -abs(v)), turned

    def of(self, values: Array) -> Array:
        """The values of a table as the friction has turned."""
        share = 0.5 * (1 + self.turned)
        return np.asarray(share * self.forwards.of(values) + (1 - share) * self.backwards.of(values))
