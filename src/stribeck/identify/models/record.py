"""The rows of a record that a static fit compares, and the blocks of time that it draws anew."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.log import Log
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.static_problem import BLOCKS, Rows, thinning
from stribeck.identify.models.terms import TERMS, column

FEWEST, ROWS = 6, 12  # blocks of a short record; rows of a block
RINGS = 4  # kept rows about a reversal in which the thinning filter rings (its order is 8): the sign is not known there
RISE = 0.35  # periods of the cut-off: the rise time of the motion's filter
LEFT = 0.6  # of the rows in motion: a record that rings more often has no others, and keeps them


class LawColumns:
    """A law's columns along a motion; those of one shape are computed once.

    Args:
        velocity: along which; ``reduce``: gives the rows that are compared.
    """

    def __init__(self, curve: SteadyCurve, velocity: Array, reduce: Callable[[Array], Array]) -> None:
        self.curve, self._velocity, self._reduce = curve, velocity, reduce
        self._made: dict[tuple[float, ...], Array] = {}

    def at(self, shape: Mapping[str, float]) -> Array:
        """The columns at a node."""
        key = tuple(shape.values())
        if key not in self._made:
            by_name = self.curve.columns(self._velocity, shape)
            columns = [self._reduce(by_name[n]) for n in self.curve.names]
            self._made[key] = np.column_stack(columns or [self._reduce(self._velocity)[:, None][:, :0]])
        return self._made[key]

    def with_slopes(self, shape: Mapping[str, float], height: Mapping[str, float]) -> Array:
        """The same, then the slopes by the logarithm of each shape."""
        slopes = map(self._reduce, self.curve.slopes(self._velocity, shape, height))
        return np.column_stack([self.at(shape), *slopes])

    def known(self, shape: Mapping[str, float]) -> Array | None:
        """The force of the law's given constants."""
        known = self.curve.known(self._velocity, shape)
        return None if known is None else self._reduce(known)


@dataclass(frozen=True)
class Record:
    """The rows that are compared: behind the filter, thinned, away from rest and from ringing reversals.

    Attributes:
        at: of the log's rows; ``block`` and ``file`` of each.
        force: the target: the force less what given terms hold.
        body: columns beside the law's, by name: mass, sigma_2, offset and the terms that the user named.
        given: coefficients of the body that are given.
        q: one row in so many was kept behind the thinning filter.
    """

    log: Log
    at: NDArray[np.intp]
    force: Array
    body: dict[str, Array]
    given: dict[str, float]
    block: NDArray[np.intp]
    file: NDArray[np.intp]
    q: int
    reduce: Callable[[Array], Array] = field(repr=False)
    counted: NDArray[np.bool_] = field(repr=False)

    def column(self, x: Array) -> Array:
        """A column of the log at the rows that are compared."""
        return self.reduce(x)[self.counted]

    def of(self, curve: SteadyCurve) -> LawColumns:
        """A law's columns at the rows that are compared."""
        return LawColumns(curve, self.log.velocity, self.column)


def body_columns(log: Log, names: Sequence[str], viscous: bool = True) -> dict[str, Array]:
    """The columns of the body's coefficients: inertia, viscous friction, and terms."""
    viscous_column = {"sigma_2": log.velocity} if viscous else {}
    usual = {"mass": log.acceleration} | viscous_column
    sign = np.sign(log.velocity)
    further = {n: column(n, log) * (sign if TERMS[n].level else 1.0) for n in names if n not in usual}
    return usual | further


def record_of(
    rows: Rows, terms: Sequence[str], given: Mapping[str, float], viscous: bool = True, all_rows: bool = False
) -> Record:
    """The record that is compared.

    Args:
        terms: of the body beside mass and viscous friction.
        given: coefficients of the body that are given, and taken off the force.
        all_rows: rows about reversals and at ends too, as in the published procedure.
    """
    log, q = rows.log, rows.q
    reduce = thinning(log, q)
    moving = rows.weight > 0
    counted = moving if all_rows else moving & ~_ringing(log, q)[rows.kept]
    if counted.sum() < LEFT * moving.sum():
        counted = moving
    held = {n: x for n, x in given.items() if n in TERMS or (n == "sigma_2" and viscous)}
    columns = body_columns(log, [*terms, *(n for n in held if n not in terms)], viscous)
    force = log.force - sum((x * columns[n] for n, x in held.items()), np.zeros(len(log)))
    at = rows.kept[counted]
    block, file = _blocks(log, at)
    body = {n: reduce(x)[counted] for n, x in columns.items() if n not in held}
    return Record(log, at, reduce(force)[counted], body, dict(held), block, file, q, reduce, counted)


def _blocks(log: Log, at: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Stretches of time, none over two files; and the file of each row."""
    file = log.file_of_rows[at]
    n, block, used = len(at), np.empty(len(at), np.intp), 0
    for each in np.unique(file):
        rows = np.flatnonzero(file == each)
        count = int(np.clip(len(rows) // ROWS, FEWEST if len(rows) == n else 1, max(round(BLOCKS * len(rows) / n), 1)))
        block[rows] = used + np.arange(len(rows)) * count // len(rows)
        used += count
    return block, file


def _ringing(log: Log, q: int) -> NDArray[np.bool_]:
    rise = max(1, round(RISE / (log.bandwidth * log.step)) if log.bandwidth and log.step else 1)
    reach = max(rise, RINGS * q if q > 1 else 1)
    out = np.zeros(len(log), bool)
    for run in log.runs():
        s, here = np.sign(log.velocity[run]), out[run]
        here[: 2 * reach] = here[max(len(s) - 2 * reach, 0) :] = True
        turns = np.flatnonzero((s[1:] * s[:-1] < 0) | ((s[1:] == 0) != (s[:-1] == 0)))
        for i in turns.tolist() if q > 1 else ():
            here[max(i + 1 - reach, 0) : i + 1 + reach] = True
    return out
