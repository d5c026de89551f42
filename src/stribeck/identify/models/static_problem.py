"""The rows of a static fit: filtered force, decimated and without rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from stribeck.arrays import Array
from stribeck.identify.data import filters
from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import ENOUGH_ROWS, Log

Reduce = Callable[[Array], Array]
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


@dataclass
class Rows:
    """A record as a static fit compares it; trials of one record share this.

    Attributes:
        log: the record, with a velocity of 0 where the body rests; of a very long one stretches evenly over it.
        source: all of it.
        q: one row in so many is kept behind the filter.
        kept: the rows of the log that are; ``weight``: 0 for those in which the body rests.
        rest: the rows of the log in which it does.
    """

    log: Log
    source: Log
    q: int
    kept: NDArray[np.intp]
    weight: Array
    rest: NDArray[np.bool_]


def rows_of(log: Log, to_choose: bool = False) -> Rows:
    """The rows that a static fit of a record compares.

    Args:
        to_choose: laws are to be chosen from: a wider band, as another record is met at all frequencies.
    """
    source = log
    rest = at_rest(log)
    share = float(np.mean(rest))
    if share <= _LITTLE_REST or share > 0.98:
        rest[:] = False
    smeared = beside_rest(rest, log)
    if len(log) > ENOUGH_ROWS:
        log, every = in_stretches(log, rest, ENOUGH_ROWS)
        rest, smeared = rest[every], smeared[every]
    if rest.any():
        log = log.with_columns(velocity=np.where(rest, 0.0, log.velocity))
    q = decimation(log, _FEW_TO_CHOOSE if to_choose else _FEW_ROWS)
    kept = kept_rows(log, q)
    near = rest
    if q > 1 and rest.any():  # the filter spreads a jump over some rows
        near = np.convolve(rest, np.ones(2 * q + 1), mode="same") > 0.5
    return Rows(log, source, q, kept, np.where((near | smeared)[kept], 0.0, 1.0), rest)


def beside_rest(rest: NDArray[np.bool_], log: Log) -> NDArray[np.bool_]:
    """Rows so near a rest that the motion's filter may have moved them there: the force is the rest's. A short motion keeps
    the middle half of it."""
    out = np.zeros(len(rest), bool)
    if not (log.bandwidth and log.step):
        return out
    width = round(_SMEARED / (log.bandwidth * log.step))
    for rows in log.runs():
        edges = np.flatnonzero(np.diff(~rest[rows], prepend=False, append=False)).tolist()
        for first, last in zip(edges[::2], edges[1::2], strict=True):
            reach = min(width, (last - first) // 4)
            out[rows.start + first : rows.start + first + reach] = first > 0
            if last < rows.stop - rows.start:
                out[rows.start + last - reach : rows.start + last] = True
    return out


def decimation(log: Log, few: int) -> int:
    """By what the rate can be lowered and still hold the force's band, and so many rows."""
    longest = max(log.runs(), key=lambda r: r.stop - r.start)
    x = log.force[longest.start : min(longest.stop, longest.start + (1 << 18))]
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


def thinning(log: Log, q: int) -> Reduce:
    """Filter and decimation of each run."""
    if q == 1:
        return lambda x: x
    runs = list(log.runs())
    return lambda x: np.concatenate([filters.decimate(x[rows], q) for rows in runs])


def kept_rows(log: Log, q: int) -> NDArray[np.intp]:
    """The rows of the log that :func:`thinning` keeps."""
    return np.concatenate([r.start + filters.decimated_rows(r.stop - r.start, q) for r in log.runs()])


def shortened(log: Log, enough: int) -> Log:
    """The record, or stretches of a longer one, ``enough`` rows in all."""
    return log if len(log) <= enough else in_stretches(log, at_rest(log), enough)[0]


def in_stretches(log: Log, rest: NDArray[np.bool_], enough: int) -> tuple[Log, NDArray[np.intp]]:
    """Stretches of a long log as separate runs, evenly over the moving parts of every run, and their rows.

    They have ``enough`` rows in all.
    """
    parts, owner = [], []
    runs = list(log.runs())
    shares = [max(int(enough * (r.stop - r.start) / len(log)), 1) for r in runs]
    counts = [int(np.clip(share // _SHORTEST_BLOCK, 1, BLOCKS)) for share in shares]
    usual = int(np.median([max(s // c, _SHORTEST_BLOCK) for s, c in zip(shares, counts, strict=True)]))
    for number, (rows, count) in enumerate(zip(runs, counts, strict=True)):
        length = min(usual, rows.stop - rows.start)  # of one length where it can be
        if count * length >= rows.stop - rows.start:
            count, length = 1, rows.stop - rows.start
        starts = _starts(rest[rows], count, length, rows.start)
        parts += [slice(a, a + length) for a in starts]
        owner += [number] * count
    every = np.concatenate([np.arange(p.start, p.stop) for p in parts])
    run = np.repeat(np.arange(len(parts), dtype=np.int32), [p.stop - p.start for p in parts])
    files = tuple(log.files[i] for i in owner) if log.files else ()
    return log.rows(every).with_columns(run=run, files=files), every


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
