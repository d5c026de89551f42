"""Example scenarios: those of the paper, and one driven by a recorded signal."""

from __future__ import annotations

from pathlib import Path

_FOLDER = Path(__file__).parent


def names() -> list[str]:
    """The names of the examples."""
    return sorted(path.stem for path in _FOLDER.glob("*.toml"))


def path(name: str) -> Path:
    """The scenario file of an example."""
    return _FOLDER / f"{name}.toml"


def companions(name: str) -> list[Path]:
    """The data files that an example reads."""
    return sorted(p for p in _FOLDER.glob(f"{name}_*") if p.suffix in (".csv", ".parquet"))
