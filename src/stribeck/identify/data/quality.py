"""Data quality: faults of raw columns, and their repair."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.identify.log import MANY_ROWS, parted, stretches

Mask = NDArray[np.bool_]
FEWEST_ROWS = 50  # rows of a run: a filter takes about as many to settle, and fewer rows hold no reversal
EVEN = 1e-2  # of the step: deviation up to which times count as evenly spaced
_GAP = 5.5  # steps without a sample that end a run: up to five lost samples are interpolated
_ALIKE = 0.95  # least correlation of the displacements by position and by velocity
_OFF = 1.5  # ratio of both displacements: beyond it a unit is wrong
_RARE = 0.02  # of the rows: more outliers are the behavior of the machine, not a fault of a sensor
_GLITCH, _SCATTER = 20.0, 2.5  # times the usual distance from a cubic: an outlier; the noise beside it
_TRACE = (1 / 6, -2 / 3, 1.0, -2 / 3, 1 / 6)  # distances from cubics that an outlier of 1 causes
_MOST_LOOKED_AT = 5000  # rows: each takes nine small regressions, which take some seconds in all
_WRAPPED = 0.4  # of the position's range: a step between rows that is larger is the wrap of an angle
_AT_LIMIT = 5  # samples in a row at the largest or smallest value: noise repeats an extreme value once or twice
# An outlier's limit: a multiple of the 99 % quantile, or an SI value if that quantile is 0.
_OUTLIER, _OUTLIER_OF_ZEROS, _QUANTILE = 1e6, 1e9, 0.99
LARGEST = 1e30  # of a value in SI units; its inverse bounds a column's largest value. Their squares stay finite
_LEVELS = 100  # with fewer different values, clipping and rest cannot be separated


@dataclass(frozen=True)
class Clean:
    """Columns with rising time, and the runs of rows that may be filtered.

    Attributes:
        columns: by role, SI.
        runs: rows without faults or gaps.
        step: between samples, s.
        even: whether the samples are evenly spaced.
        notes: sentences for the user about faults and repairs.
    """

    columns: dict[str, Array]
    runs: list[slice]
    step: float
    even: bool
    notes: list[str]


def clean(columns: dict[str, Array], file: str) -> Clean:
    """Repair or leave out faults: empty cells, repeated times, gaps, uneven sampling, outliers, stuck and clipped sensors.

    Args:
        columns: by role, SI; they may be changed.
        file: the file's name in messages.

    Raises:
        InputError: too few rows, time that goes backwards, a column of empty cells or of impossible magnitude.
    """
    notes: list[str] = []
    _require_rows(columns, file)
    columns = _without_empty(columns, file, notes)
    _require_magnitudes(columns, file)
    time, run_numbers = columns["time"], columns.pop("run", None)
    steps, new_run = _steps(time, run_numbers)
    if (back := np.flatnonzero((steps < 0) & ~new_run)).size:
        row = int(back[0]) + 1
        raise InputError(
            f"{arg('time')}: {file}: time goes backwards in row {row + 1} ({time[row - 1]:.9g} s, then {time[row]:.9g} s); "
            f"must rise within a run (name the runs' column with {arg('run')})"
        )
    if not steps.any():
        raise InputError(f"{arg('time')}: {file}: {time[0]:.9g} s in every row; must rise")
    repeated = np.append(False, (steps == 0) & ~new_run)
    if count := int(repeated.sum()):
        notes.append(f"{file}: {count} rows repeat the time of the row before and were left out")
        columns = {name: x[~repeated] for name, x in columns.items()}
        run_numbers = None if run_numbers is None else run_numbers[~repeated]
        time = columns["time"]
        steps, new_run = _steps(time, run_numbers)
    _require_rows(columns, file)
    some = steps[:: max(len(steps) // MANY_ROWS, 1)]
    step = float(np.median(some[some > 0]))
    near = (steps < 1.5 * step) & ~new_run
    near &= steps > 0.5 * step
    if near.any():
        step = float(np.mean(steps, where=near))  # a mean has more digits than a single difference
    gaps = (steps > _GAP * step) & ~new_run
    if count := int(gaps.sum()):
        notes.append(
            f"{file}: gaps in time: {count}, the longest {steps[gaps].max():.3g} s (step {step:.3g} s); "
            "the log was split there, and no filter crosses a gap"
        )
    runs = _pieces(columns, new_run | gaps, file, notes)
    _replace_outliers(columns, runs, file, notes)
    _require_agreement(columns, runs, file)
    off = max(_jitter(time[r]) for r in runs)
    even = off <= EVEN
    if not even:
        notes.append(
            f"{file}: samples are not evenly spaced (by up to {off:.3g} of a step of {step:.3g} s); "
            "they were resampled evenly by linear interpolation"
        )
    return Clean(columns, runs, step, even, notes)


def _steps(time: Array, run_numbers: Array | None) -> tuple[Array, Mask]:
    """The steps between rows, and which of them begin a run."""
    steps = np.diff(time)
    return steps, np.zeros(len(steps), bool) if run_numbers is None else np.diff(run_numbers) != 0


def _require_agreement(columns: dict[str, Array], runs: list[slice], file: str) -> None:
    """Compare a measured velocity with the slope of the position.

    Raises:
        InputError: the velocity is a multiple of the slope; the message states the factor.
    """
    if not {"position", "velocity"} <= set(columns):
        return
    ratio = disagreement([(columns["time"][r], columns["position"][r], columns["velocity"][r]) for r in runs])
    if ratio is not None:
        raise InputError(
            f"{arg('velocity')}: {file}: is {ratio:.3g} times the slope of the position; a sign or {arg('unit')} "
            f"is wrong, or it is the velocity of another body (then leave out {arg('position')})"
        )


def disagreement(runs: Iterable[tuple[Array, Array, Array]]) -> float | None:
    """The ratio of a velocity to the slope of the position, or None if both agree.

    Displacements over fifty rows are compared, so that noise counts little. They are compared also without their means,
    which a tachometer's zero offset does not change. Intervals in which a wrapped angle jumps are left out.

    Args:
        runs: time, position and velocity of each run.
    """
    ways, sums = [], []
    for time, x, v in runs:
        way = cumulative_trapezoid(v, time, initial=0)
        jumps = np.flatnonzero(abs(np.diff(x)) > _WRAPPED * np.ptp(x))
        whole = np.diff(np.searchsorted(jumps, np.arange(0, len(x), FEWEST_ROWS - 1))) == 0
        ways.append(np.diff(x[:: FEWEST_ROWS - 1])[whole])
        sums.append(np.diff(way[:: FEWEST_ROWS - 1])[whole])
    measured, summed = np.concatenate(ways), np.concatenate(sums)
    if len(measured) < 2:
        return None
    both_ratios = [_ratio(measured, summed), _ratio(measured - measured.mean(), summed - summed.mean())]
    ratios = [x for x in both_ratios if x is not None]
    return None if not ratios or any(1 / _OFF < x < _OFF for x in ratios) else ratios[-1]


def _ratio(measured: Array, summed: Array) -> float | None:
    """The ratio of displacements by velocity to those by position, or None if they do not correlate."""
    size = float(np.linalg.norm(measured)) * float(np.linalg.norm(summed))
    alike = float(measured @ summed)
    if size == 0.0 or abs(alike) < _ALIKE * size:
        return None
    return float(np.linalg.norm(summed)) / float(np.linalg.norm(measured)) * float(np.sign(alike))


def _replace_outliers(columns: dict[str, Array], runs: list[slice], file: str, notes: list[str]) -> None:
    """Replace isolated outliers of motion and force by cubic interpolation.

    Such an outlier lasts one row and is no motion of a body and no friction: a lost bit, a disturbed optical encoder, or a
    loose plug. A jump or a kink has another pattern of differences and stays.
    """
    for role in ("position", "velocity", "force"):
        if role not in columns:
            continue
        off = np.zeros(len(columns[role]))
        for rows in runs:
            off[rows] = _glitches(columns[role][rows])
        if count := np.count_nonzero(off):
            columns[role] = columns[role] - off
            first = columns["time"][np.flatnonzero(off)[0]]
            notes.append(
                f"{file}: {role}: isolated outliers: {count}, up to {np.max(abs(off)):.3g} (first at {first:.6g} s) "
                "were replaced by cubic interpolation"
            )


def _glitches(x: Array) -> Array:
    """The sizes of the outliers of a run, 0 for all other rows.

    An outlier is a single value, or two that are close to each other. If outliers are frequent, all sizes are 0.
    """
    glitches, off = np.zeros(len(x)), _distance_from_cubic(x)
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
    """The sizes of outliers at these places, or None if they do not explain the rows around them down to the noise."""
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


def _distance_from_cubic(x: Array) -> Array:
    """The distance of each value from a cubic through its two neighbors on each side; two values at each end have none.

    An outlier of 1 has the distance 1, and its neighbors have -2/3.
    """
    return np.asarray(x[2:-2] - (4 * (x[1:-3] + x[3:-1]) - x[:-4] - x[4:]) / 6)


def _pieces(columns: dict[str, Array], breaks: Mask, file: str, notes: list[str]) -> list[slice]:
    """The runs between breaks, without the rows of stuck or clipped sensors, if they are long enough."""
    bad = _repeating(columns, file, notes)
    pieces = [rows for rows in parted(breaks | (bad[1:] != bad[:-1])) if not bad[rows.start]]
    runs = [r for r in pieces if r.stop - r.start >= FEWEST_ROWS]
    if lost := sum(r.stop - r.start for r in pieces if r.stop - r.start < FEWEST_ROWS):
        notes.append(f"{file}: {lost} rows were left out, in pieces shorter than {FEWEST_ROWS} rows")
    if not runs:
        raise InputError(f"{arg('data')}: {file}: no run without a gap has {FEWEST_ROWS} rows")
    return runs


def _jitter(time: Array) -> float:
    """The largest distance of the times from an even grid, in steps."""
    step = float(time[-1] - time[0]) / (len(time) - 1)
    return float(np.max(abs(time - time[0] - step * np.arange(len(time))))) / step


def _require_rows(columns: dict[str, Array], file: str) -> None:
    rows = len(columns["time"])
    if rows < FEWEST_ROWS:
        raise InputError(f"{arg('data')}: {file}: needs {FEWEST_ROWS} rows or more for a fit, has {rows}")


def _require_magnitudes(columns: dict[str, Array], file: str) -> None:
    """Check that the squares of all values are finite.

    Raises:
        InputError: a line for each column that is too large or too small.
    """
    wrong = [f"{arg(role)}: {file}: {text}" for role, x in columns.items() if (text := impossible(x))]
    if wrong:
        raise InputError(wrong)


def impossible(x: Array) -> str | None:
    """The fault in the magnitude of a column (SI), in words, or None."""
    with np.errstate(all="ignore"):
        peak = float(np.nanmax(abs(x)))
    if not peak or 1 / LARGEST <= peak <= LARGEST:
        return None
    text = f"values up to {peak:.3g} in SI units; the largest must lie between {1 / LARGEST:g} and {LARGEST:g}"
    return f"{text} (is the unit right?)"


def unwrapped(time: Array, angle: Array) -> tuple[Array, int]:
    """An angle (rad) without the jumps of wrapping, and the number of these jumps.

    A wrapped angle stays within one turn, apart from a step due to noise and rounding. At a wrap the unwrapped motion is at
    most twice as fast as elsewhere; any other jump is a slip of the sensor.
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


