"""Measured and simulated columns of fitted and predicted recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.result import Trace
from stribeck.identify.actuator.runs import FIRST_SAMPLES, RecordedRun
from stribeck.identify.actuator.solve import search
from stribeck.identify.actuator.starts import prepared
from stribeck.scenario import Scenario

BEGIN = 2 * FIRST_SAMPLES  # to which the initial state of a predicted recording is fitted


def traces(
    scenario: Scenario, recording: Recording, log: int, sought: Sequence[MachineCoordinate], values: dict[str, float],
    window: float | None = None, fitted: Sequence[RecordedRun] = (),
) -> list[Trace]:  # fmt: skip
    """The measured and simulated columns of a recording, whole or in stretches.

    Stretches of ``fitted`` begin in the same states. An initial state that was not fitted is fitted to the first samples.
    """
    chosen = [c for c in sought if c.log in (None, log)]
    runs, starts = prepared(scenario, [(log, recording)], chosen, window)
    shifts = {(run.log, run.piece): run.shift for run in fitted}
    runs = [replace(run, shift=shifts.get((run.log, run.piece), {})) for run in runs]
    problem = MachineProblem(runs, [*chosen, *starts], dict.fromkeys(recording.outputs, 1.0))
    u = _begun(problem, problem.point(values), {c.name for c in starts} - set(values))
    columns: dict[str, list[tuple[Array, Array, Array]]] = {}
    for k, run in enumerate(problem.runs):
        for target, x in zip(run.targets, problem.predicted(run, k, u[None]), strict=True):
            columns.setdefault(target.column, []).append((target.t + run.begin, target.x, x[0]))
    units = {c.name: c.unit for c in scenario.system.columns}
    return [
        Trace(column, units.get(column, ""), *(np.concatenate(parts) for parts in zip(*pieces, strict=True)))
        for column, pieces in columns.items()
    ]


def _begun(problem: MachineProblem, u: Array, open_: set[str]) -> Array:
    """The point with the initial states ``open_`` fitted to the first samples of their recording or stretch."""
    u = u.copy()
    for k, run in enumerate(problem.runs):
        concerned = [(i, problem.sought[i]) for i in np.flatnonzero(problem.concerns[k])]
        states = [i for i, c in concerned if c.name in open_]
        if not states:
            continue
        values = problem.values(u)
        held = {
            path: scale * values[c.name] for i, c in concerned if i not in states for path, scale in c.targets.items()
        }
        sensors = [replace(c, low=values[c.name], high=values[c.name]) for _, c in concerned if c.output is not None]
        first = run.until(float(np.sort(np.concatenate([x.t for x in run.targets]))[: BEGIN * len(run.targets)][-1]))
        size = {t.column: float(np.std(t.x)) or 1.0 for t in run.targets}
        part = MachineProblem(
            [replace(first, start={**run.start, **held})], [*(problem.sought[i] for i in states), *sensors], size
        )
        u[states] = search(part, np.array([*u[states], *(0.0 for _ in sensors)])).u[: len(states)]
    return u
