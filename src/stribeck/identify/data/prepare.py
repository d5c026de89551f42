"""Preparation of a log: even sampling, zero-phase smoothing at the most likely cut-off, derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.files import sha256_of
from stribeck.identify.data.clocks import even_times, on_one_clock, released, resampled, same_step
from stribeck.identify.data.filters import ASTRAY, ORDER, SETTLED, low_pass, slope
from stribeck.identify.data.quality import FEWEST_ROWS, Clean, clean, unwrapped, unwrapping_note
from stribeck.identify.data.read import ColumnNames, named_in, read_named
from stribeck.identify.data.smoother import LOOK, likeliest
from stribeck.identify.data.units import is_rotary
from stribeck.identify.log import INTEGRAL, MOTION, STILL, Log
from stribeck.recorded import is_table, opened


@dataclass(frozen=True)
class Preparation:
    """Settings of the preparation; None chooses from the data.

    Attributes:
        cutoff: of the zero-phase Butterworth filter, Hz (order 4 if given); 0 for no filter.
        simulated: for fits by simulation, which need the motion between the samples of the force.
        published: for least squares as published, with central differences and the last rows of each run.
    """

    cutoff: float | None = None
    simulated: bool = False
    published: bool = False


def load_log(sources: Sequence[Any], columns: ColumnNames, how: Preparation | None = None) -> Log:
    """The log in one or more files or tables of the same layout, each a separate run.

    Raises:
        InputError: a file cannot be read or used; a line for each problem.
    """
    names = [f"table {i}" if is_table(each) else Path(each).name for i, each in enumerate(sources, start=1)]
    cleaned, rotary, how = [], list[bool](), how or Preparation()
    for each, name in zip(sources, names, strict=True):
        source = opened(each)
        named = named_in(source, columns)
        motion = (named.names.get(role, "") for role in ("position", "velocity"))
        rotary.append(any(is_rotary(named.units.get(column, "")) for column in motion))
        if rotary[-1] != rotary[0]:
            kinds = {True: "rotary", False: "linear"}
            text = f"{name}: its units are {kinds[rotary[-1]]}, those of {names[0]} are {kinds[rotary[0]]}; must agree"
            raise InputError(f"{arg('unit')}: {text}")
        part, notes = read_named(source, named), list[str]()
        if rotary[-1] and "position" in part:
            part["position"], turns = unwrapped(part["time"], part["position"])
            notes += [f"{name}: position: {text}" for text in unwrapping_note(turns)]
        own_samples = released(part, name, notes, how.simulated)
        if len(own_samples["time"]) < len(part["time"]):  # the published procedure needs all recorded rows
            how = replace(how, published=False)
        part_cleaned = clean(own_samples, name)
        cleaned.append(replace(part_cleaned, notes=[*notes, *part_cleaned.notes]))
    hashes = tuple(sha256_of(Path(each)) for each in sources if not is_table(each))
    log = prepare(cleaned, how, names)
    return log.with_columns(hashes=hashes if len(hashes) == len(sources) else (), rotary=rotary[0])


def prepare(parts: Sequence[Clean], how: Preparation, names: Sequence[str] = ()) -> Log:
    """One log from cleaned columns."""
    parts, step, notes = on_one_clock(parts)
    roles = list(parts[0].columns)
    notes = [*(note for part in parts for note in part.notes), *notes]
    measured = "position" if "position" in roles else "velocity"
    samples = _samples(parts, measured, step)
    smoother = likeliest(samples, step)
    cutoff, order, spline = how.cutoff, ORDER, not how.published
    if cutoff is None:
        order, cutoff, _ = smoother
        notes.append(
            f"{measured}: filtered at {cutoff:.4g} Hz (order {order}, zero phase), where motion and noise have the same spectral "
            "density"
        )
    else:
        notes += _given(cutoff, parts, measured, step)
    trim = max(round(SETTLED / (cutoff * step)) - 1, 0) if cutoff > 0 else 0
    columns, lengths = _columns(parts, measured, step, cutoff, order, trim, spline)
    notes += _too_short(parts, lengths, trim)
    numbers = np.arange(len(lengths), dtype=np.int32)
    run = np.repeat(numbers, lengths) if len(lengths) > 1 else np.broadcast_to(numbers, lengths)  # one takes no memory
    files = [i for i, part in enumerate(parts) for _ in part.runs]
    sources = _sources(roles, measured, cutoff, parts, "a cubic spline" if spline else "central differences")
    sources["unfiltered"] = measured
    parts_of_log: dict[str, Any] = {**columns, "run": run}
    if cutoff > 0 and not how.published:
        rows_kept, end_notes = _without_ends(columns, lengths, round(ASTRAY / (cutoff * step)))
        notes += end_notes
        parts_of_log = {name: x[rows_kept] for name, x in parts_of_log.items()}
    return Log(
        **parts_of_log, step=step, sources=sources, quality=tuple(notes), bandwidth=cutoff or None,
        files=tuple(names[i] for i in files) if names else (), order=order, noise=smoother.noise,
    )  # fmt: skip


def _given(cutoff: float, parts: Sequence[Clean], measured: str, step: float) -> list[str]:
    """The note about a given cut-off, Hz.

    Raises:
        InputError: no filter has this cut-off, or all motion is faster.
    """
    if not cutoff >= 0:
        raise InputError(f"{arg('cutoff')}: {cutoff:g}: must be a frequency in Hz, or 0 for no filter")
    if cutoff == 0:
        return []
    if cutoff >= 0.5 / step:
        raise InputError(f"{arg('cutoff')}: {cutoff:g}: must be below half the sampling rate, {0.5 / step:.6g} Hz")
    longest = max(len(part.columns[measured][rows]) for part in parts for rows in part.runs) * step
    if cutoff * longest < 1:
        least = f"must be at least {1 / longest:.3g} Hz (one period in the longest run), or 0 for no filter"
        raise InputError(f"{arg('cutoff')}: {cutoff:g}: {least}")
    return [f"motion filtered at {cutoff:g} Hz, as given"]


def _columns(
    parts: Sequence[Clean], measured: str, step: float, cutoff: float, order: int, trim: int, spline: bool
) -> tuple[dict[str, Array], list[int]]:
    """Every column of the log, and the rows of each run.

    Raises:
        InputError: the filter leaves fewer rows than a fit needs.
    """
    runs = [
        _run(part, rows, _grid(part, rows, step), step, cutoff, order, measured, spline)
        for part in parts for rows in part.runs
    ]  # fmt: skip
    lengths = [max(len(run["time"]) - trim, 0) for run in runs]
    if (rows := max(len(run["time"]) for run in runs)) - trim < FEWEST_ROWS:
        raise InputError(
            f"{arg('data')}: the longest run has {rows} rows, and the filter needs {trim} to settle: fewer than "
            f"{FEWEST_ROWS} are left; use a longer record or a higher {arg('cutoff')}"
        )
    if len(runs) == 1:  # a long run is not copied
        return {name: x[trim:] for name, x in runs[0].items()}, lengths
    return {name: np.concatenate([run.pop(name)[trim:] for run in runs]) for name in list(runs[0])}, lengths


def _too_short(parts: Sequence[Clean], lengths: Sequence[int], trim: int) -> list[str]:
    """The note about runs that are shorter than the settling of the filter."""
    runs = [r.stop - r.start for part in parts for r in part.runs]
    lost = [n for n, left in zip(runs, lengths, strict=True) if not left]
    if not lost:
        return []
    return [
        f"{len(lost)} of {len(runs)} runs ({sum(lost)} rows) were left out: the filter needs {trim} rows to settle; "
        "a higher cut-off keeps them"
    ]


def _without_ends(
    columns: Mapping[str, Array], lengths: Sequence[int], end: int
) -> tuple[slice | NDArray[np.bool_], list[str]]:
    """The rows without the last ones of runs that end in motion, where the filter is wrong; and the note about it."""
    v = abs(columns["velocity"])
    keep, fastest = np.ones(len(v), bool), float(v.max())
    for stop, n in zip(np.cumsum(lengths).tolist(), lengths, strict=True):
        if n > 4 * end and v[stop - 1] > STILL * fastest:
            keep[stop - end : stop] = False
    if keep.all():
        return slice(None), []
    text = f"the last {np.sum(~keep)} rows were left out: the record ends in motion, and the filter is wrong there"
    return (slice(None, -end) if len(lengths) == 1 else keep), [text]  # a slice copies nothing


def _grid(part: Clean, rows: slice, step: float) -> Array:
    """The times of a run, as measured if they are even, or else on an even grid."""
    time = part.columns["time"][rows]
    return time if part.even else even_times(time, step)


def _run(
    part: Clean, rows: slice, grid: Array, step: float, cutoff: float, order: int, measured: str, spline: bool
) -> dict[str, Array]:
    time = part.columns["time"][rows]
    signals = {"time": grid}
    for name, column in part.columns.items():
        if name != "time":
            signals[name] = column[rows] if part.even else resampled(name, time, column[rows], part.step, grid)
    signals["unfiltered"] = signals[measured]
    for name in MOTION:
        if name in signals and cutoff > 0:
            signals[name] = low_pass(signals[name], cutoff, step, order)
    if "velocity" not in signals:
        signals["velocity"] = slope(signals["position"], step, spline)
    if "position" not in signals:
        signals["position"] = cumulative_trapezoid(signals["velocity"], dx=step, initial=0)
    if "acceleration" not in signals:
        signals["acceleration"] = slope(signals["velocity"], step, spline)
    return signals


def _sources(roles: Sequence[str], measured: str, cutoff: float, parts: Sequence[Clean], slopes: str) -> dict[str, str]:
    filtered = f", low-pass {cutoff:.4g} Hz, zero phase" if cutoff > 0 else ""
    resampled = "" if all(part.even for part in parts) else ", resampled"
    sources = {name: f"measured{resampled}{filtered if name in MOTION else ''}" for name in roles}
    sources.setdefault("position", INTEGRAL)
    sources.setdefault("velocity", f"{slopes} of the position")
    sources.setdefault("acceleration", f"{slopes} of the velocity")
    return sources


def _samples(parts: Sequence[Clean], measured: str, step: float) -> list[Array]:
    """The measured motion of each run, or its first rows, at even steps.

    Files of another step are left out, because resampling filters their noise.
    """
    out = []
    for part in (p for p in parts if same_step(p.step, step)):
        for run in part.runs:
            rows = slice(run.start, min(run.stop, run.start + LOOK))
            x = part.columns[measured][rows]
            out.append(x if part.even else np.interp(_grid(part, rows, step), part.columns["time"][rows], x))
    return out
