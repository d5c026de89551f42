"""The same scenario many times, with other numbers: in the lanes of the processor's vectors, on every core."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from functools import cached_property
from html import escape
from pathlib import Path
from threading import Event

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck import platforms
from stribeck.arrays import Array
from stribeck.constants import Column
from stribeck.errors import BuildError, InputError, nearest
from stribeck.machine.equations import SLIP_AND_STICK
from stribeck.scenario import Scenario
from stribeck.scenario.objects import Machine, VariedMachine, scenario_of
from stribeck.simulation import backend, lanes
from stribeck.simulation.result import NOT_FINITE, failure
from stribeck.simulation.single import simulate_once
from stribeck.simulation.solution import Solution
from stribeck.simulation.variations import LaneByLane, Variations, vary

_Solver = Callable[[Variations, Callable[[float], None] | None], lanes.Outcome]


class Ensemble:
    """A scenario simulated with many values: ``ensemble["y"]`` has the shape (lanes, times).

    Rows that a failed lane did not reach are nan. ``ensemble.t`` holds the times in s, ``len(ensemble)`` is the number
    of lanes.

    Attributes:
        scenario: what all lanes share.
        values: the values that vary, by path.
        reason: for each lane why it failed, else None.
        slips, sticks: for each lane how often \\|v\\| rises, and falls, through v_s; of a machine, at all contacts.
        happened: for each element, and each of its events, how often it came in each lane.
        accepted, rejected: steps of each lane.
        not_finite: which lanes ended because their equations were no longer finite.
    """

    def __init__(
        self,
        variations: Variations | LaneByLane,
        states: Array,
        reason: list[str | None],
        counts: Mapping[str, NDArray[np.int64]],
        columns: dict[str, Array] | None = None,
    ) -> None:
        self.scenario, self.values = variations.scenario, variations.values
        self.reason = reason
        self.happened = happened(variations.scenario, counts["happened"])
        self.slips, self.sticks = (
            sum((x[kind] for x in self.happened.values() if kind in x), np.zeros(len(states), np.int64))
            for kind in ("slip", "stick")
        )
        self.accepted, self.rejected = counts["accepted"], counts["rejected"]
        self.not_finite = counts["status"] == NOT_FINITE
        self._variations, self._states, self._given = variations, states, columns

    def __len__(self) -> int:
        return len(self._states)

    @property
    def status(self) -> list[str]:
        """For each lane "done" or "failed"."""
        return ["done" if reason is None else "failed" for reason in self.reason]

    @property
    def success(self) -> list[bool]:
        """For each lane whether it reached its end."""
        return [reason is None for reason in self.reason]

    @property
    def message(self) -> str:
        """How many lanes are done, and why the first that is not failed."""
        failed = [(i, reason) for i, reason in enumerate(self.reason) if reason is not None]
        first = f"; lane {failed[0][0]}: {failed[0][1]}" if failed else ""
        return f"{len(self) - len(failed)} of {len(self)} lanes done{first}"

    def __repr__(self) -> str:
        columns = ", ".join(("t", *(column.name for column in self.columns)))
        varied = ", ".join(self.values)
        return f"<Ensemble of '{self.scenario.name}': {len(self)} lanes over {varied}, {len(self.t)} rows, columns {columns}>"

    def _repr_html_(self) -> str:
        return f"<p>{escape(repr(self))}<br>{escape(self.message)}</p>"

    @cached_property
    def t(self) -> Array:
        """Times of the rows, s: i * output.step."""
        return np.arange(self._states.shape[1], dtype=float) * self.scenario.output.step

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns after t: name, unit and meaning."""
        return self.scenario.system.columns

    @cached_property
    def _columns(self) -> dict[str, Array]:
        if self._given is not None:
            return self._given
        if not isinstance(self._variations, Variations):  # lane by lane, and none was possible
            return {column.name: np.full(self._states.shape[:2], np.nan) for column in self.columns}
        reached = ~np.isnan(self._states[:, :, 0])
        count = len(self.scenario.system.states)
        found = self._variations.columns(self.t, self._states[:, :, :count], self._states[:, :, count:])
        return {name: np.where(reached, x, np.nan) for name, x in found.items()}

    def __getitem__(self, name: str) -> Array:
        if name not in self._columns:
            known = list(self._columns)
            raise KeyError(f"{name!r}: no such column{nearest(name, known) or ' (known: ' + ', '.join(known) + ')'}")
        return self._columns[name]


