"""An estimate with two uncertainties and one of five states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

import numpy as np

Kept = Mapping[str, Any]  # JSON, validated as written by a fit
NARROW = 2.0  # largest ratio of high to low, or of a level to high - low: a factor of two still serves a design


class EstimateState(StrEnum):
    """The state of an estimate, which decides its use."""

    IDENTIFIED = "identified"
    MODEL_DEPENDENT = "model-dependent"
    NOT_IDENTIFIABLE = "not identifiable"
    AT_LEAST = "at least"
    AT_MOST = "at most"


@dataclass(frozen=True)
class Estimate:
    """An estimate with both uncertainties at 95 %. ``range`` is wider than ``interval`` by possible model errors.

    Attributes:
        value: the estimate.
        interval: the confidence interval for another stretch of this experiment (with several files, another run).
        range: the interval of the true value if the model may lack a form; None if it is not computed.
        state: "identified", "model-dependent", "not identifiable", "at least" or "at most".
        unit: unit of the value, SI.
        depends_on: for a model-dependent estimate, the form that widens the range.
        parts: half widths by cause: C covariance, A choice of forms, M filter or search, B forms excluded at random, H forms
            that this motion does not excite.
        files_differ: whether it is not identifiable because the files differ.
        why, experiment: if it is not identifiable, the missing information and the motion that provides it.
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
    files_differ: bool = False

    @property
    def identifiable(self) -> bool:
        """Whether the data determine the estimate, if the model is right. Its interval is then narrow, or it is a bound."""
        return self.state is not EstimateState.NOT_IDENTIFIABLE

    @property
    def usable(self) -> bool:
        """Whether exports and simulations use the estimate by default."""
        return self.identifiable and self.state is not EstimateState.AT_MOST

    @property
    def low(self) -> float | None:
        """The lower end of the 95 % interval; None if it is open."""
        return self.interval[0] if np.isfinite(self.interval[0]) else None

    @property
    def high(self) -> float | None:
        """The upper end of the 95 % interval; None if it is open."""
        return self.interval[1] if np.isfinite(self.interval[1]) else None

    def within(self, low: float, high: float) -> Estimate:
        """The estimate of a number that lies between two bounds: not identifiable if its interval lies beyond one."""
        value, wide = min(max(self.value, low), high), self.range or self.interval
        ends = [(max(a, low), min(b, high)) for a, b in (self.interval, wide)]
        if all(a <= b for a, b in ends):
            return replace(self, value=value, interval=ends[0], range=ends[1])
        why = "the estimate lies beyond the bounds of the law, so that another effect must have caused it"
        state = EstimateState.NOT_IDENTIFIABLE
        return replace(self, value=value, interval=(low, high), range=(low, high), state=state, why=why)

    def mirrored(self) -> Estimate:
        """The estimate of the number with the opposite sign."""
        (low, high), (least, most) = self.interval, self.range or self.interval
        return replace(self, value=-self.value, interval=(-high, -low), range=self.range and (-most, -least))

    def less(self, other: Estimate, times: float) -> Estimate:
        """This less a multiple of another estimate. Their errors add up."""
        both = (self.interval, other.interval), (self.range or self.interval, other.range or other.interval)
        interval, wide = ((low - times * b, high - times * a) for (low, high), (a, b) in both)
        return replace(self, value=self.value - times * other.value, interval=interval, range=wide)

    def to_dict(self) -> dict[str, object]:
        """Plain data of the file format: the ends of the interval, the range and the state; reasons if there are any."""
        reasons = {key: x for key in ("depends_on", "why", "experiment") if (x := getattr(self, key))}
        wide = self.range and [x if np.isfinite(x) else None for x in self.range]
        return {
            "value": self.value, "low": self.low, "high": self.high, "range": wide, "unit": self.unit,
            "state": str(self.state), **reasons,
        }  # fmt: skip

    def advice(self, name: str) -> str:
        """The experiment that would determine this parameter, as a sentence; empty if there is none."""
        open_ = self.state in (EstimateState.NOT_IDENTIFIABLE, EstimateState.AT_LEAST)
        return f"To determine {name}, measure {self.experiment}." if open_ and self.experiment else ""

    @classmethod
    def of_dict(cls, data: Kept) -> Estimate:
        """The estimate from the data of :meth:`to_dict`."""
        unit, form, why, experiment = (str(data.get(key, "")) for key in ("unit", "depends_on", "why", "experiment"))
        value, wide = np.nan if data["value"] is None else data["value"], data["range"]
        interval = _ends((data["low"], data["high"]))
        return cls(
            value,
            interval,
            wide and _ends(wide),
            EstimateState(data["state"]),
            unit,
            form,
            why=why,
            experiment=experiment,
        )


def known(value: float) -> Estimate:
    """A number that is known."""
    return Estimate(value, (value, value), (value, value), EstimateState.IDENTIFIED)


def _ends(pair: Sequence[float | None]) -> tuple[float, float]:
    """The ends of an interval, infinite for an open end."""
    low, high = pair
    return -np.inf if low is None else low, np.inf if high is None else high


def ends(value: float, half: float, by_ratio: bool) -> tuple[float, float]:
    """The ends of an interval of half width ``half``; ``by_ratio``: symmetric in the logarithm, as for a shape."""
    if not by_ratio:
        return float(value - half), float(value + half)
    ratio = float(np.exp(min(half / value, 50.0)))
    return value / ratio, value * ratio


def state_of(
    interval: tuple[float, float], wide: tuple[float, float], level: float | None = None, either: bool = False
) -> EstimateState:
    """The state from both intervals: identified if both are narrow, model-dependent if only ``interval`` is.

    Narrow is within a factor of two. For a parameter that may be 0, it is a width below half the friction ``level``; with
    ``either``, one of both suffices.
    """

    def narrow(low: float, high: float) -> bool:
        by_ratio = (low > 0 and high < NARROW * low) or (high < 0 and low > NARROW * high)
        beside = level is not None and high - low < abs(level) / NARROW
        return beside or (by_ratio and (level is None or either))

    state = EstimateState.NOT_IDENTIFIABLE
    if narrow(*interval):
        state = EstimateState.IDENTIFIED if narrow(*wide) else EstimateState.MODEL_DEPENDENT
    return state


def one_sided(F_s: Estimate, v_s: Estimate, levels: Sequence[Estimate]) -> tuple[Estimate, Estimate]:
    """F_s and v_s as bounds: F_s is at least the larger of some friction levels without what is viscous, v_s at most what its
    interval allows.
    """
    value, wide = max(e.value for e in levels), [e.range or e.interval for e in levels]
    interval = max(e.interval[0] for e in levels), np.inf
    at_least = replace(
        F_s, value=value, interval=interval, range=(max(x[0] for x in wide), np.inf), state=EstimateState.AT_LEAST
    )
    low, high = ((0.0, x[1]) for x in (v_s.interval, v_s.range or v_s.interval))
    return at_least, replace(v_s, interval=low, range=high, state=EstimateState.AT_MOST)
