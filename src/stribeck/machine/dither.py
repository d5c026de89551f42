"""Dither: a fast oscillation on a controller's output, under which friction on the average acts as if it were viscous."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant
from stribeck.expressions.graph import Expr, symbol, wrap
from stribeck.expressions.ops import Value, sin, where

DITHER = {
    "amplitude": Constant("N", "amplitude of the dither", at_least=0, rotary_unit="N m"),
    "frequency": Constant("Hz", "frequency of the dither", above=0),
}
KINDS = ("sine", "square")
PHASE = "phase"  # the share of a wave that has passed: what a sampled controller keeps of it
WAVES_A_STEP = 0.125  # at most, of a step of the solver: none is missed


@dataclass(frozen=True)
class DitherPart:
    """What a controller adds to its output, before its limit: a sine, or a square wave from one sample to another."""

    constants: ClassVar[dict[str, Constant]] = DITHER

    kind: str
    path: str

    @property
    def p(self) -> SimpleNamespace:
        """Its constants as symbols."""
        return SimpleNamespace(**{n: symbol(f"{self.path}.{n}") for n in self.constants})

    def force(self, phase: Value) -> Expr:
        """What is added after ``phase`` of a wave; it begins at 0 and upwards."""
        wave = sin(2 * pi * phase) if self.kind == "sine" else where(phase < 0.5, 1.0, -1.0)
        return wrap(self.p.amplitude * wave)

    def at(self, t: Expr) -> Expr:
        """What is added at the time t by a controller that is continuous."""
        return self.force(self.p.frequency * t)

    def next_phase(self, phase: Value, period: Value) -> Expr:
        """The phase at the next sample."""
        on = phase + self.p.frequency * period
        return wrap(where(on >= 1, on - 1, on))
