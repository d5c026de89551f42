"""A scenario's tables in another folder."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from stribeck.files import seen_from
from stribeck.kinds import in_a_file


def moved(data: Mapping[str, object], folder: Path, to: Path) -> dict[str, object]:
    """The tables with every relative path seen from ``to`` instead of ``folder``.

    Paths are those of parameter sets, recorded signals and laws in files. None is left out: TOML has no such value."""

    def seen(key: str, value: object) -> object:
        if isinstance(value, Mapping):
            return {k: seen(k, x) for k, x in value.items() if x is not None}
        if isinstance(value, list | tuple):
            return [seen("", x) for x in value]
        if not isinstance(value, str):
            return value
        path, colon, name = value.rpartition(":") if key in ("name", "kind") and in_a_file(value) else (value, "", "")
        if not (colon or (key == "parameters" and value.endswith(".toml")) or key == "path"):
            return value
        return f"{path if Path(path).is_absolute() else seen_from(to, folder / path)}{colon}{name}"

    return {key: seen(key, value) for key, value in data.items() if value is not None}
