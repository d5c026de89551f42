"""Which k_v? The smallest steepness with which a smooth law is as close to the exact one as a user needs.

A smaller k_v is a smoother law: dF/dt varies less abruptly around v = 0, and a fixed step resolves it. A larger one is
closer to |v|. The user says what is tolerated; closed forms answer where there are any, else the law's steady state or
simulations, by bisection.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from stribeck import laws
from stribeck.constants import Constant, show
from stribeck.errors import InputError, nearest
from stribeck.laws.base import Law
from stribeck.scenario import Scenario
from stribeck.steepness.cost import Cost, SampleTime, cost
from stribeck.steepness.level import LEVELLED, LevelAdvice, level_advice
from stribeck.steepness.search import Requirement, Tolerance, counterpart, family, with_k_v
from stribeck.steepness.simulated import PositionError, PreslidingError
from stribeck.steepness.steady import Creep, SteadyError

__all__ = ["Advice", "Cost", "LevelAdvice", "Requirement", "advise"]

_POSITIVE = Constant("", "", above=0)
MAJORANTS = {"lugre": "lugre_majorant", "elastoplastic": "elastoplastic_majorant"}
_TOLERANCES = ("creep", "steady_error", "presliding_error", "position_error", "sample_time")
_FASTEST = 100.0  # v_max as a multiple of v_s, unless given


@dataclass(frozen=True)
class Advice:
    """The smallest k_v that meets every requirement, for one law.

    Attributes:
        law: the law's name.
        k_v: in s/m; 0 where any will do, None where none will.
        requirements: each by itself, and the k_v that it needs.
        cost: the price at this k_v.
        level: what keeps a contact with this law passive while its level varies; None where that was not asked.
    """

    law: str
    k_v: float | None
    requirements: tuple[Requirement, ...]
    cost: Cost | None
    level: LevelAdvice | None = None

    def summary(self) -> dict[str, Any]:
        """As plain data."""
        return asdict(self)


def advise(
    law: str,
    parameters: str | Mapping[str, float] | None = None,
    *,
    creep: float | None = None,
    share: float = 0.95,
    steady_error: float | None = None,
    speed: float | None = None,
    presliding_error: float | None = None,
    force_rate: float | None = None,
    position_error: float | None = None,
    scenario: Scenario | str | Path | None = None,
    sample_time: float | None = None,
    v_max: float | None = None,
    mass: float | None = None,
    level: tuple[float, float] | None = None,
    **constants: float | str,
) -> dict[str, Advice]:
    """The smallest k_v that meets what is tolerated, for a law and for the majorant law of its family.

    Args:
        law: a bristle law with k_v, by name.
        parameters: the machine's, as for :func:`stribeck.law`; the scenario's unless given.
        creep: the largest speed in m/s under a load held at ``share`` of F_s.
        share: of F_s, between 0 and 1.
        steady_error: the largest error of the steady friction force at ``speed``, relative to the exact law's.
        speed: in m/s.
        presliding_error: the largest error of the position, relative to its peak, in a cycle of the force between
            +- ``share`` F_s at ``force_rate``, held for half the ramp's time at both ends.
        force_rate: in N/s.
        position_error: the largest error of the position in ``scenario``, m.
        scenario: a scenario or its file.
        sample_time: the step of the target in s, at which explicit Euler of the bristle is to be stable up to ``v_max``.
        v_max: the largest speed that matters, m/s; 100 v_s unless given.
        mass: of the body in kg, for the presliding cycle (so light that it plays no part unless given) and the cost.
        level: (LOW, HIGH): the contact's F_c and F_s vary between LOW and HIGH times their values. The answer is the largest
            v_d that keeps it passive whatever they do, at the k_v found; alone, for the k_v given, or the smallest that will do.
        **constants: the law's other constants (``z_ba=7e-6``), or single parameters.

    Returns:
        An :class:`Advice` by law: the one asked for, and the majorant law unless it is that.

    Raises:
        InputError: what is wrong, one line for each problem.
        StribeckError: a simulation failed.
    """
    if isinstance(scenario, str | Path):
        scenario = Scenario.load(scenario)
    given = {
        "creep": creep, "share": share, "steady_error": steady_error, "speed": speed, "presliding_error": presliding_error,
        "force_rate": force_rate, "position_error": position_error, "sample_time": sample_time, "v_max": v_max, "mass": mass,
    }  # fmt: skip
    only_level = level is not None and all(given[name] is None for name in _TOLERANCES)
    problems = _problems(given, scenario, only_level)
    if level is not None and not 0 < level[0] <= level[1] < float("inf"):
        problems.append(f"level: {show(list(level))}: must be two finite numbers, 0 < LOW <= HIGH")
    if only_level and not problems:
        return advise_level(law, parameters, scenario, level, constants)
    if "k_v" in constants:
        problems.append(f"k_v: {show(constants['k_v'])}: is what is asked for; must be left out")
    if problems:
        raise InputError(problems)
    asked = _law(law, parameters, scenario, constants)
    advices = {}
    for each in dict.fromkeys((asked.name, MAJORANTS[family(asked)])):
        one = asked if each == asked.name else counterpart(asked, each)
        fastest = v_max if v_max is not None else _FASTEST * one.scales(one.p).speed
        wanted: list[Tolerance] = []
        wanted += [Creep(creep, share)] if creep is not None else []
        wanted += [SteadyError(steady_error, speed)] if steady_error is not None and speed is not None else []
        if presliding_error is not None and force_rate is not None:
            wanted.append(PreslidingError(tolerance=presliding_error, force_rate=force_rate, share=share, mass=mass))
        if position_error is not None and scenario is not None:
            wanted.append(PositionError(tolerance=position_error, given=scenario))
        wanted += [SampleTime(sample_time, fastest)] if sample_time is not None else []
        advices[each] = _advice(one, [tolerance.need(one) for tolerance in wanted], fastest, mass)
        if level is not None and advices[each].k_v and each in LEVELLED:
            there = with_k_v(one, advices[each].k_v or 1.0)
            advices[each] = replace(advices[each], level=level_advice(there, *level, fastest))
    return advices


def advise_level(
    law: str,
    parameters: Any,
    scenario: Scenario | None,
    level: tuple[float, float] | None,
    constants: Mapping[str, Any],
) -> dict[str, Advice]:
    """The answer about the level alone, for one law and any k_v."""
    assert level is not None
    if parameters is None and scenario is not None:
        parameters = dict(scenario.law.machine)
    found = laws.law(law, parameters, **constants)
    answer = level_advice(found, *level, _FASTEST * found.scales(found.p).speed)
    return {found.name: Advice(found.name, found.values.get("k_v"), (), None, answer)}


def _advice(law: Law, found: Iterable[Requirement], v_max: float, mass: float | None) -> Advice:
    found = tuple(found)
    needed = [each.k_v for each in found if each.k_v is not None]
    k_v = max(needed) if len(needed) == len(found) else None
    return Advice(law.name, k_v, found, cost(law, k_v, v_max, mass) if k_v else None)


def _problems(given: Mapping[str, float | None], scenario: Scenario | None, only_level: bool) -> list[str]:
    found = []
    for name, value in given.items():
        if value is not None and (text := _POSITIVE.problem(value)):
            found.append(f"{name}: {show(value)}: {text}")
    if not found and not 0 < (given["share"] or 0.0) < 1:
        found.append(f"share: {show(given['share'])}: must be between 0 and 1, without them")
    for one, other in (("steady_error", "speed"), ("presliding_error", "force_rate"), ("position_error", "scenario")):
        missing = scenario is None if other == "scenario" else given[other] is None
        if given[one] is not None and missing:
            found.append(f"{other}: missing: must be given with {one}")
    if not only_level and all(given[name] is None for name in _TOLERANCES):
        found.append(f"missing: what is tolerated: at least one of {', '.join(_TOLERANCES)}, level")
    if given["position_error"] is not None and scenario is not None and scenario.drive.sets_velocity:
        found.append("scenario: its drive sets the velocity, so the position does not depend on the law: use another")
    return found


def _law(
    name: str, parameters: str | Mapping[str, float] | None, scenario: Scenario | None, constants: Mapping[str, Any]
) -> Law:
    found = laws.find(name)
    if name not in laws.builtin() or not found.has_z or "k_v" not in found.constants():
        fit = [n for n, each in laws.builtin().items() if each.has_z and "k_v" in each.constants()]
        raise InputError(f"{show(name)}: must be a law with bristles and k_v: {', '.join(fit)}{nearest(name, fit)}")
    if parameters is None and scenario is not None:
        own = {n: scenario.law.p.__dict__[n] for n in found.own_constants() if hasattr(scenario.law.p, n)}
        constants = {
            **scenario.law.machine,
            **{n: x for n, x in own.items() if x is not None and n != "k_v"},
            **constants,
        }
    elif parameters is None:
        parameters = {}
    values = laws.parameters_for(found, parameters) if isinstance(parameters, str) else dict(parameters or {})
    values.pop("k_v", None)
    return found({"k_v": 1.0, **values, **constants})
