"""The tables of a sweep's parts: one row for each lane, or the lanes' trajectories."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.loops.oscillation import amplitude_and_period
from stribeck.simulation import Ensemble

Values = NDArray[Any]
Column = tuple[str, str, str, Values]  # name, unit, meaning, values


def _lane_columns(e: Ensemble, first: int, lanes: NDArray[np.int64]) -> list[Column]:
    """The first columns: number of the lane, its values, status and reason."""
    reasons = np.array([reason or "" for reason in e.reason])[lanes]
    varied = [(path, "", "varied", values[lanes]) for path, values in e.values.items()]
    status = [("status", "", "done or failed", np.where(reasons == "", "done", "failed"))]
    return [
        ("lane", "", "number of the lane", first + lanes),
        *varied,
        *status,
        ("reason", "", "why it failed", reasons),
    ]


def trajectories(e: Ensemble, first: int) -> list[Column]:
    """A row for each time that each lane reached; a lane that failed at once has one row without a time."""
    reached = np.isfinite(e[e.columns[0].name])
    begun = reached.copy()
    begun[:, 0] = True
    lanes, rows = np.nonzero(begun)
    t = np.where(reached[lanes, rows], e.t[rows], np.nan)
    columns = [(c.name, c.unit, c.meaning, e[c.name][lanes, rows]) for c in e.columns]
    return [*_lane_columns(e, first, lanes), ("t", "s", "time", t), *columns]


def summary(e: Ensemble, first: int) -> list[Column]:
    """A row for each lane; peaks and final values over the rows that it reached."""
    lanes = np.arange(len(e))
    columns = _lane_columns(e, first, lanes)
    columns += [("slips", "", "|v| rises through v_s", e.slips), ("sticks", "", "|v| falls through v_s", e.sticks)]
    last = np.maximum(np.isfinite(e[e.columns[0].name]).sum(axis=1) - 1, 0)
    for c in e.columns:
        largest = np.where(np.isnan(e[c.name]), -np.inf, np.abs(e[c.name])).max(axis=1)
        peak = np.where(np.isinf(largest), np.nan, largest)
        columns.append((f"peak_{c.name}", c.unit, f"largest magnitude: {c.meaning}", peak))
        columns.append((f"final_{c.name}", c.unit, f"at the end: {c.meaning}", e[c.name][lanes, last]))
    late = e.t >= 0.5 * e.t[-1]
    y = next(column for column in e.columns if column.name.split(".")[-1] == "y")  # of a machine, the first body's
    amplitude, period = amplitude_and_period(e.t[late], e[y.name][:, late])
    columns.append(("amplitude", y.unit, f"half of peak to peak of {y.name} in the second half", amplitude))
    return [
        *columns,
        ("period", "s", f"mean time between upward crossings of {y.name}'s middle in the second half", period),
    ]
