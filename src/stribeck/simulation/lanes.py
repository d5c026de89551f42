"""The compiled solver of many trajectories in the lanes of vectors, on every core, called through ctypes."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable, Sequence
from ctypes import POINTER, c_int64
from dataclasses import dataclass
from threading import Event, Thread
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.codegen import source
from stribeck.errors import BuildError
from stribeck.machine.system import MachineSystem
from stribeck.scenario import Scenario
from stribeck.simulation import cache, compiler
from stribeck.simulation.layout import declare, struct_fields
from stribeck.simulation.native import SolverInput, Solving
from stribeck.simulation.promise import (
    MOST_PASSES,
    MeasuredMotion,
    Pass,
    Promise,
    Tolerances,
    given,
    measures,
    step_share,
)
from stribeck.simulation.result import held_back
from stribeck.simulation.variations import Variations

Integers = NDArray[np.int64]
Progress = Callable[[float], None]

_PER_LANE = ("parameters", "atol", "fixed_atol", "thresholds", "queue", "force_tolerance")  # names of both structs
_COUNTS = ("rows_reached", "status", "accepted", "rejected", "happened")


class Batch(ctypes.Structure):
    """The struct that Python shares with the compiled solver of lanes."""

    _fields_ = struct_fields("lanes.c", "Batch")


@dataclass(frozen=True)
class Outcome:
    """The results of the lanes.

    Attributes:
        states: states and held outputs, shape (lanes, rows, both).
        t_reached: the time that each lane reached, s.
        counts: rows reached, status (as in runtime/lanes.c), steps, and ``happened``: the count of each event, shape
            (lanes, watched quantities, 4).
        largest: the measured magnitudes of each lane (simulation/promise.py).
        inaccurate: whether each lane does not reach the promised accuracy.
    """

    states: Array
    t_reached: Array
    counts: dict[str, Integers]
    largest: Array
    inaccurate: NDArray[np.bool_]

    def put(self, places: Integers, other: Outcome, which: NDArray[np.bool_]) -> None:
        """Replace the lanes ``places`` by the lanes ``which`` of another outcome."""
        for name in ("states", "t_reached", "largest"):
            getattr(self, name)[places] = getattr(other, name)[which]
        for name in _COUNTS:
            self.counts[name][places] = other.counts[name][which]


LaneSolver = Callable[[Variations, Progress | None, Tolerances | None], Outcome]


def check(library: ctypes.CDLL) -> None:
    """Check that a library is a compiled system of this version, for lanes.

    Raises:
        BuildError: if it is not.
    """
    calls = {"stribeck_lanes": (c_int64, []), "stribeck_solve_batch": (None, [POINTER(Batch)])}
    declare(library, "a compiled system for lanes", Batch, "stribeck_batch_size", calls)


def threads_of_this_machine() -> int:
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True)
class Arrays:
    """A batch in memory: its arrays by name, and the struct with pointers to them."""

    by_name: dict[str, NDArray[Any]]
    batch: Batch

    def lane(self, scenario: Scenario, lane: int) -> SolverInput:
        """One lane as input of the solver of single runs."""
        x, system, b = self.by_name, scenario.system, self.batch
        pieces = slice(int(x["piece_first"][lane]), int(x["piece_end"][lane]))
        doubles = {name: x[name][lane] for name in _PER_LANE if name in x} | {
            "x": x["x0"][lane].copy(), "largest": np.zeros(x["largest"].shape[1]), "atol_now": np.zeros(len(system.states)),
            "carried": np.zeros(len(system.states)),
            "piece_start": x["piece_start"][pieces], "piece_rows": x["piece_rows"][pieces], "held": np.zeros(len(system.held)),
            "memory": np.zeros(sum(map(len, system.memory.values()))), "noise": x["noise"],
        }  # fmt: skip
        numbers = {
            "rtol": float(x["rtol"][lane]),
            "step": b.step,
            "h_limit": float(x["h_limit"][lane]),
            "rows_are_steps": b.rows_are_steps,
        }
        return SolverInput(doubles, x["piece_restart"][pieces], numbers, b.queue_room)

    def put(self, lane: int, status: int, solving: Solving) -> None:
        """Store the results of a single run in its lane."""
        x, run = self.by_name, solving.run
        width = x["out"].shape[2]
        x["out"][lane, : run.row] = solving.views["out"][: run.row, :width]
        x["largest"][lane] = solving.views["largest"]
        x["t_reached"][lane], x["rows_reached"][lane], x["status"][lane] = run.t, run.row, status
        x["accepted"][lane], x["rejected"][lane] = run.accepted, run.rejected
        for _, what in solving.events:
            x["happened"][lane, what >> 2, what & 3] += 1


def lane_arrays(lanes: Variations, tolerances: Tolerances | None = None) -> Arrays:
    """The arrays that the compiled solver of the lanes reads and writes, with other ``tolerances`` than the lanes' if given."""
    tolerances = tolerances or _first(lanes)
    scenario, count = lanes.scenario, len(lanes)
    share, pieces, thresholds = step_share(scenario) * tolerances.scale, lanes.pieces(), lanes.thresholds()
    room, noise = held_back(scenario.end, lanes.sampling())
    held = len(scenario.system.held)
    numbers = {
        "parameters": lanes.parameters(), "atol": share[:, np.newaxis] * tolerances.atol, "x0": lanes.initial(),
        "rtol": share * scenario.solve.rtol, "fixed_atol": share[:, np.newaxis] * tolerances.atol * given(scenario),
        "thresholds": thresholds, "h_limit": lanes.longest_step(), "noise": noise, "queue": np.zeros((count, held, room)),
        "piece_start": pieces.whole.start, "piece_rows": pieces.whole.rows,
        "out": np.empty((count, scenario.rows, len(scenario.system.states) + held)), "t_reached": np.zeros(count),
        "largest": np.zeros((count, measures(scenario))),
    }  # fmt: skip
    numbers |= {} if tolerances.force is None else {"force_tolerance": tolerances.force}
    integers = {"piece_first": pieces.first, "piece_end": pieces.end, "turn": np.zeros(3, np.int64)}
    integers |= {name: np.zeros(count, np.int64) for name in _COUNTS}
    integers["happened"] = np.zeros((count, thresholds.shape[1], 4), np.int64)
    restart = np.ascontiguousarray(pieces.whole.restart)
    numbers = {name: np.ascontiguousarray(x, float) for name, x in numbers.items()}
    batch = Batch(count=count, rows=scenario.rows, most_attempts=scenario.solve.max_steps)
    batch.queue_room, batch.noise_room = room, noise.shape[1]
    batch.t_end, batch.step = scenario.end, scenario.output.step
    batch.groups, batch.rows_are_steps = 1, tolerances.rows_are_steps
    arrays = Arrays({**numbers, **integers, "piece_restart": restart}, batch)
    for name, x in arrays.by_name.items():
        setattr(batch, name, x.ctypes.data)
    return arrays


