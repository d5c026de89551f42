"""Reads LOGS.toml: the recordings, the known numbers of each, and the parameters to fit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Annotated, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, ValidationError
from scipy.interpolate import BSpline

from stribeck.arrays import Array
from stribeck.constants import Constant, kind_of, show
from stribeck.errors import InputError, arg, naming, nearest
from stribeck.identify.actuator.bridges import Bridged, bridged
from stribeck.identify.data.quality import LARGEST, impossible, isolated_outliers
from stribeck.identify.data.smoother import smooth, smoothing
from stribeck.identify.log import FEWEST_SAMPLES
from stribeck.machine.table import ConstantField, FileTable, Problem, problems_of, quantity, refused
from stribeck.parameter_sets import read_toml
from stribeck.recorded import Source, require_columns
from stribeck.recorded.logs import opened_log, time_of
from stribeck.recorded.units import ACCELERATION, ANGLE, DRIVE, FORCE, LENGTH, PRESSURE, SPEED, TIME

FAR = 6.0  # standard deviations that no error reaches: bounds from a prior or from first samples cut nothing off
Finite = Annotated[float, ConstantField(Constant("", ""))]
T = TypeVar("T", bound=FileTable)
Column = TypeVar("Column", bound="ColumnTable")


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

    def rows(self, there: NDArray[np.bool_] | NDArray[np.intp]) -> Channel:
        """Some of its samples."""
        beside = {name: x[there] for name, x in self.beside.items()}
        return replace(self, t=self.t[there], x=self.x[there], beside=beside)

    @cached_property
    def bridged(self) -> Bridged:
        """The valid samples in order of time, with interpolated gaps."""
        good = np.isfinite(self.x) & np.isfinite(self.t)
        t, first = np.unique(self.t[good], return_index=True)
        return bridged(t, self.x[good][first])

    @cached_property
    def smoothing(self) -> float:
        """The parameter of the likeliest cubic smoothing spline of the valid samples."""
        return smoothing(self.bridged.t, self.bridged.x)

    @cached_property
    def smoothed(self) -> BSpline:
        """The likeliest cubic smoothing spline of the valid samples."""
        return smooth(self.bridged.t, self.bridged.x, self.smoothing)


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
    notes: tuple[str, ...] = ()
    as_well: Mapping[str, Sequence[Recording]] = field(default_factory=dict)

    def crossed(self) -> list[Recording]:
        """The run with inputs that cross their gaps otherwise; none if no input lacks samples."""
        draws = max((len(c.bridged.others) for c in self.inputs.values()), default=0)
        inputs = [
            {
                path: replace(c, t=c.bridged.t, x=[*c.bridged.others, *[c.bridged.x] * draws][n])
                for path, c in self.inputs.items()
            }
            for n in range(draws)
        ]
        return [replace(self, inputs=each) for each in inputs]


@dataclass(frozen=True)
class Sought:
    """A parameter to fit, by path: its bounds, initial value, and prior (mean and standard deviation).

    ``nuisance``: an initial state of a recording, which is fitted and not reported. ``label``: its name in the result; the
    path unless given.
    """

    path: str
    low: float
    high: float
    start: float | None = None
    prior: tuple[float, float] | None = None
    nuisance: bool = False
    label: str = ""

    def mirrored(self) -> Sought:
        """The same parameter with the opposite sign."""
        start, prior = (None if self.start is None else -self.start), self.prior and (-self.prior[0], self.prior[1])
        return replace(self, low=-self.high, high=-self.low, start=start, prior=prior)


@dataclass(frozen=True)
class Logs:
    """The content of LOGS.toml; ``path``: the file, if there is one. ``words``: for paths and contacts in the result."""

    recordings: tuple[Recording, ...]
    sought: tuple[Sought, ...]
    laws: dict[str, tuple[str, ...]] = field(default_factory=dict)
    path: Path | None = None
    words: Mapping[str, str] = field(default_factory=dict)


def _extreme(numbers: Mapping[str, float], least: float = -LARGEST) -> list[Problem]:
    """A problem for each number, by key, outside the range in which squares and their inverses are finite."""
    allowed = f"must lie between {least:g} and {LARGEST:g}"
    return [(key, f"{show(x)}: {allowed}") for key, x in numbers.items() if not least <= x <= LARGEST]


# -- the tables of the file ----------------------------------------------------------------------------------------------


class ColumnTable(FileTable):
    """A column of a recording, as a table or by its name alone."""

    units: ClassVar[Mapping[str, float]] = LENGTH | ANGLE | SPEED | ACCELERATION | FORCE | PRESSURE | DRIVE
    column: str
    unit: str = ""
    gain: float = quantity("", "factor to SI units", default=1.0)
    noise: float | None = quantity("", "standard deviation", above=0, optional=True)
    time: str | None = None
    held: bool = False

    def wrong(self) -> list[Problem]:
        """An unknown unit, a gain of 0, or a noise whose square is no number."""
        problems = []
        if self.unit and self.unit not in self.units:
            problems.append(("unit", f"{show(self.unit)}: unknown unit{nearest(self.unit, self.units)}"))
        if self.gain == 0:
            problems.append(("gain", f"{show(self.gain)}: must be a number other than 0"))
        return problems + ([] if self.noise is None else _extreme({"noise": self.noise}, 1 / LARGEST))

    @property
    def factor(self) -> float:
        """The factor to SI units."""
        return self.gain * (self.units[self.unit] if self.unit else 1.0)


class TimeTable(ColumnTable):
    """The column of times."""

    units: ClassVar[Mapping[str, float]] = TIME


def _by_name(given: object) -> object:
    """A column's table from its name."""
    if isinstance(given, str):
        return {"column": given}
    if isinstance(given, Mapping | ColumnTable | None):
        return given
    raise refused(f"must be a column's name or a table, not {kind_of(given)}", given)


