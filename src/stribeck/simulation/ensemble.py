"""Ensembles: a scenario simulated with many values, in the lanes of the processor's vectors and on every core."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck import platforms
from stribeck.arrays import Array
from stribeck.constants import Column
from stribeck.errors import InputError, printable
from stribeck.scenario import Scenario
from stribeck.scenario.objects import Machine, scenario_of
from stribeck.simulation import backend, lanes
from stribeck.simulation.result import NOT_FINITE, failure, unknown_column
from stribeck.simulation.single import simulate_once
from stribeck.simulation.variations import LaneByLane, Variations, vary


class Ensemble:
    """A scenario simulated with many values: ``ensemble["y"]`` has the shape (lanes, times).

    Rows that a failed lane did not reach are nan. ``ensemble.t`` holds the times in s, ``len(ensemble)`` is the number
    of lanes.

    Attributes:
        scenario: the scenario that the lanes vary.
        values: the values that vary, by path.
        reason: for each lane why it failed, else None.
        slips, sticks: for each lane how often \\|v\\| rises, and falls, through v_s; of a machine, at all contacts.
        happened: for each element and event, the count in each lane.
        accepted, rejected: steps of each lane.
        inaccurate: whether each lane reached its end, but not the promised accuracy.
        not_finite: whether each lane ended because its equations were no longer finite.
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
        self.inaccurate = counts["inaccurate"].astype(bool)
        self.accepted, self.rejected = counts["accepted"], counts["rejected"]
        self.not_finite = counts["status"] == NOT_FINITE
        self._variations, self._states, self._given = variations, states, columns

    def __len__(self) -> int:
        return len(self._states)

    @property
    def status(self) -> list[str]:
        """ "done" or "failed" for each lane."""
        return ["done" if reason is None else "failed" for reason in self.reason]

    @property
    def success(self) -> list[bool]:
        """Whether each lane reached its end."""
        return [reason is None for reason in self.reason]

    @property
    def message(self) -> str:
        """The number of lanes that are done, why the first other one failed, and how many are not accurate."""
        failed = [(i, reason) for i, reason in enumerate(self.reason) if reason is not None]
        first = f"; lane {failed[0][0]}: {failed[0][1]}" if failed else ""
        beyond = f"; {text}" if (text := inaccurate_lanes(int(self.inaccurate.sum()), len(self))) else ""
        return f"{len(self) - len(failed)} of {len(self)} lanes done{first}{beyond}"

    def __repr__(self) -> str:
        columns = ", ".join(("t", *(column.name for column in self.columns)))
        varied = ", ".join(self.values)
        return f"<Ensemble of '{self.scenario.name}': {len(self)} lanes over {varied}, {len(self.t)} rows, columns {columns}>"

    def _repr_html_(self) -> str:
        return f"<p>{escape(printable(repr(self)))}<br>{escape(printable(self.message))}</p>"

    @cached_property
    def t(self) -> Array:
        """Times of the rows (s), multiples of ``output.step``."""
        return np.arange(self._states.shape[1], dtype=float) * self.scenario.output.step

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns after t, each with name, unit and meaning."""
        return self.scenario.system.columns

    @cached_property
    def _columns(self) -> dict[str, Array]:
        if self._given is not None:
            return self._given
        if not isinstance(self._variations, Variations):  # lane by lane, and none had valid values
            return {column.name: np.full(self._states.shape[:2], np.nan) for column in self.columns}
        reached = ~np.isnan(self._states[:, :, 0])
        count = len(self.scenario.system.states)
        columns = self._variations.columns(self.t, self._states[:, :, :count], self._states[:, :, count:])
        return {name: np.where(reached, x, np.nan) for name, x in columns.items()}

    def __getitem__(self, name: str) -> Array:
        if name not in self._columns:
            raise unknown_column(name, self._columns)
        return self._columns[name]


def simulate_ensemble(
    scenario: Scenario | Machine | str | Path | Mapping[str, object],
    values: Mapping[str, ArrayLike] | None = None,
    *,
    t_end: float | None = None,
    step: float | None = None,
    threads: int | None = None,
    progress: Callable[[float], None] | None = None,
    growth: bool = True,
    **solve: object,
) -> Ensemble:
    """Simulate a scenario once for each value of some of its numbers: :func:`stribeck.simulate` with ``vary``.

    The lanes agree with single runs within the tolerances, for any number of lanes and threads. A lane's results are the
    same in every run. ``growth``: whether lanes whose errors grow beyond the promised accuracy are simulated again with finer
    tolerances; how a motion ends can be judged without.
    """
    variations = vary(scenario_of(scenario, t_end, step, **solve), values or {})
    _check(variations, threads)
    threads = threads or lanes.threads_of_this_machine()
    batch = _Lanes(variations)
    if not len(batch.possible):
        return batch.ensemble()
    if not isinstance(variations, Variations):
        return batch.ensemble(_simulate_singly(batch, threads, progress))
    possible = variations if batch.all_possible else variations.part(batch.possible)
    solver = backend.lane_solver(variations.scenario.system, threads)
    batch.put(possible, lanes.solve(solver, possible, progress, growth))
    return batch.ensemble()


def _check(variations: Variations | LaneByLane, threads: int | None) -> None:
    """Check the number of threads, and that the rows fit into memory."""
    scenario, count = variations.scenario, len(variations)
    if threads is not None and (isinstance(threads, bool) or not isinstance(threads, int) or threads < 1):
        raise InputError(f"threads: {threads}: must be a whole number >= 1")
    needed, room = 8.0 * count * scenario.rows * (len(scenario.system.states) + 1), platforms.free_memory()
    if needed > room:
        text = f"{count} lanes of {scenario.rows} rows would take {platforms.size_of(needed)} of memory"
        raise InputError(f"{text}, and {platforms.size_of(room)} are free: use fewer rows, or 'stribeck sweep'")


class _Lanes:
    """The results of the lanes: rows, reasons and counts; nan and 0 where a lane has none."""

    def __init__(self, variations: Variations | LaneByLane) -> None:
        self.variations, self.reason = variations, variations.problems()
        self.possible = np.flatnonzero([text is None for text in self.reason])
        scenario, count = variations.scenario, len(variations)
        self.counts = {name: np.zeros(count, np.int64) for name in ("accepted", "rejected", "status", "inaccurate")}
        self.counts["happened"] = np.zeros((count, len(scenario.system.watched), 4), np.int64)

    @cached_property
    def states(self) -> Array:
        """The states of every lane, nan until they are stored; made at first use, as it may be most of the memory."""
        scenario = self.variations.scenario
        width = len(scenario.system.states) + len(scenario.system.held) + len(scenario.system.shown)
        return np.full((len(self.variations), scenario.rows, width), np.nan)

    @property
    def all_possible(self) -> bool:
        """Whether every lane has valid values."""
        return len(self.possible) == len(self.variations)

    def put(self, possible: Variations, outcome: lanes.Outcome) -> None:
        """Store the outcome of the possible lanes."""
        scenario = possible.scenario
        if self.all_possible and not scenario.system.shown:
            self.states = outcome.states
        else:
            self.states[self.possible, :, : outcome.states.shape[2]] = outcome.states
        for name, x in self.counts.items():
            x[self.possible] = outcome.inaccurate if name == "inaccurate" else outcome.counts[name]
        for lane, status, t in zip(self.possible, outcome.counts["status"], outcome.t_reached, strict=True):
            self.reason[lane] = failure(int(status), float(t), scenario.solve.max_steps)

    def ensemble(self, columns: dict[str, Array] | None = None) -> Ensemble:
        """The ensemble; ``columns`` if they are known beside the states."""
        return Ensemble(self.variations, self.states, self.reason, self.counts, columns)


def _simulate_singly(batch: _Lanes, threads: int, progress: Callable[[float], None] | None) -> dict[str, Array]:
    """Simulate the lanes as single runs; their columns."""
    variations, scenario = batch.variations, batch.variations.scenario
    columns = {c.name: np.full(batch.states.shape[:2], np.nan) for c in scenario.system.columns}

    def run(lane: int, check_stopped: lanes.Progress) -> None:
        solution = simulate_once(scenario.with_changes(variations.changes(lane)), check_stopped)
        batch.states[lane, : len(solution.t), : solution.states.shape[1]] = solution.states
        for name, x in columns.items():
            x[lane, : len(solution.t)] = solution[name]
        batch.reason[lane] = solution.reason
        batch.counts["happened"][lane] = solution.counts
        batch.counts["inaccurate"][lane] = solution.inaccurate
        batch.counts["accepted"][lane] = solution.stats["accepted"]
        batch.counts["rejected"][lane] = solution.stats["rejected"]

    lanes.one_by_one(run, batch.possible.tolist(), threads, progress)
    return columns


def inaccurate_lanes(number: int, lanes: int) -> str:
    """A sentence with the number of lanes that do not reach the promised accuracy; empty if all reach it."""
    return f"{number} of {lanes} lanes do not reach the promised accuracy" if number else ""


def happened(scenario: Scenario, counts: NDArray[np.int64]) -> dict[str, dict[str, NDArray[np.int64]]]:
    """The count of each event in each lane, by element; a single body has no name."""
    by_element: dict[str, dict[str, NDArray[np.int64]]] = {}
    for j, (name, events) in enumerate(scenario.system.watched):
        of_element = by_element.setdefault(name, {})
        for i, event in enumerate(events):
            of_element[event] = of_element.get(event, np.zeros(len(counts), np.int64)) + counts[:, j, i]
    return by_element
