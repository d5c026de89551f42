"""From raw columns to a log: even steps, zero-phase filtering with a cut-off from the data, derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.files import sha256_of
from stribeck.identify.data.clocks import on_one_clock, released, steady_stretches
from stribeck.identify.data.effect import LONGEST_LOOK, OF_REGRESSION, OF_SIMULATION, by_effect, quiet
from stribeck.identify.data.filters import ASTRAY, HIGHEST, SETTLED, low_pass, slope
from stribeck.identify.data.quality import FEWEST, Clean, clean, unwrapped
from stribeck.identify.data.read import ColumnNames, named_in, read_named
from stribeck.identify.data.units import is_rotary
from stribeck.identify.log import INTEGRAL, STILL, Log
from stribeck.recorded import is_table, opened

_LADDER = (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)  # round numbers, no coarser than the spectrum tells its edge
_ABOVE_NOISE = 10.0  # what the spectrum of a measured motion stands above its floor up to the cut-off
_SLOWEST_FILTER = 20.0  # lowest frequencies of the spectrum: what a cut-off chosen from the data is at least
_LOST = 0.01  # of the motion's variance: less may go
_MORE_THAN_NOISE = 4.0  # the variance that a filter takes away, of the noise's


@dataclass(frozen=True)
class Preparation:
    """How raw columns become a log; None chooses from the data.

    Attributes:
        cutoff: of the zero-phase Butterworth filter (order 4, there and back), Hz; 0 takes the motion as it is.
        simulated: for simulations, which integrate the noise of the velocity away but not what a filter rounds off: a
            cut-off chosen from the data is raised.
        published: for plain least squares as published, which keeps the last rows of a run.
        spline: slopes by splines where noise would let central differences do: of a motion that is sampled coarsely.
    """

    cutoff: float | None = None
    simulated: bool = False
    published: bool = False
    spline: bool = False


def load_log(sources: Sequence[Any], columns: ColumnNames, how: Preparation | None = None) -> Log:
    """The log in one file or table, or in several of the same layout, each a run of its own.

    Raises:
        InputError: a file cannot be read or used; a line for each problem.
    """
    names = [f"table {i}" if is_table(each) else Path(each).name for i, each in enumerate(sources, start=1)]
    cleaned, owners, how = [], [], how or Preparation()
    rotary = list[bool]()
    for each, name in zip(sources, names, strict=True):
        source = opened(each)
        named = named_in(source, columns)
        motion = (named.names.get(role, "") for role in ("position", "velocity"))
        rotary.append(any(is_rotary(named.units.get(column, "")) for column in motion))
        if rotary[-1] != rotary[0]:
            kinds = {True: "turns", False: "moves straight"}
            text = (
                f"{name}: {kinds[rotary[-1]]} by its units, {names[0]} {kinds[rotary[0]]}; must be one kind of motion"
            )
            raise InputError(f"{arg('units')}: {text}")
        notes: list[str] = []
        for part in steady_stretches(read_named(source, named), name, notes):
            if rotary[-1] and "position" in part:
                part["position"], turns = unwrapped(part["time"], part["position"])
                if turns:
                    notes.append(
                        f"{name}: position: begins anew after each turn, {turns} times; read as one that goes on"
                    )
            own_samples = released(part, name, notes, how.simulated)
            if len(own_samples["time"]) < len(part["time"]):  # no published log: far fewer rows move than were recorded
                how = replace(how, published=False, spline=True)
            cleaned_part = clean(own_samples, name)
            cleaned.append(replace(cleaned_part, notes=[*notes, *cleaned_part.notes]))
            owners.append(name)
            notes = []
    hashes = tuple(sha256_of(Path(each)) for each in sources if not is_table(each))
    log = prepare(on_one_clock(cleaned), how, owners)
    return log.with_columns(hashes=hashes if len(hashes) == len(sources) else (), rotary=rotary[0])


def prepare(parts: Sequence[Clean], how: Preparation, names: Sequence[str] = ()) -> Log:
    """One log from cleaned columns."""
    step = parts[0].step
    roles = list(parts[0].columns)
    notes = [note for part in parts for note in part.notes]
    measured = "position" if "position" in roles else "velocity"
    seen = _measured_spectrum(parts, measured, step)
    cutoff, chosen, spline = how.cutoff, 0.0, how.simulated or how.spline
    if cutoff is None:
        cutoff, why = choose_cutoff(measured, *seen, step)
        notes.append(why)
        if (kept := keeping_all(parts, measured, seen[2], cutoff, step)) > cutoff:
            cutoff = kept
            notes.append(f"raised to {cutoff:.4g} Hz: below, the filter takes more away than noise")
        by_position = measured == "position"
        higher = 0.0 if how.simulated else by_effect(_met(parts, measured), by_position, cutoff, step)
        if higher > cutoff:
            cutoff = higher
            notes.append(
                f"raised to {cutoff:.4g} Hz: below, ramps or reversals are rounded off, and the force is met less well"
            )
        motion = parts[0].columns[measured][parts[0].runs[0]]
        shares = OF_SIMULATION if how.simulated else OF_REGRESSION
        if (higher := quiet(motion, by_position, seen[2], cutoff, step, shares)) > cutoff and not how.published:
            chosen, cutoff, spline = cutoff * how.simulated, higher, True  # of what has noise a spline makes more
            what = "position and velocity only " if how.simulated else ""
            notes.append(
                f"{what}raised to {cutoff:.3g} Hz: the speed's noise stays below {shares[0]:g} of the largest speed"
            )
    else:
        notes += _given(cutoff, parts, measured, step)
    trim = max(round(SETTLED / (cutoff * step)) - 1, 0) if cutoff > 0 else 0
    columns, lengths = _columns(parts, roles, measured, step, cutoff, trim, spline)
    notes += _too_short(parts, lengths, trim)
    again = chosen if chosen and "acceleration" not in roles else None
    if again:  # the acceleration's noise does not average out: it multiplies the mass
        for last, count in zip(np.cumsum(lengths).tolist(), lengths, strict=True):
            rows = slice(last - count, last)
            columns["acceleration"][rows] = low_pass(columns["acceleration"][rows], again, step)
    run = np.repeat(np.arange(len(lengths), dtype=np.int32), lengths)
    files = [i for i, part in enumerate(parts) for _ in part.runs]
    sources = _sources(roles, measured, cutoff, parts, "a cubic spline" if spline else "central differences")
    sources["unfiltered"] = measured
    parts_of_log: dict[str, Any] = {**columns, "run": run}
    if cutoff > 0 and not how.published:
        lowest = again or cutoff  # the acceleration's filter goes astray too
        rows_kept, end_notes = _without_ends(columns, lengths, round(ASTRAY / (lowest * step)))
        notes += end_notes
        parts_of_log = {name: x[rows_kept] for name, x in parts_of_log.items()}
    return Log(
        **parts_of_log, step=step, sources=sources, quality=tuple(notes), bandwidth=cutoff or None,
        acceleration_bandwidth=again, files=tuple(names[i] for i in files) if names else (), spectrum=seen,
    )  # fmt: skip


def _given(cutoff: float, parts: Sequence[Clean], measured: str, step: float) -> list[str]:
    """What a reader should know of a cut-off that is given, Hz.

    Raises:
        InputError: no filter has it, or all of the motion lies above it.
    """
    if not cutoff >= 0:
        raise InputError(f"{arg('cutoff')}: {cutoff:g}: must be a frequency in Hz, or 0 for no filter")
    if cutoff == 0:
        return []
    if cutoff >= 0.5 / step:
        raise InputError(f"{arg('cutoff')}: {cutoff:g}: must be below half the sampling rate, {0.5 / step:.6g} Hz")
    longest = max(len(part.columns[measured][rows]) for part in parts for rows in part.runs) * step
    if cutoff * longest < 1:
        least = f"must be at least {1 / longest:.3g} Hz, a swing in the longest run, or 0 for no filter"
        raise InputError(f"{arg('cutoff')}: {cutoff:g}: {least}")
    return [f"motion filtered at {cutoff:g} Hz, as given"]


def _met(parts: Sequence[Clean], measured: str) -> list[tuple[Array, Array]]:
    """Motion and force of the runs with even steps."""
    known = [p for p in parts if p.even and "force" in p.columns and "acceleration" not in p.columns]
    return [(p.columns[measured][r], p.columns["force"][r]) for p in known for r in p.runs]


def _columns(
    parts: Sequence[Clean], roles: Sequence[str], measured: str, step: float, cutoff: float, trim: int, spline: bool
) -> tuple[dict[str, Array], list[int]]:  # fmt: skip
    """Every column of the log, one after the other so that little is held twice; and the rows of each run."""
    if len(parts) == 1 and len(parts[0].runs) == 1:  # however long: nothing is copied that need not be
        grid = _grid(parts[0], parts[0].runs[0], step)
        whole = _run(parts[0], parts[0].runs[0], grid, step, cutoff, measured, spline)
        parts[0].columns.clear()
        return {name: x[trim:] for name, x in whole.items()}, [_enough(len(whole["time"]), trim)]
    grids = [_grid(part, r, step) for part in parts for r in part.runs]
    kept = [max(len(grid) - trim, 0) for grid in grids]
    _enough(max(len(grid) for grid in grids), trim)
    place = np.concatenate([[0], np.cumsum(kept)])
    names = ["time", "position", "velocity", "acceleration", *(r for r in roles if r not in _MOTION)]
    names += ["unfiltered"]
    out = {name: np.empty(place[-1]) for name in names}
    number = 0
    for part in parts:
        for r in part.runs:
            rows = slice(place[number], place[number + 1])
            for name, x in _run(part, r, grids[number], step, cutoff, measured, spline).items():
                out[name][rows] = x[trim:]
            number += 1
    return out, kept


def _too_short(parts: Sequence[Clean], lengths: Sequence[int], trim: int) -> list[str]:
    """What to say of runs of which nothing is left."""
    runs = [r.stop - r.start for part in parts for r in part.runs]
    lost = [n for n, left in zip(runs, lengths, strict=True) if not left]
    if not lost:
        return []
    return [
        f"{len(lost)} of {len(runs)} runs, {sum(lost)} rows, are left out: each has no more than the {trim} rows in which the "
        "filter settles; a higher cut-off keeps them"
    ]


def _without_ends(
    columns: Mapping[str, Array], lengths: Sequence[int], end: int
) -> tuple[slice | NDArray[np.bool_], list[str]]:
    """The rows without the last ones of the runs that end in motion, where the filter goes astray; and what to say of it."""
    v = abs(columns["velocity"])
    keep, fastest = np.ones(len(v), bool), float(v.max())
    for stop, n in zip(np.cumsum(lengths).tolist(), lengths, strict=True):
        if n > 4 * end and v[stop - 1] > STILL * fastest:
            keep[stop - end : stop] = False
    if keep.all():
        return slice(None), []
    text = f"the last {np.sum(~keep)} rows are left out: the filter goes astray where the record ends in motion"
    return (slice(None, -end) if len(lengths) == 1 else keep), [text]  # a slice copies nothing


def _enough(rows: int, trim: int) -> int:
    """The rows that are left of the longest run.

    Raises:
        InputError: too few.
    """
    if rows - trim < FEWEST:
        raise InputError(
            f"{arg('data')}: {rows} rows in the longest run, of which {trim}, where the filter settles, are dropped: less than "
            f"{FEWEST} are left; a longer record or a higher {arg('cutoff')} leaves more"
        )
    return rows - trim


_MOTION = ("time", "position", "velocity", "acceleration")


def _grid(part: Clean, rows: slice, step: float) -> Array:
    """The times of a run: as measured where they are even, else on an even grid."""
    time = part.columns["time"][rows]
    return time if part.even else time[0] + step * np.arange(int((time[-1] - time[0]) / step * (1 + 1e-12)) + 1)


def _run(
    part: Clean, rows: slice, grid: Array, step: float, cutoff: float, measured: str, spline: bool
) -> dict[str, Array]:
    time = part.columns["time"][rows]
    signals = {"time": grid}
    for name, column in part.columns.items():
        if name != "time":
            signals[name] = column[rows] if part.even else np.interp(grid, time, column[rows])
    signals["unfiltered"] = signals[measured]
    for name in ("position", "velocity", "acceleration"):
        if name in signals and cutoff > 0:
            signals[name] = low_pass(signals[name], cutoff, step)
    if "velocity" not in signals:
        signals["velocity"] = slope(signals["position"], step, spline)
    if "position" not in signals:
        signals["position"] = np.concatenate(
            [[0.0], np.cumsum((signals["velocity"][1:] + signals["velocity"][:-1]) * step / 2)]
        )
    if "acceleration" not in signals:
        signals["acceleration"] = slope(signals["velocity"], step, spline)
    return signals


def _sources(roles: Sequence[str], measured: str, cutoff: float, parts: Sequence[Clean], slopes: str) -> dict[str, str]:
    filtered = f", low-pass {cutoff:g} Hz, zero phase" if cutoff > 0 else ""
    resampled = "" if all(part.even for part in parts) else ", resampled"
    sources = {name: f"measured{resampled}{filtered if name in _MOTION[1:] else ''}" for name in roles}
    sources.setdefault("position", INTEGRAL)
    sources.setdefault("velocity", f"{slopes} of the position")
    sources.setdefault("acceleration", f"{slopes} of the velocity")
    return sources


def _longest(parts: Sequence[Clean], measured: str, step: float) -> Array:
    """The measured motion in the longest run, on even steps; of files that were resampled to others' step the noise tells
    nothing."""
    original = [p for p in parts if not p.resampled] or parts
    part, rows = max(((p, r) for p in original for r in p.runs), key=lambda pr: pr[1].stop - pr[1].start)
    rows = slice(rows.start, min(rows.stop, rows.start + LONGEST_LOOK))
    x = part.columns[measured][rows]
    return x if part.even else np.interp(_grid(part, rows, step), part.columns["time"][rows], x)


def _measured_spectrum(parts: Sequence[Clean], measured: str, step: float) -> tuple[Array, Array, float]:
    """The spectrum of the measured motion in the longest run, and its noise floor."""
    x = _longest(parts, measured, step)
    frequency, power = spectrum(x, step)
    return frequency, power, noise_floor(frequency, power, step)


def choose_cutoff(measured: str, frequency: Array, power: Array, floor: float, step: float) -> tuple[float, str]:
    """The frequency (Hz) up to which the motion's spectrum stands clear of its noise floor, and that in words."""
    highest = HIGHEST / step
    buried = np.flatnonzero(power < _ABOVE_NOISE * floor)
    edge = float(frequency[buried[0]]) if len(buried) else highest
    cutoff = min(_rounded(max(edge, _SLOWEST_FILTER * frequency[0])), highest)
    if edge >= highest:
        return highest, f"{measured}: no noise floor in sight; low-pass at {highest:.4g} Hz, 0.4 of the sampling rate"
    return cutoff, (
        f"{measured}: its spectrum stands {_ABOVE_NOISE:g} times above the noise floor up to {edge:.3g} Hz; "
        f"low-pass at {cutoff:g} Hz, zero phase"
    )


