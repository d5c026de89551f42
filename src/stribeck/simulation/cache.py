"""The cache of compiled systems on disk.

The key is a digest of the C source, the compiler, its flags and the processor, so nothing can be stale. A file's name
also contains the digest of its content. So a truncated file is detected before it is loaded, and several processes may
write at the same time. A library is code that will run. The folder is therefore closed to other users (0700), and a folder or
a file that another user owns or could have written is not used.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import stat
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import TypeVar

from stribeck.errors import BuildError, note
from stribeck.platforms import user_name
from stribeck.simulation.compiler import Compiler

Made = TypeVar("Made")

_loaded: dict[tuple[str, str], ctypes.CDLL] = {}  # by the compiler's key and the source


def folder() -> Path:
    """The folder of the cache: $STRIBECK_CACHE, or the user's cache folder; without a home, a folder for temporary files."""
    if given := os.environ.get("STRIBECK_CACHE"):
        return Path(given).absolute()  # the loader searches a relative path elsewhere
    import platformdirs

    try:
        return Path(platformdirs.user_cache_dir("stribeck", appauthor=False))
    except RuntimeError:  # a container's user may be a number alone, without $HOME
        from tempfile import gettempdir

        return Path(gettempdir(), f"stribeck-{user_name()}")


def library(
    source: str, compiler: Compiler, check: Callable[[ctypes.CDLL], None] = lambda library: None
) -> tuple[ctypes.CDLL, bool]:
    """The library of a source, from this process, from disk or built now; and whether it was built now.

    Args:
        source: the C source.
        compiler: the compiler.
        check: raises BuildError for an unsuitable library; one from disk is then built again.

    Raises:
        BuildError: if the compiler failed, or the new library does not pass the check.
        OSError: if the new library cannot be loaded.
    """
    identity = compiler.key, source
    if identity in _loaded:
        return _loaded[identity], False
    key = sha256("\0".join(identity).encode()).hexdigest()[:32]

    def load(path: Path) -> ctypes.CDLL:
        library = ctypes.CDLL(str(path))
        check(library)
        return library

    kept = stored(key, ".so", load)
    _loaded[identity] = kept if kept is not None else _compile(key, source, compiler, load)
    return _loaded[identity], kept is None


def distrusted(home: Path) -> str | None:
    """Why a folder cannot be used for the cache, or None.

    A folder of this user that is open to others is closed to them. If it contains other files, as /tmp does, it is left as
    it is, and used if others cannot write there.
    """
    if not hasattr(os, "geteuid"):
        return None
    try:
        state = home.stat()
    except OSError:
        return None  # it does not exist yet, or the attempt to write reports the reason
    if not stat.S_ISDIR(state.st_mode):
        return None
    if state.st_uid != os.geteuid():
        return "belongs to another user"
    try:
        if (mode := stat.S_IMODE(state.st_mode)) & 0o077:
            if all(path.suffix in (".so", ".cwasm") or path.name.startswith("build-") for path in home.iterdir()):
                home.chmod(mode & 0o700)
            elif mode & 0o022:
                return "is open to other users and holds other files"
    except OSError as error:
        return f"cannot be closed to other users ({error.strerror})"
    return None


def stored(key: str, suffix: str, use: Callable[[Path], Made]) -> Made | None:
    """What ``use`` makes of the file of a key; None without one that is whole, of this user and fit for use.

    ``use`` raises BuildError or OSError for an unfit file, which is then removed.
    """
    home = folder()
    if distrusted(home):
        return None  # reported when the new file cannot be stored
    try:
        candidates = sorted(home.glob(f"{key}-*{suffix}"))
    except OSError:
        return None
    for path in candidates:
        try:
            if foreign(path):
                problem = " may have been written by another user"
            elif _digest(path.read_bytes()) != path.stem.split("-")[1]:
                problem = " is damaged"
            else:
                return use(path)
        except BuildError as error:
            problem = f": {error}"
        except OSError as error:
            problem = f" cannot be loaded ({error.strerror or error})"
        note(f"cache: {path}{problem}; the system is compiled anew")
        with contextlib.suppress(OSError):
            path.unlink()
    return None


def foreign(path: Path) -> bool:
    """Whether another user owns the file or may write it, or it is a link."""
    state = path.lstat()
    if not hasattr(os, "geteuid"):
        return False
    return state.st_uid != os.geteuid() or bool(state.st_mode & 0o022) or stat.S_ISLNK(state.st_mode)


def _compile(key: str, source: str, compiler: Compiler, load: Callable[[Path], ctypes.CDLL]) -> ctypes.CDLL:
    from tempfile import TemporaryDirectory

    with TemporaryDirectory(prefix="stribeck-", ignore_cleanup_errors=True) as work:
        code, built = Path(work) / "system.c", Path(work) / "system.so"
        code.write_text(source, encoding="utf-8")
        compiler.build(code, built)
        kept = store(key, ".so", built.read_bytes()) or built
        # the one in the cache first: temporary files may not be executable, and Windows removes no library in use
        try:
            return load(kept)
        except BuildError:
            with contextlib.suppress(OSError):
                kept.unlink()
            raise
        except OSError:  # reported by the next process
            if kept == built:
                raise
        return load(built)


def store(key: str, suffix: str, content: bytes) -> Path | None:
    """Store a file in the cache and return its place; None, and a note, if the cache cannot be written."""
    from tempfile import NamedTemporaryFile

    home = folder()
    kept = home / f"{key}-{_digest(content)}{suffix}"
    if reason := distrusted(home):
        note(f"cache: {home} {reason}: it is not used; the next process compiles again (set STRIBECK_CACHE)")
        return None
    try:
        if kept.is_file() and not foreign(kept) and kept.read_bytes() == content:
            return kept  # stored by another process, which may use it
        home.mkdir(parents=True, exist_ok=True, mode=0o700)
        with NamedTemporaryFile(prefix="build-", dir=home, delete=False) as draft:
            try:
                draft.write(content)
                draft.close()
                Path(draft.name).replace(kept)
            except BaseException:
                with contextlib.suppress(OSError):
                    Path(draft.name).unlink()
                raise
    except OSError as error:
        why = f"cannot be written ({error.strerror})"
        note(f"cache: {home} {why}; the next process compiles again (set STRIBECK_CACHE)")
        return None
    return kept


def _digest(content: bytes) -> str:
    return sha256(content).hexdigest()[:32]
