"""Simulates recordings in parallel lanes. A lane is the simulation of one set of parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from threading import Lock

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from stribeck.arrays import Array
from stribeck.errors import BuildError, InputError, StribeckError
from stribeck.identify.actuator.inputs import RecordedInput, later, misread, recorded_input, table_at
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.scenario import Scenario
from stribeck.simulation import backend
from stribeck.simulation.lanes import LaneSolver
from stribeck.simulation.variations import Variations, vary
from stribeck.waveforms import Signal
from stribeck.waveforms.piecewise import PointsSignal

Late = tuple[Array | None, Array | None]  # of each lane: constant delay, s, and clock drift, s/s
_FINER = 5
_EVEN = 2e-2  # of a step: tolerance of an even grid of samples
_LOCK = Lock()


@dataclass(frozen=True)
class Compared:
    """A compared column of a run: times, values, and its terms beside the machine's column."""

    column: str
    t: Array
    x: Array
    beside: Mapping[str, Array] = field(default_factory=dict)

    def rows(self, there: NDArray[np.bool_]) -> Compared:
        """Some of its times."""
        beside = {name: column[there] for name, column in self.beside.items()}
        return replace(self, t=self.t[there], x=self.x[there], beside=beside)


@dataclass(frozen=True)
class MeasuredRun:
    """The measurements of a run: its inputs by path, and the compared columns."""

    inputs: dict[str, RecordedInput]
    targets: list[Compared]


@dataclass
class RecordedRun:
    """A recording, or a stretch of one, as a scenario with its inputs and known numbers, ready to simulate."""

    name: str
    log: int
    piece: str | None
    scenario: Scenario
    targets: list[Compared]
    start: dict[str, float] = field(default_factory=dict)  # initial values that differ from the file's
    held_out: bool = False
    shift: dict[str, float] = field(default_factory=dict)  # added to other initial states of a stretch
    otherwise: tuple[Scenario, ...] = ()  # draws of the inputs with the interpolation error of gaps, by ``doubt``
    doubt: float = 0.0
    inputs: dict[str, RecordedInput] = field(default_factory=dict)  # the recorded inputs, by path
    played: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)  # by name, a term's unit in each signal
    as_well: Mapping[str, Sequence[MeasuredRun]] = field(default_factory=dict)  # alternatives by cause of error
    attempts: int = 0  # the most steps that the solver tried in a lane of the latest simulation

    def driven(self, drives: Mapping[str, RecordedInput]) -> RecordedRun:
        """The run with other signals. A signal of another kind changes the structure, so the scenario is rebuilt."""
        signals = {path: x.signal() for path, x in drives.items()}
        kinds = {use.path: type(x) for use, x in self.scenario.elements.signals.items()}
        if all(type(x) is kinds.get(path) for path, x in signals.items()):
            return replace(self, scenario=self.scenario.with_signals(signals))
        return replace(self, scenario=self.scenario.with_changes({path: x.table() for path, x in drives.items()}))

    def instead(self, measured: MeasuredRun) -> RecordedRun:
        """The run with other measurements."""
        return replace(self.driven(measured.inputs), targets=measured.targets, inputs=measured.inputs)

    def until(self, end: float) -> RecordedRun:
        """The run up to a time."""
        step = self.scenario.output.step
        end = min(max(math.ceil(end / step - _EVEN), 2) * step, self.scenario.end)
        targets = [x.rows(x.t <= end) for x in self.targets]
        scenario = self.scenario.with_changes({"solve.t_end": end})
        return replace(self, scenario=scenario, targets=[x for x in targets if len(x.t)])

    @property
    def size(self) -> int:
        """The number of compared samples."""
        return sum(len(x.t) for x in self.targets)

    def predict(
        self, values: Mapping[str, Array], delays: Mapping[str, Late], threads: int, ends: Sequence[str] = (),
        shift: Mapping[str, Array] | None = None, signals: Mapping[str, Sequence[Signal]] | None = None,
    ) -> list[Array]:  # fmt: skip
        """For each target the simulated column at its times, (lanes, times); nan where a lane failed.

        The columns ``ends`` at the end of the run follow, (lanes, 1). ``shift`` is added to the initial states of each
        lane; the run's own shift unless given. ``signals``: by path, inputs of each lane instead of the recorded ones.
        """
        count = len(next(iter(values.values())))
        given = {path: np.full(count, x) for path, x in self.start.items()} | dict(values)
        shares = {name: given.pop(name) for name in self.played if name in given}
        variations = vary(self.scenario, given)
        if not isinstance(variations, Variations):
            raise StribeckError(
                "a number that is sought changes the form of the equations: it cannot be fitted in lanes"
            )
        scenario = variations.scenario
        variations.played = self._signals(shares, count) | dict(signals or {})
        good = np.flatnonzero([text is None for text in variations.problems()])
        last = np.array([self.scenario.end])
        wanted = [*self.targets, *(Compared(name, last, last) for name in ends)]
        found = [np.full((count, len(x.t)), np.nan) for x in wanted]
        if not len(good):
            return found
        own = self.shift if shift is None else shift
        variations.shift = {name: np.broadcast_to(x, (count,)) for name, x in own.items()}
        some = variations if len(good) == count else variations.part(good)
        outcome = solver(scenario, threads)(some, None, None)
        width = len(scenario.system.states)
        grid: Array = np.arange(scenario.rows, dtype=float) * scenario.output.step
        with np.errstate(all="ignore"):
            columns = some.columns(grid, outcome.states[:, :, :width], outcome.states[:, :, width:])
        self.attempts = int(np.max(outcome.counts["accepted"] + outcome.counts["rejected"]))
        whole = outcome.counts["status"] == 0
        for i, target in enumerate(wanted):
            x = np.where(whole[:, None], columns[target.column], np.nan)
            late = delays.get(target.column) if i < len(self.targets) else None
            if late is not None:
                late = tuple(None if each is None else each[good] for each in late)  # type: ignore[assignment]
            found[i][good] = at_times(grid, x, target, late)
        return found

    def _signals(self, shares: Mapping[str, Array], count: int) -> dict[str, Sequence[Signal]]:
        """The signals with added terms in each lane: the sum of the terms, each times its coefficient."""
        if not shares:
            return {}
        grid: Array = np.arange(self.scenario.rows, dtype=float) * self.scenario.output.step
        paths = dict.fromkeys(path for name in shares for path in self.played[name])
        found: dict[str, list[Signal]] = {path: [] for path in paths}
        for path, lane in product(paths, range(count)):
            total = np.zeros(len(grid))
            for name, x in shares.items():
                if x[lane] and path in self.played[name]:
                    total += x[lane] * self.played[name][path]
            found[path].append(PointsSignal(grid, total))
        return dict(found)


