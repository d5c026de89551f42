"""The errors of a smooth law that a user tolerates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path

from stribeck.constants import POSITIVE, show
from stribeck.errors import InputError, arg, nearest
from stribeck.laws.base import Law
from stribeck.properties.steepness.cost import SampleTime
from stribeck.properties.steepness.search import Tolerance
from stribeck.properties.steepness.simulated import PositionError, PreslidingError
from stribeck.properties.steepness.steady import Creep, SteadyError
from stribeck.scenario import Scenario

_TOLERANCES = ("creep", "steady_error", "presliding_error", "position_error", "sample_time")
_NEEDS = (("steady_error", "speed"), ("presliding_error", "force_rate"), ("position_error", "scenario"))
_FASTEST = 100.0  # v_max as a multiple of v_s, unless given: far beyond the Stribeck effect, where a machine moves fast


@dataclass(frozen=True, kw_only=True)
class Tolerated:
    """Tolerances of a smooth law's errors, SI units; at least one of the five must be given.

    Attributes:
        creep: the largest speed in m/s under a load held at ``share`` of F_s.
        share: of F_s, between 0 and 1.
        steady_error: the largest error of the steady friction force at ``speed``, relative to the exact law's.
        speed: in m/s.
        presliding_error: the largest error of the position, relative to its peak, in a cycle of the force. The force goes
            between +- ``share`` F_s at ``force_rate``, and is held for half the ramp's time at both ends.
        force_rate: in N/s.
        position_error: the largest error of the position in ``scenario``, m.
        scenario: a scenario whose position is compared.
        sample_time: the step of the target in s, at which explicit Euler of the bristle is to be stable up to ``v_max``.
        v_max: the largest speed that matters, m/s; 100 v_s unless given.
        mass: of the body in kg, for the presliding cycle (so light that it plays no part unless given) and the cost.
    """

    creep: float | None = None
    share: float = 0.95
    steady_error: float | None = None
    speed: float | None = None
    presliding_error: float | None = None
    force_rate: float | None = None
    position_error: float | None = None
    scenario: Scenario | None = None
    sample_time: float | None = None
    v_max: float | None = None
    mass: float | None = None

    @classmethod
    def given(cls, tolerances: Mapping[str, object]) -> Tolerated:
        """The tolerances of a mapping; one that is None is not given.

        Raises:
            InputError: a key is unknown.
        """
        known = [field.name for field in fields(cls)]
        if unknown := [name for name in tolerances if name not in known]:
            raise InputError([f"{name}: no such tolerance{nearest(name, known)}" for name in unknown])
        values = {name: x for name, x in tolerances.items() if x is not None}
        if isinstance(values.get("scenario"), str | Path):
            values["scenario"] = Scenario.load(values["scenario"])  # type: ignore[arg-type]
        return cls(**values)  # type: ignore[arg-type]

    def problems(self) -> list[str]:
        """Why the question cannot be answered: a line for each problem."""
        numbers = {n: x for n, x in vars(self).items() if n != "scenario" and x is not None}
        problems = [f"{arg(n)}: {show(x)}: {text}" for n, x in numbers.items() if (text := POSITIVE.problem(x))]
        if not problems and not 0 < self.share < 1:
            problems.append(f"{arg('share')}: {show(self.share)}: must be between 0 and 1, without them")
        for needing, other in _NEEDS:
            if getattr(self, needing) is not None and getattr(self, other) is None:
                problems.append(f"{arg(other)}: missing: must be given with {arg(needing)}")
        if all(getattr(self, name) is None for name in _TOLERANCES):
            problems.append(f"missing: a tolerance: at least one of {', '.join(map(arg, _TOLERANCES))}")
        if self.position_error is not None and self.scenario is not None and self.scenario.elements.given_alone:
            problems.append(
                f"{arg('scenario')}: its drive sets the velocity, so the position does not depend on the law: use another"
            )
        return problems

    def fastest(self, law: Law) -> float:
        """The largest speed that matters, m/s."""
        return self.v_max if self.v_max is not None else _FASTEST * law.scales(law.p).speed

    def tolerances(self, law: Law) -> list[Tolerance]:
        """The measures that are to be small."""
        wanted: list[Tolerance] = []
        if self.creep is not None:
            wanted.append(Creep(self.creep, self.share))
        if self.steady_error is not None and self.speed is not None:
            wanted.append(SteadyError(self.steady_error, self.speed))
        if self.presliding_error is not None and self.force_rate is not None:
            wanted.append(
                PreslidingError(
                    tolerance=self.presliding_error, force_rate=self.force_rate, share=self.share, mass=self.mass
                )
            )
        if self.position_error is not None and self.scenario is not None:
            wanted.append(PositionError(tolerance=self.position_error, given=self.scenario))
        if self.sample_time is not None:
            wanted.append(SampleTime(self.sample_time, self.fastest(law)))
        return wanted
