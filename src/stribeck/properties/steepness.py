"""The smallest steepness k_v with which a smooth law is as close to the exact one as a user needs.

A smaller k_v is a smoother law: dF/dt varies less abruptly around v = 0, and a fixed step resolves it. A larger one is
closer to |v|. The user says which errors are tolerable, and the law's steady state gives the smallest k_v: creep under a
constant load, and friction at a speed.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields

import numpy as np

from stribeck import laws
from stribeck.constants import POSITIVE, rotary_unit, show
from stribeck.errors import InputError, arg, nearest
from stribeck.expressions.ops import Value
from stribeck.laws.base import PARAMETERS, Law
from stribeck.laws.terms import g

MAJORANTS = {"lugre": "lugre_majorant", "elastoplastic": "elastoplastic_majorant"}
FORMULA, STEADY = "formula", "root of the law's steady state"
_TOLERANCES = ("creep", "steady_error")
_FASTEST = 100.0  # v_max as a multiple of v_s, unless given: far beyond the Stribeck effect, where a machine moves fast
_LEAST, _MOST = 1e-6, 1e12  # k_v as multiples of 1/speed: where it is looked for
_ACCURACY = 1e-10  # relative, of a k_v: below all digits that are shown


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
            problems.append(f"{', '.join(map(arg, _TOLERANCES))}: missing: at least one must be given")
        return problems

    def requirements(self, law: Law) -> tuple[Requirement, ...]:
        """The k_v that each tolerance needs."""
        needed = []
        if self.creep is not None:
            needed.append(_for_creep(law, self.creep, self.share))
        if self.steady_error is not None and self.speed is not None:
            needed.append(_for_steady_error(law, self.steady_error, self.speed))
        return tuple(needed)


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


@dataclass(frozen=True)
class Cost:
    """The price of a steepness: the stiffness of the equations, and the largest step of an explicit method.

    Attributes:
        v_max: up to this speed, m/s.
        stiffness: the largest |d(dz/dt)/dz| for |v| <= v_max and |z| <= F_s/sigma_0, 1/s.
        largest_step: the largest stable step of explicit Euler for the bristle at a held speed, s.
        bend: the speed 1/k_v within which the smooth |v| differs from |v|, m/s.
        force_bend: the largest |d^2 F/dv^2| there, N s^2/m^2: how fast the damping that a controller sees changes.
    """

    v_max: float
    stiffness: float
    largest_step: float
    bend: float
    force_bend: float


@dataclass(frozen=True)
class Steepness:
    """The smallest k_v of a law that meets every tolerance.

    Attributes:
        law: the law's name.
        k_v: in s/m; 0 if any will do, None if none will.
        requirements: each tolerance by itself, and the k_v that it needs.
        cost: the price at this k_v.
        rotary: whether the machine turns: rad for m, N m for N in all units.
    """

    law: str
    k_v: float | None
    requirements: tuple[Requirement, ...]
    cost: Cost | None
    rotary: bool = False

    def to_dict(self) -> dict[str, object]:
        """As plain data."""
        return asdict(self)


def smallest_steepness(law: Law, tolerated: Tolerated) -> dict[str, Steepness]:
    """The smallest k_v that meets the tolerances, for a law and for the majorant law of its family.

    Args:
        law: a bristle law with k_v; the value of its k_v plays no part.
        tolerated: the errors that are allowed.

    Returns:
        By law: the one asked for, and the majorant law unless it is that.

    Raises:
        InputError: a tolerance is not valid, or the law is another; one line for each problem.
    """
    if problems := tolerated.problems():
        raise InputError(problems)
    fit = [n for n, each in laws.builtin().items() if each.has_z and "k_v" in each.constants()]
    if law.name not in fit or type(law) is not laws.builtin()[law.name]:
        raise InputError(f"{show(law.name)}: must be a law with bristles and k_v: {', '.join(fit)}")
    by_law = {}
    for name in dict.fromkeys((law.name, MAJORANTS[_exact(law)])):
        variant = law if name == law.name else _counterpart(law, name)
        requirements = tolerated.requirements(variant)
        needed = [each.k_v for each in requirements if each.k_v is not None]
        k_v = max(needed) if len(needed) == len(requirements) else None
        v_max = tolerated.v_max if tolerated.v_max is not None else _FASTEST * variant.scales(variant.p).speed
        price = _cost(variant.replace(k_v=k_v), v_max) if k_v else None
        by_law[name] = Steepness(name, k_v, requirements, price, law.rotary)
    return by_law


def _cost(law: Law, v_max: float) -> Cost:
    """The price of a law's steepness, from the law's own derivatives on a grid."""
    k_v, bound = law.p.k_v, law.p.F_s / law.p.sigma_0
    v = np.unique(np.concatenate([[0.0], np.geomspace(1e-4, 1e4, 161) / k_v, np.geomspace(1e-9, 1.0, 161) * v_max]))
    v = v[v <= v_max]
    v, z = np.concatenate([-v[::-1], v])[:, None], np.linspace(-bound, bound, 81)[None, :]
    largest = float(np.max(np.abs(law.jacobian(v, z)[1])))
    near = np.linspace(-3, 3, 601)[:, None] / k_v
    slopes = law.force_rate(near, z, 1.0) - law.force_rate(near, z, 0.0)
    bend = float(np.max(np.abs(np.diff(slopes, axis=0)))) / float(near[1, 0] - near[0, 0])
    return Cost(v_max, largest, 2 / largest, 1 / k_v, bend)


def _exact(law: Law) -> str:
    """The law that this one makes smooth: lugre or elastoplastic."""
    return "elastoplastic" if "z_ba" in law.constants() else "lugre"


def _counterpart(law: Law, name: str) -> Law:
    """Another law with the constants that both have."""
    cls = laws.find(name)
    known = {**PARAMETERS, **cls.constants()}
    return cls({n: x for n, x in {**law.machine, **law.p.numbers}.items() if n in known}, law.rotary)


def _unit(law: Law, linear: str) -> str:
    """A unit as the law's machine has it: rad for m where it turns."""
    return rotary_unit(linear) if law.rotary else linear


