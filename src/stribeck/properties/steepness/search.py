"""The smallest k_v at which a measure that falls with k_v meets its tolerance."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from stribeck import laws
from stribeck.constants import rotary_unit
from stribeck.laws.base import PARAMETERS, Law

FORMULA, STEADY = "formula", "root of the law's steady state"
_SLOPES = (1e-6, 1e12)  # k_v as multiples of 1/v_s: where it is looked for


@dataclass(frozen=True)
class Requirement:
    """The k_v that one tolerance needs.

    Attributes:
        name: what is tolerated, in words.
        tolerance: how much.
        unit: of the tolerance; empty for shares.
        k_v: the smallest that meets it, s/m; 0 where any does, None where none does.
        achieved: the measure at that k_v, computed from the law itself.
        method: formula, or root of the steady state.
        detail: the formula, or the equation.
        points: (k_v, measure) around it, for a plot.
    """

    name: str
    tolerance: float
    unit: str
    k_v: float | None
    achieved: float | None
    method: str
    detail: str
    points: tuple[tuple[float, float], ...] = field(default=(), repr=False)


class Tolerance(ABC):
    """A measure of a law, and how much of it is tolerated."""

    tolerance: float

    @abstractmethod
    def measure(self, law: Law) -> float:
        """The error of a law with its k_v."""

    @abstractmethod
    def need(self, law: Law) -> Requirement:
        """The smallest k_v that keeps the measure within the tolerance."""

    def curve(self, law: Law, k_v: float | None) -> tuple[tuple[float, float], ...]:
        """The measure at steepnesses around one."""
        around: Sequence[float] = [k_v * 10 ** (i / 6) for i in range(-12, 13)] if k_v else []
        return tuple((k, self.measure(law.replace(k_v=k))) for k in around)


def family(law: Law) -> str:
    """The law that this one makes smooth: lugre or elastoplastic."""
    return "elastoplastic" if "z_ba" in law.constants() else "lugre"


def counterpart(law: Law, name: str) -> Law:
    """Another law with the constants that both have."""
    cls = laws.find(name)
    known = {**PARAMETERS, **cls.constants()}
    return cls({n: x for n, x in {**law.machine, **law.p.numbers}.items() if n in known}, law.rotary)


def unit(law: Law, linear: str) -> str:
    """A unit as the law's machine has it: rad for m where it turns."""
    return rotary_unit(linear) if law.rotary else linear


def smallest(
    measure: Callable[[float], float], tolerance: float, start: float, accuracy: float
) -> tuple[float | None, list[tuple[float, float]]]:
    """The smallest k_v with measure(k_v) <= tolerance, for a measure that falls; and all that was computed.

    0 where the measure is met however small k_v is (down to 1e-6 start), None where it is met nowhere.

    Args:
        measure: of k_v; should be cheap, or accuracy modest.
        tolerance: what the measure is to reach.
        start: where to begin, s/m.
        accuracy: relative, of k_v.
    """
    points: list[tuple[float, float]] = []

    def error(k_v: float) -> float:
        points.append((k_v, measure(k_v)))
        return points[-1][1]

    low = high = start
    if error(start) <= tolerance:
        while low > start * _SLOPES[0] and error(low / 10) <= tolerance:
            low /= 10
        low, high = low / 10, low
        if points[-1][1] <= tolerance:
            return 0.0, sorted(points)
    else:
        while error(high * 10) > tolerance:
            high *= 10
            if high > start * _SLOPES[1]:
                return None, sorted(points)
        low, high = high, high * 10
    known = dict(points)
    aim, count = accuracy / 3, 0
    while high / low > 1 + accuracy:
        count += 1
        middle = _between(low, high, known, tolerance, aim if count % 3 else None)
        known[middle] = error(middle)
        met = known[middle] <= tolerance
        low, high = (low, middle) if met else (middle, high)
        aim = -accuracy / 3 if met else accuracy / 3  # the other end closes in
    return high, sorted(points)


def _between(low: float, high: float, known: dict[float, float], tolerance: float, aim: float | None) -> float:
    """Where the measure, as a power of k_v, would meet the tolerance, shifted by ``aim``; the middle where that is None."""
    above, below = known[low], known[high]
    if aim is None or not 0 < below < tolerance < above < math.inf:
        return math.sqrt(low * high)
    width = math.log(high / low)
    place = width * math.log(above / tolerance) / math.log(above / below) + aim
    return low * math.exp(min(max(place, abs(aim)), width - abs(aim)))