def unwrapping_note(turns: int) -> list[str]:
    """The note for the user that an angle was unwrapped."""
    return [f"wraps after each turn, {turns} times; it was unwrapped"] if turns else []


def isolated_outliers(x: Array) -> str | None:
    """The isolated outliers of a column (SI), in words, or None. A simulation with one would need extremely small steps."""
    size = abs(x[np.isfinite(x)])
    usual = float(np.quantile(size, _QUANTILE, method="lower"))
    far = size > (_OUTLIER * usual if usual else _OUTLIER_OF_ZEROS)
    alone = np.flatnonzero(far & ~np.append(False, far[:-1]) & ~np.append(far[1:], False))
    if not len(alone):
        return None
    text = f"isolated outliers: {len(alone)}, up to {size[alone].max():.3g} (other samples reach {usual:.3g})"
    return f"{text}: correct them or leave their cells empty"


def _without_empty(columns: dict[str, Array], file: str, notes: list[str]) -> dict[str, Array]:
    keep = np.ones(len(columns["time"]), bool)
    for role, x in columns.items():
        empty = ~np.isfinite(x)
        if count := int(empty.sum()):
            if count > len(x) / 2:
                raise InputError(f"{arg(role)}: {file}: {count} of {len(x)} cells are empty or not finite")
            notes.append(f"{file}: {role}: {count} cells are empty or not finite; their rows were left out")
            keep &= ~empty
    if not keep.any():
        raise InputError(f"{arg('data')}: {file}: no row has a finite value in every column ({', '.join(columns)})")
    return columns if keep.all() else {role: x[keep] for role, x in columns.items()}


