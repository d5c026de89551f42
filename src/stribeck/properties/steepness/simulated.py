"""Tolerances that only simulations answer: presliding, and the position in a scenario."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field
from math import pi
from typing import ClassVar

import numpy as np

from stribeck.errors import InputError, StribeckError, arg
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law
from stribeck.properties.replay import law_table
from stribeck.properties.steepness.search import (
    SIMULATION,
    Requirement,
    Tolerance,
    counterpart,
    family,
    smallest,
    unit,
)
from stribeck.scenario import Scenario
from stribeck.simulation import Solution, simulate

_ACCURACY = 1e-3  # relative, of a k_v found by simulations: each takes a run, and nobody gives a tolerance more exactly
_ROWS = 1000  # of a run: the displacement peaks while the force is held, where a fifth of them lie
_STEPS = 20_000_000  # attempted; a law without resistance would slide for ever


def _law(law: Law) -> dict[str, object]:
    table = law_table(law)
    assert table is not None, "laws of the package have a name"
    return table


def _solve(scenario: Scenario) -> Solution:
    solution = simulate(scenario)
    if solution.reason:
        raise StribeckError(f"{scenario.name} under {scenario.law.name} failed: {solution.reason}")
    return solution


@dataclass(frozen=True, kw_only=True)
class _Simulated(Tolerance):
    """The position's error in a scenario against the exact law."""

    tolerance: float
    _references: dict[str, Value] = field(default_factory=dict, init=False, repr=False, compare=False)

    @abstractmethod
    def scenario(self, law: Law) -> Scenario:
        """The scenario of the simulation."""

    @abstractmethod
    def words(self, law: Law) -> tuple[str, str]:
        """The name of the measure, and what is simulated."""

    relative: ClassVar[bool] = False  # to the position's peak

    def measure(self, law: Law) -> float:
        """The largest difference of the position, over its peak where the measure is relative."""
        name = family(law)
        if name not in self._references:
            self._references[name] = _solve(self.scenario(counterpart(law, name)))["y"]
            self._judge(law, self._references[name])
        y = self._references[name]
        error = float(np.max(np.abs(_solve(self.scenario(law))["y"] - y)))
        return error / float(np.max(np.abs(y))) if self.relative else error

    def _judge(self, law: Law, y: Value) -> None:
        """Refuse a scenario that does not show what is asked for, by the exact law's position in it."""

    def need(self, law: Law) -> Requirement:
        """By bisection between powers of ten."""
        name, detail = self.words(law)
        start = 1e3 / law.scales(law.p).speed
        k_v, points = smallest(lambda k: self.measure(law.replace(k_v=k)), self.tolerance, start, _ACCURACY)
        achieved = dict(points).get(k_v) if k_v else None
        detail = f"{detail}; {len(points)} simulations"
        return Requirement(
            name,
            self.tolerance,
            "" if self.relative else unit(law, "m"),
            k_v,
            achieved,
            SIMULATION,
            detail,
            tuple(points),
        )


@dataclass(frozen=True, kw_only=True)
class PreslidingError(_Simulated):
    """The position's error relative to its peak in a cycle of the force between +- share F_s."""

    force_rate: float
    share: float
    mass: float | None = None

    relative: ClassVar[bool] = True

    def words(self, law: Law) -> tuple[str, str]:
        """Names the rate and the cycle."""
        name = f"error of presliding at {self.force_rate:g} {unit(law, 'N/s')}"
        return name, f"a cycle of the force between +-{self.share:g} F_s, held for half the ramp's time"

    def _judge(self, law: Law, y: Value) -> None:
        """Loaded slowly to a share of F_s, LuGre moves by F_s/sigma_0 ln(1/(1 - share)): dz/dy = 1 - z/g."""
        if np.max(np.abs(y)) > 2 * law.p.F_s / law.p.sigma_0 * -np.log1p(-self.share):
            text = f"so fast {family(law)} breaks away below {self.share:g} F_s; must be slower, or the share smaller"
            raise InputError([f"{arg('force_rate')}: {self.force_rate:g}: {text}"])

    def scenario(self, law: Law) -> Scenario:
        """The cycle under a law."""
        top = self.share * law.p.F_s
        ramp = top / self.force_rate
        times = np.cumsum([0.0, ramp, ramp / 2, 2 * ramp, ramp / 2, ramp]).tolist()
        # so light that its own swing lasts a thousandth of the ramp
        mass = self.mass or law.p.sigma_0 * (1e-3 * ramp / (2 * pi)) ** 2
        return Scenario(
            name="presliding", law=_law(law), plant={"mass": mass},
            drive={"kind": "force", "signal": {"kind": "points", "t": times, "value": [0, top, top, -top, -top, 0]}},
            solve={"t_end": times[-1], "max_steps": _STEPS}, output={"step": times[-1] / _ROWS},
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class PositionError(_Simulated):
    """The position's error in a scenario of the user's, m."""

    given: Scenario

    def words(self, law: Law) -> tuple[str, str]:
        """Names the scenario."""
        return f"error of the position in {self.given.name}", f"{self.given.name}, {self.given.end:g} s"

    def scenario(self, law: Law) -> Scenario:
        """The scenario under a law."""
        return Scenario({**self.given.data, "law": _law(law)}, folder=self.given.folder)
