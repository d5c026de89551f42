"""Clocks: files sampled at different rates, a rate that changes within a file, a column that comes from a slower clock."""

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

_ALIKE = 1e-3  # of the step: files that differ by less share a grid
_ANOTHER = 1.5  # between steps: more is another rate, as a lost sample doubles a step
_WINDOW = 25  # rows whose median step tells the rate, whatever twelve of them do
_REGULAR = 0.8  # of the changes of a held column stand at one distance: where the value does not change, one is missed
_LATE, _DRIFTS = 1.2, 0.3  # rows: what samples of a clock may be late by, more or less; from when on it is not locked
_KNOWN = 0.8  # rows: samples that come late by so much more or less are known to a tenth of one
_ENOUGH = 4  # times the fewest rows: samples that are a log of their own
_HELD = ("position", "velocity", "force")


def steady_stretches(columns: dict[str, Array], name: str, notes: list[str]) -> list[dict[str, Array]]:
    """The columns of a file, cut where its sampling rate changes for good."""
    time = columns["time"]
    steps = np.diff(time)
    if len(steps) < 4 * _WINDOW or not np.all(np.isfinite(steps)):
        return [columns]
    count = len(steps) // _WINDOW
    local = np.median(steps[: count * _WINDOW].reshape(count, _WINDOW), axis=1)
    if np.any(local <= 0) or float(local.max()) < _ANOTHER * float(local.min()):
        return [columns]
    cuts, middle = [0], float(local[0])
    for i in range(1, count - 1):
        if not 1 / _ANOTHER < local[i] / middle < _ANOTHER and 1 / 1.1 < local[i + 1] / local[i] < 1.1:
            around = steps[(i - 1) * _WINDOW : (i + 1) * _WINDOW]  # the row at which it changes
            new = abs(np.log(np.maximum(around, 1e-300) / local[i])) < abs(np.log(np.maximum(around, 1e-300) / middle))
            cuts.append((i - 1) * _WINDOW + int(np.argmax(new)) + 1)
            middle = float(local[i])
    cuts.append(len(time))
    parts = [slice(a, b) for a, b in pairwise(cuts) if b - a >= FEWEST]
    if len(parts) < 2:
        return [columns]
    stated = ", ".join(f"{np.median(np.diff(time[p])):.4g} s from {time[p.start]:.4g} s" for p in parts[:4])
    notes.append(f"{name}: two clocks: the step changes within the file ({stated}); each part is taken on its own")
    return [{role: x[p].copy() for role, x in columns.items()} for p in parts]


def released(columns: dict[str, Array], name: str, notes: list[str], whole: bool = True) -> dict[str, Array]:
    """The columns with those that a slower clock holds as straight lines between their own samples.

    Not the ``whole``: at the samples of the force, if it is among them and their times are known. A line between them crosses
    the jump of friction where the motion turns round.
    """
    columns, of_force = dict(columns), None
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
        at = np.concatenate([[0], changes]) if changes[0] > 0 else changes
        own_time = np.interp(np.concatenate([[0.0], rows]) if changes[0] > 0 else rows, np.arange(len(time)), time)
        columns[role] = np.interp(time, own_time, x[at])
        remedy = "straight lines between its own samples were taken"
        if role == "force" and one_run and known and not whole and len(own_time) > _ENOUGH * FEWEST:
            first = int(changes[0] > 0)  # what is held at first was sampled nobody knows when
            of_force, remedy = (own_time[first:], x[at][first:]), "the log was taken at its own samples"
        notes.append(f"{name}: two clocks: {role} changes once in {every} rows only; {remedy}")
    if of_force is None:
        return columns
    own_time, force = of_force
    there = {role: np.interp(own_time, columns["time"], x) for role, x in columns.items()}
    return there | {"time": own_time, "force": force}


def _own_clock(changes: NDArray[np.intp]) -> tuple[Array, str, bool] | None:
    """When a column that is held between its samples was sampled, in rows, its period, and whether the times are known to a
    part of a row; None where there is no clock.

    A clock that is not locked to the rows shows its samples late, by up to a row and now more, now less: a line through
    all of them, which no sample can be ahead of, tells when they were taken.
    """
    gaps = np.diff(changes)
    usual = int(np.median(gaps))
    if usual < 2:
        return None
    period = float(np.mean(gaps[gaps < 1.5 * usual]))
    for count in (100, 1000, len(changes)):  # the period ever more closely, so that rounding to whole ones stays right
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
    """Files sampled at different steps on the grid of the usual one, each from its own clock."""
    step = median_high([p.step for p in parts])  # a file has it, whose noise tells the cut-off
    if all(abs(p.step - step) <= _ALIKE * step for p in parts):
        return list(parts)
    note = (
        f"the files are sampled at different steps ({', '.join(f'{s:.4g}' for s in sorted({p.step for p in parts})[:6])} s); "
        f"each was resampled to {step:.4g} s from its own clock"
    )
    out = [p if abs(p.step - step) <= _ALIKE * step else _resampled(p, step) for p in parts]
    return [replace(out[0], notes=[*out[0].notes, note]), *out[1:]]


def _resampled(part: Clean, step: float) -> Clean:
    """A file on another step: what is faster than it can hold is filtered off first; smooth curves between slower samples."""
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