def at_times(grid: Array, x: Array, target: Compared, late: Late | None) -> Array:
    """Simulated columns (lanes, grid) at the times of a target, delayed by ``late`` if given."""
    step = grid[1] - grid[0] if len(grid) > 1 else 1.0
    index = np.rint(target.t / step).astype(int)
    if late is None and abs(target.t - index * step).max(initial=0.0) <= _EVEN * step * 1e-3:
        return x[:, np.clip(index, 0, len(grid) - 1)]
    found = np.full((len(x), len(target.t)), np.nan)
    for i, row in enumerate(x):
        if np.isfinite(row).all():
            delay, clock = (0.0 if late is None or (each := late[j]) is None else float(each[i]) for j in (0, 1))
            t = np.clip(target.t * (1 - clock) - delay, grid[0], grid[-1])
            smooth = target.column.endswith((".y", ".v")) and len(grid) > 3
            found[i] = CubicSpline(grid, row)(t) if smooth else np.interp(t, grid, row)
    return found


def solver(scenario: Scenario, threads: int) -> LaneSolver:
    """The solver of a system's lanes.

    Raises:
        StribeckError: it cannot be built.
    """
    try:
        with _LOCK:
            return backend.lane_solver(scenario.system, threads)
    except BuildError as error:
        raise StribeckError(f"fitting a machine: its compiled form cannot be built: {error}") from None


def roughness(parts: Sequence[Array], order: int = 3) -> float:
    """The noise of a column's pieces from their differences of this order. A higher order removes more of the motion."""
    parts = [x for x in parts if len(x) > order]
    found = np.concatenate([np.diff(x, order) for x in parts]) if parts else np.zeros(1)
    return float(np.sqrt(np.mean(found**2) / math.comb(2 * order, order)))


def rows_of(recording: Recording, begin: float, end: float) -> dict[str, Channel]:
    """The measured columns between two times; times count from the first."""
    found = {}
    for name, c in recording.outputs.items():
        there = (c.t >= begin - 1e-12) & (c.t <= end + 1e-12) & np.isfinite(c.x) & np.isfinite(c.t)
        beside = {of: x[there] for of, x in c.beside.items()}
        found[name] = replace(c, t=c.t[there] - begin, x=c.x[there], beside=beside)
    return found


