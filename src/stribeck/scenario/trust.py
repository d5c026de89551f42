"""Laws in files are programs: which of them a scenario may have executed.

A scenario may come from a stranger. It names its laws (``law.name``, ``drive.observer.name``) as ``FILE.py:NAME``, and
reading one executes the file. So that happens last, when everything else is valid, and only for files in the
scenario's own folder or below it, unless the user trusts the scenario or has named the law himself.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from stribeck.constants import show

_PLACES = (("law", "name"), ("drive", "observer", "name"))


def in_a_file(name: object) -> bool:
    """True for the name of a law in a file, FILE.py:NAME."""
    return isinstance(name, str) and ".py:" in name


def named(data: Mapping[str, Any]) -> dict[str, str]:
    """The laws in files that a scenario's data names, by the path of the key."""
    found: dict[str, str] = {}
    for place in _PLACES:
        value: Any = data
        for key in place:
            value = value.get(key) if isinstance(value, Mapping) else None
        if in_a_file(value):
            found[".".join(place)] = value
    return found


def problems(data: Mapping[str, Any], folder: Path, trusted: Iterable[str]) -> list[tuple[str, str]]:
    """(path, message) for each law in a file that lies elsewhere; ``trusted`` are names that the user has given."""
    text = "lies outside the scenario's folder, and a law is a program that would be executed"
    remedy = "must be in that folder or below it, or allowed with trust=True (--trust)"
    return [
        (path, f"{show(name)}: {text}: {remedy}")
        for path, name in named(data).items()
        if name not in trusted and _elsewhere(folder / name.rpartition(":")[0], folder)
    ]


def _elsewhere(file: Path, folder: Path) -> bool:
    try:
        return not file.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):
        return False  # no path at all: it will be said that it cannot be read