def simulate_ensemble(
    scenario: Scenario | Machine | VariedMachine | str | Path | Mapping[str, object],
    values: Mapping[str, ArrayLike] | None = None,
    *,
    t_end: float | None = None,
    step: float | None = None,
    threads: int | None = None,
    progress: Callable[[float], None] | None = None,
    **solve: object,
) -> Ensemble:
    """Simulate a scenario once for each value of some of its numbers (:func:`stribeck.simulate` with ``vary``).

    Lane i takes the i-th value of every path: ``simulate(s, {"law.k_v": [1e6, 1e7], "plant.mass": [1, 2]})``
    has two lanes. What can be varied: the law's constants, the mass, initial values, constants of the drive and of the
    signal. The lanes agree with single runs within the tolerances, however many lanes and threads there are, and a
    lane's numbers are the same from run to run.

    Args:
        scenario: what the lanes share: a scenario, a machine, the path of its file, or its tables; ``machine.vary(...)``
            brings its values with it.
        t_end, step, **solve: as for :func:`stribeck.simulate`.
        values: numbers by path, as many for each path as there are lanes; a single number holds for all.
        threads: how many to use; all of the machine's unless given.
        progress: called now and then with the share of the lanes done, 0 to 1.

    Returns:
        The ensemble. A lane that fails, or whose values no scenario may have, has a ``reason``; the others go on.

    Raises:
        InputError: a path is none that can be varied, its values are no numbers, or the rows do not fit into memory.
    """
    if isinstance(scenario, VariedMachine):
        values = {**scenario.values, **(values or {})}
    shared = scenario.machine if isinstance(scenario, VariedMachine) else scenario
    variations = vary(scenario_of(shared, t_end, step, **solve), values or {})
    _check(variations, threads)
    threads = threads or lanes.threads_of_this_machine()
    lanes_in = _Lanes(variations)
    if not len(lanes_in.possible):
        return lanes_in.ensemble()
    solver = _solver(variations, threads)
    if solver is None or not isinstance(variations, Variations):
        return lanes_in.ensemble(_one_by_one(lanes_in, threads, progress))
    some = variations if lanes_in.all_possible else variations.part(lanes_in.possible)
    lanes_in.take(some, solver(some, progress))
    return lanes_in.ensemble()


def _check(variations: Variations | LaneByLane, threads: int | None) -> None:
    """Refuse what is no number of threads, and what memory does not hold."""
    scenario, count = variations.scenario, len(variations)
    if threads is not None and (isinstance(threads, bool) or not isinstance(threads, int) or threads < 1):
        raise InputError(f"threads: {threads}: must be a whole number >= 1")
    needed, room = 8.0 * count * scenario.rows * (len(scenario.system.states) + 1), platforms.free_memory()
    if needed > room:
        text = f"{count} lanes of {scenario.rows} rows would take {platforms.size_of(needed)} of memory"
        raise InputError(f"{text}, and {platforms.size_of(room)} are free: use fewer rows, or 'stribeck sweep'")