def _repeats(x: Array) -> tuple[NDArray[np.intp], NDArray[np.intp], float, int]:
    """Stretches of one repeated value.

    Returns:
        First rows and lengths of the stretches of two rows or more; the usual length, which 90 % of all stretches do not
        exceed; and the number of stretches of any length.
    """
    same = x[1:] == x[:-1]
    edges = stretches(same)
    starts, lengths = edges[:, 0], np.ptp(edges, axis=1) + 1
    count = len(x) - int(same.sum())
    rank = (0.9 * count - (count - len(lengths))) / max(len(lengths), 1)
    return starts, lengths, float(np.quantile(lengths, rank)) if rank > 0 else 1.0, count


def _repeating(columns: dict[str, Array], file: str, notes: list[str]) -> Mask:
    """Rows of a clipped or stuck sensor, which usually changes: it repeats one value.

    A clipped one repeats its largest or smallest value. A stuck one repeats any value for long while the body moves.
    """
    time = columns["time"]
    bad = np.zeros(len(time), bool)
    motion = columns["position"] if "position" in columns else np.cumsum(columns["velocity"])
    still = 0.02 * float(np.ptp(motion))
    for role in ("force", "velocity", "load", "pressure"):
        starts, lengths, usual, count = _repeats(columns.get(role, np.zeros(1)))
        if count < _LEVELS:
            continue
        value, enough = columns[role][starts], lengths >= (_AT_LIMIT if usual <= 2 else np.inf)
        moved = abs(motion[starts + lengths - 1] - motion[starts])
        low, high = float(columns[role].min()), float(columns[role].max())
        rows = {
            f"clipped at its largest value {high:.6g}": enough & (value == high),
            f"clipped at its smallest value {low:.6g}": enough & (value == low),
        }
        stuck = (lengths > max(FEWEST_ROWS, 20 * usual)) & (moved > still) & ~np.any(list(rows.values()), axis=0)
        rows["the sensor is stuck at one value while the body moves,"] = stuck
        for text, which in rows.items():
            for first, length in zip(starts[which].tolist(), lengths[which].tolist(), strict=True):
                bad[first : first + length] = True
            if which.any():
                notes.append(
                    f"{file}: {role}: {text} in {lengths[which].sum()} rows (first at {time[starts[which][0]]:.6g} s); these "
                    "rows were left out and the log was split there"
                )
    return bad
