"""C -> WebAssembly by the compiler in the package ziglang, kept beside the compiled systems."""

from __future__ import annotations

import contextlib
import ctypes
import importlib.util
import os
import sys
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from hashlib import sha256
from pathlib import Path

from stribeck.errors import BuildError, MissingExtra
from stribeck.files import read_file, write_with
from stribeck.simulation import cache, compiler
from stribeck.simulation.native import Run

_FLAGS = (
    "-target", "wasm32-wasi", "-O3", "-fno-math-errno", "-mexec-model=reactor", "-Wl,--no-entry", "-Wl,--export-dynamic",
    "-Wl,--export=__heap_base", "-Wl,--strip-all",
)  # fmt: skip
_TIME_LIMIT = 600  # s; the first time the compiler builds its library of mathematical functions
_MAGIC = b"\0asm"


def modules(sources: Sequence[str], progress: Callable[[float], None] | None = None) -> list[bytes]:
    """Each C source as a WebAssembly module with no imports, from the cache or built now.

    Raises:
        MissingExtra: ziglang is not installed.
        BuildError: the compiler failed.
    """
    identity = _compiler()
    done = 0

    def one(source: str) -> bytes:
        nonlocal done
        module = _module(source, identity)
        done += 1
        if progress is not None:
            progress(done / len(sources))
        return module

    first = [one(source) for source in sources[:1]]  # which leaves the compiler's library for the others
    with ThreadPoolExecutor(max_workers=min(8, os.cpu_count() or 1)) as pool:
        return [*first, *pool.map(one, sources[1:])]


def layout() -> dict[str, tuple[int, str]]:
    """The fields of Run (simulation/native.py) in the memory of a module: each one's offset and kind."""
    found: dict[str, tuple[int, str]] = {}
    at = 0
    for name, kind, *_ in Run._fields_:
        word, size = _word(kind)
        at = -(-at // size) * size
        found[name] = (at, word)
        at += size
    found["_size"] = (-(-at // 8) * 8, "size")
    return found


def _word(kind: object) -> tuple[str, int]:
    if kind is ctypes.c_double:
        return "double", 8
    if kind is ctypes.c_int64:
        return "integer", 8
    return "pointer", 4


def _compiler() -> str:
    from importlib.metadata import version

    if importlib.util.find_spec("ziglang") is None:
        raise MissingExtra("an explorer", "ziglang", "explore")
    return f"ziglang {version('ziglang')}"


def _module(source: str, identity: str) -> bytes:
    key = sha256("\0".join((identity, *_FLAGS, source)).encode()).hexdigest()[:32]
    home = cache.folder()
    closed = cache.distrusted(home) is None
    kept = home / f"{key}.wasm"
    if closed:
        with contextlib.suppress(OSError):
            content = b"" if cache.foreign(kept) else read_file(kept)
            if content[-32:] == _seal(content[:-32]):  # one cut short is built anew
                return content[:-32]
    module = _build(source)
    if closed:
        with contextlib.suppress(OSError):
            home.mkdir(parents=True, exist_ok=True, mode=0o700)
            write_with(kept, lambda path: _write_closed(path, module + _seal(module)))
    return module


def _write_closed(path: Path, content: bytes) -> None:
    path.touch(0o600)
    path.write_bytes(content)


def _seal(module: bytes) -> bytes:
    return sha256(module).digest()


def _build(source: str) -> bytes:
    with tempfile.TemporaryDirectory(prefix="stribeck-", ignore_cleanup_errors=True) as work:
        code, built = Path(work) / "system.c", Path(work) / "system.wasm"
        code.write_text(source, encoding="utf-8")
        command = [sys.executable, "-m", "ziglang", "cc", *_FLAGS, "-o", str(built), str(code)]
        result = compiler.called(command, "zig cc", _TIME_LIMIT, built.parent)
        content = built.read_bytes() if built.is_file() else b""
        if result.returncode or not content.startswith(_MAGIC):
            complaint = compiler.first_complaint(result.stderr) or f"exit status {result.returncode}"
            raise BuildError(f"zig cc failed: {complaint}")
        return content
