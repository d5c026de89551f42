"""How the page calls a system's module: the same that simulates where there is no C compiler."""

from __future__ import annotations

import ctypes

from stribeck.simulation.wasm import System, run_struct


def shape(system: System) -> dict[str, object]:
    """What the runtime needs to know of the system before it solves (runtime/any.c), and where memory is free."""
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
