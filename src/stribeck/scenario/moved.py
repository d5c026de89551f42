"""A scenario's tables for a file in another folder: what they name by relative paths is still found from there."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from stribeck.scenario.trust import in_a_file


def moved(data: Mapping[str, object], folder: Path, to: Path) -> dict[str, object]:
    """The tables with every relative path (a parameter set, a recorded signal, a law in a file) seen from ``to`` instead
    of ``folder``; what is None is left out, for TOML has no such value."""
    return {k: _seen(k, x, folder, to) for k, x in data.items() if x is not None}


def _within(value: object, folder: Path, to: Path) -> object:
    if isinstance(value, Mapping):
        return moved(value, folder, to)
    return [_within(x, folder, to) for x in value] if isinstance(value, list | tuple) else value


def _seen(key: str, value: object, folder: Path, to: Path) -> object:
    if not isinstance(value, str):
        return _within(value, folder, to)
    path, colon, name = value.rpartition(":") if key in ("name", "kind") and in_a_file(value) else (value, "", "")
    if not (colon or (key == "parameters" and value.endswith(".toml")) or key == "path") or Path(path).is_absolute():
        return value
    try:
        path = os.path.relpath((folder / path).absolute(), to.absolute())
    except ValueError:  # on another drive of Windows
        path = str((folder / path).absolute())
    return f"{Path(path).as_posix()}{colon}{name}"
