"""Regions of u = |v| and w = |z|, in these or in polar coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import nextafter

from stribeck.expressions.intervals import INF, Range

_FAR = Fraction(10) ** 300  # a float of more may be infinite after a few operations
End = Fraction | None  # None: no end
ExactRange = tuple[Fraction, End]


@dataclass(frozen=True)
class Axis:
    """A coordinate and its range."""

    name: str
    low: Fraction
    high: End


@dataclass(frozen=True)
class Region:
    """A part of the domain. ``axes`` are some of u and w, or (w, p) with u = p w, or (u, q) with w = q u.

    Attributes:
        closed: u = 0 and w = 0 belong to it, where a range begins with 0.
    """

    axes: tuple[Axis, ...]
    closed: bool = False

    def axis(self, name: str) -> Axis | None:
        """The axis of that name."""
        return next((a for a in self.axes if a.name == name), None)

    def split(self, name: str, cut_at: Fraction) -> tuple[Region, Region]:
        """Below and above ``cut_at``."""
        below = [Axis(name, a.low, cut_at) if a.name == name else a for a in self.axes]
        above = [Axis(name, cut_at, a.high) if a.name == name else a for a in self.axes]
        return self.with_axes(*below), self.with_axes(*above)

    def with_axes(self, *axes: Axis) -> Region:
        """The same in other coordinates."""
        return Region(axes, self.closed)

    def bounds(self) -> dict[str, Range]:
        """The ranges of u and w, as floats rounded outward."""
        ends: dict[str, ExactRange] = {axis.name: (axis.low, axis.high) for axis in self.axes}
        for share, missing, by in (("p", "u", "w"), ("q", "w", "u")):
            if share in ends:
                (low, high), (least, most) = ends.pop(share), ends[by]
                ends[missing] = low * least, None if high is None or most is None else high * most
        return {name: (down(low), INF if high is None else up(high)) for name, (low, high) in ends.items()}


def down(x: Fraction) -> float:
    """A float that is not above x."""
    f = float(x) if abs(x) < _FAR else (1e300 if x > 0 else -INF)
    return f if Fraction(f) <= x else nextafter(f, -INF)


def up(x: Fraction) -> float:
    """A float that is not below x."""
    f = float(x) if abs(x) < _FAR else (INF if x > 0 else -1e300)
    return f if f == INF or Fraction(f) >= x else nextafter(f, INF)
