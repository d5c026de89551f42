"""What is known of a number: an estimate with two uncertainties, and one of five states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

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
class JudgedEstimate:
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


def ends(value: float, half: float, by_ratio: bool) -> tuple[float, float]:
    """The ends of an interval; of a shape by its logarithm."""
    if not by_ratio:
        return value - half, value + half
    ratio = float(np.exp(min(half / value, 50.0)))
    return value / ratio, value * ratio


def state_of(interval: tuple[float, float], wide: tuple[float, float], level: float | None) -> EstimateState:
    """Narrow: within a factor of two; of what may be 0, within half of the friction's ``level``."""

    def narrow(low: float, high: float) -> bool:
        return high - low < OFFSET * abs(level) if level is not None else low > 0 and high < NARROW * low

    return (
        EstimateState.IDENTIFIED
        if narrow(*wide)
        else EstimateState.MODEL_DEPENDENT
        if narrow(*interval)
        else EstimateState.NOT_IDENTIFIABLE
    )
