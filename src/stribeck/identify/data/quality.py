"""What is wrong with raw columns, and what is done about it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.identify.log import MANY_ROWS

Mask = NDArray[np.bool_]
FEWEST = 50  # rows of a run: fewer hold no reversal, and a filter takes as many to settle
EVEN = 1e-2  # of the step: what times may be off and still count as evenly spaced
_GAP = 5.5  # steps without a sample that end a run: up to five lost samples are interpolated
_ALIKE = 0.95  # correlation of the ways made, by the position and by the velocity
_OFF = 1.5  # times each other: more is another unit
_SPIKE = 10.0  # times the usual force: what no friction comes to
_RARE = 0.02  # of the rows: more are no fault of a sensor, but what the machine does
_GLITCH, _SCATTER = 20.0, 2.5  # times what is usual beside a cubic: a value that is off; what noise adds
_TRACE = (1 / 6, -2 / 3, 1.0, -2 / 3, 1 / 6)  # of a value that is off by 1, in the distances from cubics
_MOST_LOOKED_AT = 5000  # rows: each takes nine small regressions, all of them some seconds
_WRAPPED = 0.4  # of the position's range, from a row to the next: a turn is over
_STUCK = 50  # samples of one and the same value while the others move: as many as a run needs
_AT_LIMIT = 5  # samples in a row at the largest or smallest value: noise repeats an extreme value once or twice
_WILD, _WILDEST, _ALL_BUT = 1e6, 1e9, 0.99  # of the largest of most samples; where these are 0, in SI units; most
LARGEST = 1e30  # of a value in SI units, and its inverse of a column's largest: squares of them stay numbers
_LEVELS = 100  # a sensor with fewer different values is too coarse to tell clipping from rest


@dataclass(frozen=True)
class Clean:
    """Columns whose time rises, as runs (first and last row) that may be filtered, all else left out; ``resampled``: to the
    step of other files, so that its noise is the filter's."""

    columns: dict[str, Array]
    runs: list[slice]
    step: float
    even: bool
    notes: list[str]
    resampled: bool = False


