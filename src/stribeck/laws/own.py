"""Plants and elements of the user's own: ``FILE.py:NAME`` wherever a kind's name stands, as for a law."""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

from stribeck.errors import InputError
from stribeck.laws import load_module

T = TypeVar("T")


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
