"""Sampling clocks: different rates of files, and a column from a slower clock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from statistics import median_high

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from stribeck.arrays import Array
from stribeck.identify.data.filters import HIGHEST, low_pass
from stribeck.identify.data.quality import FEWEST_ROWS, Clean

_SAME_STEP = 1e-3  # of the step: files that differ by less share a grid
_WINDOW = 25  # changes of a column: fewer do not show its clock
_REGULAR = 0.8  # of the changes of a held column are one period apart; a sample of the same value shows no change
_LATE, _DRIFTS = 1.2, 0.3  # rows, range of the delays of one clock: the most, and from which on the clock drifts
_KNOWN = 0.8  # rows, range of the delays: with more the sampling times are known to a tenth of a row
_ENOUGH = 4  # times the fewest rows: samples that make a log
_HELD = ("position", "velocity", "force")


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
        if role == "force" and one_run and known and not whole and len(own_time) >= _ENOUGH * FEWEST_ROWS:
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


def same_step(step: float, other: float) -> bool:
    """Whether files with these steps share a grid."""
    return abs(step - other) <= _SAME_STEP * other


def on_one_clock(parts: Sequence[Clean]) -> tuple[list[Clean], float, list[str]]:
    """Files for a log of one step: without runs that are too short for it, the step, and a note if there are others."""
    step = median_high([p.step for p in parts])  # a file has this step, and its noise determines the cut-off
    if all(same_step(p.step, step) for p in parts):
        return list(parts), step, []
    stated = ", ".join(f"{s:.4g}" for s in sorted({p.step for p in parts})[:6])
    note = f"the files are sampled at different steps ({stated} s); all were resampled to {step:.4g} s"
    out = []
    for p in parts:
        long = [r for r in p.runs if len(even_times(p.columns["time"][r], step)) >= FEWEST_ROWS]
        out.append(replace(p, runs=long, even=p.even and same_step(p.step, step)))
    return out, step, [note]


def even_times(time: Array, step: float) -> Array:
    """An even grid over some times."""
    return np.asarray(time[0] + step * np.arange(int((time[-1] - time[0]) / step * (1 + 1e-12)) + 1))


def resampled(role: str, time: Array, x: Array, own: float, grid: Array) -> Array:
    """A column on an even grid; ``own``: its step.

    To a longer step it passes a low-pass filter, and the motion to a shorter one a cubic spline.
    """
    step = float(grid[-1] - grid[0]) / (len(grid) - 1)
    if same_step(own, step):
        return np.asarray(np.interp(grid, time, x))
    even = even_times(time, own)
    x = np.interp(even, time, x)
    if own < step:
        return np.asarray(np.interp(grid, even, low_pass(x, HIGHEST / step, own) if own < step / 1.1 else x))
    return np.asarray(CubicSpline(even, x)(grid) if role in ("position", "velocity") else np.interp(grid, even, x))
