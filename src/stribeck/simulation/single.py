"""The simulation of one scenario."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from stribeck.errors import note
from stribeck.scenario import Scenario
from stribeck.simulation import backend, counts, promise
from stribeck.simulation.result import Result
from stribeck.simulation.solution import Solution

if TYPE_CHECKING:
    from stribeck.scenario.objects import Machine


def simulate_once(
    scenario: Scenario | Machine | str | Path | Mapping[str, object],
    progress: Callable[[float], None] | None = None,
    *,
    t_end: float | None = None,
    step: float | None = None,
    **solve: object,
) -> Solution:
    """Simulate a scenario or a machine once; arguments, result and errors are those of :func:`stribeck.simulate`."""
    if not isinstance(scenario, Scenario) or t_end is not None or step is not None or solve:
        from stribeck.scenario.objects import scenario_of  # a file that is run needs no objects

        scenario = scenario_of(scenario, t_end, step, **solve)
    started = perf_counter()
    built = backend.solver(scenario)
    for text in promise.doubts(scenario):
        note(text)
    for text in _remarks(scenario):
        note(text)

    def once(what: Scenario) -> Result:
        return built.solve(what, progress)

    result = counts.settled(scenario, once) if counts.reads_counts(scenario) else once(scenario)
    for text in result.remarks:
        note(text)
    result.stats.update({"backend": built.backend, "built": built.new, "build_seconds": built.seconds})
    result.stats["seconds"] = perf_counter() - started - built.seconds
    solution = Solution(scenario, result)
    if solution.reason is None:
        for each in scenario.elements.controllers.values():
            for text in each.remarks(solution, scenario.end):
                note(f"{scenario.name}: {text}")
    return solution


def _remarks(scenario: Scenario) -> list[str]:
    """Notes on values that are allowed but probably a mistake."""
    remarks, values = list[str](), scenario.elements.values
    if scenario.rows == 1:
        step, t_end = scenario.output.step, scenario.solve.t_end
        remarks.append(f"output.step: {step:g}: is longer than solve.t_end = {t_end:g}: the output is one row, t = 0")
    longest, most = scenario.elements.longest_step, scenario.solve.max_steps
    if (least := scenario.end / longest) > most:
        why = f"a signal's waves allow no step longer than {longest:.3g} s, and {least:.3g} would be needed"
        remarks.append(f"solve.max_steps: {most:g}: {why}: given up before t = {scenario.end * most / least:.3g} s")
    for contact in scenario.system.elements.contacts.values():
        law = scenario.elements.laws[contact.law_path].machine
        for i in range(len(contact.loads)):
            path = f"{contact.path}.loads.{i}"
            excess = values.get((path, "F_c"), 0.0) - values.get((path, "F_s"), 0.0)
            if excess > 0 and "F_s" in law:
                f = (law["F_s"] - law["F_c"]) / excess
                text = f"F_c grows more than F_s: from |force| = {f:.3g} on friction is less at rest than in motion"
                remarks.append(f"{path}: {text}")
    return remarks
