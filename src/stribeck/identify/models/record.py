"""The rows of a record that a static fit compares: filtered, decimated, in motion, in blocks of time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from stribeck.arrays import Array
from stribeck.identify.data import filters
from stribeck.identify.data.smoother import LOOK
from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log, stretches
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.terms import TERMS, column

_POWER_KEPT = 0.999  # of the force's, by the band that is fitted: what is cut off is 3 % of its deviation
RATES = (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000)  # of factors 2 and 5: stages of decimation stay few
MOST_ROWS = 25_000  # of a fit, whose columns then take some 50 MB: neighbors behind the filter are alike
BLOCKS = 24  # of time: the jackknife's variance is then known to 15 %, and most blocks still hold a reversal
_SHORTEST_BLOCK = 600  # rows of a stretch of a long run
_FEW_ROWS = 400  # that are compared: fewer do not show a bend of the curve
_FEW_TO_CHOOSE = 3000  # rows where laws are chosen: a filter rounds off the sign, by which they differ
_LITTLE_REST = 0.02  # of the rows: less rest moves no estimate, and stays in
_SMEARED = 4.0  # periods of the motion's cut-off: how far it moves a start or a stop into a rest
_BEFORE = 10  # a stretch of a long record begins this part of its length before it moves
FEWEST_BLOCKS, BLOCK_ROWS = 6, 12  # blocks of a short record, and parts of cross-validation; rows of a block
RINGS = 4  # kept rows about a reversal in which the thinning filter rings (its order is 8): the sign is not known there
RISE = 0.35  # periods of the cut-off: the rise time of the motion's filter
LEFT = 0.6  # of the rows in motion: a record that rings more often has no others, and keeps them


@dataclass
class Rows:
    """A record as a static fit compares it; trials of one record share this.

    Attributes:
        log: the record, with a velocity of 0 where the body rests.
        q: one row in so many is kept behind the filter.
        kept: the rows of the log that are; ``moving``: those of them in which the body moves.
        rest: the rows of the log in which it rests.
    """

    log: Log
    q: int
    kept: NDArray[np.intp]
    moving: NDArray[np.bool_]
    rest: NDArray[np.bool_]


def rows_of(log: Log, to_choose: bool = False) -> Rows:
    """The rows that a static fit of a record compares.

    Args:
        to_choose: laws are to be chosen from: a wider band, as another record is met at all frequencies.
    """
    rest = at_rest(log)
    share = float(np.mean(rest))
    if share <= _LITTLE_REST or share > 1 - _LITTLE_REST:
        rest[:] = False
    smeared = beside_rest(rest, log)
    if rest.any():
        log = log.with_columns(velocity=np.where(rest, 0.0, log.velocity))
    q = decimation(log, _FEW_TO_CHOOSE if to_choose else _FEW_ROWS)
    kept = kept_rows(log, q)
    near = rest
    if q > 1 and rest.any():  # the filter spreads a jump over some rows
        near = np.convolve(rest, np.ones(2 * q + 1), mode="same") > 0.5
    return Rows(log, q, kept, ~(near | smeared)[kept], rest)


def beside_rest(rest: NDArray[np.bool_], log: Log) -> NDArray[np.bool_]:
    """Rows so near a rest that the motion's filter may have moved them there: the force is the rest's. A short motion keeps
    the middle half of it."""
    out = np.zeros(len(rest), bool)
    if not log.bandwidth:
        return out
    width = round(_SMEARED / (log.bandwidth * log.step))
    for rows in log.runs():
        for first, last in stretches(~rest[rows]).tolist():
            reach = min(width, (last - first) // 4)
            out[rows.start + first : rows.start + first + reach] = first > 0
            if last < rows.stop - rows.start:
                out[rows.start + last - reach : rows.start + last] = True
    return out


def decimation(log: Log, few: int) -> int:
    """By what the rate can be lowered and still hold the force's band, and so many rows."""
    longest = max(log.runs(), key=lambda r: r.stop - r.start)
    x = log.force[longest.start : min(longest.stop, longest.start + LOOK)]
    f, p = signal.welch(x - x.mean(), 1 / log.step, nperseg=min(len(x), 4096))
    share = np.cumsum(p) / max(float(np.sum(p)), 1e-300)
    band = max(float(f[np.searchsorted(share, _POWER_KEPT)]), float(f[1]))
    q = max((r for r in RATES if r <= max(filters.HIGHEST / (band * log.step), 1)), default=1)
    shortest = min(r.stop - r.start for r in log.runs())
    while q > 1 and (shortest < 30 * q or len(log) < few * q):
        q = RATES[RATES.index(q) - 1]
    while len(log) / q > MOST_ROWS and q < RATES[-1]:
        q = next(r for r in RATES if r > q)
    return q


def kept_rows(log: Log, q: int) -> NDArray[np.intp]:
    """The rows of the log that are kept behind the filter."""
    return np.concatenate([r.start + filters.decimated_rows(r.stop - r.start, q) for r in log.runs()])