class OutputTable(ColumnTable):
    """A measured column."""

    def wrong(self) -> list[Problem]:
        """As of any column; and a sample is not held."""
        held = [("held", "true: must be said of an input: an output is a sample")] if self.held else []
        return super().wrong() + held


class RecordingTable(FileTable):
    """One [[log]]."""

    file: str = Field(description="the recording's file")
    name: str | None = None
    time: Annotated[TimeTable | None, BeforeValidator(_by_name)] = None
    outputs: dict[str, Annotated[OutputTable, BeforeValidator(_by_name)]] = Field(description="the measured columns")
    inputs: dict[str, Annotated[ColumnTable, BeforeValidator(_by_name)]] = Field(default_factory=dict)
    known: dict[str, Finite] = Field(default_factory=dict)
    hold_out: bool = False

    def wrong(self) -> list[Problem]:
        """No outputs, or a known number whose square is none."""
        problems = [] if self.outputs else [("outputs", "missing: at least one measured column must be given")]
        return problems + _extreme({f"known.{path}": x for path, x in self.known.items()})

    @property
    def columns(self) -> dict[str, ColumnTable]:
        """The columns by their use in the machine."""
        groups: dict[str, Mapping[str, ColumnTable]] = {"outputs": self.outputs, "inputs": self.inputs}
        return {f"{group}.{name}": c for group, columns in groups.items() for name, c in columns.items()}


class PriorTable(FileTable):
    """Prior knowledge of a parameter."""

    mean: Finite
    deviation: float = quantity("", "standard deviation", above=0)

    def wrong(self) -> list[Problem]:
        """A number whose square, or its inverse, is none."""
        return _extreme({"mean": self.mean}) + _extreme({"deviation": self.deviation}, 1 / LARGEST)


class SoughtTable(FileTable):
    """One entry of [unknown]."""

    low: float | None = quantity("", "lower bound", optional=True)
    high: float | None = quantity("", "upper bound", optional=True)
    start: float | None = quantity("", "initial value", optional=True)
    prior: PriorTable | None = None

    def wrong(self) -> list[Problem]:
        """Bounds that are missing or in the wrong order, or a start outside."""
        if self.prior is None and (missing := [n for n in ("low", "high") if getattr(self, n) is None]):
            return [(n, "missing: must be given, unless there is a prior") for n in missing]
        low, high = self.bounds
        if problems := _extreme({"low": low, "high": high}):
            return problems
        if not low < high:
            return [("high", f"{show(high)}: must be > low ({show(low)})")]
        if self.start is not None and not low <= self.start <= high:
            return [("start", f"{show(self.start)}: must be a number from low to high ({show(low)} to {show(high)})")]
        return []

    @property
    def bounds(self) -> tuple[float, float]:
        """The bounds, from the prior unless given."""
        mean, reach = (self.prior.mean, FAR * self.prior.deviation) if self.prior is not None else (0.0, 0.0)
        return mean - reach if self.low is None else self.low, mean + reach if self.high is None else self.high


