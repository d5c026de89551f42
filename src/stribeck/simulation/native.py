"""The compiled solver of one trajectory, called through ctypes (which releases the GIL)."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from ctypes import POINTER, c_int, c_int64
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.scenario import Scenario
from stribeck.simulation import promise
from stribeck.simulation.layout import declare, struct_fields
from stribeck.simulation.promise import MeasuredMotion, Tolerances
from stribeck.simulation.result import Result, failure, held_back

_SLICE = 100_000  # attempted steps between two checks of Ctrl-C and updates of the progress bar: some 30 ms
EVENT_ROOM = 4096  # events between two calls of the solver: 48 kB

_DONE, _MORE, _EVENTS_FULL = 0, 1, 2


class Run(ctypes.Structure):
    """The struct that Python shares with the compiled solver."""

    _fields_ = struct_fields("run.c", "Run")


def check(library: ctypes.CDLL) -> None:
    """Check that a library is a compiled system of this version.

    Raises:
        BuildError: if it is not.
    """
    calls = {"stribeck_event_room": (c_int64, []), "stribeck_advance": (c_int, [POINTER(Run)])}
    declare(library, "a compiled system", Run, "stribeck_run_size", calls)


def solve(library: ctypes.CDLL, scenario: Scenario, progress: Callable[[float], None] | None = None) -> Result:
    """Integrate the scenario with its compiled and checked system; ``progress`` is called with the share of time done."""

    def once(tolerances: Tolerances, most: int) -> tuple[Result, MeasuredMotion]:
        return _once(library, scenario, progress, tolerances, most)

    return promise.solve_to_promise(scenario, once)


def _once(
    library: ctypes.CDLL,
    scenario: Scenario,
    progress: Callable[[float], None] | None,
    tolerances: Tolerances,
    most: int,
) -> tuple[Result, MeasuredMotion]:
    given, event_room = solver_input(scenario, tolerances), max(EVENT_ROOM, library.stribeck_event_room())
    arrays, run = given.arrays(scenario, event_room), Run()  # the arrays live as long as the struct points to them
    for name, array in arrays.items():
        setattr(run, name, array.ctypes.data)
    run.event_room = event_room
    advance = partial(library.stribeck_advance, ctypes.byref(run))
    solving = Solving(scenario, given, run, arrays, advance)
    return solving.to_the_end(progress, most), solving.measured


@dataclass(frozen=True)
class SolverInput:
    """The input of the compiled solver: the arrays and numbers of the struct Run, by their names there."""

    doubles: dict[str, Array]
    restart: NDArray[np.int8]
    numbers: dict[str, float]  # rtol, step and h_limit
    queue_room: int

    def arrays(self, scenario: Scenario, event_room: int) -> dict[str, NDArray[Any]]:
        """All arrays of the struct Run by name, those for results included."""
        system = scenario.system
        held, width = len(system.held), len(system.states) + len(system.held) + len(system.shown)
        return {
            **self.doubles, "piece_restart": self.restart, "sampled": np.zeros(held, np.int64),
            "acted": np.zeros(held, np.int64), "out": np.empty((scenario.rows, width)),
            "event_time": np.empty(event_room), "event_what": np.empty(event_room, np.int32),
        }  # fmt: skip


def solver_input(scenario: Scenario, tolerances: Tolerances | None = None) -> SolverInput:
    """A scenario as input of the compiled solver, with other tolerances than its own if given."""
    system, values, tolerances = scenario.system, scenario.elements.values, tolerances or promise.first(scenario)
    share, pieces, held = promise.step_share(scenario) * float(tolerances.scale[0]), scenario.pieces, len(system.held)
    room, noise = held_back(scenario.end, [scenario.elements.sampling()])
    doubles = {
        "parameters": np.array([values[key] for key in system.parameters]),
        "x": np.array([scenario.initial.get(state.name, 0.0) for state in system.states]),
        "atol": share * tolerances.atol[0], "fixed_atol": share * tolerances.atol[0] * promise.given(scenario),
        "atol_now": np.zeros(len(system.states)), "largest": np.zeros(promise.measures(scenario)),
        "carried": np.zeros(len(system.states)),
        "thresholds": np.array(scenario.elements.thresholds()),
        "piece_start": np.ascontiguousarray(pieces.start), "piece_rows": np.ascontiguousarray(pieces.rows),
        "held": np.zeros(held), "memory": np.zeros(sum(map(len, system.memory.values()))),
        "queue": np.zeros((held, room)), "noise": noise,
    }  # fmt: skip
    doubles |= {} if tolerances.force is None else {"force_tolerance": tolerances.force[0]}
    numbers = {
        "rtol": share * scenario.solve.rtol,
        "step": scenario.output.step,
        "h_limit": float(scenario.elements.longest_step),
        "rows_are_steps": tolerances.rows_are_steps,
    }
    return SolverInput(doubles, np.ascontiguousarray(pieces.restart), numbers, room)


class Solving:
    """A run of the compiled solver, in C or WebAssembly.

    Args:
        scenario: the scenario.
        given: its input.
        run: the struct that is shared with the solver, with its pointers set.
        views: the arrays that it points to, by name.
        advance: continues the integration and returns a status.
    """

    def __init__(
        self, scenario: Scenario, given: SolverInput, run: Any, views: Mapping[str, NDArray[Any]], advance: Callable[[], int]
    ) -> None:  # fmt: skip
        self.scenario, self.run, self.views, self.advance = scenario, run, views, advance
        self.events: list[tuple[float, int]] = []
        for name, number in given.numbers.items():
            setattr(run, name, number)
        run.h = run.h_smallest = np.inf
        run.queue_room, run.noise_room = given.queue_room, given.doubles["noise"].shape[1]
        run.pieces, run.rows = len(given.restart), scenario.rows

    @property
    def measured(self) -> MeasuredMotion:
        """The magnitudes that the solver measured of the motion."""
        return MeasuredMotion.of(self.views["largest"].copy()[np.newaxis], len(self.views["x"]))

    def to_the_end(self, progress: Callable[[float], None] | None, most: int) -> Result:
        """Integrate from t = 0 to the end in at most ``most`` attempted steps."""
        return self._result(self.integrate(progress, most))

    def integrate(self, progress: Callable[[float], None] | None, most: int) -> int:
        """The same, slice by slice; the status at the end (runtime/run.c)."""
        run, end, attempts_left = self.run, self.scenario.end, most
        status, run.restart, run.t_end = _MORE, 1, end
        while status in (_MORE, _EVENTS_FULL) and attempts_left > 0:
            run.attempts_left = attempts = min(_SLICE, attempts_left)
            status = self.advance()
            attempts_left -= attempts - max(run.attempts_left, 0)
            if count := run.events:
                times, what = (self.views[name][:count].tolist() for name in ("event_time", "event_what"))
                self.events += zip(times, what, strict=True)
                run.events = 0
            if progress is not None:
                progress(run.t / end)
        return status

    def _result(self, status: int) -> Result:
        run, scenario = self.run, self.scenario
        why = scenario.system.ended(scenario.elements.values, run.t, self.views["x"]) if status < 0 else None
        return Result(
            states=self.views["out"][: run.row],
            events=self.events,
            reason=why or failure(status, run.t, scenario.solve.max_steps),
            stats={
                "accepted": run.accepted, "rejected": run.rejected, "rates": run.rates, "jacobians": run.jacobians,
                "smallest_step": run.h_smallest if np.isfinite(run.h_smallest) else None,
                "largest_step": run.h_largest or None,
                "solver": "rodas5p",
            },
        )  # fmt: skip
