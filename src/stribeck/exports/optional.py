"""Packages of other tools, imported where they are used."""

from __future__ import annotations

import importlib
from types import ModuleType

from stribeck.errors import needed


def package(name: str) -> ModuleType:
    """The package called ``name``.

    Raises:
        MissingExtra: it is not installed.
    """
    with needed("this export"):
        return importlib.import_module(name)
