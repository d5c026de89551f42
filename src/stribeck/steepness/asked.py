"""What a user tolerates: whether it can be asked so, and the measures that follow from it."""

from __future__ import annotations

from dataclasses import dataclass

from stribeck.constants import POSITIVE, show
from stribeck.errors import arg
from stribeck.laws.base import Law
from stribeck.properties.level import level_problem
from stribeck.scenario import Scenario
from stribeck.steepness.cost import SampleTime
from stribeck.steepness.search import Tolerance
from stribeck.steepness.simulated import PositionError, PreslidingError
from stribeck.steepness.steady import Creep, SteadyError

_TOLERANCES = ("creep", "steady_error", "presliding_error", "position_error", "sample_time")
_NEEDS = (("steady_error", "speed"), ("presliding_error", "force_rate"), ("position_error", "scenario"))
_FASTEST = 100.0  # v_max as a multiple of v_s, unless given


@dataclass(frozen=True, kw_only=True)
class Asked:
    """The arguments of :func:`stribeck.steepness.advise` of that name."""

    creep: float | None
    share: float
    steady_error: float | None
    speed: float | None
    presliding_error: float | None
    force_rate: float | None
    position_error: float | None
    sample_time: float | None
    v_max: float | None
    mass: float | None
    level: tuple[float, float] | None
    scenario: Scenario | None

    @property
    def only_level(self) -> bool:
        """Whether nothing is asked but what keeps a contact passive while its level varies."""
        return self.level is not None and all(getattr(self, name) is None for name in _TOLERANCES)

    def problems(self) -> list[str]:
        """What cannot be asked so: a line for each problem."""
        numbers = {n: x for n, x in vars(self).items() if n not in ("level", "scenario") and x is not None}
        found = [f"{arg(n)}: {show(x)}: {text}" for n, x in numbers.items() if (text := POSITIVE.problem(x))]
        if not found and not 0 < (self.share or 0.0) < 1:
            found.append(f"{arg('share')}: {show(self.share)}: must be between 0 and 1, without them")
        for one, other in _NEEDS:
            if getattr(self, one) is not None and getattr(self, other) is None:
                found.append(f"{arg(other)}: missing: must be given with {arg(one)}")
        if not self.only_level and all(getattr(self, name) is None for name in _TOLERANCES):
            found.append(f"missing: what is tolerated: at least one of {', '.join(map(arg, (*_TOLERANCES, 'level')))}")
        if self.position_error is not None and self.scenario is not None and self.scenario.drive.sets_velocity:
            found.append(
                f"{arg('scenario')}: its drive sets the velocity, so the position does not depend on the law: use another"
            )
        if self.level is not None and (text := level_problem(self.level)):
            found.append(text)
        return found

    def fastest(self, law: Law) -> float:
        """The largest speed that matters, m/s."""
        return self.v_max if self.v_max is not None else _FASTEST * law.scales(law.p).speed

    def tolerances(self, law: Law) -> list[Tolerance]:
        """The measures that are to be small."""
        found: list[Tolerance] = []
        if self.creep is not None:
            found.append(Creep(self.creep, self.share))
        if self.steady_error is not None and self.speed is not None:
            found.append(SteadyError(self.steady_error, self.speed))
        if self.presliding_error is not None and self.force_rate is not None:
            found.append(
                PreslidingError(
                    tolerance=self.presliding_error, force_rate=self.force_rate, share=self.share, mass=self.mass
                )
            )
        if self.position_error is not None and self.scenario is not None:
            found.append(PositionError(tolerance=self.position_error, given=self.scenario))
        if self.sample_time is not None:
            found.append(SampleTime(self.sample_time, self.fastest(law)))
        return found
