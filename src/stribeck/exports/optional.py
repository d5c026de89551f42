"""Packages of other tools, imported where they are used."""

from __future__ import annotations

import importlib
from types import ModuleType

from stribeck.errors import needed
from stribeck.expressions.ops import Value


def package(name: str) -> ModuleType:
    """The package called ``name``.

    Raises:
        MissingExtra: it is not installed.
    """
    with needed("this export"):
        return importlib.import_module(name)


class Operations:
    """The operations of :mod:`stribeck.expressions.ops` by a package; ``names``: of those that it calls otherwise."""

    def __init__(self, package: str, **names: str) -> None:
        self._package, self._names = package, names

    def __getattr__(self, op: str) -> Value:
        return getattr(package(self._package), self._names.get(op, op))
