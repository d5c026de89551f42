"""Simulates recordings in parallel lanes. A lane is the simulation of one set of parameters."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from threading import Lock

import numpy as np
from scipy.interpolate import CubicSpline

from stribeck.arrays import Array
from stribeck.errors import BuildError, InputError, StribeckError
from stribeck.identify.actuator.inputs import RecordedInput, misread, recorded_input
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.scenario import Scenario
from stribeck.simulation import backend
from stribeck.simulation.lanes import LaneSolver
from stribeck.simulation.variations import Variations, vary
from stribeck.waveforms import Signal
from stribeck.waveforms.piecewise import PointsSignal

Late = tuple[Array, Array]  # of each lane: constant delay, s, and clock drift, s/s
_FINER = 5  # rows of a step, if a delay is fitted: a cubic spline between them errs by less than the solver
_EVEN = 2e-5  # of a step: tolerance of an even grid of samples, far above the rounding of times
_LOCK = Lock()


@dataclass(frozen=True)
class MeasuredRun:
    """The measurements of a run: its inputs by path, and the compared columns."""

    inputs: dict[str, RecordedInput]
    targets: list[Channel]


@dataclass
class RecordedRun:
    """A recording as a scenario with its inputs and known numbers, ready to simulate.

    Attributes:
        inputs: the recorded inputs, by path.
        as_well: alternative measurements by cause of error.
        start: initial values that differ from the file's.
        played: by name, a term's unit in each signal.
        attempts: the most steps that the solver tried in a lane of the latest simulation.
    """

    name: str
    log: int
    scenario: Scenario
    targets: list[Channel]
    inputs: dict[str, RecordedInput] = field(default_factory=dict)
    as_well: Mapping[str, Sequence[MeasuredRun]] = field(default_factory=dict)
    start: dict[str, float] = field(default_factory=dict)
    played: Mapping[str, Mapping[str, Array]] = field(default_factory=dict)
    attempts: int = 0

    @property
    def size(self) -> int:
        """The number of compared samples."""
        return sum(len(x.t) for x in self.targets)

    @property
    def grid(self) -> Array:
        """The times of the simulation's rows."""
        return np.arange(self.scenario.rows, dtype=float) * self.scenario.output.step

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
        targets = [x.rows(x.t <= end) for x in self.targets if x.t[0] <= end]
        return replace(self, scenario=self.scenario.with_changes({"solve.t_end": end}), targets=targets)

    def predict(
        self, values: Mapping[str, Array], delays: Mapping[str, Late], threads: int,
        shift: Mapping[str, Array] | None = None, signals: Mapping[str, Sequence[Signal]] | None = None,
    ) -> list[Array]:  # fmt: skip
        """For each target the simulated column at its times, (lanes, times); nan where a lane failed.

        ``shift`` is added to the initial states of each lane. ``signals``: by path, inputs of each lane instead of the
        recorded ones.
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
        predicted = [np.full((count, len(x.t)), np.nan) for x in self.targets]
        if not len(good):
            return predicted
        variations.shift = dict(shift or {})
        lanes = variations if len(good) == count else variations.part(good)
        outcome = solver(scenario, threads)(lanes, None, None)
        width = len(scenario.system.states)
        grid = self.grid
        with np.errstate(all="ignore"):
            states, held = np.split(outcome.states, [width], axis=2)
            columns = lanes.columns(grid, states, held, [target.column for target in self.targets])
        self.attempts = int(np.max(outcome.counts["accepted"] + outcome.counts["rejected"]))
        whole = outcome.counts["status"] == 0
        for i, target in enumerate(self.targets):
            x = np.where(whole[:, None], columns[target.column], np.nan)
            late = delays.get(target.column)
            predicted[i][good] = at_times(grid, x, target, late and (late[0][good], late[1][good]))
        return predicted

    def _signals(self, shares: Mapping[str, Array], count: int) -> dict[str, Sequence[Signal]]:
        """The signals with added terms in each lane: the sum of the terms, each times its coefficient."""
        grid = self.grid
        paths = dict.fromkeys(path for name in shares for path in self.played[name])
        signals: dict[str, list[Signal]] = {path: [] for path in paths}
        for path, lane in product(paths, range(count)):
            total = np.zeros(len(grid))
            for name, x in shares.items():
                if x[lane] and path in self.played[name]:
                    total += x[lane] * self.played[name][path]
            signals[path].append(PointsSignal(grid, total))
        return dict(signals)


def at_times(grid: Array, x: Array, target: Channel, late: Late | None) -> Array:
    """Simulated columns (lanes, grid) at the times of a target, delayed by ``late`` if given."""
    step = grid[1] - grid[0]
    index = np.rint(target.t / step).astype(int)
    if late is None and abs(target.t - index * step).max(initial=0.0) <= _EVEN * step:
        return x[:, np.clip(index, 0, len(grid) - 1)]
    columns = np.full((len(x), len(target.t)), np.nan)
    for i, row in enumerate(x):
        if np.isfinite(row).all():
            delay, clock = (float(each[i]) for each in late) if late else (0.0, 0.0)
            t = np.clip(target.t * (1 - clock) - delay, grid[0], grid[-1])
            smooth = target.column.endswith((".y", ".v")) and len(grid) > 3
            columns[i] = CubicSpline(grid, row)(t) if smooth else np.interp(t, grid, row)
    return columns


def delayed(t: Array, x: Array, late: Late) -> Array:
    """A column at later times in each lane; beyond its ends it is constant."""
    delay, clock = (each[:, None] for each in late)
    return np.array([np.interp(at, t, x) for at in t * (1 - clock) - delay])


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


def least_step(x: Array) -> float:
    """The least difference of two values of a column, such as its quantization; 0 of a constant."""
    return float(np.diff(np.unique(x)).min()) if np.ptp(x) > 0 else 0.0


def rms(parts: Sequence[Array]) -> float:
    """The root mean square over the pieces of a column."""
    return float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))


def recorded_run(scenario: Scenario, recording: Recording, log: int, fine: bool = False) -> RecordedRun:
    """The scenario of a recording; ``fine``: with rows between samples, for delays and clock drift.

    Raises:
        InputError: an output, an input or a known number does not exist in the machine.
    """
    if scenario.elements.unnamed:
        raise InputError(["the machine: schema = 1: a fit to recordings needs a machine (schema = 2)"])
    drives, length = driven_by(scenario, recording), float(recording.t[-1])
    problems = [
        f"log.{log}.inputs.{path}.held: true: must be false: a feedforward needs a smooth command"
        for path, each in drives.items() if each.held and each.spline
    ]  # fmt: skip
    problems += misread(scenario, recording, log)
    if problems:
        raise InputError(problems)
    step = _step(recording) / (_FINER if fine else 1)
    step = length / max(math.ceil(length / step - _EVEN), 1)  # the last row is the end, where samples lie
    changes = {**recording.known, **{path: each.table() for path, each in drives.items()}}
    changes |= {"solve.t_end": length, "output.step": step, "output.energy": False}
    try:
        new = scenario.with_changes(changes)
    except InputError as error:
        raise InputError([f"log.{log} ({recording.file}): {line}" for line in error.problems]) from None
    as_well = {
        cause: [MeasuredRun(driven_by(scenario, x), compared(x, new.end)) for x in same]
        for cause, same in {**recording.as_well, "missing samples": recording.crossed()}.items() if same
    }  # fmt: skip
    return RecordedRun(recording.file, log, new, compared(recording, new.end), drives, as_well)


def compared(recording: Recording, end: float) -> list[Channel]:
    """The measured columns up to a time by the machine's names."""
    targets = []
    for name, c in recording.outputs.items():
        there = (c.t >= -1e-12) & (c.t <= end + 1e-12) & np.isfinite(c.x) & np.isfinite(c.t)
        if there.any():
            targets.append(replace(c, column=name).rows(there))
    return targets


def driven_by(scenario: Scenario, recording: Recording) -> dict[str, RecordedInput]:
    """The recorded inputs by path."""
    end = float(recording.t[-1])
    return {path: recorded_input(scenario, path, end, c) for path, c in recording.inputs.items()}


def _step(recording: Recording) -> float:
    """The output step: even samples coincide with rows; uneven ones lie between finer rows."""
    step = float(np.median(np.diff(recording.t)))
    span = recording.t[-1] - recording.t[0]
    even = span / max(round(span / step), 1)
    index = np.rint(recording.t / even)
    return float(even) if abs(recording.t - index * even).max() < _EVEN * even else step / 2
