"""Packages of other tools, imported where they are used."""

from __future__ import annotations

import importlib
from types import ModuleType

from stribeck.errors import needed


def package(name: str, extra: str) -> ModuleType:
    """The package called ``name``, which an extra brings.

    Raises:
        MissingExtra: it is not installed.
    """
    with needed("this export", extra):
        return importlib.import_module(name)
