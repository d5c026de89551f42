"""How classes are found: those of a package's modules, and ``FILE.py:NAME`` of the user's own wherever a kind's name stands."""

from __future__ import annotations

import copyreg
import importlib
import pkgutil
import sys
import threading
import traceback
from collections.abc import Callable, Iterable
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from typing import TypeGuard, TypeVar

from stribeck.errors import InputError, said_by
from stribeck.files import read_file

T = TypeVar("T")


def in_a_file(name: object) -> TypeGuard[str]:
    """True for the name of a law or an element in a file, FILE.py:NAME."""
    return isinstance(name, str) and ".py:" in name


_loading = threading.RLock()  # another thread must not meet a module that is half loaded
_OF_FILE = "_stribeck_user_"  # how the modules of users' files are called
_paths: dict[str, Path] = {}  # of users' files, by their module's name


def modules(
    package: str, path: Iterable[str], first: Iterable[str] = (), aside: Iterable[str] = ()
) -> list[ModuleType]:
    """Every module of a package but those ``aside``: the ``first`` in their order, then the others by name."""
    first = tuple(first)
    others = {m.name for m in pkgutil.iter_modules(path)} - {*first, *aside}
    return [importlib.import_module(f"{package}.{name}") for name in (*first, *sorted(others))]


def classes(module: ModuleType, base: type[T]) -> list[type[T]]:
    """The public classes that a module itself defines and that are derived from ``base``, in their order."""
    return [
        value
        for name, value in vars(module).items()
        if isinstance(value, type) and issubclass(value, base) and value is not base
        and value.__module__ == module.__name__ and not name.startswith("_")
    ]  # fmt: skip


def of_a_file(kind: type) -> bool:
    """True for a class that a user's file defines."""
    return kind.__module__.startswith(_OF_FILE)


class FromFile(type):
    """The class of classes that users' files may define: another process unpickles them by loading the file."""


def _pickled(kind: FromFile) -> str | tuple[Callable[[str, str, str], FromFile], tuple[str, str, str]]:
    if not of_a_file(kind):
        return kind.__qualname__
    return _unpickled, (str(_paths[kind.__module__]), kind.__module__, kind.__qualname__)


def _unpickled(file: str, module_name: str, name: str) -> FromFile:
    """A class of a user's file, which must be what it was.

    Raises:
        InputError: the file cannot be read, does not load, or has changed.
    """
    module, path, _ = load_module(f"{file}:{name}", None)
    if module.__name__ != module_name:
        raise InputError(f"{path}: has changed since '{name}' was pickled")
    found = getattr(module, name)
    assert isinstance(found, FromFile)
    return found


copyreg.pickle(FromFile, _pickled)


def at_fault(error: BaseException) -> str | None:
    """What a user's file raised, and in which line, where one did while it was called; else None."""
    found = [
        (frame.f_code.co_filename, line)
        for frame, line in traceback.walk_tb(error.__traceback__)
        if str(frame.f_globals.get("__name__")).startswith(_OF_FILE)
    ]
    return f"{found[-1][0]}: line {found[-1][1]}: {said_by(error)}" if found else None


def load_module(name: str, folder: Path | None) -> tuple[ModuleType, Path, str]:
    """The module, the path and the name behind ``FILE.py:NAME``.

    Raises:
        InputError: the file cannot be read or does not load.
    """
    file, _, wanted = name.rpartition(":")
    path = (folder or Path()) / file
    try:
        text = read_file(path)
    except (OSError, ValueError) as error:
        raise InputError(f"{name!r}: cannot read {path}: {getattr(error, 'strerror', None) or error}") from None
    return _module(name, path, text), path, wanted


def find_class(name: str, folder: Path | None, base: type[T]) -> type[T]:
    """The class ``NAME`` in ``FILE.py``, which must be derived from ``base``.

    Raises:
        InputError: the file does not load, or has no such class.
    """
    module, path, wanted = load_module(name, folder)
    found = getattr(module, wanted, None)
    if isinstance(found, type) and issubclass(found, base):
        return found
    if isinstance(found, type):
        room = base.__module__.rpartition(".")[0]
        raise InputError(f"{name!r}: {wanted} must be derived from {room}'s {base.__name__}")
    has = [n for n, x in vars(module).items() if isinstance(x, type) and issubclass(x, base) and x is not base]
    what = base.__name__.removesuffix("Element").lower()
    raise InputError(f"{name!r}: {path} has no {what} '{wanted}' (it has {', '.join(has) or 'none'})")


def _module(name: str, path: Path, text: bytes) -> ModuleType:
    """The module of a user's file: these very bytes, executed once; no byte code that lies beside them is taken."""
    # the content is part of the name: an edited file is loaded anew
    module_name = f"{_OF_FILE}{sha256(str(path.resolve()).encode() + b'|' + text).hexdigest()[:16]}"
    with _loading:
        if module_name not in sys.modules:
            module = ModuleType(module_name)
            module.__file__ = str(path)
            _paths[module_name] = path.resolve()
            sys.modules[module_name] = module
            try:
                exec(compile(text, str(path), "exec", dont_inherit=True), module.__dict__)
            except BaseException as error:
                del sys.modules[module_name]
                if isinstance(error, InputError):
                    raise InputError([f"{name!r}: {path}: {problem}" for problem in error.problems]) from error
                if isinstance(error, KeyboardInterrupt):
                    raise
                raise InputError(f"{name!r}: {path} does not load: {said_by(error)}") from error
    return sys.modules[module_name]
