"""The compiled solver of many trajectories in the lanes of vectors, on every core, called through ctypes."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Callable
from ctypes import POINTER, c_int64
from dataclasses import dataclass
from hashlib import sha256
from threading import Thread
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.codegen import source
from stribeck.errors import BuildError
from stribeck.machine.equations import Equations
from stribeck.simulation import cache, compiler
from stribeck.simulation.layout import declare, struct_fields
from stribeck.simulation.native import step_share
from stribeck.simulation.promise import MOST_PASSES, MeasuredMotion, Promise, Tolerances, measures
from stribeck.simulation.result import held_back
from stribeck.simulation.variations import Variations

Integers = NDArray[np.int64]
Progress = Callable[[float], None]

_COUNTS = ("rows_reached", "status", "accepted", "rejected", "happened")


class Batch(ctypes.Structure):
    """What Python and the compiled solver share."""

    _fields_ = struct_fields("lanes.c", "Batch")


@dataclass(frozen=True)
class Outcome:
    """What became of each lane: states and held outputs (lanes, rows, both), rows reached, status as in runtime/lanes.c,
    counts; ``happened`` has the shape (lanes, watched quantities, 4)."""

    states: Array
    t_reached: Array
    counts: dict[str, Integers]
    largest: Array  # what the solver measured of each lane: simulation/promise.py

    @property
    def digest(self) -> str:
        """Of every bit."""
        found = sha256()
        for x in (self.states, self.t_reached, *(self.counts[name] for name in _COUNTS)):
            found.update(np.ascontiguousarray(x).tobytes())
        return found.hexdigest()

    def put(self, places: Integers, other: Outcome, which: NDArray[np.bool_]) -> None:
        """Take some lanes of another outcome for some of these."""
        for name in ("states", "t_reached", "largest"):
            getattr(self, name)[places] = getattr(other, name)[which]
        for name in _COUNTS:
            self.counts[name][places] = other.counts[name][which]


def check(library: ctypes.CDLL) -> None:
    """Make sure that the library is a compiled system of this version, for lanes.

    Raises:
        BuildError: it is not.
    """
    calls = {"stribeck_lanes": (c_int64, []), "stribeck_solve_batch": (None, [POINTER(Batch)])}
    declare(library, "a compiled system for lanes", Batch, "stribeck_batch_size", calls)


def threads_of_this_machine() -> int:
    """How many threads may run at once."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass(frozen=True)
class Arrays:
    """A batch in memory: the numbers of its arrays by name, and the struct whose pointers are theirs."""

    by_name: dict[str, NDArray[Any]]
    batch: Batch


def lane_arrays(lanes: Variations, tolerances: Tolerances | None = None) -> Arrays:
    """What the compiled solver of the lanes reads and writes; ``tolerances``: others than the lanes' own."""
    tolerances = tolerances or Tolerances(lanes.atol())
    scenario, count = lanes.scenario, len(lanes)
    share, pieces, thresholds = step_share(scenario), lanes.pieces(), lanes.thresholds()
    room, noise = held_back(scenario.end, lanes.sampling())
    held = len(scenario.system.held)
    numbers = {
        "parameters": lanes.parameters(), "atol": share * tolerances.atol, "x0": lanes.initial(),
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
    batch.rtol, batch.t_end, batch.step = share * scenario.solve.rtol, scenario.end, scenario.output.step
    batch.groups, batch.rows_are_steps = 1, tolerances.rows_are_steps
    made = Arrays({**numbers, **integers, "piece_restart": restart}, batch)
    for name, x in made.by_name.items():
        setattr(batch, name, x.ctypes.data)
    return made


def outcome(made: Arrays) -> Outcome:
    """What became of the lanes, from the arrays that the solver filled."""
    found = made.by_name
    for lane in np.flatnonzero(found["rows_reached"] < made.batch.rows):
        found["out"][lane, found["rows_reached"][lane] :] = np.nan
    return Outcome(found["out"], found["t_reached"], {name: found[name] for name in _COUNTS}, found["largest"])


def compiled(system: Equations) -> ctypes.CDLL:
    """A system for lanes.

    Raises:
        BuildError: there is no C compiler, or it cannot build the system.
        OSError: the cache cannot be written.
    """
    chosen = compiler.find()
    if chosen is None:
        raise BuildError("there is no C compiler")
    return cache.library(source(system, lanes=True), chosen.for_lanes(), check)[0]


def solve(library: ctypes.CDLL, lanes: Variations, threads: int, progress: Progress | None = None) -> Outcome:
    """Integrate every lane, and some once more: those whose motion needs other tolerances than the first ones to be as
    right as is promised (see :mod:`stribeck.simulation.promise`)."""
    found, promise, now = once(library, lanes, threads, progress), Promise(lanes.scenario), Tolerances(lanes.atol())
    width = len(lanes.scenario.system.states)
    loose, wrong = promise.broken(now, MeasuredMotion(found.largest, width))
    places = np.flatnonzero((found.counts["status"] == 0) & (loose.any(axis=1) | wrong.any(axis=1)))
    for _ in range(MOST_PASSES):
        if not len(places):
            break
        wanted = promise.tightened(promise.part(now, places), MeasuredMotion(found.largest[places], width))
        again = once(library, lanes.part(places), threads, progress, wanted)
        better = again.counts["status"] == 0
        found.put(places[better], again, better)
        now.atol[places[better]] = wanted.atol[better]
        loose, wrong = promise.broken(wanted, MeasuredMotion(again.largest, width))
        places = places[better & (loose.any(axis=1) | wrong.any(axis=1))]
    return found


def once(
    library: ctypes.CDLL, lanes: Variations, threads: int, progress: Progress | None = None,
    tolerances: Tolerances | None = None,
) -> Outcome:  # fmt: skip
    """Integrate every lane; the threads take lanes from one queue, and the result does not depend on which took which."""
    made = lane_arrays(lanes, tolerances)
    made.batch.groups = -(-len(lanes) // (library.stribeck_lanes() * threads))  # no thread takes what another could
    _run(library, made, threads, progress)
    return outcome(made)


def _run(library: ctypes.CDLL, made: Arrays, threads: int, progress: Progress | None) -> None:
    """Let the threads work; Ctrl-C stops them at their next step."""
    turn = made.by_name["turn"]

    def work() -> None:  # holds the arrays until the solver has returned: join() may return before that (CPython 3.11)
        library.stribeck_solve_batch(ctypes.byref(made.batch))

    workers = [Thread(target=work) for _ in range(threads)]
    try:
        for worker in workers:
            worker.start()
        for worker in workers:
            while worker.is_alive():
                worker.join(0.1)
                if progress is not None:
                    progress(turn[1] / made.batch.count)
    finally:
        turn[2] = 1
        for worker in workers:
            if worker.ident is not None:
                worker.join()
