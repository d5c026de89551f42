"""WebAssembly modules compiled and called by Wasmtime's library, through ctypes.

The functions in use are declared here, since the package ``wasmtime`` declares some hundreds at its import. Their
documentation: https://docs.wasmtime.dev/c-api/
"""

from __future__ import annotations

import ctypes
import platform
import sys
from ctypes import POINTER, byref, c_bool, c_char_p, c_int32, c_size_t, c_uint8, c_uint64, c_void_p
from functools import cache
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stribeck.errors import BuildError

_PAGE = 65536  # bytes, of WebAssembly's memory


class _Bytes(ctypes.Structure):
    _fields_ = [("size", c_size_t), ("data", c_void_p)]


class _Extern(ctypes.Structure):
    """An export of a module: its content is a function, a memory or a global, each at most 24 bytes."""

    _fields_ = [("kind", c_uint8), ("content", c_uint64 * 3)]


class _Value(ctypes.Structure):
    _fields_ = [("kind", c_uint8), ("content", c_uint64 * 3)]


class _Raw(ctypes.Union):
    _fields_ = [("i32", c_int32), ("room", c_uint64 * 2)]


_DECLARED: dict[str, tuple[object, list[object]]] = {
    "wasm_engine_new": (c_void_p, []),
    "wasm_byte_vec_delete": (None, [POINTER(_Bytes)]),
    "wasmtime_error_message": (None, [c_void_p, POINTER(_Bytes)]),
    "wasmtime_error_delete": (None, [c_void_p]),
    "wasm_trap_delete": (None, [c_void_p]),
    "wasmtime_module_new": (c_void_p, [c_void_p, c_char_p, c_size_t, POINTER(c_void_p)]),
    "wasmtime_module_serialize": (c_void_p, [c_void_p, POINTER(_Bytes)]),
    "wasmtime_module_deserialize": (c_void_p, [c_void_p, c_char_p, c_size_t, POINTER(c_void_p)]),
    "wasmtime_module_delete": (None, [c_void_p]),
    "wasmtime_store_new": (c_void_p, [c_void_p, c_void_p, c_void_p]),
    "wasmtime_store_context": (c_void_p, [c_void_p]),
    "wasmtime_store_delete": (None, [c_void_p]),
    "wasmtime_instance_new": (c_void_p, [c_void_p, c_void_p, c_void_p, c_size_t, POINTER(c_uint64 * 2), POINTER(c_void_p)]),
    "wasmtime_instance_export_get": (c_bool, [c_void_p, POINTER(c_uint64 * 2), c_char_p, c_size_t, POINTER(_Extern)]),
    "wasmtime_memory_data": (c_void_p, [c_void_p, c_void_p]),
    "wasmtime_memory_data_size": (c_size_t, [c_void_p, c_void_p]),
    "wasmtime_memory_grow": (c_void_p, [c_void_p, c_void_p, c_uint64, POINTER(c_uint64)]),
    "wasmtime_global_get": (None, [c_void_p, c_void_p, POINTER(_Value)]),
    "wasmtime_func_call_unchecked": (c_void_p, [c_void_p, c_void_p, POINTER(_Raw), c_size_t, POINTER(c_void_p)]),
}  # fmt: skip
_FILES = {"linux": "_libwasmtime.so", "win32": "_wasmtime.dll", "darwin": "_libwasmtime.dylib"}
_MACHINES = {"AMD64": "x86_64", "x86_64": "x86_64", "arm64": "aarch64", "ARM64": "aarch64", "aarch64": "aarch64"}


@cache
def _library() -> ctypes.CDLL:
    """Wasmtime's library.

    Raises:
        BuildError: if it is not installed, or there is none for this machine.
    """
    spec = find_spec("wasmtime")
    machine = _MACHINES.get(platform.machine())
    if spec is None or spec.origin is None or sys.platform not in _FILES or machine is None:
        raise BuildError(f"no Wasmtime for {sys.platform} on {platform.machine()} (pip install wasmtime)")
    file = Path(spec.origin).parent / f"{sys.platform}-{machine}" / _FILES[sys.platform]
    try:
        library = ctypes.CDLL(str(file))
        for name, (result, arguments) in _DECLARED.items():
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
    except (OSError, AttributeError) as error:
        raise BuildError(f"Wasmtime cannot be loaded: {error}") from None
    return library


@cache
def _engine() -> int:
    """An engine with Cranelift's defaults: its best code, all of this processor's instructions, no fused operations."""
    return int(_library().wasm_engine_new())


def identity() -> str:
    """The version, which determines the machine code of a module beside the processor."""
    return f"wasmtime {version('wasmtime')}"


