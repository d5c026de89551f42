"""Signals: references and inputs as functions of time."""

from __future__ import annotations

from stribeck.waveforms.piecewise import (
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
from stribeck.waveforms.sums import SumSignal
from stribeck.waveforms.trajectories import Curve, PointToPointSignal, SplineSignal

__all__ = [
    "Curve", "FileSignal", "PointToPointSignal", "PointsSignal", "RampSignal", "Segment", "Segments", "Signal",
    "SineSignal", "SplineSignal", "SquareSignal", "StaircaseSignal", "StepSignal", "SumSignal",
]  # fmt: skip
