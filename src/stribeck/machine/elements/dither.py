"""Dither: a fast oscillation on a controller's output, under which friction on the average acts as if it were viscous."""

from __future__ import annotations

from math import pi
from typing import Literal

from pydantic import Field

from stribeck.expressions.graph import Expr, wrap
from stribeck.expressions.ops import Value, sin, where
from stribeck.machine.table import FileTable, quantity

PHASE = "phase"  # the share of a wave that has passed: what a sampled controller keeps of it
WAVES_A_STEP = 0.125  # at most, of a step of the solver: none is missed
_EDGE = 1e-9  # of a wave: a sample so little before an edge is at it; 1e6 samples' rounding adds up to 1e-10


class Dither(FileTable):
    """An oscillation added to a controller's output before its limit: a sine, or a sampled square wave."""

    kind: Literal["sine", "square"] = Field("sine", description="sine, or square if it is sampled; sine unless given")
    amplitude: float = quantity("N", "amplitude of the dither", at_least=0, rotary_unit="N m")
    frequency: float = quantity("Hz", "frequency of the dither", above=0)

    def force(self, phase: Value) -> Expr:
        """The value after ``phase`` of a wave, which begins at 0 and rises."""
        wave = sin(2 * pi * phase) if self.kind == "sine" else where(phase < 0.5 - _EDGE, 1.0, -1.0)
        return wrap(self.amplitude * wave)

    def next_phase(self, phase: Value, period: Value) -> Expr:
        """The phase at the next sample."""
        on = phase + self.frequency * period
        return wrap(where(on >= 1 - _EDGE, on - 1, on))
