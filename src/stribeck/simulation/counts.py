"""How far a run under an encoder can be trusted: it is solved at two tolerances, and the two are compared.

A reading near the edge of a count falls to one side or the other by the errors of the steps before it, and a contact that
creeps towards break-away multiplies what follows. No error of a single step shows either. So the motion of a machine whose
controller reads counts is solved at ten times solve.rtol too, which costs two thirds of the run. Where the two differ by more
than is promised, finer runs follow until two neighbours agree, or a note says that none do.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stribeck.scenario import Scenario
from stribeck.simulation.promise import FORCE, MOTION
from stribeck.simulation.result import Result
from stribeck.simulation.solution import Solution

_STEP = 10.0  # between the tolerances of two runs
_FINEST = 1e-11  # a smaller rtol changes rounding only


def reads_counts(scenario: Scenario) -> bool:
    """Whether a sampled controller reads an encoder's counts."""
    every = scenario.system.elements.controllers.values()
    return any(each.sampling is not None and each.sampling.resolution is not None for each in every)


def settled(scenario: Scenario, solve: Callable[[Scenario], Result]) -> Result:
    """The result of a scenario under an encoder: at its own rtol where that keeps the promise, else at a finer one.

    Args:
        scenario: what is solved.
        solve: solves it, or the same with another rtol.
    """
    rtol = scenario.solve.rtol

    def at(other: float) -> Result:
        return solve(scenario.with_values(solve=scenario.solve.model_copy(update={"rtol": other})))

    result = solve(scenario)
    if result.reason is not None or rtol <= _FINEST or not _apart(scenario, result, at(min(_STEP * rtol, 0.1))):
        return result
    now = rtol
    while now > _FINEST:
        now = max(now / _STEP, _FINEST)
        finer = at(now)
        if finer.reason is not None:
            break
        apart, result = _apart(scenario, finer, result), finer
        if not apart:
            return result
    text = f"accuracy not reached: runs at solve.rtol = {rtol:g} and less differ by more than {MOTION * rtol:g} of the peak"
    result.remarks.append(f"{text}; counts of an encoder, or a contact near break-away, make small errors large")
    return result


def _apart(scenario: Scenario, one: Result, other: Result) -> bool:
    """Whether two results of a scenario differ by more than is promised of it."""
    if other.reason is not None:
        return True
    x, y = Solution(scenario, one), Solution(scenario, other)
    promised = {"y": MOTION, "v": MOTION, "F": FORCE}
    for column in x.columns:
        if share := promised.get(column.name.rpartition(".")[2]):
            a, b = x[column.name], y[column.name]
            if np.max(abs(a - b)) > share * scenario.solve.rtol * np.max(abs(a)):
                return True
    return False