def outcome(arrays: Arrays) -> Outcome:
    """The results of the lanes, from the arrays that the solver filled."""
    filled = arrays.by_name
    for lane in np.flatnonzero(filled["rows_reached"] < arrays.batch.rows):
        filled["out"][lane, filled["rows_reached"][lane] :] = np.nan
    return Outcome(
        filled["out"],
        filled["t_reached"],
        {name: filled[name] for name in _COUNTS},
        filled["largest"],
        np.zeros(len(filled["out"]), bool),
    )


def compiled(system: MachineSystem) -> ctypes.CDLL:
    """The compiled library of a system, for lanes.

    Raises:
        BuildError: if there is no C compiler, or it cannot build the system.
        OSError: if the library cannot be loaded.
    """
    chosen = compiler.find()
    if chosen is None:
        raise BuildError("there is no C compiler")
    return cache.library(source(system, lanes=True), chosen.for_lanes(), check)[0]


def solve(once: LaneSolver, lanes: Variations, progress: Progress | None = None, growth: bool = True) -> Outcome:
    """Integrate every lane, and repeat lanes whose motion needs tighter tolerances for the promised accuracy
    (:mod:`stribeck.simulation.promise`); ``growth``: of errors that grow along it, too."""
    scenario, promise = lanes.scenario, Promise(lanes.scenario, growth)

    def run(which: Integers, tolerances: Tolerances | None) -> tuple[Outcome, Pass]:
        some = lanes if len(which) == len(lanes) else lanes.part(which)
        result, width = once(some, progress, tolerances), len(scenario.system.states)
        states, measured = result.states[:, :, :width], MeasuredMotion.of(result.largest, width)
        return result, Pass(_first(lanes) if tolerances is None else tolerances, measured, states)

    lane_numbers = np.arange(len(lanes))
    result, coarse = run(lane_numbers, None)
    missed = promise.missed(coarse.tolerances, coarse.measured)
    done = result.counts["status"] == 0
    result.inaccurate[:] = done & missed.lanes
    for _ in range(MOST_PASSES):
        repeated = np.flatnonzero(done & promise.mends(coarse.tolerances, missed))
        if not len(repeated):
            break
        lane_numbers, coarse, missed = lane_numbers[repeated], coarse.part(repeated), missed.part(repeated)
        again, fine = run(lane_numbers, promise.tightened(coarse.tolerances, coarse.measured, missed))
        done = again.counts["status"] == 0
        missed = promise.after(missed, coarse, fine)
        result.put(lane_numbers[done], again, done)
        result.inaccurate[lane_numbers[done]] = promise.beyond(missed, fine.measured)[done]
        coarse = fine
    return result