def clean(columns: dict[str, Array], number: str) -> Clean:
    """Look for what spoils a fit: empty cells, repeated times, gaps, uneven sampling, stuck and clipped sensors.

    Args:
        columns: by role, SI; they may be changed.
        number: what to call the file in messages.

    Raises:
        InputError: too few rows, time that goes backwards, a column of empty cells or of impossible magnitude.
    """
    notes: list[str] = []
    _enough(columns, number)
    columns = _without_empty(columns, number, notes)
    _possible(columns, number)
    time, run_numbers = columns["time"], columns.pop("run", None)
    steps = np.diff(time)
    new_run = np.zeros(len(steps), bool) if run_numbers is None else np.diff(run_numbers) != 0
    if (back := np.flatnonzero((steps < 0) & ~new_run)).size:
        row = int(back[0]) + 1
        raise InputError(
            f"{arg('time')}: {number}: time goes backwards in row {row + 1} ({time[row - 1]:.9g} s, then {time[row]:.9g} s); "
            f"must rise within a run (name the runs' column with {arg('run')})"
        )
    if not steps.any():
        raise InputError(f"{arg('time')}: {number}: {time[0]:.9g} s in every row; must rise")
    repeated = np.append(False, (steps == 0) & ~new_run)
    if count := int(repeated.sum()):
        notes.append(f"{number}: {count} rows repeat the time of the row before; the first of each was kept")
        columns = {name: x[~repeated] for name, x in columns.items()}
        run_numbers = None if run_numbers is None else run_numbers[~repeated]
        time = columns["time"]
        steps = np.diff(time)
        new_run = np.zeros(len(steps), bool) if run_numbers is None else np.diff(run_numbers) != 0
    _enough(columns, number)
    some = steps[:: max(len(steps) // MANY_ROWS, 1)]
    step = float(np.median(some[some > 0]))
    near = (steps < 1.5 * step) & ~new_run
    near &= steps > 0.5 * step
    if near.any():
        step = float(np.mean(steps, where=near))  # to more digits than a single difference has
    gaps = (steps > _GAP * step) & ~new_run
    if count := int(gaps.sum()):
        notes.append(
            f"{number}: {count} gaps in time, the longest {steps[gaps].max():.3g} s (step {step:.3g} s); "
            "the log is cut there, and nothing is filtered across a gap"
        )
    runs = _pieces(columns, new_run | gaps, number, notes)
    _without_glitches(columns, runs, number, notes)
    _agree(columns, runs, number)
    if "force" in columns:
        _without_spikes(columns, number, notes)
    off = max(_jitter(time[r]) for r in runs)
    even = off <= EVEN
    if not even:
        notes.append(
            f"{number}: samples are not evenly spaced (up to {off:.3g} steps off; the step is {step:.3g} s); "
            "resampled to even steps by straight lines"
        )
    return Clean(columns, runs, step, even, notes)


def _agree(columns: dict[str, Array], runs: list[slice], number: str) -> None:
    """Refuse a measured velocity that is another multiple of the position's slope.

    Raises:
        InputError: naming the factor.
    """
    if not {"position", "velocity"} <= set(columns):
        return
    ratio = disagreement([(columns["time"][r], columns["position"][r], columns["velocity"][r]) for r in runs])
    if ratio is not None:
        raise InputError(
            f"{arg('velocity')}: {number}: is {ratio:.3g} times the slope of the position; a sign or a unit is wrong "
            f"({arg('units')}), or it is another body's: leave out {arg('position')} then"
        )


def disagreement(runs: Iterable[tuple[Array, Array, Array]]) -> float | None:
    """How many times the position's slope a velocity is, by runs of time, position and velocity; None where it is the slope.

    Way made over fifty rows is compared, in which noise counts little: as it is, and less its mean, which a tachometer's
    zero does not touch. Where a wrapped angle jumps nothing is compared.
    """
    ways, sums = [], []
    for time, x, v in runs:
        way = np.append(0.0, np.cumsum((v[1:] + v[:-1]) / 2 * np.diff(time)))
        jumps = np.flatnonzero(abs(np.diff(x)) > _WRAPPED * np.ptp(x))
        whole = np.diff(np.searchsorted(jumps, np.arange(0, len(x), FEWEST - 1))) == 0
        ways.append(np.diff(x[:: FEWEST - 1])[whole])
        sums.append(np.diff(way[:: FEWEST - 1])[whole])
    measured, summed = np.concatenate(ways), np.concatenate(sums)
    if len(measured) < 2:
        return None
    both_ratios = [_ratio(measured, summed), _ratio(measured - measured.mean(), summed - summed.mean())]
    ratios = [x for x in both_ratios if x is not None]
    return None if not ratios or any(1 / _OFF < x < _OFF for x in ratios) else ratios[-1]


def _ratio(measured: Array, summed: Array) -> float | None:
    """How many times the ways by the velocity are those by the position, where the two are alike."""
    size = float(np.linalg.norm(measured)) * float(np.linalg.norm(summed))
    alike = float(measured @ summed)
    if size == 0.0 or abs(alike) < _ALIKE * size:
        return None
    return float(np.linalg.norm(summed)) / float(np.linalg.norm(measured)) * float(np.sign(alike))


def _without_glitches(columns: dict[str, Array], runs: list[slice], number: str, notes: list[str]) -> None:
    """Put cubics in place of single values of the motion that stand out of it for one row and no longer, as no body moves: a
    lost bit, a light that flickered. A jump and a kink leave another trace in the differences, and stay."""
    for role in ("position", "velocity"):
        if role not in columns:
            continue
        off = np.zeros(len(columns[role]))
        for rows in runs:
            off[rows] = _glitches(columns[role][rows])
        if count := np.count_nonzero(off):
            columns[role] = columns[role] - off
            first = columns["time"][np.flatnonzero(off)[0]]
            notes.append(
                f"{number}: {role}: {count} single rows stand out of the motion by up to {np.max(abs(off)):.3g} (first at "
                f"{first:.6g} s): cubics through the rows beside in their place"
            )


def _glitches(x: Array) -> Array:
    """By how much single values, or two close to each other, stand out of a run; 0 for the others, and for all where they are
    many."""
    glitches, off = np.zeros(len(x)), _beside_cubic(x)
    usual = max(1.4826 * float(np.median(abs(off))), float(np.quantile(abs(off), 0.95)) / 1.96)
    far = abs(off) > _GLITCH * usual
    if not 0 < np.count_nonzero(far) < 3 * _RARE * len(x):
        return glitches
    far[1:] &= abs(off[1:]) >= abs(off[:-1])
    far[:-1] &= abs(off[:-1]) > abs(off[1:])
    for row in np.flatnonzero(far)[:_MOST_LOOKED_AT].tolist():
        sets = [(row,), *((row, row + by) for by in (-4, -3, -2, -1, 1, 2, 3, 4))]
        if (explained := next(filter(None, (_explained(off, each, usual) for each in sets)), None)) is not None:
            for place, size in explained.items():
                glitches[place + 2] = size
    return glitches


def _explained(off: Array, places: tuple[int, ...], usual: float) -> dict[int, float] | None:
    """The sizes of glitches at these places, if they explain what the rows around show down to its noise."""
    first, last = min(places) - 2, max(places) + 3
    if first < 0 or last > len(off):
        return None
    traces = np.zeros((last - first, len(places)))
    for k, place in enumerate(places):
        traces[place - 2 - first : place + 3 - first, k] = _TRACE
    sizes = np.linalg.lstsq(traces, off[first:last], rcond=None)[0]
    left = off[first:last] - traces @ sizes
    if np.max(abs(left)) > _SCATTER * usual or np.min(abs(sizes)) < 0.25 * _GLITCH * usual:
        return None
    return dict(zip(places, sizes.tolist(), strict=True))


def _beside_cubic(x: Array) -> Array:
    """How far each value, but for two at either end, lies beside a cubic through the two before and the two behind it; a value
    that is off by 1 shows as 1, with -2/3 to each side."""
    return np.asarray(x[2:-2] - (4 * (x[1:-3] + x[3:-1]) - x[:-4] - x[4:]) / 6)


def _without_spikes(columns: dict[str, Array], number: str, notes: list[str]) -> None:
    """Put straight lines in place of single forces far beyond all others: a plug, a bit."""
    force = columns["force"]
    thin = force[:: max(len(force) // MANY_ROWS, 1)]
    middle = float(np.median(thin))
    usual = float(np.quantile(abs(thin - middle), 0.95))
    far = np.concatenate([[True], abs(force - middle) > _SPIKE * usual, [True]])
    spikes = np.flatnonzero(far[1:-1] & ~far[:-2] & ~far[2:])
    if usual > 0.0 and 0 < len(spikes) < _RARE * len(force):
        largest = float(np.max(abs(force[spikes])))
        notes.append(
            f"{number}: force: {len(spikes)} single rows of up to {largest:.3g} beyond all others ({usual:.3g} about the middle; "
            f"first at {columns['time'][spikes[0]]:.6g} s): straight lines in their place"
        )
        kept = np.delete(np.arange(len(force)), spikes)
        columns["force"] = force.copy()
        columns["force"][spikes] = np.interp(spikes, kept, force[kept])


def _pieces(columns: dict[str, Array], breaks: Mask, number: str, notes: list[str]) -> list[slice]:
    """The rows between breaks and stretches of bad sensors, as far as they are many enough."""
    bad = _clipped(columns, number, notes)
    bad |= _stuck(columns, number, notes, bad)
    breaks = breaks | (bad[1:] != bad[:-1])
    cuts = [0, *(np.flatnonzero(breaks) + 1).tolist(), len(bad)]
    pieces = [slice(a, b) for a, b in pairwise(cuts) if not bad[a]]
    runs = [r for r in pieces if r.stop - r.start >= FEWEST]
    if lost := sum(r.stop - r.start for r in pieces if r.stop - r.start < FEWEST):
        notes.append(f"{number}: {lost} rows stand in pieces shorter than {FEWEST} rows and were left out")
    if not runs:
        raise InputError(f"{arg('data')}: {number}: no {FEWEST} rows stand together in one run without a gap")
    return runs


def _jitter(time: Array) -> float:
    """How far times are from an even grid of their own, in steps."""
    step = float(time[-1] - time[0]) / (len(time) - 1)
    blocks = range(0, len(time), MANY_ROWS)
    off = (time[b : b + MANY_ROWS] - time[0] - step * np.arange(b, min(b + MANY_ROWS, len(time))) for b in blocks)
    return max(float(np.max(abs(x))) for x in off) / step


def _enough(columns: dict[str, Array], number: str) -> None:
    rows = len(columns["time"])
    if rows < FEWEST:
        raise InputError(f"{arg('data')}: {number}: has {rows} rows; a fit needs {FEWEST} or more")


def _possible(columns: dict[str, Array], number: str) -> None:
    """Refuse values whose squares are no numbers any more.

    Raises:
        InputError: a line for each such column.
    """
    wrong = [f"{arg(role)}: {number}: {text}" for role, x in columns.items() if (text := impossible(x))]
    if wrong:
        raise InputError(wrong)


def impossible(x: Array) -> str | None:
    """What is wrong with the magnitude of a column (SI), or None."""
    with np.errstate(all="ignore"):
        peak = float(np.nanmax(abs(x)))
    if not peak or 1 / LARGEST <= peak <= LARGEST:
        return None
    text = f"values up to {peak:.3g} in SI units; the largest must lie between {1 / LARGEST:g} and {LARGEST:g}"
    return f"{text} (is the unit right?)"


def unwrapped(time: Array, angle: Array) -> tuple[Array, int]:
    """A wrapped angle (rad) without its jumps, and their number; 0 of an angle that is not wrapped.

    A wrapped angle never leaves one turn, but for a step that noise and rounding add. Where it jumps by more than half a turn,
    the unwrapped motion is at most twice as fast as elsewhere; any other jump is a slip.
    """
    there = np.isfinite(angle) & np.isfinite(time)
    x, apart = angle[there], np.diff(time[there])
    step = np.diff(x)
    on = step - 2 * np.pi * np.round(step / (2 * np.pi))
    moves = (on == step) & (apart > 0)
    fastest = np.max(abs(step[moves]) / apart[moves], initial=0.0)
    wraps = (on != step) & (abs(on) <= 2 * fastest * apart)
    if not wraps.any() or np.ptp(x) > 2 * np.pi + np.max(abs(step[moves]), initial=0.0):
        return angle, 0
    whole = angle.copy()
    whole[there] -= np.append(0.0, np.cumsum(np.where(wraps, step - on, 0.0)))
    return whole, int(np.sum(wraps))


def of_turns(turns: int) -> list[str]:
    """What to say of an angle that was unwrapped."""
    return [f"begins anew after each turn, {turns} times; read as one that goes on"] if turns else []


def wild(x: Array) -> str | None:
    """What is wrong with a column (SI) of which single samples are far beyond all others, or None: whoever simulates with one
    takes steps as small as it is large."""
    size = abs(x[np.isfinite(x)])
    usual = float(np.quantile(size, _ALL_BUT, method="lower"))
    far = size > (_WILD * usual if usual else _WILDEST)
    alone = np.flatnonzero(far & ~np.append(False, far[:-1]) & ~np.append(far[1:], False))
    if not len(alone):
        return None
    text = f"{len(alone)} single samples of up to {size[alone].max():.3g} beyond all others ({usual:.3g} or less)"
    return f"{text}: must be mended, or left empty"


def _without_empty(columns: dict[str, Array], number: str, notes: list[str]) -> dict[str, Array]:
    keep = np.ones(len(columns["time"]), bool)
    for role, x in columns.items():
        empty = ~np.isfinite(x)
        if count := int(empty.sum()):
            if count > len(x) / 2:
                raise InputError(f"{arg(role)}: {number}: {count} of {len(x)} cells are empty or no finite numbers")
            notes.append(f"{number}: {role}: {count} cells are empty or no finite numbers; their rows were left out")
            keep &= ~empty
    if not keep.any():
        raise InputError(f"{arg('data')}: {number}: no row has a number in each of its columns: {', '.join(columns)}")
    return columns if keep.all() else {role: x[keep] for role, x in columns.items()}


def _repeats(x: Array) -> tuple[NDArray[np.intp], NDArray[np.intp], float, int]:
    """First rows and lengths of the stretches of one value, two rows or longer; the usual length (nine in ten stretches
    are no longer), and the number of stretches of any length."""
    same = x[1:] == x[:-1]
    edges = np.flatnonzero(np.diff(same, prepend=False, append=False))
    starts, lengths = edges[::2], edges[1::2] - edges[::2] + 1
    count = len(x) - int(same.sum())
    rank = (0.9 * count - (count - len(lengths))) / max(len(lengths), 1)
    return starts, lengths, float(np.quantile(lengths, rank)) if rank > 0 else 1.0, count


def _stuck(columns: dict[str, Array], number: str, notes: list[str], known: Mask) -> Mask:
    """A sensor that repeats one value for long, though it does not do so by its nature and the body moves."""
    bad = np.zeros(len(columns["time"]), bool)
    motion = columns["position"] if "position" in columns else np.cumsum(columns["velocity"])
    for role in ("force", "velocity", "load", "pressure"):
        if role not in columns:
            continue
        starts, lengths, usual, count = _repeats(columns[role])
        candidates = np.flatnonzero(lengths > max(_STUCK, 20 * usual)).tolist()
        still = 0.02 * float(np.ptp(motion))
        long = [
            i
            for i in candidates
            if abs(motion[starts[i] + lengths[i] - 1] - motion[starts[i]]) > still and not known[starts[i]]
        ]
        if not long or count < _LEVELS:
            continue
        rows = int(sum(lengths[i] for i in long))
        first = columns["time"][starts[long[0]]]
        notes.append(
            f"{number}: {role}: the sensor repeats one value while the body moves, {rows} rows in all "
            f"(first at {first:.6g} s); the log is cut there, without them"
        )
        for i in long:
            bad[starts[i] : starts[i] + lengths[i]] = True
    return bad


def _clipped(columns: dict[str, Array], number: str, notes: list[str]) -> Mask:
    """A sensor at the end of its range: its largest or smallest value again and again, and not by coarse steps."""
    bad = np.zeros(len(columns["time"]), bool)
    for role in ("force", "velocity"):
        x = columns.get(role)
        if x is None:
            continue
        starts, lengths, usual, count = _repeats(x)
        if count < _LEVELS or usual > 2:
            continue
        values = x[starts]
        for end, word in ((x.max(), "largest"), (x.min(), "smallest")):
            at = np.flatnonzero((values == end) & (lengths >= _AT_LIMIT))
            rows = int(lengths[at].sum())
            if rows:
                notes.append(
                    f"{number}: {role}: clipped at its {word} value {end:.6g} in {rows} rows "
                    f"(first at {columns['time'][starts[at[0]]]:.6g} s); the log is cut there, without them"
                )
                for i in at:
                    bad[starts[i] : starts[i] + lengths[i]] = True
    return bad
