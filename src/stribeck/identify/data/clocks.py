"""Sampling clocks: different rates of files, a rate that changes within a file, and a column from a slower clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from statistics import median_high

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.data.filters import HIGHEST, low_pass
from stribeck.identify.data.quality import FEWEST, Clean

_SAME_STEP = 1e-3  # of the step: files that differ by less share a grid
_ANOTHER_RATE = 1.5  # ratio of steps: a larger one is another rate, as a lost sample doubles a step
_WINDOW = 25  # rows: their median step is the rate, even if twelve are wrong
_REGULAR = 0.8  # of the changes of a held column are one period apart; a sample of the same value shows no change
_LATE, _DRIFTS = 1.2, 0.3  # rows, range of the delays of one clock: the most, and from which on the clock drifts
_KNOWN = 0.8  # rows, range of the delays: with more the sampling times are known to a tenth of a row
_ENOUGH = 4  # times the fewest rows: samples that make a log
_HELD = ("position", "velocity", "force")


def steady_stretches(columns: dict[str, Array], name: str, notes: list[str]) -> list[dict[str, Array]]:
    """The columns of a file, split where its sampling rate changes permanently."""
    time = columns["time"]
    steps = np.diff(time)
    if len(steps) < 4 * _WINDOW or not np.all(np.isfinite(steps)):
        return [columns]
    count = len(steps) // _WINDOW
    local = np.median(steps[: count * _WINDOW].reshape(count, _WINDOW), axis=1)
    if np.any(local <= 0) or float(local.max()) < _ANOTHER_RATE * float(local.min()):
        return [columns]
    cuts, middle = [0], float(local[0])
    for i in range(1, count - 1):
        if not 1 / _ANOTHER_RATE < local[i] / middle < _ANOTHER_RATE and 1 / 1.1 < local[i + 1] / local[i] < 1.1:
            around = steps[(i - 1) * _WINDOW : (i + 1) * _WINDOW]  # the row at which it changes
            new = abs(np.log(np.maximum(around, 1e-300) / local[i])) < abs(np.log(np.maximum(around, 1e-300) / middle))
            cuts.append((i - 1) * _WINDOW + int(np.argmax(new)) + 1)
            middle = float(local[i])
    cuts.append(len(time))
    parts = [slice(a, b) for a, b in pairwise(cuts) if b - a >= FEWEST]
    if len(parts) < 2:
        return [columns]
    stated = ", ".join(f"{np.median(np.diff(time[p])):.4g} s from {time[p.start]:.4g} s" for p in parts[:4])
    notes.append(f"{name}: the sampling rate changes within the file (steps: {stated}); each part is a separate run")
    return [{role: x[p].copy() for role, x in columns.items()} for p in parts]


def released(columns: dict[str, Array], name: str, notes: list[str], whole: bool = True) -> dict[str, Array]:
    """The columns, with those that a slower clock holds interpolated linearly between the samples of that clock.

    Args:
        columns: by role, SI.
        name: the file's name in notes.
        notes: receives a sentence for each such column.
        whole: keep all rows. Otherwise, if the force is such a column and its sampling times are known, the log has only the
            rows at these times: linear interpolation would smooth the jump of friction at a reversal.
    """
    columns, force_samples = dict(columns), None
    one_run = "run" not in columns and bool(np.all(np.diff(columns["time"]) > 0))
    for role in _HELD:
        if role not in columns or len(columns[role]) < 10 * _WINDOW:
            continue
        x = columns[role]
        changes = np.flatnonzero(np.diff(x) != 0) + 1
        if len(changes) < _WINDOW:
            continue
        time = columns["time"]
        clock = _own_clock(changes)
        if clock is None:
            continue
        rows, every, known = clock
        own_time = np.interp(rows, np.arange(len(time)), time)
        columns[role] = np.interp(time, np.append(time[0], own_time), x[np.append(0, changes)])
        remedy = "it was interpolated linearly between its samples"
        if role == "force" and one_run and known and not whole and len(own_time) >= _ENOUGH * FEWEST:
            force_samples, remedy = (own_time, x[changes]), "the log was resampled at its samples"
        notes.append(f"{name}: {role} has a slower clock, with one sample in {every} rows; {remedy}")
    if force_samples is None:
        return columns
    own_time, force = force_samples
    there = {role: np.interp(own_time, columns["time"], x) for role, x in columns.items()}
    return there | {"time": own_time, "force": force}


def _own_clock(changes: NDArray[np.intp]) -> tuple[Array, str, bool] | None:
    """The sampling times of a column that is held between its samples, or None if it has no clock of its own.

    A drifting clock shows its samples late, by up to one row. No sample can be early, so a straight line through the changes
    gives the sampling times.

    Returns:
        The times in rows, the period in rows, and whether the times are known to a fraction of a row.
    """
    gaps = np.diff(changes)
    usual = int(np.median(gaps))
    if usual < 2:
        return None
    period = float(np.mean(gaps[gaps < 1.5 * usual]))
    for count in (100, 1000, len(changes)):  # refines the period, so that it rounds to whole periods correctly
        number = np.append(0.0, np.cumsum(np.round(gaps[: count - 1] / period)))
        period, first = np.polyfit(number, changes[:count], 1)
    late = changes - (first + period * number)
    if np.ptp(late) <= _LATE and np.ptp(late) > _DRIFTS:
        taken = first + period * number + (float(late.min()) + float(late.max()) - 1.0) / 2
        return np.maximum(taken, 0.0), f"{period:.5g}", bool(np.ptp(late) > _KNOWN)
    if float(np.mean(gaps % usual == 0)) < _REGULAR or float(np.mean(gaps == usual)) < _REGULAR:
        return None
    return changes.astype(float), f"{usual}", False


def on_one_clock(parts: Sequence[Clean]) -> list[Clean]:
    """Files of different sampling steps, each resampled from its own clock to the median step."""
    step = median_high([p.step for p in parts])  # a file has this step, and its noise determines the cut-off
    if all(abs(p.step - step) <= _SAME_STEP * step for p in parts):
        return list(parts)
    note = (
        f"the files are sampled at different steps ({', '.join(f'{s:.4g}' for s in sorted({p.step for p in parts})[:6])} s); "
        f"all were resampled to {step:.4g} s"
    )
    out = [p if abs(p.step - step) <= _SAME_STEP * step else _resampled(p, step) for p in parts]
    return [replace(out[0], notes=[*out[0].notes, note]), *out[1:]]


def _resampled(part: Clean, step: float) -> Clean:
    """A file at another step: a low-pass filter before a longer step, cubic splines of the motion for a shorter one."""
    from scipy.interpolate import CubicSpline

    columns: dict[str, list[Array]] = {name: [] for name in part.columns}
    runs, place = [], 0
    for rows in part.runs:
        time = part.columns["time"][rows]
        even = time[0] + part.step * np.arange(int((time[-1] - time[0]) / part.step * (1 + 1e-12)) + 1)
        grid = even[0] + step * np.arange(int((even[-1] - even[0]) / step * (1 + 1e-12)) + 1)
        if len(grid) < FEWEST:
            continue
        for name, column in part.columns.items():
            if name == "time":
                columns[name].append(grid)
                continue
            x = np.interp(even, time, column[rows])
            if part.step < step / 1.1:
                x = low_pass(x, HIGHEST / step, part.step)
            smooth = name in ("position", "velocity") and part.step > step
            columns[name].append(np.asarray(CubicSpline(even, x)(grid)) if smooth else np.interp(grid, even, x))
        runs.append(slice(place, place + len(grid)))
        place += len(grid)
    joined = {name: np.concatenate(x) if x else np.empty(0) for name, x in columns.items()}
    return Clean(joined, runs, step, True, part.notes, resampled=True)
