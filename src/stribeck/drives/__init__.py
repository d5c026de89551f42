"""What moves the body: each kind of drive with its constants and equations; a file in this folder is found by itself."""

from __future__ import annotations

from stribeck import kinds as find
from stribeck.drives.base import Drive

__all__ = ["KINDS", "Drive"]

_LISTED_FIRST = ("force", "spring", "pid", "velocity")


def kinds() -> dict[str, type[Drive]]:
    """Every drive of the package by its kind."""
    modules = find.modules(__name__, __path__, _LISTED_FIRST, ("base",))
    return {drive.kind: drive for module in modules for drive in find.classes(module, Drive)}


KINDS = kinds()
