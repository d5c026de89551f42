"""Quantities on an axis, with unit, meaning and an SI prefix for short numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.mouth.cells import prefixed

_CHANGE = 1e-2  # of the value: what changes by less is shown as a change


@dataclass(frozen=True)
class Quantity:
    """Numbers with a symbol, an SI unit and words for them."""

    name: str
    unit: str
    meaning: str
    values: Array


@dataclass(frozen=True)
class Scale:
    """The scale of a quantity on an axis: ``(value - base) / factor``, under a label."""

    factor: float
    base: float
    label: str

    def of(self, values: Array) -> Array:
        """The values as the axis has them."""
        return np.asarray((values - self.base) / self.factor)


def scale(shown: Iterable[Quantity], plain: bool = False, name: str = "") -> Scale:
    """The scale on which these quantities of one unit stand.

    Args:
        plain: in SI, for powers of ten.
        name: of what all of them are, for the label; the first one's unless given.
    """
    shown = list(shown)
    values = [q.values[np.isfinite(q.values)] for q in shown]
    low = min((float(x.min()) for x in values if len(x)), default=0.0)
    high = max((float(x.max()) for x in values if len(x)), default=0.0)
    largest, span = max(abs(low), abs(high)), high - low
    first, base = shown[0], 0.0
    name = name or first.name
    if plain:
        return Scale(1.0, 0.0, f"{name} ({first.unit})")
    if 0 < span < _CHANGE * largest:
        digit = 10.0 ** (math.floor(math.log10(span)) + 1)
        base = round(low / digit) * digit
        largest = max(abs(low - base), abs(high - base))
    factor, unit = prefixed(first.unit, largest)
    of = f"{name} \N{MINUS SIGN} {base:.10g} {first.unit}".rstrip() if base else name
    return Scale(factor, base, f"{of} ({unit})" if unit not in ("", "1") else of)
