"""Whole recordings, followed from their beginnings on: as far as the numbers allow, then a little farther.

The cost of a whole recording has many minima where one slip more or less changes everything that comes after; up to
there it has one. So each recording is fitted as far as it is followed, which makes the numbers better, which makes it
followed farther, until its end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.actuator.solve import search
from stribeck.identify.work import Stopped

LEVELS = 16  # parts of a recording
_FOLLOWED = 0.1  # of a column's changes: a larger error is no longer followed
_CLOSELY = 0.02  # the same, where errors may grow fast
_FARTHER = 1.25
_ROUNDS = 24
_STUCK = 3
_STEPS, _MORE_STEPS = 3, 12
_SMALL = 1e-3


def continued(
    problem: MachineProblem, u: Array, keep: Callable[[Array, float], None] | None, careful: bool = False
) -> tuple[Array, float]:
    """The point from where whole recordings can be fitted, or the one that follows them farthest; and the share of them
    that is followed, 1 for all. ``careful``: part by part, each to its best
    numbers, as chaotic motion asks for.

    Raises:
        Stopped: Ctrl-C; what was found so far went to ``keep``.
    """
    parts: dict[tuple[int, int], RecordedRun] = {}
    limit, steps = (_CLOSELY, _MORE_STEPS) if careful else (_FOLLOWED, _STEPS)
    reached, stuck, best = _followed(problem, u, limit), 0, u
    most = np.ones(len(problem.runs)) if careful else np.full(len(problem.runs), float(LEVELS))
    for _ in range(_ROUNDS):
        if ((reached == LEVELS) & (most >= LEVELS)).all() or stuck == _STUCK:
            break
        most = np.minimum(np.ceil(_FARTHER * most), LEVELS)
        levels = np.minimum(np.maximum(np.ceil(_FARTHER * reached), reached + 1), most).astype(int)
        part = _until(problem, levels, parts)
        found = search(part, 1, 0, best, keep, steps=_MORE_STEPS if stuck else steps, small=_SMALL)
        if found.stopped:
            raise Stopped
        now = _followed(problem, found.u, limit)
        moved = now.sum() > reached.sum() or (careful and (now >= levels).all())
        reached, best, stuck = now, found.u, 0 if moved else stuck + 1
    return best, float(reached.mean()) / LEVELS


def _followed(problem: MachineProblem, u: Array, limit: float = _FOLLOWED) -> Array:
    """By run: how many of its parts are followed, at least one."""
    r = problem.residuals(u[None])[0]
    found = np.full(len(problem.runs), LEVELS)
    for k, run in enumerate(problem.runs):
        at = int(problem.first[k])
        for target in run.targets:
            most = limit * max(float(np.std(target.x)), 1e-300) / problem.noise[target.column]
            lost = np.flatnonzero(~(abs(r[at : at + len(target.t)]) <= most))
            if len(lost):
                share = target.t[lost[0]] / run.scenario.end
                found[k] = min(found[k], max(int(share * LEVELS), 1))
            at += len(target.t)
    return found


def _until(problem: MachineProblem, levels: Array, parts: dict[tuple[int, int], RecordedRun]) -> MachineProblem:
    """The problem with each run up to one of its parts."""
    runs = []
    for k, (run, level) in enumerate(zip(problem.runs, levels, strict=True)):
        if level == LEVELS:
            runs.append(run)
            continue
        if (k, level) not in parts:
            parts[k, level] = cut(run, int(level))
        runs.append(parts[k, level] if parts[k, level].size else run)
    return replace(problem, runs=runs)


def cut(run: RecordedRun, level: int) -> RecordedRun:
    """The first parts of a run."""
    step = run.scenario.output.step
    end = max(round(run.scenario.end * level / LEVELS / step), 2) * step
    targets = [t.rows(t.t <= end) for t in run.targets]
    return replace(
        run, scenario=run.scenario.with_changes({"solve.t_end": end}), targets=[t for t in targets if len(t.t)]
    )