def shortened(log: Log, enough: int) -> Log:
    """The record, or stretches of a longer one as separate runs, ``enough`` rows in all.

    The stretches lie evenly over the moving parts of every run.
    """
    if len(log) <= enough:
        return log
    parts, owner, rest, runs = [], [], at_rest(log), log.runs()
    shares = [max(int(enough * (r.stop - r.start) / len(log)), 1) for r in runs]
    counts = [int(np.clip(share // _SHORTEST_BLOCK, 1, BLOCKS)) for share in shares]
    usual = int(np.median([max(s // c, _SHORTEST_BLOCK) for s, c in zip(shares, counts, strict=True)]))
    for rows, count in zip(runs, counts, strict=True):
        length = min(usual, rows.stop - rows.start)  # of one length where it can be
        if count * length >= rows.stop - rows.start:
            count, length = 1, rows.stop - rows.start
        starts = _starts(rest[rows], count, length, rows.start)
        parts += [slice(a, a + length) for a in starts]
        owner += [int(log.run[rows.start])] * count
    every = np.concatenate([np.arange(p.start, p.stop) for p in parts])
    run = np.repeat(np.arange(len(parts), dtype=np.int32), [p.stop - p.start for p in parts])
    files = tuple(log.files[i] for i in owner) if log.files else ()
    return log.rows(every).with_columns(run=run, files=files)


def _starts(rest: NDArray[np.bool_], count: int, length: int, first: int) -> list[int]:
    """Where the stretches of a run begin: evenly over it, or over the rows that move, each with a little of what is before."""
    highest = len(rest) - length
    if np.mean(rest) <= _LITTLE_REST or rest.all():
        return [first + int(start) for start in np.linspace(0, highest, count)]
    moves = np.flatnonzero(~rest)
    which = np.linspace(0, max(len(moves) - length, 0), count).astype(int)
    starts: list[int] = np.clip(moves[which] - length // _BEFORE, 0, highest).tolist()
    for k in range(1, count):  # none reaches into the next
        starts[k] = max(starts[k], starts[k - 1] + length)
    for k in range(count):
        starts[k] = min(starts[k], len(rest) - (count - k) * length)
    return [first + start for start in starts]


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
            self._made[key] = np.column_stack([self._reduce(by_name[n]) for n in self.curve.names])
        return self._made[key]

    def with_slopes(self, shape: Mapping[str, float], height: Mapping[str, float]) -> Array:
        """The same, then the slopes by the logarithm of each shape."""
        slopes = map(self._reduce, self.curve.slopes(self._velocity, shape, height))
        return np.column_stack([self.at(shape), *slopes])


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


def body_columns(log: Log, names: Sequence[str]) -> dict[str, Array]:
    """The columns of the body's coefficients: inertia, viscous friction, and terms."""
    usual, sign = {"mass": log.acceleration, "sigma_2": log.velocity}, np.sign(log.velocity)
    further = {n: column(n, log) * (sign if TERMS[n].level else 1.0) for n in names if n not in usual}
    return usual | further


def record_of(rows: Rows, terms: Sequence[str], given: Mapping[str, float], all_rows: bool = False) -> Record:
    """The record that is compared.

    Args:
        terms: of the body beside mass and viscous friction.
        given: coefficients of the body that are given, and taken off the force.
        all_rows: rows about reversals and at ends too, as in the published procedure.
    """
    log, q = rows.log, rows.q
    runs = log.runs()

    def reduce(x: Array) -> Array:
        return np.concatenate([filters.decimate(x[run], q) for run in runs])

    counted = rows.moving if all_rows else rows.moving & ~_ringing(log, q)[rows.kept]
    if counted.sum() < LEFT * rows.moving.sum():
        counted = rows.moving
    held = {n: x for n, x in given.items() if n in TERMS or n == "sigma_2"}
    columns = body_columns(log, [*terms, *(n for n in held if n not in terms)])
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
        least, most = FEWEST_BLOCKS if len(rows) == n else 1, max(round(BLOCKS * len(rows) / n), 1)
        count = int(np.clip(len(rows) // BLOCK_ROWS, least, most))
        block[rows] = used + np.arange(len(rows)) * count // len(rows)
        used += count
    return block, file


def _ringing(log: Log, q: int) -> NDArray[np.bool_]:
    """The rows at the ends of runs, and behind a thinning filter those about reversals."""
    rise = max(1, round(RISE / (log.bandwidth * log.step)) if log.bandwidth else 1)
    reach = max(rise, RINGS * q if q > 1 else 1)
    out = np.zeros(len(log), bool)
    for run in log.runs():
        s, here = np.sign(log.velocity[run]), out[run]
        here[: 2 * reach] = here[max(len(s) - 2 * reach, 0) :] = True
        for i in np.flatnonzero(np.diff(s)).tolist() if q > 1 else ():
            here[max(i + 1 - reach, 0) : i + 1 + reach] = True
    return out
