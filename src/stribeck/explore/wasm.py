"""Calls of a system's WebAssembly module by the page; the module is the one of the WebAssembly backend."""

from __future__ import annotations

import ctypes

from stribeck.simulation.wasm import System, run_struct


def shape(system: System) -> dict[str, object]:
    """The runtime's description of the system before a solution (runtime/any.c), and the address of free memory."""
    return {"numbers": system.shape, "end": system.end}


def layout() -> dict[str, tuple[int, str]]:
    """The fields of the struct Run in the memory of a module: each one's offset and kind."""
    kind = run_struct()
    fields = {name: (getattr(kind, name).offset, _word(of)) for name, of, *_ in kind._fields_}
    return {**fields, "_size": (ctypes.sizeof(kind), "size")}


def _word(kind: object) -> str:
    if kind is ctypes.c_double:
        return "double"
    return "integer" if kind is ctypes.c_int64 else "pointer"
