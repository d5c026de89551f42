"""WebAssembly modules compiled and called by Wasmtime."""

from __future__ import annotations

import atexit
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib.metadata import version
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from stribeck.errors import BuildError

if TYPE_CHECKING:
    from wasmtime import Engine, Func, Global, Memory, Module

_PAGE = 65536  # bytes, of WebAssembly's memory


@contextmanager
def _failures() -> Iterator[None]:
    """Turn errors of Wasmtime into a BuildError; it must be installed, and for this machine."""
    try:
        import wasmtime
    except (ImportError, OSError, RuntimeError) as error:
        raise BuildError(f"Wasmtime cannot be loaded: {error} (pip install wasmtime)") from None
    try:
        yield
    except (wasmtime.WasmtimeError, wasmtime.Trap) as error:
        raise BuildError(f"Wasmtime: {' '.join(str(error).split())}") from None


@cache
def engine() -> Engine:
    """An engine with Cranelift's defaults: its best code, all of this processor's instructions, no fused operations."""
    import wasmtime

    return wasmtime.Engine()


atexit.register(engine.cache_clear)  # as _release of wasm.py


def identity() -> str:
    """The version, which determines the machine code of a module beside the processor."""
    return f"wasmtime {version('wasmtime')}"


def build(module: bytes) -> Module:
    """Compile a module. Threads may share it.

    Raises:
        BuildError: if it is not valid, or there is no Wasmtime for this machine.
    """
    with _failures():
        import wasmtime

        return wasmtime.Module(engine(), module)


def read(code: bytes) -> Module:
    """Read the machine code of ``Module.serialize()``. The code will run, so it must come from a trusted place.

    Raises:
        BuildError: if it is damaged, or was written by another version or for another processor.
    """
    with _failures():
        import wasmtime

        return wasmtime.Module.deserialize(engine(), code)


class Instance:
    """A module with a memory of its own, for one thread at a time.

    Args:
        compiled: the module; it imports nothing.

    Raises:
        BuildError: if it cannot be instantiated.
    """

    def __init__(self, compiled: Module) -> None:
        with _failures():
            import wasmtime

            self._store = wasmtime.Store(engine())
            self._exports = wasmtime.Instance(self._store, compiled, []).exports(self._store)

    def address(self, name: str) -> int:
        """The value of an exported global, which is an address."""
        return int(cast("Global", self._exports[name]).value(self._store))

    def call(self, name: str, argument: int) -> int:
        """Call an exported function of one i32 that returns an i32; other threads continue.

        Raises:
            BuildError: if the module trapped.
        """
        with _failures():
            return int(cast("Func", self._exports[name])(self._store, argument))

    def memory(self, size: int) -> NDArray[np.uint8]:
        """The memory, of at least ``size`` bytes. Growing moves it, so that earlier views are no longer valid.

        Raises:
            MemoryError: if it cannot grow.
        """
        memory = cast("Memory", self._exports["memory"])
        missing = size - memory.data_len(self._store)
        if missing > 0:
            try:
                with _failures():
                    memory.grow(self._store, -(-missing // _PAGE))
            except BuildError as error:
                raise MemoryError(str(error)) from None
        return np.ctypeslib.as_array(memory.data_ptr(self._store), (memory.data_len(self._store),))