def recorded_run(
    scenario: Scenario, recording: Recording, log: int, span: tuple[float, float] | None = None, fine: bool = False
) -> RecordedRun:
    """The scenario of a recording, or of a stretch; ``fine``: with rows between samples, for delays and clock drift.

    Raises:
        InputError: an output, an input or a known number does not exist in the machine.
    """
    if scenario.elements.unnamed:
        raise InputError(["the machine: schema = 1: a fit to recordings needs a machine (schema = 2)"])
    begin, end = span or (0.0, float(recording.t[-1]))
    changes: dict[str, object] = dict(recording.known)
    problems = []
    drives, others, doubt = driven_by(scenario, recording, (begin, end))
    changes |= {path: each.table() for path, each in drives.items()}
    problems += [
        f"log.{log}.inputs.{path}.held: true: must be false: a feedforward needs a smooth command"
        for path, each in drives.items() if each.held and each.spline
    ]  # fmt: skip
    if begin > 0:
        changes |= _signals_later(scenario, recording, begin)
    problems += misread(scenario, recording, log)
    if problems:
        raise InputError(problems)
    step = _step(recording) / (_FINER if fine else 1)
    length = end - begin
    step = length / max(math.ceil(length / step - _EVEN * 1e-4), 1)  # the last row is the end, where samples lie
    changes |= {"solve.t_end": length, "output.step": step, "output.energy": False}
    try:
        new = scenario.with_changes(changes)
    except InputError as error:
        raise InputError([f"log.{log} ({recording.file}): {line}" for line in error.problems]) from None
    until = min(end, new.end + begin)
    targets = compared(recording, begin, until)
    as_well = {
        cause: [MeasuredRun(driven_by(scenario, x, (begin, end))[0], compared(x, begin, until)) for x in same]
        for cause, same in recording.as_well.items()
    }
    piece = None if span is None else f"{begin:g}"
    run = RecordedRun(recording.file, log, piece, new, targets, {}, recording.hold_out, {}, (), doubt, drives)
    return replace(run, otherwise=tuple(run.driven(each).scenario for each in others), as_well=as_well)


def compared(recording: Recording, begin: float, end: float) -> list[Compared]:
    """The measured columns between two times for comparison with a run."""
    return [Compared(n, c.t, c.x, c.beside) for n, c in rows_of(recording, begin, end).items() if len(c.t)]


def driven_by(
    scenario: Scenario, recording: Recording, span: tuple[float, float]
) -> tuple[dict[str, RecordedInput], list[dict[str, RecordedInput]], float]:
    """The recorded inputs by path, draws of those with gaps, and the factor to scale their interpolation error."""
    drives, draws = dict[str, RecordedInput](), list[dict[str, RecordedInput]]()
    doubt = max((c.bridged.doubt for c in recording.inputs.values()), default=0.0)
    for path, channel in recording.inputs.items():
        whole = channel.bridged
        drives[path] = recorded_input(scenario, path, whole.t, whole.x, span, channel)
        if whole.doubt > 0:
            draws = draws or [{} for _ in whole.others]
            for each, other in zip(draws, whole.others, strict=True):
                x = whole.x + whole.doubt / doubt * (other - whole.x)
                each[path] = recorded_input(scenario, path, whole.t, x, span, channel)
    return drives, draws, doubt


def _step(recording: Recording) -> float:
    """The output step: even samples coincide with rows; uneven ones lie between finer rows."""
    gaps = np.diff(recording.t)
    step = float(np.median(gaps))
    span = recording.t[-1] - recording.t[0]
    even = span / max(round(span / step), 1)
    index = np.rint(recording.t / even)
    if abs(recording.t - index * even).max() < _EVEN * even * 1e-3:
        return float(even)
    return step / 2


def unshifted(scenario: Scenario, recording: Recording) -> list[str]:
    """The machine's signals that are not recorded and cannot be cut inside a recording."""
    return [
        use.path for use in scenario.elements.signals
        if use.path not in recording.inputs and later(table_at(scenario, use.path), 1.0) is None
    ]  # fmt: skip


def _signals_later(scenario: Scenario, recording: Recording, begin: float) -> dict[str, object]:
    """The machine's own signals in a stretch that begins later.

    Raises:
        InputError: one cannot begin there.
    """
    if wrong := unshifted(scenario, recording):
        raise InputError(
            [
                f"{path}: a signal of this kind cannot be cut: give it as a recorded input, or no window"
                for path in wrong
            ]
        )
    paths = [use.path for use in scenario.elements.signals if use.path not in recording.inputs]
    return {path: later(table_at(scenario, path), begin) for path in paths}


def varies(scenario: Scenario, path: str) -> bool:
    """Whether the number at a path can vary between lanes."""
    return path in scenario.places
