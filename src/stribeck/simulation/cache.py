"""Compiled systems, kept on disk under a digest of all that made them.

The digest is of the C source itself, the compiler, its flags and the processor, so nothing can be stale. A file's name
also holds the digest of its content: a file cut short is noticed before it is loaded, and several processes may write
at the same time.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import shutil
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
    home = folder()
    try:
        home.mkdir(parents=True, exist_ok=True)
        work = Path(tempfile.mkdtemp(prefix="build-", dir=home))
    except OSError as error:
        _say_not_kept(home, error)
        work = Path(tempfile.mkdtemp(prefix="stribeck-"))
        home = work
    try:
        try:
            code, built = work / "system.c", work / "system.so"
            code.write_text(source, encoding="utf-8")
        except OSError as error:
            if home == work:
                raise
            _say_not_kept(home, error)
            shutil.rmtree(work, ignore_errors=True)
            home = work = Path(tempfile.mkdtemp(prefix="stribeck-"))
            code, built = work / "system.c", work / "system.so"
            code.write_text(source, encoding="utf-8")
        compiler.build(code, built)
        kept = home / f"{key}-{_digest(built)}.so"
        try:
            built.replace(kept)
        except OSError as error:
            _say_not_kept(home, error)
            kept = built
        return ctypes.CDLL(str(kept))
    finally:
        shutil.rmtree(work, ignore_errors=True)


def _say_not_kept(home: Path, error: OSError) -> None:
    note(f"cache: {home} cannot be written ({error.strerror}); the next process compiles again (set STRIBECK_CACHE)")


def _digest(path: Path) -> str:
    return sha256(path.read_bytes()).hexdigest()[:32]
