"""Signals: references and inputs as functions of time; ``KINDS`` lists them."""

from __future__ import annotations

from stribeck.signals import piecewise, sums, trajectories
from stribeck.signals.piecewise import (
    FileSignal,
    PointsSignal,
    RampSignal,
    Segment,
    Segments,
    Signal,
    SineSignal,
    SquareSignal,
    StaircaseSignal,
    StepSignal,
)
from stribeck.signals.sums import SumSignal
from stribeck.signals.trajectories import Curve, PointToPointSignal, SplineSignal

__all__ = [
    "KINDS", "Curve", "FileSignal", "PointToPointSignal", "PointsSignal", "RampSignal", "Segment", "Segments", "Signal",
    "SineSignal", "SplineSignal", "SquareSignal", "StaircaseSignal", "StepSignal", "SumSignal",
]  # fmt: skip

KINDS: dict[str, type[Signal]] = {**piecewise.KINDS, **trajectories.KINDS, **sums.KINDS}
