"""What an axis shows: a quantity with its unit and meaning, in a prefix that keeps its numbers short."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.simulation import Solution

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))
_NOT_ABOVE_ONE = ("m", "s", "rad", "V")  # nobody reads kilometres, kiloseconds or kiloradians off a plot
_PREFIXED = (*_NOT_ABOVE_ONE, "N", "Pa", "J", "W", "A", "Hz")
_LEAST = 0.5  # what the largest number of an axis is at least, in its unit
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
    """How an axis shows a quantity: ``(value - base) / factor``, under a label."""

    factor: float
    base: float
    label: str

    def of(self, values: Array) -> Array:
        """The values as the axis has them."""
        return np.asarray((values - self.base) / self.factor)


def prefixed(unit: str, largest: float) -> tuple[float, str]:
    """The factor and the unit in which numbers up to ``largest`` are short: mm for what is below half a metre."""
    base = unit.partition("/")[0].partition(" ")[0].partition("^")[0]
    if base not in _PREFIXED or not 0 < largest < math.inf:
        return 1.0, unit
    top = 1.0 if base in _NOT_ABOVE_ONE else _PREFIXES[0][0]
    fitting = [(factor, name) for factor, name in _PREFIXES if factor <= top]
    factor, name = next(((f, n) for f, n in fitting if largest >= _LEAST * f), fitting[-1])
    return factor, name + unit


def human(x: float, unit: str) -> str:
    """A number of three digits in a unit that keeps it short: ``0.0642`` m is ``64.2 mm``."""
    factor, name = prefixed(unit, abs(x))
    return f"{x / factor:.3g} {name}".rstrip()


def scale(shown: Iterable[Quantity], plain: bool = False) -> Scale:
    """The scale on which these quantities of one unit stand; the first gives the label. ``plain``: in SI, for powers."""
    shown = list(shown)
    values = [q.values[np.isfinite(q.values)] for q in shown]
    low = min((float(x.min()) for x in values if len(x)), default=0.0)
    high = max((float(x.max()) for x in values if len(x)), default=0.0)
    largest, span = max(abs(low), abs(high)), high - low
    first, base = shown[0], 0.0
    if plain:
        return Scale(1.0, 0.0, f"{first.name} ({first.unit})")
    if 0 < span < _CHANGE * largest:
        digit = 10.0 ** (math.floor(math.log10(span)) + 1)
        base = round(low / digit) * digit
        largest = max(abs(low - base), abs(high - base))
    factor, unit = prefixed(first.unit, largest)
    of = f"{first.name} \N{MINUS SIGN} {base:.10g} {first.unit}".rstrip() if base else first.name
    return Scale(factor, base, f"{of} ({unit})" if unit not in ("", "1") else of)


def quantities(solution: Solution) -> dict[str, Quantity]:
    """The columns of a solution by name, and what its plots derive from them: y_d of a servo, e of a PID loop."""
    found = {"t": Quantity("t", "s", "time", solution.t)}
    found |= {c.name: Quantity(c.name, c.unit, c.meaning, solution[c.name]) for c in solution.columns}
    if "r" in found and "I" in found:
        found["e"] = Quantity("e", found["y"].unit, "control error y - r", solution["y"] - solution["r"])
    elif "e" in found:
        found["y_d"] = Quantity("y_d", found["y"].unit, "desired position", solution["y"] - solution["e"])
    return found


def deviation_rows(
    reference: Mapping[str, Quantity], other: Mapping[str, Quantity], names: Iterable[str] = ("y", "v", "F")
) -> dict[str, Quantity]:
    """How far the columns are from the reference's, over the rows that both reached; t too."""
    rows = min(len(reference["t"].values), len(other["t"].values))
    found = {"t": Quantity("t", "s", "time", reference["t"].values[:rows])}
    for name in names:
        a, b = reference[name], other[name]
        found[f"Δ{name}"] = Quantity(f"Δ{name}", a.unit, f"deviation of {name}", b.values[:rows] - a.values[:rows])
    return found
