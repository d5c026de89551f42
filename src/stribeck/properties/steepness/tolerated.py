"""The errors of a smooth law that a user tolerates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

from stribeck.constants import POSITIVE, show
from stribeck.errors import InputError, arg, nearest
from stribeck.laws.base import Law
from stribeck.properties.steepness.search import Tolerance
from stribeck.properties.steepness.steady import Creep, SteadyError

_TOLERANCES = ("creep", "steady_error")
_FASTEST = 100.0  # v_max as a multiple of v_s, unless given: far beyond the Stribeck effect, where a machine moves fast


@dataclass(frozen=True, kw_only=True)
class Tolerated:
    """Tolerances of a smooth law's errors, SI units; at least one of the two must be given.

    Attributes:
        creep: the largest speed in m/s under a load held at ``share`` of F_s.
        share: of F_s, between 0 and 1.
        steady_error: the largest error of the steady friction force at ``speed``, relative to the exact law's.
        speed: in m/s.
        v_max: the largest speed that matters, m/s; 100 v_s unless given.
    """

    creep: float | None = None
    share: float = 0.95
    steady_error: float | None = None
    speed: float | None = None
    v_max: float | None = None

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
        return cls(**values)  # type: ignore[arg-type]

    def problems(self) -> list[str]:
        """Why the question cannot be answered: a line for each problem."""
        numbers = {n: x for n, x in vars(self).items() if x is not None}
        problems = [f"{arg(n)}: {show(x)}: {text}" for n, x in numbers.items() if (text := POSITIVE.problem(x))]
        if not problems and not 0 < self.share < 1:
            problems.append(f"{arg('share')}: {show(self.share)}: must be between 0 and 1, without them")
        if self.steady_error is not None and self.speed is None:
            problems.append(f"{arg('speed')}: missing: must be given with {arg('steady_error')}")
        if all(getattr(self, name) is None for name in _TOLERANCES):
            problems.append(f"missing: a tolerance: at least one of {', '.join(map(arg, _TOLERANCES))}")
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
        return wanted