def _raise_error(error: int | None) -> None:
    if error:
        message, library = _Bytes(), _library()
        library.wasmtime_error_message(error, byref(message))
        text = ctypes.string_at(message.data, message.size).decode(errors="replace")
        library.wasm_byte_vec_delete(byref(message))
        library.wasmtime_error_delete(error)
        raise BuildError(f"Wasmtime: {' '.join(text.split())}")


class Compiled:
    """A module as machine code. Threads may share it."""

    def __init__(self, handle: int) -> None:
        self.handle = handle

    @classmethod
    def build(cls, module: bytes) -> Compiled:
        """Compile a module.

        Raises:
            BuildError: if it is not valid.
        """
        handle = c_void_p()
        _raise_error(_library().wasmtime_module_new(_engine(), module, len(module), byref(handle)))
        return cls(int(handle.value or 0))

    @classmethod
    def read(cls, code: bytes) -> Compiled:
        """Read the machine code of :meth:`written`. The code will run, so it must come from a trusted place.

        Raises:
            BuildError: if it is damaged, or was written by another version or for another processor.
        """
        handle = c_void_p()
        _raise_error(_library().wasmtime_module_deserialize(_engine(), code, len(code), byref(handle)))
        return cls(int(handle.value or 0))

    def written(self) -> bytes:
        """The machine code as bytes."""
        content = _Bytes()
        _raise_error(_library().wasmtime_module_serialize(self.handle, byref(content)))
        code = ctypes.string_at(content.data, content.size)
        _library().wasm_byte_vec_delete(byref(content))
        return code

    def __del__(self) -> None:
        _library().wasmtime_module_delete(self.handle)


class Instance:
    """A module with a memory of its own, for one thread at a time.

    Args:
        compiled: the module; it imports nothing.

    Raises:
        BuildError: if it cannot be instantiated.
    """

    def __init__(self, compiled: Compiled) -> None:
        self._compiled, library = compiled, _library()  # kept as long as its code runs
        self._store = library.wasmtime_store_new(_engine(), None, None)
        self._context = library.wasmtime_store_context(self._store)
        self._instance, trap = (c_uint64 * 2)(), c_void_p()
        _raise_error(
            library.wasmtime_instance_new(self._context, compiled.handle, None, 0, byref(self._instance), byref(trap))
        )
        self._memory = self._export("memory")
        self._functions: dict[str, _Extern] = {}
        self._raw, self._trap = _Raw(), c_void_p()

    def _export(self, name: str) -> _Extern:
        item = _Extern()
        if not _library().wasmtime_instance_export_get(
            self._context, byref(self._instance), name.encode(), len(name), byref(item)
        ):
            raise BuildError(f"the module exports no {name}")
        return item

    def address(self, name: str) -> int:
        """The value of an exported global, which is an address."""
        value = _Value()
        _library().wasmtime_global_get(self._context, byref(self._export(name), _Extern.content.offset), byref(value))
        return int(c_int32(value.content[0] & 0xFFFFFFFF).value)

    def call(self, name: str, argument: int) -> int:
        """Call an exported function of one i32 that returns an i32; other threads continue.

        Raises:
            BuildError: if the module trapped.
        """
        if name not in self._functions:
            self._functions[name] = self._export(name)
        self._raw.i32 = argument
        function = byref(self._functions[name], _Extern.content.offset)
        library = _library()
        _raise_error(
            library.wasmtime_func_call_unchecked(self._context, function, byref(self._raw), 1, byref(self._trap))
        )
        if self._trap:
            library.wasm_trap_delete(self._trap)
            self._trap = c_void_p()
            raise BuildError(f"the module trapped in {name}")
        return int(self._raw.i32)

    def memory(self, size: int) -> NDArray[np.uint8]:
        """The memory, of at least ``size`` bytes. Growing moves it, so that earlier views are no longer valid.

        Raises:
            MemoryError: if it cannot grow.
        """
        library, item = _library(), byref(self._memory, _Extern.content.offset)
        missing = size - library.wasmtime_memory_data_size(self._context, item)
        if missing > 0:
            before = c_uint64()
            try:
                _raise_error(library.wasmtime_memory_grow(self._context, item, -(-missing // _PAGE), byref(before)))
            except BuildError as error:
                raise MemoryError(str(error)) from None
        length = library.wasmtime_memory_data_size(self._context, item)
        pointer = ctypes.cast(library.wasmtime_memory_data(self._context, item), POINTER(c_uint8))
        return np.ctypeslib.as_array(pointer, (length,))

    def __del__(self) -> None:
        if store := getattr(self, "_store", None):
            _library().wasmtime_store_delete(store)
