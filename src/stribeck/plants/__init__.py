"""What a friction law acts on: each plant with its constants and equations; a file in this folder is found by itself."""

from __future__ import annotations

import importlib
import pkgutil

from stribeck.plants.base import Plant
from stribeck.plants.mass import Mass

__all__ = ["KINDS", "Mass", "Plant"]


def kinds() -> dict[str, type[Plant]]:
    """Every plant of the package by its kind, the single body first."""
    files = {m.name for m in pkgutil.iter_modules(__path__)} - {"base", "mass"}
    found: dict[str, type[Plant]] = {Mass.kind: Mass}
    for name in sorted(files):
        module = importlib.import_module(f"{__name__}.{name}")
        own = (x for x in vars(module).values() if isinstance(x, type) and x.__module__ == module.__name__)
        found |= {plant.kind: plant for plant in own if issubclass(plant, Plant)}
    return found


KINDS = kinds()
