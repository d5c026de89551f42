"""The accuracy of a run under an encoder: it is solved at two tolerances, and the results are compared.

Small errors decide to which count a reading near an edge is rounded, and a contact that creeps towards break-away amplifies
the difference. The errors of single steps show neither. A machine whose controller reads counts is therefore also solved at
ten times solve.rtol, which takes two thirds of the run's time. If the two differ by more than the promised accuracy, finer
runs follow until two neighbors agree; otherwise a note reports it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from stribeck.scenario import Scenario
from stribeck.simulation.promise import FORCE, MOTION
from stribeck.simulation.result import Result
from stribeck.simulation.solution import Solution

_STEP = 10.0  # ratio of the tolerances of two runs
_FINEST = 1e-11  # below, rounding is the larger error (promise.py)


def reads_counts(scenario: Scenario) -> bool:
    """Whether a sampled controller reads an encoder's counts."""
    controllers = scenario.system.elements.controllers.values()
    return any(each.sampling is not None and each.sampling.resolution is not None for each in controllers)


def settled(scenario: Scenario, solve: Callable[[Scenario], Result]) -> Result:
    """The result of a scenario under an encoder: at its own rtol if that is accurate enough, otherwise at a finer one.

    Args:
        scenario: the scenario.
        solve: solves it, and the same with another rtol.
    """
    rtol = scenario.solve.rtol

    def solve_at(other: float) -> Result:
        return solve(scenario.with_rtol(other))

    result = solve(scenario)
    if result.reason is not None or rtol <= _FINEST or not _differ(scenario, result, solve_at(min(_STEP * rtol, 0.1))):
        return result
    finer_rtol = rtol
    while finer_rtol > _FINEST:
        finer_rtol = max(finer_rtol / _STEP, _FINEST)
        finer = solve_at(finer_rtol)
        if finer.reason is not None:
            break
        differ, result = _differ(scenario, finer, result), finer
        if not differ:
            return result
    text = f"accuracy not reached: runs at solve.rtol = {rtol:g} and less differ by more than {MOTION * rtol:g} of the peak"
    result.remarks.append(f"{text}; counts of an encoder, or a contact near break-away, make small errors large")
    return result


def _differ(scenario: Scenario, first: Result, second: Result) -> bool:
    """Whether two results of a scenario differ by more than the promised accuracy."""
    if second.reason is not None:
        return True
    x, y = Solution(scenario, first), Solution(scenario, second)
    promised = {"y": MOTION, "v": MOTION, "F": FORCE}
    for column in x.columns:
        if share := promised.get(column.name.rpartition(".")[2]):
            a, b = x[column.name], y[column.name]
            if np.max(abs(a - b)) > share * scenario.solve.rtol * np.max(abs(a)):
                return True
    return False
