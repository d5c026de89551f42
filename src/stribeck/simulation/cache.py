"""Compiled systems, kept on disk under a digest of all that made them.

The digest is of the C source itself, the compiler, its flags and the processor, so nothing can be stale. A file's name
also holds the digest of its content: a file cut short is noticed before it is loaded, and several processes may write
at the same time. A library is code that will run: the folder is closed to other users (0700), and neither a folder nor
a file is trusted that another user owns or could have written.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import stat
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

from stribeck.errors import BuildError, note
from stribeck.files import sha256_of
from stribeck.platforms import user_name
from stribeck.simulation.compiler import Compiler

_loaded: dict[tuple[str, str], ctypes.CDLL] = {}  # by the compiler's key and the source


def folder() -> Path:
    """Where compiled systems are kept: $STRIBECK_CACHE, or the user's cache folder; of a user who has no home, a folder for
    temporary files."""
    if given := os.environ.get("STRIBECK_CACHE"):
        return Path(given).absolute()  # a library's bare name would be looked for elsewhere
    import platformdirs

    try:
        return Path(platformdirs.user_cache_dir("stribeck", appauthor=False))
    except RuntimeError:  # a container's user may be a number alone, without $HOME
        from tempfile import gettempdir

        return Path(gettempdir(), f"stribeck-{user_name()}")


def library(
    source: str, compiler: Compiler, check: Callable[[ctypes.CDLL], None] | None = None
) -> tuple[ctypes.CDLL, bool]:
    """The compiled source, from this process, from disk or built now; and whether it was built now.

    Args:
        source: the C.
        compiler: what compiles it.
        check: raises BuildError where a library is not what it should be; one from disk is then built anew.

    Raises:
        BuildError: the compiler failed, or what it built does not pass the check.
        OSError: what it built cannot be loaded.
    """
    both = compiler.key, source
    if both in _loaded:
        return _loaded[both], False
    key = sha256("\0".join(both).encode()).hexdigest()[:32]
    check = check or (lambda library: None)
    found = _from_disk(key, check)
    if found is not None:
        _loaded[both] = found
        return found, False
    _loaded[both] = _build(key, source, compiler, check)
    return _loaded[both], True


def distrusted(home: Path) -> str | None:
    """Why nothing is loaded from this folder, or None; one of ours that is open to others is closed, unless it holds other
    files, as /tmp does: then it is used where others cannot write."""
    if not hasattr(os, "geteuid"):
        return None
    try:
        state = home.stat()
    except OSError:
        return None  # there is none yet, or it will be said that it cannot be written
    if not stat.S_ISDIR(state.st_mode):
        return None
    if state.st_uid != os.geteuid():
        return "belongs to another user"
    try:
        if (mode := stat.S_IMODE(state.st_mode)) & 0o077:
            if all(
                path.suffix in (".so", ".wasm", ".cwasm") or path.name.startswith("build-") for path in home.iterdir()
            ):
                home.chmod(mode & 0o700)
            elif mode & 0o022:
                return "is open to other users and holds other files"
    except OSError as error:
        return f"cannot be closed to other users ({error.strerror})"
    return None


def _from_disk(key: str, check: Callable[[ctypes.CDLL], None]) -> ctypes.CDLL | None:
    home = folder()
    if distrusted(home):
        return None  # said when what is built cannot be kept
    try:
        candidates = sorted(home.glob(f"{key}-*.so"))
    except OSError:
        return None
    for path in candidates:
        try:
            if foreign(path):
                note(f"cache: {path} may have been written by another user; the system is compiled anew")
            elif _digest(path) != path.stem.split("-")[1]:
                note(f"cache: {path} is damaged; the system is compiled anew")
            else:
                library = ctypes.CDLL(str(path))
                check(library)
                return library
        except BuildError as error:
            note(f"cache: {path}: {error}; the system is compiled anew")
        except OSError as error:
            note(f"cache: {path} cannot be loaded ({error.strerror or error}); the system is compiled anew")
        with contextlib.suppress(OSError):
            path.unlink()
    return None


def foreign(path: Path) -> bool:
    """True where another user owns the file, or may write it."""
    state = path.lstat()
    if not hasattr(os, "geteuid"):
        return False
    return state.st_uid != os.geteuid() or bool(state.st_mode & 0o022) or stat.S_ISLNK(state.st_mode)


def _build(key: str, source: str, compiler: Compiler, check: Callable[[ctypes.CDLL], None]) -> ctypes.CDLL:
    from tempfile import TemporaryDirectory

    with TemporaryDirectory(prefix="stribeck-", ignore_cleanup_errors=True) as work:
        code, built = Path(work) / "system.c", Path(work) / "system.so"
        code.write_text(source, encoding="utf-8")
        compiler.build(code, built)
        kept = _keep(key, built)
        # the one in the cache: programs may not lie among temporary files, and Windows removes no library in use
        for place in dict.fromkeys((kept, built)):
            try:
                library = ctypes.CDLL(str(place))
                check(library)
                return library
            except BuildError:
                with contextlib.suppress(OSError):
                    place.unlink()
                raise
            except OSError:  # the next process says so
                if place == built:
                    raise
        raise AssertionError


def _keep(key: str, built: Path) -> Path:
    """The library's place in the cache, or where it is when the cache cannot be written."""
    from tempfile import NamedTemporaryFile

    home = folder()
    kept = home / f"{key}-{_digest(built)}.so"
    if reason := distrusted(home):
        note(f"cache: {home} {reason}: it is not used; the next process compiles again (set STRIBECK_CACHE)")
        return built
    try:
        if kept.is_file() and not foreign(kept) and _digest(kept) == _digest(built):
            return kept  # by another process, which may have it in use
        home.mkdir(parents=True, exist_ok=True, mode=0o700)
        with NamedTemporaryFile(prefix="build-", dir=home, delete=False) as draft:
            try:
                draft.write(built.read_bytes())
                draft.close()
                Path(draft.name).replace(kept)
            except BaseException:
                with contextlib.suppress(OSError):
                    Path(draft.name).unlink()
                raise
    except OSError as error:
        _say_not_kept(home, error)
        return built
    return kept


def _say_not_kept(home: Path, error: OSError) -> None:
    note(f"cache: {home} cannot be written ({error.strerror}); the next process compiles again (set STRIBECK_CACHE)")


def read_sealed(name: str) -> bytes | None:
    """A file of the cache that :func:`write_sealed` wrote: its content, or None where there is none that is whole and ours."""
    home = folder()
    if distrusted(home) is not None:
        return None
    with contextlib.suppress(OSError):
        if not foreign(home / name):
            content = (home / name).read_bytes()
            if sha256(content[:-32]).digest() == content[-32:]:
                return content[:-32]
    return None


def write_sealed(name: str, content: bytes) -> None:
    """Keep a file in the cache, with its digest; where that cannot be done the next process makes it anew."""
    from tempfile import NamedTemporaryFile

    home = folder()
    if distrusted(home) is not None:
        return
    with contextlib.suppress(OSError):
        home.mkdir(parents=True, exist_ok=True, mode=0o700)
        with NamedTemporaryFile(prefix="build-", dir=home, delete=False) as draft:
            draft.write(content + sha256(content).digest())
        Path(draft.name).replace(home / name)


def _digest(path: Path) -> str:
    return sha256_of(path)[:32]
