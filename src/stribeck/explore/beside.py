"""What a page shows beside its scenario: what was measured, and the intervals of a fit."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stribeck.arrays import Array
from stribeck.scenario import Scenario


@dataclass(frozen=True)
class Beside:
    """What was measured: where it is from, and each column against its times."""

    about: str
    columns: dict[str, tuple[Array, Array]]
    given: tuple[str, ...] = ()  # those that drive the simulation, so that nothing is to be compared

    def as_data(self) -> dict[str, object]:
        """For the page: times that are even by their step alone."""
        lists = {
            name: {"t": _even(t) or short(t), "x": short(x, float(abs(x).max(initial=0)))}
            for name, (t, x) in self.columns.items()
        }
        return {"about": self.about, "columns": lists, "given": self.given}


@dataclass(frozen=True)
class Report:
    """What a folder holds: the scenario; of a fit, the interval of each number by its path, and what was measured."""

    scenario: Scenario
    intervals: dict[str, tuple[float, float]] = field(default_factory=dict)
    measured: Beside | None = None


def short(x: Array, size: float = 0.0) -> list[float]:
    """Numbers in as few letters as keep nine figures of the largest, ``size``; nine places unless it is given."""
    digits = 9 if size == 0 else 9 - int(np.floor(np.log10(size))) - 1
    return [round(float(value), digits) for value in x]


def _even(t: Array) -> float | None:
    step = float(t[-1]) / max(len(t) - 1, 1)
    return step if step > 0 and np.allclose(t, step * np.arange(len(t)), rtol=0, atol=1e-6 * step) else None
