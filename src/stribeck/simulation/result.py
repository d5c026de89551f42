"""What a solver returns, whichever it was."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.scenario import Scenario


@dataclass(frozen=True)
class Result:
    """The states at the output rows that were reached, the events met, why it ended early if so, and statistics."""

    states: NDArray[np.float64]
    events: list[tuple[float, bool]]  # time; True where |v| rises through the threshold
    reason: str | None
    stats: dict[str, Any]


def piecewise(scenario: Scenario) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Start, value and slope of the signal's pieces from t = 0 on; a single dummy piece for a smooth signal."""
    if scenario.signal.smooth:
        return np.zeros(1), np.zeros(1), np.zeros(1)
    s = scenario.signal.segments
    first = max(int(np.searchsorted(s.start, 0.0, side="right")) - 1, 0)
    return s.start[first:].copy(), s.value[first:].copy(), s.slope[first:].copy()