def _first(lanes: Variations) -> Tolerances:
    """The tolerances of the lanes before their motion is known."""
    return Tolerances(lanes.atol(), np.ones(len(lanes)))


def lane_solver(library: ctypes.CDLL, threads: int) -> LaneSolver:
    """The solver that integrates every lane once. The threads take lanes from one queue; the result does not depend on
    their order."""

    def once(lanes: Variations, progress: Progress | None, tolerances: Tolerances | None) -> Outcome:
        arrays = lane_arrays(lanes, tolerances)
        share = library.stribeck_lanes() * threads  # groups are spread over all threads
        arrays.batch.groups = -(-len(lanes) // share)
        _run(library, arrays, threads, progress)
        return outcome(arrays)

    return once


def one_by_one(
    run: Callable[[int, Progress], None], lanes: Sequence[int], threads: int, progress: Progress | None
) -> None:
    """Run lanes as single runs in threads.

    Args:
        run: runs a lane and stores its results; calls its second argument from time to time, which raises if Ctrl-C came.
        lanes: the lanes' numbers.
        threads: number of threads, which take lanes from one queue.
        progress: called with the share of the lanes done.
    """
    from concurrent.futures import ThreadPoolExecutor

    stopped = Event()

    def check_stopped(share: float) -> None:
        if stopped.is_set():
            raise KeyboardInterrupt

    with ThreadPoolExecutor(threads) as pool:
        try:
            for done, _ in enumerate(pool.map(lambda lane: run(lane, check_stopped), lanes)):
                if progress is not None:
                    progress((done + 1) / len(lanes))
        except BaseException:
            stopped.set()
            pool.shutdown(cancel_futures=True)
            raise


def _run(library: ctypes.CDLL, arrays: Arrays, threads: int, progress: Progress | None) -> None:
    """Run the threads; Ctrl-C stops them at their next step."""
    turn = arrays.by_name["turn"]

    def work() -> None:  # holds the arrays until the solver has returned: join() may return before that (CPython 3.11)
        library.stribeck_solve_batch(ctypes.byref(arrays.batch))

    workers = [Thread(target=work) for _ in range(threads)]
    try:
        for worker in workers:
            worker.start()
        for worker in workers:
            while worker.is_alive():
                worker.join(0.1)
                if progress is not None:
                    progress(turn[1] / arrays.batch.count)
    finally:
        turn[2] = 1
        for worker in workers:
            if worker.ident is not None:
                worker.join()
