"""Signals with three continuous derivatives through given points, for controllers that need the jerk."""

from __future__ import annotations

from functools import cached_property
from types import SimpleNamespace
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.constants import Constant, show
from stribeck.errors import needed
from stribeck.expressions.ops import Value
from stribeck.waveforms.piecewise import PointsSignal, Signal

COEFFICIENTS = tuple(f"c{n}" for n in range(8))
_MOVE = (35.0, -84.0, 70.0, -20.0)  # of x^4 to x^7: from 0 to 1 with zero speed, acceleration and jerk at both ends


class Curve(Signal):
    """Polynomials of order seven between points, constant before the first point and after the last."""

    smooth = True
    constants: ClassVar[dict[str, Constant]] = {
        "start": Constant("s", "when the current polynomial begins"),
        **{name: Constant("", f"its coefficient of (t - start)^{n}") for n, name in enumerate(COEFFICIENTS)},
    }

    def __init__(self, t: Array, value: Array) -> None:
        inner = self.between(t, value)
        rest = np.zeros((2, 8))
        rest[:, 0] = value[[0, -1]]
        self._start = np.concatenate([[min(0.0, t[0]) - 1.0], t])
        self._rows = np.vstack([rest[:1], inner, rest[1:]])
        super().__init__({name: float(x) for name, x in self.values_at(0.0).items()})

    @staticmethod
    def between(t: Array, value: Array) -> Array:
        """The coefficients between neighboring points, lowest first, as rows of eight."""
        raise NotImplementedError

    @staticmethod
    def problems(t: Array, value: Array) -> list[tuple[str, str]]:
        """Key and message of each mistake in the points."""
        problems = PointsSignal.problems(t, value)
        if not problems and len(t) < 2:
            problems.append(("t", f"{show(t.tolist())}: must hold at least two times"))
        if not problems and (same := np.flatnonzero(np.diff(t) <= 0)).size:
            i = int(same[0]) + 1
            problems.append(
                (f"t[{i}]", f"{t[i]}: times must increase, a jump has no derivatives (the one before is {t[i - 1]})")
            )
        if not problems and (steep := np.flatnonzero(~np.isfinite(_highest_coefficients(t, value)))).size:
            i = int(steep[0]) + 1
            problems.append((f"value[{i}]", f"{value[i]}: too far from the one before for the time between them"))
        return problems

    @staticmethod
    def equation(p: SimpleNamespace, t: Value) -> Value:
        """The current polynomial."""
        x, total = t - p.start, 0.0 * t
        for name in reversed(COEFFICIENTS):
            total = total * x + getattr(p, name)
        return total

    def table(self) -> Array:
        """The pieces from t = 0 on as rows: when each begins, and its coefficients."""
        first = int(np.searchsorted(self._start, 0.0, side="right")) - 1
        return np.column_stack([self._start[first:], self._rows[first:]])

    @cached_property
    def pieces(self) -> list[tuple[float, dict[str, float]]]:
        return [(row[0], dict(zip(self.constants, row, strict=True))) for row in self.table().tolist()]

    def values_at(self, t: ArrayLike) -> dict[str, Value]:
        i = np.clip(np.searchsorted(self._start, np.asarray(t, float), side="right") - 1, 0, None)
        return {"start": self._start[i], **{name: self._rows[i, n] for n, name in enumerate(COEFFICIENTS)}}


def _highest_coefficients(t: Array, value: Array) -> Array:
    """The magnitude of the highest coefficient between points; not finite if it overflows."""
    with np.errstate(all="ignore"):
        return np.asarray(1e3 * np.diff(value) / np.diff(t) ** 7)


class PointToPointSignal(Curve):
    """Moves from point to point, each with zero speed, acceleration and jerk at both ends."""

    kind = "point_to_point"

    @staticmethod
    def between(t: Array, value: Array) -> Array:
        """value + d (35 x^4 - 84 x^5 + 70 x^6 - 20 x^7), x from 0 to 1."""
        rows = np.zeros((len(t) - 1, 8))
        rows[:, 0] = value[:-1]
        length = np.diff(t)
        with np.errstate(over="ignore"):  # of an infinite time
            power = length * length * length  # products: a power's last bit depends on the machine
            for n, factor in enumerate(_MOVE, start=4):
                power = power * length
                rows[:, n] = factor * np.diff(value) / power
        return rows


class SplineSignal(Curve):
    """A spline through points, at rest at the first and the last."""

    kind = "spline"

    @staticmethod
    def between(t: Array, value: Array) -> Array:
        """The spline with zero speed, acceleration and jerk at both ends."""
        with needed("a signal of kind 'spline'"):
            from scipy.interpolate import PPoly, make_interp_spline

        rest = [(order, 0.0) for order in (1, 2, 3)]
        spline = make_interp_spline(t, value, k=7, bc_type=(rest, rest))  # type: ignore[arg-type]
        rows = PPoly.from_spline(spline)  # type: ignore[arg-type]
        inside = np.flatnonzero(np.diff(rows.x) > 0)
        return np.asarray(rows.c[::-1, inside].T, float)