class LogsTable(FileTable):
    """LOGS.toml; its recordings and parameters are read one by one."""

    log: list[object] = Field(default_factory=list)
    unknown: dict[str, object] = Field(default_factory=dict)
    laws: dict[str, list[str]] = Field(default_factory=dict)
    version: object = Field(None, alias="schema")

    def wrong(self) -> list[Problem]:
        """No recordings, or no laws to compare."""
        problems = [] if self.log else [("log", "missing: there must be at least one [[log]]")]
        return problems + [(f"laws.{n}", "[]: must be a list of names of laws") for n, x in self.laws.items() if not x]


def _valid(kind: type[T], table: object, path: str, problems: list[str]) -> T | None:
    """The table at a path; None, and a line for each problem, if it is wrong."""
    try:
        return kind.model_validate(table)
    except ValidationError as error:
        problems += [f"{place}: {text}" for place, text in problems_of(error, path)]
        return None


def read_logs(path: str | Path, needs_unknown: bool = True) -> Logs:
    """The recordings that a LOGS.toml lists, in SI units.

    Args:
        path: the file.
        needs_unknown: whether a file without parameters to fit is an error.

    Raises:
        InputError: the file or a recording cannot be read; a line for each mistake.
    """
    path = Path(path)
    problems: list[str] = []
    table = _valid(LogsTable, read_toml(path), "", problems) or LogsTable.model_construct()
    recordings = list[Recording]()
    for i, given in enumerate(table.log):
        entry = _valid(RecordingTable, given, f"log.{i}", problems)
        try:
            with naming(partial(_key, f"log.{i}")):
                recordings += [] if entry is None else [_read(entry, f"log.{i}", path.parent)]
        except InputError as error:
            problems += error.problems
    sought, wrong = sought_of(table.unknown)
    problems += wrong
    if not sought and needs_unknown and not problems:
        problems.append("unknown: missing: at least one path with its bounds must be sought")
    if not problems and all(r.hold_out for r in recordings) and needs_unknown:
        problems.append("log.0.hold_out: true: at least one recording must be for fitting")
    if problems:
        raise InputError([f"{path}: {line}" for line in problems])
    return Logs(tuple(recordings), tuple(sought), {n: tuple(x) for n, x in table.laws.items()}, path)


def _key(where: str, name: str) -> str:
    """The key that gives a reader's argument: the file is ``data``, and the columns have the names of their keys."""
    return f"{where}.file" if name == "data" else name


def sought_of(unknown: Mapping[str, object], argument: bool = False) -> tuple[list[Sought], list[str]]:
    """The entries of [unknown], or of an argument of that name (each a table, or low and high), and their errors."""
    sought: list[Sought] = []
    problems: list[str] = []
    for path, given in unknown.items():
        place = arg(f"unknown.{path}") if argument else f"unknown.{path}"
        if argument and isinstance(given, list | tuple) and len(given) == 2:
            given = {"low": given[0], "high": given[1]}
        if (table := _valid(SoughtTable, given, place, problems)) is not None:
            prior = None if table.prior is None else (table.prior.mean, table.prior.deviation)
            sought.append(Sought(path, *table.bounds, table.start, prior))
    return sought, problems


# -- the columns of a recording ------------------------------------------------------------------------------------------


def _source(entry: RecordingTable, where: str, folder: Path) -> Source:
    """The file, open.

    Raises:
        InputError: it cannot be read.
    """
    try:
        return opened_log(folder / entry.file)
    except OSError as error:  # an invalid file name
        raise InputError(f"{where}.file: {show(entry.file)}: cannot be read: {error.strerror}") from None


