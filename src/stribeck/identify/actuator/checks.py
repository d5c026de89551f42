"""Detects errors in a recording: gaps, columns that end early, units, signs."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

import numpy as np

from stribeck.identify.actuator.bridges import GAP
from stribeck.identify.actuator.recordings import Logs, Recording
from stribeck.identify.data.quality import disagreement

_TAIL = 0.02  # of a recording that a column may lack at its end: a filter's delay, or a slower sensor's last sample


def before(logs: Logs) -> list[str]:
    """Errors that the recordings show without a fit."""
    return [note for r in logs.recordings for note in (*r.notes, *_gaps(r), *_tails(r), *_rates(r))]


def _gaps(r: Recording) -> list[str]:
    """Missing samples."""
    gaps = np.diff(r.t)
    step = float(np.median(gaps))
    long = gaps > GAP * step
    if not long.any():
        return []
    missing = int(np.sum(np.rint(gaps[long] / step) - 1))
    at = float(r.t[:-1][long][0])
    return [
        f"{r.file}: {missing} samples are missing in {int(long.sum())} gaps (first after {at:.4g} s, longest "
        f"{gaps.max():.3g} s); inputs are interpolated there, and outputs are not compared"
    ]


def _tails(r: Recording) -> Iterator[str]:
    """Columns with empty cells, columns that end before the others, and columns that never change."""
    for name, c in chain(r.outputs.items(), r.inputs.items()):
        good = np.isfinite(c.x) & np.isfinite(c.t)
        last, empty = float(c.t[good][-1]), int((~good).sum())
        place = f"{r.file}: {name}: column {c.column!r}"
        if last < (1 - _TAIL) * r.t[-1]:
            yield f"{place} ends at {last:.4g} s, the recording at {r.t[-1]:.4g} s: was it cut short?"
        elif empty:
            yield f"{place} has {empty} empty cells, which are left out"
        if name in r.outputs and not np.ptp(c.x[good]) > 0:
            yield f"{place} never changes"


def _rates(r: Recording) -> Iterator[str]:
    """Contradictions between a measured speed and the derivative of the measured position."""
    for name, c in r.outputs.items():
        body, _, what = name.rpartition(".")
        y = r.outputs.get(f"{body}.y")
        if what != "v" or y is None:
            continue
        good, also = np.isfinite(y.x), np.isfinite(c.x)
        if (ratio := disagreement([(y.t[good], y.x[good], np.interp(y.t[good], c.t[also], c.x[also]))])) is not None:
            text = f"is {ratio:.4g} times the slope of {y.column!r}: a sign or a unit is wrong"
            yield f"{r.file}: {name}: column {c.column!r} {text}"
