"""Laws in files are programs: which of them a scenario may have executed.

A scenario may come from a stranger. It may name laws and elements (``law.name``, ``drive.observer.name``,
``links.gear.kind``) as ``FILE.py:NAME``, and reading one executes the file. So that happens last, when everything else
is valid. The file must be in the scenario's folder or below, unless the user trusts the scenario or named the law.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from stribeck.constants import show
from stribeck.kinds import in_a_file

_DEEPEST = 16  # tables within tables; no valid file has as many


def named(data: Mapping[str, object]) -> dict[str, str]:
    """The laws and elements in files that a scenario's data names, by the path of the key."""
    programs: dict[str, str] = {}
    left: list[tuple[str, Mapping[str, object] | list[object]]] = [
        (key, value) for key, value in data.items() if isinstance(value, Mapping)
    ]
    while left:  # a file may nest deeper than Python calls
        path, value = left.pop()
        if isinstance(value, list) and set(map(type, value)) <= {float}:  # the samples of a signal, which may be many
            continue
        inside: Iterable[tuple[str | int, object]] = value.items() if isinstance(value, Mapping) else enumerate(value)
        for key, each in inside:
            place = f"{path}[{key}]" if isinstance(key, int) else f"{path}.{key}"
            if key in ("name", "kind") and in_a_file(each):
                programs[place] = each
            elif isinstance(each, Mapping | list) and place.count(".") + place.count("[") < _DEEPEST:
                left.append((place, each))
    return programs


def problems(data: Mapping[str, object], folder: Path, trusted: Iterable[str]) -> list[tuple[str, str]]:
    """(path, message) for each law in a file that lies elsewhere; ``trusted`` are names that the user has given."""
    text = "lies outside the scenario's folder, and a law is a program that would be executed"
    remedy = "must be in that folder or below it, or allowed with trust=True (--trust)"
    return [
        (path, f"{show(name)}: {text}: {remedy}")
        for path, name in named(data).items()
        if name not in trusted and elsewhere(folder / name.rpartition(":")[0], folder)
    ]


def astray(names: Iterable[object], base: Path, *homes: Path) -> list[str]:
    """The laws in files, as seen from ``base``, that lie in none of these folders nor below them."""
    files = {name: base / name.rpartition(":")[0] for name in names if in_a_file(name)}
    return [name for name, file in files.items() if all(elsewhere(file, home) for home in homes)]


def elsewhere(file: Path, folder: Path) -> bool:
    """Whether a file lies neither in a folder nor below it."""
    try:
        return not file.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):
        return False  # no path at all: it will be said that it cannot be read
