"""A scenario's tables in another folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from stribeck.files import seen_from
from stribeck.kinds import in_a_file

Renamed = Callable[[str], str]


def moved(data: Mapping[str, object], folder: Path, to: Path) -> dict[str, object]:
    """The tables with every relative path seen from ``to`` instead of ``folder``.

    Paths are those of parameter sets, recorded signals and laws in files. None is left out: TOML has no such value."""

    def seen(path: str) -> str:
        return path if Path(path).is_absolute() else seen_from(to, folder / path)

    return _renamed(data, seen)


def _renamed(data: Mapping[str, object], rename: Renamed) -> dict[str, object]:
    """The tables with each path in them renamed."""
    return {k: _value(k, x, rename) for k, x in data.items() if x is not None}


def _within(value: object, rename: Renamed) -> object:
    if isinstance(value, Mapping):
        return _renamed(value, rename)
    return [_within(x, rename) for x in value] if isinstance(value, list | tuple) else value


def _value(key: str, value: object, rename: Renamed) -> object:
    if not isinstance(value, str):
        return _within(value, rename)
    path, colon, name = value.rpartition(":") if key in ("name", "kind") and in_a_file(value) else (value, "", "")
    if not (colon or (key == "parameters" and value.endswith(".toml")) or key == "path"):
        return value
    return f"{rename(path)}{colon}{name}"
