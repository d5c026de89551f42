"""The choice of the solver's backend: C if the machine has a compiler, otherwise WebAssembly by Wasmtime.

Both compute the same equations in the same order. C takes about two thirds of the time, and its bits depend on the
compiler; those of WebAssembly are the same on every processor.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import TYPE_CHECKING

from stribeck.codegen import source
from stribeck.errors import BuildError, InputError, note
from stribeck.machine.system import MachineSystem
from stribeck.scenario import Scenario
from stribeck.simulation import cache, compiler, native
from stribeck.simulation.result import Result

if TYPE_CHECKING:
    from stribeck.simulation.lanes import LaneSolver

BACKENDS = ("auto", "c", "wasm")
VARIABLE = "STRIBECK_BACKEND"  # the environment variable with the wanted backend
Progress = Callable[[float], None]
Solver = Callable[[Scenario, Progress | None], Result]


def chosen() -> str:
    """``c`` or ``wasm``: the value of $STRIBECK_BACKEND; ``auto``, or unset: C if there is a compiler.

    Raises:
        InputError: if the value is none of these, or is C and there is no compiler.
    """
    wanted = os.environ.get(VARIABLE, "auto") or "auto"
    if wanted not in BACKENDS:
        raise InputError(f"{VARIABLE}: {wanted!r}: must be {', '.join(BACKENDS[:-1])} or {BACKENDS[-1]}")
    has_compiler = wanted != "wasm" and compiler.find() is not None
    if wanted == "c" and not has_compiler:
        raise InputError(f"{VARIABLE}: 'c': no C compiler was found ('stribeck doctor' lists the places searched)")
    return "c" if has_compiler else "wasm"


@dataclass(frozen=True)
class Built:
    """The solver of a scenario's system: its backend (``c`` or ``wasm``), whether it was built now, and the time of this."""

    solve: Solver
    backend: str
    new: bool
    seconds: float


def solver(scenario: Scenario) -> Built:
    """The solver of a scenario's system.

    If the compiler fails, a note reports it and WebAssembly is used.

    Raises:
        InputError: as :func:`chosen`.
        BuildError: if neither backend can build the system.
    """
    started = perf_counter()
    if chosen() == "c":
        c_compiler = compiler.find()
        assert c_compiler is not None
        try:
            library, new = cache.library(source(scenario.system), c_compiler, native.check)
            return Built(partial(native.solve, library), "c", new, perf_counter() - started)
        except (BuildError, OSError) as error:
            _compiling_failed(error)
    from stribeck.simulation import wasm  # imported only if needed: its emitter is slow to import

    system = wasm.system_module(scenario.system)
    code, new = wasm.compiled(system.module)
    return Built(partial(wasm.solve, code, system), "wasm", new, perf_counter() - started)


def lane_solver(system: MachineSystem, threads: int) -> LaneSolver:
    """The solver of a system's lanes (simulation/lanes.py). C solves several lanes at once, in vectors.

    Raises:
        InputError, BuildError: as :func:`solver`.
    """
    from stribeck.simulation import lanes, wasm_lanes  # a single run needs neither

    if chosen() == "c":
        try:
            return lanes.lane_solver(lanes.compiled(system), threads)
        except (BuildError, OSError) as error:
            _compiling_failed(error)
    return wasm_lanes.lane_solver(system, threads)


def _compiling_failed(error: Exception) -> None:
    """Say by a note that WebAssembly is used, unless C is demanded.

    Raises:
        BuildError: C is demanded.
    """
    text = " ".join(str(error).split())
    if os.environ.get(VARIABLE) == "c":
        raise BuildError(f"compiling failed: {text}") from None
    note(f"compiling failed ({text}): solving by WebAssembly, in half as much time again")
