"""Compiled systems, kept on disk under a digest of all that made them.

The digest is of the C source itself, the compiler, its flags and the processor, so nothing can be stale. A file's name
also holds the digest of its content: a file cut short is noticed before it is loaded, and several processes may write
at the same time.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import tempfile
from hashlib import sha256
from pathlib import Path

from stribeck.errors import note
from stribeck.simulation.compiler import Compiler

_loaded: dict[str, ctypes.CDLL] = {}


def folder() -> Path:
    """Where compiled systems are kept: $STRIBECK_CACHE, or the user's cache folder."""
    if given := os.environ.get("STRIBECK_CACHE"):
        return Path(given)
    import platformdirs

    return Path(platformdirs.user_cache_dir("stribeck", appauthor=False))


def library(source: str, compiler: Compiler) -> tuple[ctypes.CDLL, bool]:
    """The compiled source, from this process, from disk or built now; and whether it was built now.

    Raises:
        BuildError: the compiler failed.
    """
    key = sha256(f"{compiler.key}\0{source}".encode()).hexdigest()[:32]
    if key in _loaded:
        return _loaded[key], False
    found = _from_disk(key)
    if found is not None:
        _loaded[key] = found
        return found, False
    _loaded[key] = _build(key, source, compiler)
    return _loaded[key], True


def _from_disk(key: str) -> ctypes.CDLL | None:
    try:
        candidates = sorted(folder().glob(f"{key}-*.so"))
    except OSError:
        return None
    for path in candidates:
        try:
            if _digest(path) == path.stem.split("-")[1]:
                return ctypes.CDLL(str(path))
            note(f"cache: {path} is damaged; the system is compiled anew")
        except OSError as error:
            note(f"cache: {path} cannot be loaded ({error.strerror or error}); the system is compiled anew")
        with contextlib.suppress(OSError):
            path.unlink()
    return None


def _build(key: str, source: str, compiler: Compiler) -> ctypes.CDLL:
    with tempfile.TemporaryDirectory(prefix="stribeck-", ignore_cleanup_errors=True) as work:
        code, built = Path(work) / "system.c", Path(work) / "system.so"
        code.write_text(source, encoding="utf-8")
        compiler.build(code, built)
        return ctypes.CDLL(str(_keep(key, built)))


def _keep(key: str, built: Path) -> Path:
    """The library's place in the cache, or where it is when the cache cannot be written."""
    home = folder()
    kept = home / f"{key}-{_digest(built)}.so"
    try:
        home.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(prefix="build-", dir=home, delete=False) as draft:
            try:
                draft.write(built.read_bytes())
                draft.close()
                Path(draft.name).replace(kept)
            except OSError:
                with contextlib.suppress(OSError):
                    Path(draft.name).unlink()
                raise
    except OSError as error:
        _say_not_kept(home, error)
        return built
    return kept


def _say_not_kept(home: Path, error: OSError) -> None:
    note(f"cache: {home} cannot be written ({error.strerror}); the next process compiles again (set STRIBECK_CACHE)")


def _digest(path: Path) -> str:
    return sha256(path.read_bytes()).hexdigest()[:32]
