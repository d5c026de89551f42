"""Measured and simulated columns of fitted and predicted recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.guides import Guides
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.solve import search
from stribeck.identify.actuator.starts import prepared
from stribeck.identify.log import BEGIN, Trace
from stribeck.scenario import Scenario


def traces(
    scenario: Scenario, recording: Recording, log: int, sought: Sequence[MachineCoordinate], values: dict[str, float],
    bandwidth: float = 0.0,
) -> list[Trace]:  # fmt: skip
    """The measured and simulated columns of a recording; ``bandwidth``: of the guide that the simulation needs, rad/s.

    An initial state that was not fitted is fitted to the first samples.
    """
    chosen = [c for c in sought if c.log in (None, log)]
    guided = Guides(scenario, [(log, recording)]).at(bandwidth)
    (run,), starts = prepared(guided.scenario, guided.recordings, chosen)
    problem = MachineProblem([run], [*chosen, *starts], dict.fromkeys(recording.outputs, 1.0))
    u = _begun(problem, problem.point(values), {c.name for c in starts} - set(values))
    units = {c.name: c.unit for c in scenario.system.columns}
    return [
        Trace(target.column, units.get(target.column, ""), target.t, target.x, x[0])
        for target, x in zip(run.targets, problem.predicted(run, 0, u[None]), strict=True)
    ]


def _begun(problem: MachineProblem, u: Array, open_: set[str]) -> Array:
    """The point with the initial states ``open_`` fitted to the first samples of the recording."""
    u, run = u.copy(), problem.runs[0]
    states = [i for i, c in enumerate(problem.sought) if c.name in open_]
    if not states:
        return u
    values = problem.values(u)
    held = {
        path: scale * values[c.name]
        for i, c in enumerate(problem.sought) if i not in states for path, scale in c.targets.items()
    }  # fmt: skip
    sensors = [replace(c, low=values[c.name], high=values[c.name]) for c in problem.sought if c.output is not None]
    first = run.until(float(np.sort(np.concatenate([x.t for x in run.targets]))[: BEGIN * len(run.targets)][-1]))
    size = {t.column: float(np.std(t.x)) or 1.0 for t in run.targets}
    part = MachineProblem(
        [replace(first, start={**run.start, **held})], [*(problem.sought[i] for i in states), *sensors], size
    )
    u[states] = search(part, np.array([*u[states], *(0.0 for _ in sensors)])).u[: len(states)]
    return u
