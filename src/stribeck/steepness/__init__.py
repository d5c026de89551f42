"""Which k_v? The smallest steepness with which a smooth law is as close to the exact one as a user needs.

A smaller k_v is a smoother law: dF/dt varies less abruptly around v = 0, and a fixed step resolves it. A larger one is
closer to |v|. The user says what is tolerated; closed forms answer where there are any, else the law's steady state or
simulations, by bisection.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from stribeck import laws
from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.laws.base import PARAMETERS, Law
from stribeck.scenario import Scenario
from stribeck.steepness.asked import Asked
from stribeck.steepness.cost import Cost, cost
from stribeck.steepness.level import LEVELLED, LevelAdvice, level_advice
from stribeck.steepness.search import Requirement, counterpart, family, with_k_v

__all__ = ["Advice", "Cost", "LevelAdvice", "Requirement", "advise"]

MAJORANTS = {"lugre": "lugre_majorant", "elastoplastic": "elastoplastic_majorant"}


@dataclass(frozen=True)
class Advice:
    """The smallest k_v that meets every requirement, for one law.

    Attributes:
        law: the law's name.
        k_v: in s/m; 0 where any will do, None where none will.
        requirements: each by itself, and the k_v that it needs.
        cost: the price at this k_v.
        level: what keeps a contact with this law passive while its level varies; None where that was not asked.
        rotary: whether the machine turns: rad for m, N m for N in all units.
    """

    law: str
    k_v: float | None
    requirements: tuple[Requirement, ...]
    cost: Cost | None
    level: LevelAdvice | None = None
    rotary: bool = False

    def summary(self) -> dict[str, object]:
        """As plain data."""
        return asdict(self)


Parameters = str | Path | Mapping[str, float] | None


def advise(
    law: str,
    parameters: Parameters = None,
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
    asked = Asked(
        creep=creep, share=share, steady_error=steady_error, speed=speed, presliding_error=presliding_error,
        force_rate=force_rate, position_error=position_error, sample_time=sample_time, v_max=v_max, mass=mass, level=level,
        scenario=Scenario.load(scenario) if isinstance(scenario, str | Path) else scenario,
    )  # fmt: skip
    return _advices(law, parameters, asked, constants)


def _advices(
    name: str, parameters: Parameters, asked: Asked, constants: Mapping[str, float | str]
) -> dict[str, Advice]:
    """For the law and its majorant; for the law alone where only the level is asked about."""
    problems = asked.problems()
    if asked.only_level and not problems:
        return _about_level(name, parameters, asked, constants)
    if "k_v" in constants:
        problems.append(f"k_v: {show(constants['k_v'])}: is what is asked for; must be left out")
    if problems:
        raise InputError(problems)
    law = _law(name, parameters, asked.scenario, constants)
    advices = {}
    for each in dict.fromkeys((law.name, MAJORANTS[family(law)])):
        one = law if each == law.name else counterpart(law, each)
        fastest = asked.fastest(one)
        found = _advice(one, [tolerance.need(one) for tolerance in asked.tolerances(one)], fastest, asked.mass)
        if asked.level is not None and found.k_v and each in LEVELLED:
            found = replace(found, level=level_advice(with_k_v(one, found.k_v), *asked.level, fastest))
        advices[each] = found
    return advices


def _about_level(
    name: str, parameters: Parameters, asked: Asked, constants: Mapping[str, float | str | None]
) -> dict[str, Advice]:
    """The answer about the level alone, for one law and its k_v."""
    assert asked.level is not None
    found = _made(name, parameters, asked.scenario, constants)
    answer = level_advice(found, *asked.level, asked.fastest(found))
    return {found.name: Advice(found.name, found.values.get("k_v"), (), None, answer, found.rotary)}


def _advice(law: Law, found: Iterable[Requirement], v_max: float, mass: float | None) -> Advice:
    found = tuple(found)
    needed = [each.k_v for each in found if each.k_v is not None]
    k_v = max(needed) if len(needed) == len(found) else None
    price = cost(law, k_v, v_max, mass) if k_v else None
    return Advice(law.name, k_v, found, price, rotary=law.rotary)


def _made(
    name: str, parameters: Parameters, scenario: Scenario | None, constants: Mapping[str, float | str | None]
) -> Law:
    """The law with these parameters; unless given, with the constants that the scenario's law has too."""
    if parameters is not None or scenario is None:
        return laws.law(name, parameters, **constants)
    kind, given = laws.find(name), {**scenario.law.machine, **scenario.law.p.numbers, **scenario.law.p.words}
    known = {n: x for n, x in given.items() if n in PARAMETERS or n in kind.constants()}
    return kind({**known, **constants}, scenario.law.rotary)


def _law(
    name: str, parameters: Parameters, scenario: Scenario | None, constants: Mapping[str, float | str | None]
) -> Law:
    """The law with a k_v that is still to be found."""
    found = laws.find(name)
    if name not in laws.builtin() or not found.has_z or "k_v" not in found.constants():
        fit = [n for n, each in laws.builtin().items() if each.has_z and "k_v" in each.constants()]
        raise InputError(f"{show(name)}: must be a law with bristles and k_v: {', '.join(fit)}{nearest(name, fit)}")
    return _made(name, parameters, scenario, {**constants, "k_v": 1.0})
