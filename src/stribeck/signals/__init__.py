"""Signals: what a drive follows, as a function of time; ``KINDS`` lists them."""

from __future__ import annotations

from stribeck.signals import piecewise, trajectories
from stribeck.signals.piecewise import File, Points, Ramp, Segment, Segments, Signal, Sine, Step
from stribeck.signals.trajectories import Curve, PointToPoint, Spline

__all__ = [
    "KINDS", "Curve", "File", "PointToPoint", "Points", "Ramp", "Segment", "Segments", "Signal", "Sine", "Spline", "Step",
]  # fmt: skip

KINDS: dict[str, type[Signal]] = {**piecewise.KINDS, **trajectories.KINDS}
