"""What a friction law acts on: each plant with its constants and equations; a file in this folder is found by itself."""

from __future__ import annotations

from stribeck import kinds as find
from stribeck.plants.base import Plant
from stribeck.plants.mass import Mass

__all__ = ["KINDS", "Mass", "Plant"]


def kinds() -> dict[str, type[Plant]]:
    """Every plant of the package by its kind, the single body first."""
    modules = find.modules(__name__, __path__, ("mass",), ("base",))
    return {plant.kind: plant for module in modules for plant in find.classes(module, Plant)}


KINDS = kinds()
