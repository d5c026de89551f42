"""Classes of laws and elements: those of a package's modules, and ``FILE.py:NAME`` of a user's file."""

from __future__ import annotations

import copyreg
import importlib
import inspect
import pkgutil
import sys
import threading
import traceback
from collections.abc import Callable, Iterable
from hashlib import sha256
from pathlib import Path
from types import ModuleType
from typing import TypeGuard, TypeVar

from stribeck.errors import InputError, error_text
from stribeck.files import read_file

T = TypeVar("T")


def in_a_file(name: object) -> TypeGuard[str]:
    """Whether a name is that of a law or an element in a file, FILE.py:NAME."""
    return isinstance(name, str) and ".py:" in name


_loading = threading.RLock()  # no other thread may use a module that is partly loaded
_OF_FILE = "_stribeck_user_"  # prefix of the names of users' modules
_paths: dict[str, Path] = {}  # of users' files, by their module's name


def modules(package: str, path: Iterable[str], first: Iterable[str] = ()) -> list[ModuleType]:
    """Every module of a package: the ``first`` in their order, then the others by name."""
    first = tuple(first)
    others = {m.name for m in pkgutil.iter_modules(path)} - {*first}
    return [importlib.import_module(f"{package}.{name}") for name in (*first, *sorted(others))]


def classes(module: ModuleType, base: type[T]) -> list[type[T]]:
    """The public classes derived from ``base`` that a module itself defines, in their order."""
    return [
        value
        for name, value in vars(module).items()
        if isinstance(value, type) and issubclass(value, base) and value is not base
        and value.__module__ == module.__name__ and not name.startswith("_")
    ]  # fmt: skip


def of_a_file(kind: type) -> bool:
    """Whether a user's file defines a class."""
    return kind.__module__.startswith(_OF_FILE)


class FromFile(type):
    """The metaclass of classes that users' files may define; another process unpickles them by loading the file."""


def _pickled(kind: FromFile) -> str | tuple[Callable[[str, str, str], FromFile], tuple[str, str, str]]:
    if not of_a_file(kind):
        return kind.__qualname__
    return _unpickled, (str(_paths[kind.__module__]), kind.__module__, kind.__qualname__)


def _unpickled(file: str, module_name: str, name: str) -> FromFile:
    """A class of a user's file, which must be unchanged.

    Raises:
        InputError: if the file cannot be read, does not load, or has changed.
    """
    full, path = f"{file}:{name}", Path(file)
    text = _text(full, path)
    if _module_name(path, text) != module_name:
        raise InputError(f"{path}: has changed since '{name}' was pickled")
    kind = getattr(_module(full, path, text), name)
    assert isinstance(kind, FromFile)
    return kind


copyreg.pickle(FromFile, _pickled)


def at_fault(error: BaseException) -> str | None:
    """File, line and text of an error that a user's file raised; None if it was not raised there."""
    frames = [
        (frame.f_code.co_filename, line)
        for frame, line in traceback.walk_tb(error.__traceback__)
        if str(frame.f_globals.get("__name__")).startswith(_OF_FILE)
    ]
    return f"{frames[-1][0]}: line {frames[-1][1]}: {error_text(error)}" if frames else None


def load_module(name: str, folder: Path | None) -> tuple[ModuleType, Path, str]:
    """The module, the path and NAME of ``FILE.py:NAME``.

    Raises:
        InputError: if the file cannot be read or does not load.
    """
    file, _, wanted = name.rpartition(":")
    path = (folder or Path()) / file
    return _module(name, path, _text(name, path)), path, wanted


def find_class(name: str, folder: Path | None, base: type[T]) -> type[T]:
    """The class ``NAME`` in ``FILE.py``, which must be derived from ``base``.

    Raises:
        InputError: if the file does not load or has no such class, or a method takes other arguments than the base's.
    """
    module, path, wanted = load_module(name, folder)
    value = getattr(module, wanted, None)
    if isinstance(value, type) and issubclass(value, base):
        if problems := _other_arguments(value, base):
            raise InputError([f"{name!r}: {problem}" for problem in problems])
        return value
    if isinstance(value, type):
        package = base.__module__.rpartition(".")[0]
        raise InputError(f"{name!r}: {wanted} must be derived from {package}'s {base.__name__}")
    others = [n for n, x in vars(module).items() if isinstance(x, type) and issubclass(x, base) and x is not base]
    what = base.__name__.removesuffix("Element").lower()
    raise InputError(f"{name!r}: {path} has no {what} '{wanted}' (it has {', '.join(others) or 'none'})")


def _other_arguments(kind: type, base: type) -> list[str]:
    """The methods of a class that cannot be called with the arguments of the base's method."""
    problems = []
    for name in dict.fromkeys(n for each in kind.__mro__[: kind.__mro__.index(base)] for n in vars(each)):
        method, overridden = inspect.getattr_static(kind, name), inspect.getattr_static(base, name, None)
        if name.startswith("_") or not (inspect.isfunction(method) and inspect.isfunction(overridden)):
            continue
        arguments = [*inspect.signature(overridden).parameters]
        try:
            inspect.signature(method).bind(*arguments)
        except TypeError:
            problems.append(f"{name} must take the arguments ({', '.join(arguments)})")
    return problems


def _text(name: str, path: Path) -> bytes:
    """The content of a user's file."""
    try:
        return read_file(path)
    except (OSError, ValueError) as error:
        raise InputError(f"{name!r}: cannot read {path}: {getattr(error, 'strerror', None) or error}") from None


def _module_name(path: Path, text: bytes) -> str:
    """The name of a user's module. The content is part of it: an edited file is loaded again."""
    return f"{_OF_FILE}{sha256(str(path.resolve()).encode() + b'|' + text).hexdigest()[:16]}"


def _module(name: str, path: Path, text: bytes) -> ModuleType:
    """The module of a user's file, from its text, executed once; byte code beside the file is not used."""
    module_name = _module_name(path, text)
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
                raise InputError(f"{name!r}: {path} does not load: {error_text(error)}") from error
    return sys.modules[module_name]