def _read(entry: RecordingTable, where: str, folder: Path) -> Recording:
    """The columns of one recording, in order of time.

    Raises:
        InputError: a column is missing, contains no possible numbers, or is not as long as its times.
    """
    source, wanted = _source(entry, where, folder), entry.columns
    time = entry.time
    if time is None:  # a topic of a bag has its own times
        time = TimeTable(column=time_of(source, next(iter(entry.outputs.values())).column) or "t")
    time, wanted = _in_si(time, source), {use: _in_si(c, source) for use, c in wanted.items()}
    names = {f"{where}.time": time.column}
    names |= {f"{where}.{use}": c.column for use, c in wanted.items()}
    apart = {use: c.time or time_of(source, c.column) for use, c in wanted.items()}
    names |= {f"{where}.{use}.time": at for use, at in apart.items() if at and at != time.column}
    roles = {f"{where}.{use}": f"{where}.{use}.time" for use in wanted}
    times = {role: at if at in names else f"{where}.time" for role, at in roles.items()}
    require_columns(source, names)
    columns, notes = source.columns(names, times), list(getattr(source, "notes", []))
    t = columns.pop(f"{where}.time") * time.factor
    keep, more = _in_order(t, entry.file)
    notes += more
    if len(keep) < FEWEST_SAMPLES:
        raise InputError(_too_few(t, keep, where, entry.file, time.column))
    if text := impossible(t[keep]) or _parted(t[keep]):
        raise InputError(f"{where}.time: {show(time.column)}: {text}")
    origin, channels = float(t[keep[0]]), dict[str, Channel]()
    for use, c in wanted.items():
        x, at, rows = columns[f"{where}.{use}"] * c.factor, t, keep
        if f"{where}.{use}.time" in columns:
            at = columns[f"{where}.{use}.time"] * time.factor
            rows, more = _in_order(at, f"{entry.file}: {use.partition('.')[2]}")
            notes += [] if np.isnan(at).any() else more  # shorter columns of a table end in empty cells
            if text := _parted(at[rows]):
                raise InputError(f"{where}.{use}.time: {show(names[f'{where}.{use}.time'])}: {text}")
        text = impossible(x[rows]) or isolated_outliers(x[rows]) if np.isfinite(x[rows]).any() else "holds no number"
        if text:
            raise InputError(f"{where}.{use}: {show(c.column)}: {text}")
        unit = "" if "gain" in c.model_fields_set else c.unit
        channels[use] = Channel(c.column, at[rows] - origin, x[rows], unit, c.noise, c.held)
    outputs, inputs = ({n: channels[f"{g}.{n}"] for n in getattr(entry, g)} for g in ("outputs", "inputs"))
    return Recording(
        entry.name or entry.file, t[keep] - origin, outputs, inputs, dict(entry.known), entry.hold_out, tuple(notes)
    )


def _in_si(column: Column, source: Source) -> Column:
    """A column in the unit that its file states, unless LOGS.toml gives a unit or a gain."""
    stated = "" if column.unit or "gain" in column.model_fields_set else source.unit(column.column, column.units)
    return column.model_copy(update={"unit": stated}) if stated else column


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


def _too_few(t: Array, keep: NDArray[np.int64], where: str, file: str, column: str) -> str:
    """Why a recording has too few rows in order of time: the file has no more, or its time does not rise."""
    there = t[np.isfinite(t)]
    if len(there) < FEWEST_SAMPLES:
        return f"{where}.file: {show(file)}: has {len(there)} rows with a time: must have at least {FEWEST_SAMPLES}"
    i = int(np.argmax(np.diff(there) <= 0))
    does = "repeats" if there[i + 1] == there[i] else f"falls from {there[i]:.6g} s to"
    return (
        f"{where}.time: {show(column)}: {does} {there[i + 1]:.6g} s: {len(keep)} of {len(there)} rows are in order of time, "
        f"must be at least {FEWEST_SAMPLES}"
    )


def _parted(t: Array) -> str | None:
    """What is wrong with a time that jumps by more than all other samples last."""
    steps = np.diff(t)
    if not len(steps) or not 2 * np.max(steps) > t[-1] - t[0] or len(steps) < FEWEST_SAMPLES:
        return None
    i = int(np.argmax(steps))
    return f"jumps from {t[i]:.6g} s to {t[i + 1]:.6g} s, longer than all the rest: must be two recordings"
