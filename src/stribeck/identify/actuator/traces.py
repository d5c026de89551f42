"""Measured and simulated columns of fitted and predicted recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate, paths
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.result import Trace
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.actuator.solve import search
from stribeck.identify.actuator.starts import prepared
from stribeck.scenario import Scenario

_BEGIN = 24  # samples to which the initial state of a predicted recording is fitted


def traces(
    scenario: Scenario, recording: Recording, log: int, sought: Sequence[MachineCoordinate], values: dict[str, float],
    window: float | None = None, fitted: Sequence[RecordedRun] = (),
) -> list[Trace]:  # fmt: skip
    """The measured and simulated columns of a recording, whole or in stretches.

    Stretches of ``fitted`` begin in the same states. An initial state that was not fitted is fitted to the first samples.
    """
    chosen = [c for c in sought if c.log in (None, log)]
    named = {c.name for c in chosen} | paths(chosen)
    runs, own = prepared(scenario, [(log, recording)], named, window)
    shifts = {(run.log, run.piece): run.shift for run in fitted}
    runs = [replace(run, shift=shifts.get((run.log, run.piece), {})) for run in runs]
    problem = MachineProblem(runs, [*chosen, *own], dict.fromkeys(recording.outputs, 1.0))
    u = _begun(problem, problem.point(values), {c.name for c in own} - set(values))
    parts: dict[str, list[tuple[Array, Array, Array]]] = {}
    for k, run in enumerate(problem.runs):
        at = float(run.piece) if run.piece is not None else 0.0
        for target, x in zip(run.targets, problem.predicted(run, k, u[None]), strict=True):
            parts.setdefault(target.column, []).append((target.t + at, target.x, x[0]))
    found = []
    for column, pieces in parts.items():
        t, x, p = (np.concatenate([piece[i] for piece in pieces]) for i in range(3))
        found.append(Trace(column, unit_of(scenario, column), t, x, p))
    return found


def _begun(problem: MachineProblem, u: Array, open_: set[str]) -> Array:
    """The point with the initial states ``open_`` fitted to the first samples of their recording or stretch."""
    u = u.copy()
    for k, run in enumerate(problem.runs):
        concerned = [(i, problem.sought[i]) for i in np.flatnonzero(problem.concerns[k])]
        mine = [i for i, c in concerned if c.name in open_]
        if not mine:
            continue
        values = problem.values(u)
        held = {
            path: scale * values[c.name] for i, c in concerned if i not in mine for path, scale in c.targets.items()
        }
        sensors = [replace(c, low=values[c.name], high=values[c.name]) for _, c in concerned if c.output is not None]
        first = run.until(float(np.sort(np.concatenate([x.t for x in run.targets]))[: _BEGIN * len(run.targets)][-1]))
        size = {t.column: float(np.std(t.x)) or 1.0 for t in run.targets}
        part = MachineProblem(
            [replace(first, start={**run.start, **held})], [*(problem.sought[i] for i in mine), *sensors], size
        )
        u[mine] = search(part, 1, 0, np.array([*u[mine], *(0.0 for _ in sensors)])).u[: len(mine)]
    return u


def unit_of(scenario: Scenario, column: str) -> str:
    """The unit of a machine's column."""
    return next((c.unit for c in scenario.system.columns if c.name == column), "")