def keeping_all(parts: Sequence[Clean], measured: str, floor: float, cutoff: float, step: float) -> float:
    """The cut-off, raised until what the filter takes away is no more than the noise, or little of the motion.

    Small reversals on a long slow motion, such as presliding, stand high in no part of the spectrum; yet they are no noise.
    """
    x = _longest(parts, measured, step)
    edge = min(round(SETTLED / (cutoff * step)), len(x) // 4)
    highest = HIGHEST / step
    while cutoff < highest:
        taken = (x - low_pass(x, cutoff, step))[edge : len(x) - edge]
        lost = float(np.mean(taken**2))
        if lost <= max(_MORE_THAN_NOISE * floor * (0.5 / step - cutoff), _LOST * float(np.var(x))):
            break
        cutoff = min(cutoff * 1.5, highest)
    return float(cutoff)


def spectrum(x: Array, step: float) -> tuple[Array, Array]:
    """Frequencies (Hz) and power spectral density in sixths of an octave; trends do not leak into it."""
    rate = np.diff(x) / step
    f, p = signal.welch(signal.detrend(rate), 1 / step, nperseg=min(len(rate), 4096))
    f, p = f[1:], p[1:]
    p = p / (2 * np.sin(np.pi * f * step) / step) ** 2  # undoes the difference
    band = np.round(6 * np.log2(f / f[0])).astype(int)
    bands = np.unique(band)
    return (
        np.array([np.exp(np.mean(np.log(f[band == b]))) for b in bands]),
        np.array([np.mean(p[band == b]) for b in bands]),
    )


def noise_floor(frequency: Array, power: Array, step: float) -> float:
    """The lowest level in the upper part of a spectrum: what is measured where nothing moves any more."""
    return float(np.min(power[frequency > 0.15 / step]))


def _rounded(x: float) -> float:
    """The nearest number of a short ladder, on a logarithmic scale."""
    exponent = np.floor(np.log10(x))
    choices = [rung * 10.0**e for e in (exponent, exponent + 1) for rung in _LADDER]
    return float(min(choices, key=lambda c: abs(np.log(c / x))))
