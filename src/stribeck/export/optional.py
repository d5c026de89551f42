"""Packages of other tools, imported where they are used."""

from __future__ import annotations

import importlib
from types import ModuleType

from stribeck.errors import StribeckError


class MissingPackage(StribeckError, ImportError):
    """A tool's Python package is not installed; the message says how to get it."""


def package(name: str, extra: str) -> ModuleType:
    """The package called ``name``, which the extra of that name brings.

    Raises:
        MissingPackage: it is not installed.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        text = f"needs the package '{name}', which is not installed: pip install 'stribeck[{extra}]'"
        raise MissingPackage(f"{text} ({error})") from error
