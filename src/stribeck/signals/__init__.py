"""Signals: what a drive follows, as a function of time; ``KINDS`` lists them."""

from __future__ import annotations

from stribeck.signals import piecewise, trajectories
from stribeck.signals.piecewise import (
    FileSignal,
    PointsSignal,
    RampSignal,
    Segment,
    Segments,
    Signal,
    SineSignal,
    StepSignal,
)
from stribeck.signals.trajectories import Curve, PointToPointSignal, SplineSignal

__all__ = [
    "KINDS", "Curve", "FileSignal", "PointToPointSignal", "PointsSignal", "RampSignal", "Segment", "Segments", "Signal",
    "SineSignal", "SplineSignal", "StepSignal",
]  # fmt: skip

KINDS: dict[str, type[Signal]] = {**piecewise.KINDS, **trajectories.KINDS}