class _Lanes:
    """What becomes of the lanes: rows, reasons and counts, nan and 0 where nothing was found."""

    def __init__(self, variations: Variations | LaneByLane) -> None:
        self.variations, self.reason = variations, variations.problems()
        self.possible = np.flatnonzero([text is None for text in self.reason])
        scenario, count = variations.scenario, len(variations)
        self.counts = {name: np.zeros(count, np.int64) for name in ("accepted", "rejected", "status")}
        self.counts["happened"] = np.zeros((count, max(1, len(scenario.system.watched)), 4), np.int64)

    @cached_property
    def states(self) -> Array:
        """Of every lane, nan until they are found; made when it is asked for, as it may be most of the memory."""
        scenario = self.variations.scenario
        width = len(scenario.system.states) + len(scenario.system.held) + len(scenario.system.shown)
        return np.full((len(self.variations), scenario.rows, width), np.nan)

    @property
    def all_possible(self) -> bool:
        """Whether every lane has values that a scenario may have."""
        return len(self.possible) == len(self.variations)

    def take(self, some: Variations, found: lanes.Outcome) -> None:
        """The outcome of the possible lanes, solved at once."""
        scenario = some.scenario
        if self.all_possible and not scenario.system.shown:
            self.states = found.states
        else:
            self.states[self.possible, :, : found.states.shape[2]] = found.states
        watched = found.counts["happened"].shape[1]
        for name, x in self.counts.items():
            if name == "happened":
                x[self.possible, :watched] = found.counts[name]
            else:
                x[self.possible] = found.counts[name]
        for lane, status, t in zip(self.possible, found.counts["status"], found.t_reached, strict=True):
            self.reason[lane] = failure(int(status), float(t), scenario.solve.max_steps)
        step = scenario.output.step
        for i, lane in enumerate(self.possible):
            done = found.counts["status"][i] == 0
            reached = scenario.end if done else max(float(found.counts["rows_reached"][i]) - 1, 0.0) * step
            for _, what in some.more_events(i, reached):
                self.counts["happened"][lane, what >> 2, what & 3] += 1

    def ensemble(self, columns: dict[str, Array] | None = None) -> Ensemble:
        """All of it; ``columns`` where they were found with the states."""
        return Ensemble(self.variations, self.states, self.reason, self.counts, columns)


def _solver(variations: Variations | LaneByLane, threads: int) -> _Solver | None:
    """What solves many lanes at once; None where they are to be solved one by one."""
    library = _library(variations.scenario) if isinstance(variations, Variations) else None
    return None if library is None else lambda some, progress: lanes.solve(library, some, threads, progress)


def _library(scenario: Scenario) -> ctypes.CDLL | None:
    """The compiled system for lanes; None where it cannot be built, or where WebAssembly is to solve."""
    try:
        if backend.chosen() == "wasm":
            return None
        return lanes.compiled(scenario.system)
    except (BuildError, OSError):
        return None  # the single runs will say why


def _one_by_one(found: _Lanes, threads: int, progress: Callable[[float], None] | None) -> dict[str, Array]:
    """The lanes as single runs, where vectors do not serve; their columns."""
    from concurrent.futures import ThreadPoolExecutor

    variations, places, scenario = found.variations, found.possible, found.variations.scenario
    columns = {c.name: np.full(found.states.shape[:2], np.nan) for c in scenario.system.columns}
    stopped = Event()

    def go_on(share: float) -> None:
        if stopped.is_set():
            raise KeyboardInterrupt

    def run(lane: int) -> Solution:
        return simulate_once(scenario.with_changes(variations.changes(lane)), go_on)

    with ThreadPoolExecutor(threads) as pool:
        try:
            for done, (lane, solution) in enumerate(zip(places, pool.map(run, map(int, places)), strict=True)):
                found.states[lane, : len(solution.t), : solution.states.shape[1]] = solution.states
                for name, x in columns.items():
                    x[lane, : len(solution.t)] = solution[name]
                found.reason[lane] = solution.reason
                found.counts["happened"][lane] = solution.counts
                found.counts["accepted"][lane] = solution.stats["accepted"]
                found.counts["rejected"][lane] = solution.stats["rejected"]
                if progress is not None:
                    progress((done + 1) / len(places))
        except BaseException:
            stopped.set()
            pool.shutdown(cancel_futures=True)
            raise
    return columns


def happened(scenario: Scenario, counts: NDArray[np.int64]) -> dict[str, dict[str, NDArray[np.int64]]]:
    """How often each event came in each lane, by element; a single body has no name."""
    found: dict[str, dict[str, NDArray[np.int64]]] = {}
    for j, (name, events) in enumerate(scenario.system.watched or (("", SLIP_AND_STICK),)):
        mine = found.setdefault(name, {})
        for i, event in enumerate(events):
            mine[event] = mine.get(event, np.zeros(len(counts), np.int64)) + counts[:, j, i]
    return found
