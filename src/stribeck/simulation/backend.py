"""What solves a scenario: C by the machine's compiler where there is one, else WebAssembly by Wasmtime.

Both compute the same equations in the same order. C takes about two thirds of the time, and its bits depend on the
compiler; those of WebAssembly are the same everywhere.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from time import perf_counter

from stribeck.codegen import source
from stribeck.errors import BuildError, InputError, note
from stribeck.scenario import Scenario
from stribeck.simulation import cache, compiler, native
from stribeck.simulation.result import Result

BACKENDS = ("auto", "c", "wasm")
VARIABLE = "STRIBECK_BACKEND"  # of the environment: what is asked for
Progress = Callable[[float], None]
Solver = Callable[[Scenario, Progress | None], Result]


def chosen() -> str:
    """``c`` or ``wasm``: what $STRIBECK_BACKEND asks for; ``auto``, or nothing: C if there is a compiler.

    Raises:
        InputError: it is none of these, or C is asked for and there is no compiler.
    """
    asked = os.environ.get(VARIABLE, "auto") or "auto"
    if asked not in BACKENDS:
        raise InputError(f"{VARIABLE}: {asked!r}: must be {', '.join(BACKENDS[:-1])} or {BACKENDS[-1]}")
    has_compiler = asked != "wasm" and compiler.find() is not None
    if asked == "c" and not has_compiler:
        raise InputError(f"{VARIABLE}: 'c': no C compiler was found ('stribeck doctor' says where it is looked for)")
    return "c" if has_compiler else "wasm"


@dataclass(frozen=True)
class Built:
    """What solves a scenario's system: ``c`` or ``wasm``, whether it was built now, and the seconds that this took."""

    solve: Solver
    backend: str
    new: bool
    seconds: float


def solver(scenario: Scenario) -> Built:
    """What solves a scenario's system.

    A compiler that fails is named in a note; WebAssembly then solves.

    Raises:
        InputError: see :func:`chosen`.
        BuildError: neither can build the system.
    """
    started = perf_counter()
    if chosen() == "c":
        compiler_now = compiler.find()
        assert compiler_now is not None
        try:
            library, built = cache.library(source(scenario.system), compiler_now, native.check)
            return Built(partial(native.solve, library), "c", built, perf_counter() - started)
        except (BuildError, OSError) as error:
            if os.environ.get(VARIABLE) == "c":
                raise BuildError(f"compiling failed: {' '.join(str(error).split())}") from None
            note(
                f"compiling failed ({' '.join(str(error).split())}): solving by WebAssembly, in half as much time again"
            )
    from stribeck.simulation import wasm  # not where C is used: its emitter takes a while to import

    system = wasm.system_module(scenario.system)
    made, built = wasm.compiled(system.module)
    return Built(partial(wasm.solve, made, system), "wasm", built, perf_counter() - started)
