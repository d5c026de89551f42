"""Measured data and intervals of a fit that a page shows with its scenario."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stribeck.arrays import Array
from stribeck.scenario import Scenario


@dataclass(frozen=True)
class Beside:
    """Measured columns.

    Attributes:
        about: their source, in words.
        columns: times (s) and values of each column.
        given: columns that drive the simulation, and are therefore not compared.
    """

    about: str
    columns: dict[str, tuple[Array, Array]]
    given: tuple[str, ...] = ()

    def as_data(self) -> dict[str, object]:
        """The data for the page; evenly spaced times are given by their step."""
        lists = {
            name: {"t": _even_step(t) or short(t), "x": short(x, float(abs(x).max(initial=0)))}
            for name, (t, x) in self.columns.items()
        }
        return {"about": self.about, "columns": lists, "given": self.given}


@dataclass(frozen=True)
class Report:
    """The scenario of a result's folder; of a fit also the interval of each number by its path, and measured columns."""

    scenario: Scenario
    intervals: dict[str, tuple[float, float]] = field(default_factory=dict)
    measured: Beside | None = None


def short(x: Array, size: float = 0.0) -> list[float]:
    """Numbers rounded to nine significant figures of the largest, ``size``; to nine decimals without it."""
    digits = 9 if size == 0 else 9 - int(np.floor(np.log10(size))) - 1
    return [round(float(value), digits) for value in x]


def _even_step(t: Array) -> float | None:
    step = float(t[-1]) / max(len(t) - 1, 1)
    return step if step > 0 and np.allclose(t, step * np.arange(len(t)), rtol=0, atol=1e-6 * step) else None
