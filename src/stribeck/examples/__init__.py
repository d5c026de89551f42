"""The example scenarios: those of the paper, machines, and records to fit."""

from __future__ import annotations

from pathlib import Path

_FOLDER = Path(__file__).parent


def names() -> list[str]:
    """The names of the examples."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml") if "." not in path.stem)


def path(name: str) -> Path:
    """The scenario file of an example."""
    return _FOLDER / f"{name}.toml"


def companions(name: str) -> list[Path]:
    """The other files of an example: its records, and the list of recordings to fit."""
    records = (p for p in _FOLDER.glob(f"{name}_*") if p.suffix in (".csv", ".parquet"))
    return sorted([*records, *_FOLDER.glob(f"{name}.*.toml")])
