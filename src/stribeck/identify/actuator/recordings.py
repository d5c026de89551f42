"""Reads LOGS.toml: the recordings, the known numbers of each, and the parameters to fit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.constants import Constant, show
from stribeck.errors import InputError, arg, nearest
from stribeck.identify.actuator.bridges import Bridged, bridged
from stribeck.identify.data.quality import LARGEST, impossible, wild
from stribeck.parameter_sets import read_toml
from stribeck.recorded import Source, listed
from stribeck.recorded.logs import opened_log, time_of
from stribeck.recorded.units import ACCELERATION, ANGLE, DRIVE, FORCE, LENGTH, PRESSURE, SPEED, TIME

_UNITS = LENGTH | ANGLE | SPEED | ACCELERATION | FORCE | PRESSURE | DRIVE
_KEYS = ("file", "time", "outputs", "inputs", "known", "hold_out", "window", "name", "episode")
_SOUGHT = ("low", "high", "start", "prior")
_FEWEST = 8  # samples of a recording, or of a stretch
_TOP = ("log", "unknown", "laws", "window", "schema")


@dataclass(frozen=True)
class Channel:
    """A recorded column in SI units with its times; nan where a sample is missing.

    ``unit`` is the file's, if no gain is given. ``beside``: further terms of an output, such as inertia. These are columns
    at the same times, by the name of the fitted coefficient (``outputs.COLUMN.NAME``).
    """

    column: str
    t: Array
    x: Array
    unit: str = ""
    noise: float | None = None
    held: bool = False  # constant between samples, as a sampled controller's output
    beside: Mapping[str, Array] = field(default_factory=dict)
    smooth: bool = False  # a cubic spline between samples

    @cached_property
    def bridged(self) -> Bridged:
        """The valid samples in order of time, with interpolated gaps."""
        good = np.isfinite(self.x) & np.isfinite(self.t)
        t, first = np.unique(self.t[good], return_index=True)
        return bridged(t, self.x[good][first])


@dataclass(frozen=True)
class Named:
    """A column as declared in LOGS.toml.

    That is its name, factor to SI, noise, unit, own column of times, and whether it is constant between samples.
    """

    column: str
    factor: float = 1.0
    noise: float | None = None
    unit: str = ""
    time: str | None = None
    held: bool = False


@dataclass(frozen=True)
class Recording:
    """One run of the actuator: times from 0 s, measured columns by the machine's names, and signals by path.

    ``known`` are the numbers that differ in this run; ``hold_out``: whether it is held out. ``as_well``: by cause,
    alternatives of the run that measurement errors allow.
    """

    file: str
    t: Array
    outputs: dict[str, Channel]
    inputs: dict[str, Channel] = field(default_factory=dict)
    known: dict[str, float] = field(default_factory=dict)
    hold_out: bool = False
    window: float | None = None
    notes: tuple[str, ...] = ()
    as_well: Mapping[str, Sequence[Recording]] = field(default_factory=dict)


@dataclass(frozen=True)
class Sought:
    """A parameter to fit, by path: its bounds, initial value, and prior (mean and standard deviation).

    ``nuisance``: an initial state of a recording, which is fitted and not reported.
    """

    path: str
    low: float
    high: float
    start: float | None = None
    prior: tuple[float, float] | None = None
    nuisance: bool = False


@dataclass(frozen=True)
class Logs:
    """The content of LOGS.toml; ``path``: the file, if there is one."""

    recordings: tuple[Recording, ...]
    sought: tuple[Sought, ...]
    laws: dict[str, tuple[str, ...]] = field(default_factory=dict)
    path: Path | None = None


def read_logs(path: str | Path, needs_unknown: bool = True) -> Logs:
    """The recordings that a LOGS.toml lists, in SI units.

    Args:
        path: the file.
        needs_unknown: whether a file without parameters to fit is an error.

    Raises:
        InputError: the file or a recording cannot be read; a line for each mistake.
    """
    path = Path(path)
    data = read_toml(path)
    problems = [f"{path}: {k}: unknown key{nearest(k, _TOP)} (known: {', '.join(_TOP)})" for k in data if k not in _TOP]
    entries = data.get("log")
    if not isinstance(entries, list) or not entries:
        problems.append(f"{path}: log: missing: there must be at least one [[log]]")
        entries = []
    found = []
    for i, entry in enumerate(entries):
        try:
            found.append(_recording(entry, f"log.{i}", path.parent, data.get("window")))
        except InputError as error:
            problems += [f"{path}: {line}" for line in error.problems]
    sought, wrong = sought_of(_table(data.get("unknown", {}), f"{path}: unknown", problems))
    problems += [f"{path}: {line}" for line in wrong]
    if not sought and needs_unknown and not problems:
        problems.append(f"{path}: unknown: missing: at least one path with its bounds must be sought")
    laws: dict[str, tuple[str, ...]] = {}
    for contact, names in _table(data.get("laws", {}), f"{path}: laws", problems).items():
        if not isinstance(names, list) or not names or not all(isinstance(n, str) for n in names):
            problems.append(f"{path}: laws.{contact}: {show(names)}: must be a list of names of laws")
        else:
            laws[contact] = tuple(names)
    if found and not problems and all(r.hold_out for r in found) and needs_unknown:
        problems.append(f"{path}: log.0.hold_out: true: at least one recording must be for fitting")
    if problems:
        raise InputError(problems)
    return Logs(tuple(found), tuple(sought), laws, path)


def _table(given: object, where: str, problems: list[str]) -> Mapping[str, object]:
    if isinstance(given, Mapping):
        return given
    problems.append(f"{where}: {show(given)}: must be a table")
    return {}


def _number(x: object) -> bool:
    return Constant("", "").problem(x) is None


def sought_of(unknown: Mapping[str, object], argument: bool = False) -> tuple[list[Sought], list[str]]:
    """The entries of [unknown], or of an argument of that name (each a table, or low and high), and their errors."""
    found: list[Sought] = []
    wrong: list[str] = []
    for path, table in unknown.items():
        where = arg(f"unknown.{path}") if argument else f"unknown.{path}"
        if argument and isinstance(table, list | tuple) and len(table) == 2:
            table = {"low": table[0], "high": table[1]}
        wrong += _sought(path, table, where, found)
    return found, wrong


def _sought(path: str, table: object, where: str, into: list[Sought]) -> list[str]:
    """Append one entry of [unknown]; returns its errors."""
    if not isinstance(table, Mapping):
        return [f"{where}: {show(table)}: must be a table with low and high"]
    found = [
        f"{where}.{k}: unknown key{nearest(k, _SOUGHT)} (known: {', '.join(_SOUGHT)})"
        for k in table
        if k not in _SOUGHT
    ]
    prior = table.get("prior")
    mean = dev = math.nan
    if prior is not None:
        if (
            not isinstance(prior, Mapping)
            or set(prior) != {"mean", "deviation"}
            or not all(map(_number, prior.values()))
        ):
            return [*found, f"{where}.prior: {show(prior)}: must be {{ mean = NUMBER, deviation = NUMBER }}"]
        mean, dev = float(prior["mean"]), float(prior["deviation"])
        if dev <= 0:
            return [*found, f"{where}.prior.deviation: {show(dev)}: must be > 0"]
    low, high = table.get("low", mean - 6 * dev), table.get("high", mean + 6 * dev)
    for name, x in (("low", low), ("high", high)):
        if not _number(x):
            missing = name not in table
            text = (
                "missing: must be given, unless there is a prior" if missing else f"{show(x)}: must be a finite number"
            )
            found.append(f"{where}.{name}: {text}")
    if found:
        return found
    if not low < high:
        return [f"{where}.high: {show(high)}: must be > low ({show(low)})"]
    start = table.get("start")
    if start is not None and not (_number(start) and low <= start <= high):
        return [f"{where}.start: {show(start)}: must be a number from low to high ({show(low)} to {show(high)})"]
    given = None if prior is None else (mean, dev)
    into.append(Sought(path, float(low), float(high), None if start is None else float(start), given))
    return []


def _recording(entry: object, where: str, folder: Path, window: Any) -> Recording:
    """One [[log]]."""
    if not isinstance(entry, Mapping):
        raise InputError(f"{where}: {show(entry)}: must be a table")
    problems = [
        f"{where}.{k}: unknown key{nearest(k, _KEYS)} (known: {', '.join(_KEYS)})" for k in entry if k not in _KEYS
    ]
    window = entry.get("window", window)
    if window is not None and not (_number(window) and window > 0):
        problems.append(f"{where}.window: {show(window)}: must be a number > 0 (s)")
    known = _table(entry.get("known", {}), f"{where}.known", problems)
    problems += [f"{where}.known.{k}: {show(x)}: must be a finite number" for k, x in known.items() if not _number(x)]
    hold = entry.get("hold_out", False)
    if not isinstance(hold, bool):
        problems.append(f"{where}.hold_out: {show(hold)}: must be true or false")
    if not isinstance(entry.get("file"), str):
        raise InputError([*problems, f"{where}.file: missing: must be given, the recording's file"])
    wanted: dict[tuple[str, str], Named] = {}
    time = _column(entry["time"], f"{where}.time", TIME, problems) if "time" in entry else None
    for group in ("outputs", "inputs"):
        for name, given in _table(entry.get(group, {}), f"{where}.{group}", problems).items():
            if (column := _column(given, f"{where}.{group}.{name}", _UNITS, problems)) is None:
                continue
            if column.held and group == "outputs":
                problems.append(f"{where}.{group}.{name}.held: true: must be said of an input: an output is a sample")
            wanted[group, name] = column
    if not any(group == "outputs" for group, _ in wanted) and not problems:
        problems.append(f"{where}.outputs: missing: at least one measured column must be given")
    if problems:
        raise InputError(problems)
    return _read(entry, where, folder, time, wanted, None if window is None else float(window))


def _column(given: object, where: str, units: Mapping[str, float], problems: list[str]) -> Named | None:
    """A column from its name, or from a table with further keys."""
    if isinstance(given, str):
        return Named(given)
    keys = ("column", "unit", "gain", "noise", "time", "held")
    if not isinstance(given, Mapping) or not isinstance(given.get("column"), str):
        problems.append(f"{where}: {show(given)}: must be a column's name, or {{ column = NAME, unit = UNIT }}")
        return None
    wrong = [f"{where}.{k}: unknown key{nearest(k, keys)} (known: {', '.join(keys)})" for k in given if k not in keys]
    unit, noise, time, gain = given.get("unit", ""), given.get("noise"), given.get("time"), given.get("gain", 1.0)
    held = given.get("held", False)
    if not isinstance(held, bool):
        wrong.append(f"{where}.held: {show(held)}: must be true or false")
    if unit and (not isinstance(unit, str) or unit not in units):
        wrong.append(f"{where}.unit: {show(unit)}: unknown unit{nearest(str(unit), units)}")
    if not (_number(gain) and gain != 0):
        wrong.append(f"{where}.gain: {show(gain)}: must be a number other than 0, by which the column is multiplied")
    if noise is not None and not (_number(noise) and noise > 0):
        wrong.append(f"{where}.noise: {show(noise)}: must be a number > 0, the standard deviation")
    elif noise is not None and not 1 / LARGEST <= noise <= LARGEST:
        wrong.append(f"{where}.noise: {show(noise)}: must lie between {1 / LARGEST:g} and {LARGEST:g}")
    if time is not None and not isinstance(time, str):
        wrong.append(f"{where}.time: {show(time)}: must be the name of a column")
    problems += wrong
    if wrong:
        return None
    factor, told = gain * (units[unit] if unit else 1.0), "" if "gain" in given else unit
    return Named(given["column"], factor, noise, told, time, held is True)


def _episode(given: object, where: str) -> int:
    """The number of an episode from LOGS.toml.

    Raises:
        InputError: the value is not an episode's number.
    """
    if isinstance(given, int) and not isinstance(given, bool) and given >= 0:
        return given
    raise InputError(f"{where}.episode: {show(given)}: must be a whole number >= 0")


def _source(entry: Mapping[str, Any], where: str, folder: Path) -> Source:
    """The file, open.

    Raises:
        InputError: it cannot be read.
    """
    episode = _episode(entry["episode"], where) if "episode" in entry else None
    try:
        return opened_log(folder / entry["file"], episode)
    except InputError as error:
        raise InputError([f"{where}.file: {line}" for line in error.problems]) from None
    except OSError as error:  # an invalid file name
        raise InputError(f"{where}.file: {show(entry['file'])}: cannot be read: {error.strerror}") from None


def _read(
    entry: Mapping[str, Any], where: str, folder: Path, time: Named | None, wanted: dict[tuple[str, str], Named],
    window: float | None,
) -> Recording:  # fmt: skip
    """The columns of one recording, in order of time."""
    source = _source(entry, where, folder)
    if time is None:  # a topic of a bag has its own times, an episode of LeRobot "timestamp"
        first = next(c.column for (group, _), c in wanted.items() if group == "outputs")
        usual = "timestamp" if "episode" in entry else "t"
        time = Named(time_of(source, first) or usual)
    time, wanted = _in_si(time, source, TIME), {key: _in_si(c, source, _UNITS) for key, c in wanted.items()}
    own = {key: c.time or time_of(source, c.column) for key, c in wanted.items()}
    names = {f"{where}.time": time.column}
    names |= {f"{where}.{g}.{n}": c.column for (g, n), c in wanted.items()}
    names |= {f"{where}.{g}.{n}.time": at for (g, n), at in own.items() if at and at != time.column}
    times = {f"{where}.{g}.{n}": f"{where}.{g}.{n}.time" for g, n in wanted}
    times = {role: at if at in names else f"{where}.time" for role, at in times.items()}
    columns, notes = _columns(source, where, names, times), list(getattr(source, "notes", []))
    t = columns.pop(f"{where}.time") * time.factor
    keep, more = _in_order(t, str(entry["file"]))
    notes += more
    if len(keep) < _FEWEST:
        few = f"has {len(keep)} rows with a time: must have at least {_FEWEST}"
        raise InputError(f"{where}.file: {show(entry['file'])}: {few}")
    if text := impossible(t[keep]):
        raise InputError(f"{where}.time: {show(time.column)}: {text}")
    if window is not None and window < (least := _FEWEST * float(np.median(np.diff(t[keep])))):
        raise InputError(f"{where}.window: {show(window)}: must be at least {least:.3g} s, {_FEWEST} samples")
    origin, found = float(t[keep[0]]), {"outputs": {}, "inputs": {}}  # type: ignore[var-annotated]
    for (group, name), c in wanted.items():
        label, x, at, rows = f"{where}.{group}.{name}", columns[f"{where}.{group}.{name}"] * c.factor, t, keep
        if f"{label}.time" in columns:
            at = columns[f"{label}.time"] * time.factor
            rows, more = _in_order(at, f"{entry['file']}: {name}")
            notes += [] if np.isnan(at).any() else more  # shorter columns of a table end in empty cells
        if not np.isfinite(x[rows]).any():
            raise InputError(f"{label}: {show(c.column)}: holds no number")
        if text := impossible(x[rows]) or wild(x[rows]):
            raise InputError(f"{label}: {show(c.column)}: {text}")
        found[group][name] = Channel(c.column, at[rows] - origin, x[rows], c.unit, c.noise, c.held)
    known = {k: float(x) for k, x in entry.get("known", {}).items()}
    return Recording(
        str(entry.get("name", entry["file"])), t[keep] - origin, found["outputs"], found["inputs"], known,
        bool(entry.get("hold_out", False)), window, tuple(notes),
    )  # fmt: skip


def _in_si(column: Named, source: Source, known: Mapping[str, float]) -> Named:
    """A column in the unit that its file states, unless LOGS.toml gives a unit or a gain."""
    if column.unit or column.factor != 1.0 or not (unit := source.unit(column.column, known)):
        return column
    return replace(column, factor=known[unit], unit=unit)


def _columns(source: Source, where: str, names: Mapping[str, str], times: Mapping[str, str]) -> dict[str, Array]:
    """The columns by their use.

    Raises:
        InputError: a column is missing, contains no numbers, or is not as long as its times.
    """
    if missing := [(role, name) for role, name in names.items() if name not in source.names]:
        raise InputError(
            [
                f"{role}: {show(name)}: {source.path} has no such column"
                + (nearest(name, source.names) or f" (it has {listed(source.names)})")
                for role, name in missing
            ]
        )
    try:
        return source.columns(dict(names), times)
    except InputError as error:
        raise InputError([f"{where}.file: {source.path}: {line}" for line in error.problems]) from None


def _in_order(t: Array, file: str) -> tuple[NDArray[np.int64], list[str]]:
    """The rows with a valid, increasing time, and notes about the others."""
    notes = []
    there = np.flatnonzero(np.isfinite(t))
    if len(there) < len(t):
        notes.append(f"{file}: {len(t) - len(there)} rows have no time and are left out")
    highest = np.maximum.accumulate(t[there]) if len(there) else t[there]
    rising = np.append(True, t[there][1:] > highest[:-1])[: len(there)]
    if not rising.all():
        notes.append(f"{file}: {int((~rising).sum())} rows repeat a time or go back in time and are left out")
    return there[rising], notes
