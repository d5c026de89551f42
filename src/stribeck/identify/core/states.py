"""What is known of a number: an estimate with two uncertainties, and one of five states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

import numpy as np

Kept = Mapping[str, Any]  # JSON, once it was found to be as a fit writes it
NARROW = 2.0  # high below twice low: the factor of two that an engineer still designs with
OFFSET = 0.5  # of the friction level: an offset is narrow against that, as it may be 0


class EstimateState(StrEnum):
    """What an estimate may be used for."""

    IDENTIFIED = "identified"
    MODEL_DEPENDENT = "model-dependent"
    NOT_IDENTIFIABLE = "not identifiable"
    AT_LEAST = "at least"
    AT_MOST = "at most"


@dataclass(frozen=True)
class Estimate:
    """A number with both uncertainties at 95 %; ``range`` is wider than ``interval`` by what the model may lack.

    Attributes:
        interval: how far the estimate moves in another stretch of this experiment (another run, of several files).
        range: how far it may be from the truth if the model lacks something; None where that is not computed.
        state: what it may be used for.
        unit: SI.
        depends_on: the form that makes the range wide, of a model-dependent estimate.
        parts: half widths: C covariance, A choice, B forms withheld, H forms hidden.
        why, experiment: what is missing, and which motion gives it; of one that is not identifiable.
    """

    value: float
    interval: tuple[float, float]
    range: tuple[float, float] | None
    state: EstimateState
    unit: str = ""
    depends_on: str = ""
    parts: Mapping[str, float] = field(default_factory=dict)
    why: str = ""
    experiment: str = ""

    @property
    def identifiable(self) -> bool:
        """Whether the data determine it, if the model is right: its interval is narrow, or it is a bound."""
        return self.state is not EstimateState.NOT_IDENTIFIABLE

    @property
    def usable(self) -> bool:
        """Whether exports and simulations take it without being told to."""
        return self.identifiable and self.state is not EstimateState.AT_MOST

    @property
    def low(self) -> float | None:
        """The lower end of the 95 % interval; None if it is open."""
        return self.interval[0] if np.isfinite(self.interval[0]) else None

    @property
    def high(self) -> float | None:
        """The upper end of the 95 % interval; None if it is open."""
        return self.interval[1] if np.isfinite(self.interval[1]) else None

    def to_dict(self) -> dict[str, object]:
        """As the contract has it, with both uncertainties and the state."""
        told = {key: getattr(self, key) for key in ("why", "experiment") if getattr(self, key)}
        return {
            "value": self.value, "low": self.low, "high": self.high, "unit": self.unit, "identifiable": self.identifiable,
            "estimate": self.value, "interval": _open(self.interval), "range": self.range and _open(self.range),
            "state": str(self.state), "depends_on": self.depends_on, **told,
        }  # fmt: skip

    @classmethod
    def of_dict(cls, told: Kept) -> Estimate:
        """The estimate that :meth:`to_dict` told.

        Raises:
            KeyError, TypeError, ValueError: it is something else.
        """
        interval, wide = _ends(told["interval"]), told["range"]
        unit, form, why, experiment = (str(told.get(key, "")) for key in ("unit", "depends_on", "why", "experiment"))
        value = np.nan if told["estimate"] is None else float(told["estimate"])
        state = EstimateState(told["state"])
        return cls(value, interval, wide and _ends(wide), state, unit, form, why=why, experiment=experiment)


def _ends(pair: Sequence[float | None]) -> tuple[float, float]:
    """The ends, infinite where one is open."""
    low, high = pair
    return -np.inf if low is None else float(low), np.inf if high is None else float(high)


def _open(pair: tuple[float, float]) -> list[float | None]:
    """The ends, None where one is open."""
    return [x if np.isfinite(x) else None for x in pair]


def ends(value: float, half: float, by_ratio: bool) -> tuple[float, float]:
    """The ends of an interval; of a shape by its logarithm."""
    if not by_ratio:
        return float(value - half), float(value + half)
    ratio = float(np.exp(min(half / value, 50.0)))
    return value / ratio, value * ratio


def state_of(
    interval: tuple[float, float], wide: tuple[float, float], level: float | None = None, either: bool = False
) -> EstimateState:
    """Narrow: within a factor of two; of what may be 0, within half of the friction's ``level``, or ``either``."""

    def narrow(low: float, high: float) -> bool:
        by_ratio = (low > 0 and high < NARROW * low) or (high < 0 and low > NARROW * high)
        beside = level is not None and high - low < OFFSET * abs(level)
        return beside or (by_ratio and (level is None or either))

    found = EstimateState.NOT_IDENTIFIABLE
    if narrow(*interval):
        found = EstimateState.IDENTIFIED if narrow(*wide) else EstimateState.MODEL_DEPENDENT
    return found
