"""What of each number the recordings tell, in words, and what would tell the rest."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator import advise, driven, gaps, intervals, lacking, suspects
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.estimate import BestPoint
from stribeck.identify.actuator.intervals import WHITE, Ends, Spread, groups, profiles
from stribeck.identify.actuator.problem import MachineProblem, number_at
from stribeck.identify.actuator.result import Group, Parameter
from stribeck.identify.actuator.shooting import unset
from stribeck.identify.actuator.solve import search
from stribeck.identify.statistics.curves import NO_CURVE, no_curve_seen
from stribeck.scenario import Scenario
from stribeck.simulation.places import machine_places

_WIDE = 10.0  # an interval over this factor tells the order of magnitude only
_AGAIN = 4


@dataclass
class JudgedParameters:
    """The parameters with their verdicts, and the estimate itself (a profile may have found a better one)."""

    best: BestPoint
    parameters: dict[str, Parameter]
    correlated: list[Group] = field(default_factory=list)
    relation: tuple[list[str], Array] | None = None
    notes: list[str] = field(default_factory=list)


def judged(best: BestPoint, scenario: Scenario, trusted: bool) -> JudgedParameters:
    """Each number with its interval and verdict; ``trusted``: the fit follows the recordings, and was not stopped."""
    problem = best.problem
    asked = [i for i, c in enumerate(problem.sought) if not c.nuisance]
    if not trusted:
        return _blank(best, scenario, "no interval: the fit was stopped, or does not follow the recordings", [])
    for _ in range(_AGAIN):
        s = intervals.spread(problem, best.u)
        if (noisy := driven.moved_by_noise(problem, best.u, s)) is not None:
            s = intervals.widened(s, *noisy)
        if missing := gaps.unknown(problem, best.u, s):
            return _blank(best, scenario, "no interval: samples of the inputs are missing (see the notes)", missing)
        if begun := unset(problem, best.u, s):
            return _blank(
                best, scenario, "no interval: stretches begin in states that nobody knows (see the notes)", begun
            )
        ways = suspects.between(best, s)
        numbers = suspects.numbers(best, s, ways)
        unsaid = lacking.unsaid(best, s, numbers)
        unsaid.alike.extend(suspects.unresolved(ways))
        told_of, moves = suspects.seen(best, s, numbers, unsaid.terms, ways)
        if moves:
            return _blank(
                best,
                scenario,
                "no interval: a sensor, an input or a fixed number is wrong by what would move the numbers (see the notes)",
                told_of,
            )
        ends = profiles(problem, best.u, s, asked)
        lower = next((e.lower for e in ends.values() if e.lower is not None), None)
        if lower is None:
            break
        best.u = search(problem, 1, 0, lower).u
    else:
        return _blank(best, scenario, "no interval: the search did not come to rest: a better point lies nearby", [])
    ends = {k: unsaid.wider(k, ends[k], problem.low[k], problem.high[k]) for k in asked}
    found = {problem.sought[k].name: _parameter(best, scenario, s, k, ends[k]) for k in asked}
    _without_curve(best, found)
    names = [c.name for c in problem.sought]
    told = groups(s, names, asked)
    open_ = [k for k in asked if found[names[k]].verdict != "found"]
    for k, text in advise.experiments(best, s, open_).items():
        found[names[k]].experiment = text
    size = np.sqrt(np.maximum(np.diag(s.covariance), 1e-300))
    relation = (s.covariance / np.outer(size, size))[np.ix_(asked, asked)]
    result = JudgedParameters(best, found, told, ([names[k] for k in asked], relation), _widened(s, problem, asked))
    result.notes += [
        *told_of,
        *unsaid.notes(s, asked),
        *suspects.taken_as_exact(best, s, unsaid.farther),
        *unsaid.exact,
    ]
    return result


def _blank(best: BestPoint, scenario: Scenario, why: str, notes: list[str]) -> JudgedParameters:
    """The parameters without intervals."""
    found = {
        c.name: Parameter(c.outer(best.u[i]), None, None, unit(scenario, c), "not judged", why)
        for i, c in enumerate(best.problem.sought) if not c.nuisance
    }  # fmt: skip
    return JudgedParameters(best, found, notes=notes)


def _parameter(best: BestPoint, scenario: Scenario, s: Spread, k: int, ends: Ends) -> Parameter:
    c = best.problem.sought[k]
    low, high = (None if x is None else c.outer(x) for x in (ends.low, ends.high))
    curve = [(c.outer(u), rise) for u, rise in ends.curve]
    value = c.outer(best.u[k])
    verdict, why = "found", ""
    if low is None and high is None:
        verdict, why = "not told", f"the recordings are followed as well with any value from {c.low:g} to {c.high:g}"
    elif low is None:
        verdict, why = "bounded above", f"they are followed as well with any smaller value down to {c.low:g}"
    elif high is None:
        verdict, why = "bounded below", f"they are followed as well with any larger value up to {c.high:g}"
    elif c.logarithmic and high > _WIDE * low:
        verdict, why = "not told", f"its interval spans a factor of {high / low:.2g}"
    if verdict not in ("found", "not judged") and (others := partners(best, s, k)):
        why += f"; {others} can make up for it"
    return Parameter(value, low, high, unit(scenario, c), verdict, why, "", curve)


def _without_curve(best: BestPoint, found: dict[str, Parameter]) -> None:
    """Each F_s beside a v_s that is not told is not told either where no Stribeck curve was seen."""
    for name, F_s in found.items():
        law = name.removesuffix("F_s")
        v_s, F_c = found.get(f"{law}v_s"), found.get(f"{law}F_c")
        if not name.endswith(".law.parameters.F_s") or v_s is None or v_s.verdict == "found":
            continue
        highest = F_c.high if F_c is not None else number_at(best.problem.runs[0], f"{law}F_c")
        if no_curve_seen(F_s.low, highest):
            F_s.low, F_s.high, F_s.verdict, F_s.why = None, None, "not told", NO_CURVE


def partners(best: BestPoint, s: Spread, k: int) -> str:
    """What moves with a coordinate where it moves along its valley."""
    size = np.sqrt(np.maximum(np.diag(s.covariance), 1e-300))
    relation = s.covariance[k] / (size * size[k])
    others = [i for i in np.argsort(-abs(relation)) if i != k and abs(relation[i]) > 0.9]
    return " and ".join(best.problem.sought[i].name for i in others[:2])


def _widened(s: Spread, problem: MachineProblem, asked: list[int]) -> list[str]:
    if s.moved is not None:
        run, wider = max(problem.runs, key=lambda each: len(driven.noises(each))), np.sqrt(s.inflation[asked])
        how = ", by which residuals are weighed" if problem.colours else ""
        return [
            f"noise of the inputs ({driven.in_words(run)}{how}) is counted: intervals are {wider.min():.2g} to {wider.max():.2g} "
            "times as wide as for noise of the outputs alone"
        ]
    coloured = {name: x for name, x in s.memory.items() if x > WHITE}
    if not coloured:
        return ["residuals are white: the intervals need no widening"]
    how = ", ".join(f"{name} over {x:.3g} samples" for name, x in coloured.items())
    wider = np.sqrt(s.inflation[asked])
    return [
        f"residuals are not white ({how}): intervals are {wider.min():.2g} to {wider.max():.2g} times as wide as for white "
        "ones (Newey and West's covariance over that memory)"
    ]


def unit(scenario: Scenario, c: MachineCoordinate) -> str:
    """The unit of what is sought, where the machine says it."""
    if c.output is not None:
        of = next((x.unit for x in scenario.rig.machine.columns if x.name == c.output[0]), "")
        return {"offset": of, "gain": "1", "delay": "s", "clock": "s/s"}.get(c.output[1], "")
    path = next(iter(c.targets))
    owner, name = machine_places(scenario).get(path, ("", path.rpartition(".")[2]))
    if owner == "initial":
        body = scenario.rig.machine.elements.bodies[name.rpartition(".")[0]]
        length = "rad" if body.rotary else "m"
        return length if name.endswith(".y") else f"{length}/s"
    tables = scenario.rig.machine.tables
    if owner in scenario.rig.laws or owner in tables:
        constants = scenario.rig.laws[owner].constants() if owner in scenario.rig.laws else tables[owner][0]
        if name in constants:
            return constants[name].unit_for(bool(owner in tables and tables[owner][1])) or "1"
    return ""
