"""Sums of signals: polynomials between breakpoints, and sines beside them."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from math import inf
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.expressions.ops import Value
from stribeck.waveforms.piecewise import Signal, SineSignal
from stribeck.waveforms.trajectories import COEFFICIENTS, Curve

_SINE = tuple(SineSignal.constants)
# Samples for each longest step that cannot miss a wave, to find changes of sign; 8 times as many for each piece
_SAMPLES = 4
_ROUNDING = 1e-12  # relative: well above the rounding of values


class SumSignal(Signal):
    """The sum of several signals."""

    kind, smooth = "sum", True
    sines: ClassVar[int] = 0

    def __init__(self, parts: Sequence[Signal]) -> None:
        self.parts = parts
        super().__init__(self.pieces[0][1])

    @staticmethod
    def flattened(parts: Sequence[Signal]) -> SumSignal:
        """The sum, with nested sums flattened, of the class for its number of sines."""
        flat = [p for part in parts for p in (part.parts if isinstance(part, SumSignal) else [part])]
        return sum_with(sum(isinstance(p, SineSignal) for p in flat))(flat)

    @classmethod
    def equation(cls, p: SimpleNamespace, t: Value) -> Value:
        """The current polynomial and the sines."""
        total = Curve.equation(p, t)
        for i in range(cls.sines):
            total = total + SineSignal.equation(SimpleNamespace(**{n: getattr(p, f"{n}_{i}") for n in _SINE}), t)
        return total

    @cached_property
    def _sines(self) -> list[Signal]:
        return [part for part in self.parts if isinstance(part, SineSignal)]

    @cached_property
    def _polynomials(self) -> list[list[tuple[float, Polynomial]]]:
        """For each part other than sines: start and polynomial of each piece, in the time since its start."""
        polynomials = []
        for part in self.parts:
            if isinstance(part, Curve):
                rows = [(start, Polynomial([v[n] for n in COEFFICIENTS])) for start, v in part.pieces]
            elif not part.smooth:
                s = part.segments
                rows = [(float(a), Polynomial([b, c])) for a, b, c in zip(s.start, s.value, s.slope, strict=True)]
            else:
                continue
            polynomials.append(rows)
        return polynomials

    @cached_property
    def pieces(self) -> list[tuple[float, dict[str, float]]]:
        """Start (s) and constants of each piece."""
        waves = {f"{n}_{i}": float(w.values[n]) for i, w in enumerate(self._sines) for n in _SINE}
        starts = sorted({0.0, *(start for rows in self._polynomials for start, _ in rows if start > 0)})
        pieces = []
        for start in starts:
            total = Polynomial([0.0])
            for rows in self._polynomials:
                begin, polynomial = next((r for r in reversed(rows) if r[0] <= start), rows[0])
                total = total + polynomial(Polynomial([start - begin, 1.0]))
            c = np.pad(total.coef, (0, len(COEFFICIENTS) - len(total.coef)))
            pieces.append((start, {"start": start, **dict(zip(COEFFICIENTS, c.tolist(), strict=True)), **waves}))
        return pieces

    @property
    def longest_step(self) -> float:
        return min((part.longest_step for part in self.parts), default=inf)

    def values_at(self, t: ArrayLike) -> dict[str, Value]:
        starts = np.array([start for start, _ in self.pieces])
        i = np.clip(np.searchsorted(starts, np.asarray(t, float), side="right") - 1, 0, None)
        return {n: np.array([v[n] for _, v in self.pieces])[i] for n in self.values}

    def at(self, t: ArrayLike) -> Array:
        return np.asarray(sum((part.at(t) for part in self.parts), np.zeros(np.shape(t))))

    @property
    def jumps(self) -> list[bool]:
        """Whether the value jumps at the start of each piece but the first."""
        ends = [(self._within(i, start), self._within(i + 1, start)) for i, (start, _) in enumerate(self.pieces[1:])]
        return [bool(abs(b - a) > _ROUNDING * max(abs(a), abs(b))) for a, b in ends]

    def _within(self, i: int, t: Value) -> Value:
        """The equation of piece i, also at its ends."""
        return self.equation(SimpleNamespace(**self.pieces[i][1]), t)

    def _rate(self, i: int, t: Value) -> Value:
        """The time derivative of piece i, also at its ends."""
        p = self.pieces[i][1]
        rate = Polynomial([p[n] for n in COEFFICIENTS]).deriv()(t - p["start"])
        for wave in self._sines:
            w = 2 * np.pi * wave.values["frequency"]
            rate = rate + wave.values["amplitude"] * w * np.cos(w * t + wave.values["phase"])
        return rate

    def turns(self, t_end: float) -> Array:
        """The times before ``t_end`` at which the rate passes through 0: starts of pieces, or bisected to rounding."""
        starts, turns, before = [start for start, _ in self.pieces if start <= t_end], list[float](), 0.0
        for i, (begin, end) in enumerate(zip(starts, [*starts[1:], t_end], strict=True)):
            count = int(np.ceil((end - begin) / self.longest_step * _SAMPLES)) + 8 * _SAMPLES
            t = np.linspace(begin, end, count + 1)
            side = np.sign(self._rate(i, t) + 0.0 * t)
            t, side = t[side != 0], side[side != 0]  # where it is 0 it may pass, or touch 0 only
            if not len(t):
                continue
            if before * side[0] < 0:
                turns.append(begin)
            for k in np.flatnonzero(side[1:] * side[:-1] < 0):
                low, high = float(t[k]), float(t[k + 1])
                while low < (middle := 0.5 * (low + high)) < high:
                    low, high = (middle, high) if self._rate(i, middle) * side[k] > 0 else (low, middle)
                turns.append(low)
            before = side[-1]
        return np.array(turns)


@lru_cache(maxsize=64)
def sum_with(sines: int) -> type[SumSignal]:
    """The class of sums with a number of sines, on which the equation depends."""
    waves = {f"{n}_{i}": c for i in range(sines) for n, c in SineSignal.constants.items()}
    return type("SumSignal", (SumSignal,), {"sines": sines, "constants": {**Curve.constants, **waves}})
