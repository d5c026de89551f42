"""A scenario solved by WebAssembly: the counterpart of native.py where there is no C compiler.

The runtime is built once, with the package (tools/make_runtime.py). A system's functions are emitted from its expressions
and joined with it. Wasmtime compiles the module to machine code, which the cache stores.
"""

from __future__ import annotations

import atexit
import ctypes
import threading
from collections.abc import Callable, Mapping
from ctypes import c_uint32
from dataclasses import dataclass, replace
from functools import lru_cache
from hashlib import sha256
from importlib.resources import files
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from stribeck.codegen.emitted import LINE, Added, Emitted
from stribeck.codegen.webassembly import Module
from stribeck.machine.system import MachineSystem
from stribeck.scenario import Scenario
from stribeck.simulation import cache, compiler, engine
from stribeck.simulation.layout import struct_fields
from stribeck.simulation.native import EVENT_ROOM, SolverInput, Solving, solver_input
from stribeck.simulation.promise import MeasuredMotion, Tolerances, solve_to_promise
from stribeck.simulation.result import Result

if TYPE_CHECKING:
    import wasmtime

Made = TypeVar("Made")
Progress = Callable[[float], None]

_KEPT = 2**23  # bytes of memory of an instance that a thread keeps: a new one costs 0.2 ms, most of them for its pages
_RUN_ROOM = 512  # bytes for the struct Run


@dataclass(frozen=True)
class System:
    """A system's module, its sizes for the runtime (struct Shape in runtime/any.c), and the first free address."""

    module: bytes
    shape: list[int]
    end: int


@lru_cache(maxsize=1)
def _runtime() -> Module:
    return Module(files("stribeck.codegen.runtime").joinpath("runtime.wasm").read_bytes())


@lru_cache(maxsize=64)
def system_module(equations: MachineSystem) -> System:
    """Emit a system and join it with the runtime."""
    return with_functions(equations, {})


def with_functions(equations: MachineSystem, added: Mapping[str, Added]) -> System:
    """The same with further exported functions, by name."""
    base = _runtime()
    emitted = Emitted(equations, base.exported, base.imports.index("rates"), base.constant("__heap_base"))
    functions = {name: emitted.added(each) for name, each in added.items()}
    return System(base.joined(emitted.functions, functions), emitted.shape, emitted.end)


def compiled(module: bytes) -> tuple[wasmtime.Module, bool]:
    """A module as machine code, from the cache or built now; and whether it was built now.

    Raises:
        BuildError: if Wasmtime is missing, or rejects the module.
    """
    key = sha256("|".join((engine.identity(), compiler.processor())).encode() + module).hexdigest()[:32]
    if key in _compiled:
        return _compiled[key], False
    kept = cache.stored(key, ".cwasm", lambda path: engine.read(path.read_bytes()))
    _compiled[key] = kept if kept is not None else engine.build(module)
    if kept is None:
        cache.store(key, ".cwasm", bytes(_compiled[key].serialize()))
    return _compiled[key], kept is None


_compiled: dict[str, wasmtime.Module] = {}


@lru_cache(maxsize=1)
def run_struct() -> type[ctypes.Structure]:
    """The struct Run in the layout of wasm32: a pointer has four bytes, all other fields are as on 64-bit machines."""
    return type("WasmRun", (ctypes.Structure,), {"_fields_": struct_fields("run.c", "Run", pointer=c_uint32)})


def solve(code: wasmtime.Module, system: System, scenario: Scenario, progress: Progress | None = None) -> Result:
    """Integrate the scenario with its compiled module; ``progress`` is called with the share of time done."""

    def once(tolerances: Tolerances, most: int) -> tuple[Result, MeasuredMotion]:
        def run(solving: Solving) -> tuple[Result, MeasuredMotion]:
            result = solving.to_the_end(progress, most)
            return replace(result, states=result.states.copy()), solving.measured

        return in_memory(code, system, scenario, solver_input(scenario, tolerances), run)

    return solve_to_promise(scenario, once)


_of_thread = threading.local()  # the module that this thread used last, and its instance


@atexit.register
def _release() -> None:
    """Wasmtime's objects must not outlive its functions, or Python reports an error at its end."""
    vars(_of_thread).clear()
    _compiled.clear()


def in_memory(
    code: wasmtime.Module, system: System, scenario: Scenario, given: SolverInput, use: Callable[[Solving], Made]
) -> Made:
    """What ``use`` makes of a run whose arrays lie in the memory of an instance."""
    last, _of_thread.last = getattr(_of_thread, "last", None), None
    instance = last[1] if last is not None and last[0] is code else engine.Instance(code)
    event_room = max(EVENT_ROOM, 16 * (len(scenario.system.watched) + 1))
    arrays = given.arrays(scenario, event_room)
    heap = -(-system.end // LINE) * LINE
    place, end = dict[str, int](), heap + _RUN_ROOM
    for name, x in arrays.items():
        place[name], end = end, end + -(-max(x.nbytes, 8) // LINE) * LINE
    memory = instance.memory(end)
    views = {
        name: np.frombuffer(memory.data, x.dtype, x.size, place[name]).reshape(x.shape) for name, x in arrays.items()
    }
    for name, x in arrays.items():
        if name != "out":  # the largest, and written before it is read
            views[name][...] = x
    shape = np.array(system.shape, np.int32)
    begin = instance.address("shape")
    memory[begin : begin + shape.nbytes] = shape.view(np.uint8)
    memory[heap : heap + _RUN_ROOM] = 0
    run = run_struct().from_buffer(memory.data, heap)
    for name in arrays:
        setattr(run, name, place[name])
    run.event_room = event_room
    result = use(Solving(scenario, given, run, views, lambda: instance.call("stribeck_advance", heap)))
    if memory.nbytes <= _KEPT:
        _of_thread.last = code, instance
    return result
