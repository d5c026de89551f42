"""What moves the body: each kind of drive with its constants and equations; a file in this folder is found by itself."""

from __future__ import annotations

import importlib
import pkgutil

from stribeck.drives.base import Drive

__all__ = ["KINDS", "Drive"]

_LISTED_FIRST = ("force", "spring", "pid", "velocity")


def kinds() -> dict[str, type[Drive]]:
    """Every drive of the package by its kind."""
    files = {m.name for m in pkgutil.iter_modules(__path__)}
    found: dict[str, type[Drive]] = {}
    for name in (*_LISTED_FIRST, *sorted(files - {*_LISTED_FIRST, "base"})):
        module = importlib.import_module(f"{__name__}.{name}")
        own = (x for x in vars(module).values() if isinstance(x, type) and x.__module__ == module.__name__)
        found |= {drive.kind: drive for drive in own if issubclass(drive, Drive)}
    return found


KINDS = kinds()
