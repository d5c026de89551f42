"""Rows of a record that lie beyond the speeds, positions, loads and pressures that a fit has seen: there its
form extrapolates."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.constants import rotary_unit
from stribeck.identify.log import INTEGRAL, Log
from stribeck.identify.models.terms import TERMS, WEIGHT

_MARGIN = 0.01  # of the range seen: noise
_GROWS = ("stiffness", "spring", "level by position")  # terms and forms that grow with the position, without end
_TURNS = (*WEIGHT, "weight")  # of an angle: all is seen on a turn
_UNITS = {"velocity": "m/s", "position": "m", "load": "N", "pressure": "Pa"}


@dataclass(frozen=True)
class Beyond:
    """Rows in motion beyond what a fit has seen.

    Attributes:
        rows: how many; ``of``: of how many.
        error: norm(residual)/norm(force) over these; ``within``: over the others; None where there are none.
        what: of each quantity that goes beyond: how many rows, what the fit saw, and what this record has.
        rotary: whether the machine turns.
    """

    rows: int
    of: int
    error: float | None
    within: float | None
    what: dict[str, tuple[int, tuple[float, float], tuple[float, float]]]
    rotary: bool = False

    def to_dict(self) -> dict[str, object]:
        """As ``stribeck predict --json`` has it."""
        what = {
            name: {"rows": n, "seen": list(seen), "here": list(here)} for name, (n, seen, here) in self.what.items()
        }
        return {"rows": self.rows, "of": self.of, "error": self.error, "within": self.within, "what": what}

    def text(self) -> str:
        """In a line; nothing where no row lies beyond."""
        if not self.rows:
            return ""
        units = {name: rotary_unit(unit) if self.rotary else unit for name, unit in _UNITS.items()}
        parts = [
            f"{name} from {here[0]:.3g} to {here[1]:.3g} {units[name]}, fitted from {seen[0]:.3g} to {seen[1]:.3g}"
            for name, (_, seen, here) in self.what.items()
        ]
        share = f"{self.rows / self.of:.0%}" if self.rows >= 0.005 * self.of else "less than 1 %"
        return f"{self.rows} rows ({share}) lie beyond the fitted range: {'; '.join(parts)}"


def seen(log: Log, rows: NDArray[np.bool_]) -> dict[str, tuple[float, float]]:
    """The ranges of a record's rows."""
    columns = {n: getattr(log, n) for n in _UNITS if getattr(log, n) is not None}
    if log.sources.get("position") == INTEGRAL:
        columns.pop("position")
    return {n: (float(x[rows].min()), float(x[rows].max())) for n, x in columns.items()} if rows.any() else {}


def _hangs_on(terms: Collection[str], ranges: Mapping[str, Sequence[float]]) -> list[str]:
    """The quantities on which a model with these terms hangs, and of which not all is seen."""
    quantities = ["velocity", *(TERMS[n].needs for n in terms if n in TERMS and TERMS[n].needs)]
    turn = "position" in ranges and ranges["position"][1] - ranges["position"][0] >= 2 * np.pi
    if set(_GROWS) & set(terms) or (set(_TURNS) & set(terms) and not turn):
        quantities.append("position")
    return [n for n in dict.fromkeys(quantities) if n in ranges]


def beyond(
    ranges: Mapping[str, Sequence[float]], terms: Collection[str], log: Log, rows: NDArray[np.bool_], left: Array
) -> Beyond:  # fmt: skip
    """Which of the rows lie beyond the ranges that a fit has seen, of what its model hangs on.

    Args:
        ranges: by quantity; ``terms``: of the model, and its forms.
        log, rows: the record, and its rows in motion.
        left: what the model misses of the force, N.
    """
    out, what = np.zeros(len(log), bool), {}
    for name in _hangs_on(terms, ranges):
        x = getattr(log, name)
        if x is None:
            continue
        low, high = ranges[name]
        margin = _MARGIN * (high - low)
        there = rows & ((x < low - margin) | (x > high + margin))
        if there.any():
            out |= there
            what[name] = int(there.sum()), (low, high), (float(x[rows].min()), float(x[rows].max()))

    def error(which: NDArray[np.bool_]) -> float | None:
        size = float(np.linalg.norm(log.force[which])) if which.any() else 0.0
        return float(np.linalg.norm(left[which])) / size if size else None

    return Beyond(int(out.sum()), int(rows.sum()), error(out), error(rows & ~out), what, log.rotary)