def _smallest(met: Callable[[float], Value], start: float) -> float | None:
    """The smallest k_v that meets a tolerance, which every larger one meets too, by bisection.

    0 where it is met at 1e-6 ``start`` (s/m), None where it is not met at 1e12 ``start``.
    """
    low, high = start * _LEAST, min(start * _MOST, sys.float_info.max)
    if met(low):
        return 0.0
    if not met(high):
        return None
    while high / low > 1 + _ACCURACY:
        middle = math.sqrt(low) * math.sqrt(high)
        low, high = (low, middle) if met(middle) else (middle, high)
    return high


def _required(
    law: Law, name: str, tolerance: float, unit: str, k_v: float | None, detail: str, measure: Callable[[Law], float]
) -> Requirement:
    """A requirement with the measure at its k_v, and at steepnesses around it."""
    around: Sequence[float] = [k_v * 10 ** (i / 6) for i in range(-12, 13)] if k_v else []
    points = tuple((k, measure(law.replace(k_v=k))) for k in around)
    achieved = measure(law.replace(k_v=k_v)) if k_v else None
    return Requirement(name, tolerance, unit, k_v, achieved, STEADY, detail, points)


# -- creep under a load -------------------------------------------------------------------------------------------------


def _carries(law: Law, v: Value, load: float) -> Value:
    """True where steady friction at v is the load or more: at the z that carries it, z still grows."""
    return law.rate(v, (load - law.p.sigma_2 * v) / law.p.sigma_0) >= 0


def creep_under(law: Law, load: float) -> float:
    """The slowest speed at which steady friction carries a load, m/s."""
    v = np.geomspace(1e-12, 1e4, 321) / law.p.k_v
    for _ in range(6):
        carries = _carries(law, v, load)
        first = int(carries.argmax())
        if not carries.any() or first == 0:
            return 0.0 if carries.any() else math.inf
        v = np.linspace(v[first - 1], v[first], 321)
    return float(v[-1])


def _for_creep(law: Law, v: float, share: float) -> Requirement:
    """The k_v at which friction at the tolerated speed v is a load of ``share`` F_s: then the creep is slower."""
    name, load, unit = f"creep under {share:g} F_s", share * law.p.F_s, _unit(law, "m/s")
    if law.name == "lugre_arctan":
        return Requirement(name, v, unit, 0.0, 0.0, FORMULA, "z has no bound: it does not creep below F_s")
    if "z_ba" in law.constants() and load <= law.p.sigma_0 * law.p.z_ba:
        return Requirement(name, v, unit, 0.0, 0.0, FORMULA, "the load is below sigma_0 z_ba: it does not creep")
    sliding = law.p.sigma_0 * g(law.p, v) + law.p.sigma_2 * v
    if not load < sliding:
        detail = f"at {v:g} {unit} sliding friction itself, {sliding:.4g} {_unit(law, 'N')}, is below the load"
        return Requirement(name, v, unit, None, None, FORMULA, detail)
    k_v = _smallest(lambda k: _carries(law.replace(k_v=k), v, load), 1 / v)
    detail = "at the tolerated speed, steady friction equals the load"
    return _required(law, name, v, unit, k_v, detail, lambda law: creep_under(law, load))


# -- friction at a speed ------------------------------------------------------------------------------------------------


def _for_steady_error(law: Law, tolerance: float, speed: float) -> Requirement:
    """The k_v at which the friction force at a held speed differs from the exact law's by a share of that."""
    exact = float(_counterpart(law, _exact(law)).steady_force(speed))

    def error(law: Law) -> float:
        return abs(float(law.steady_force(speed)) - exact) / exact

    name = f"error of steady friction at {speed:g} {_unit(law, 'm/s')}"
    k_v = _smallest(lambda k: error(law.replace(k_v=k)) <= tolerance, 1 / speed)
    return _required(law, name, tolerance, "", k_v, "steady friction differs by the tolerance", error)
