"""Fits whole recordings by continuation: first only the described beginning of each, then longer and longer parts.

One slip more or less changes all later samples, so the cost of a whole recording has many local minima. The cost of its
beginning has one. Each fit improves the parameters, and the simulation then follows a longer part.
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
_FOLLOWED = 0.1  # of a column's changes: with a larger error, the simulation no longer follows the recording
_CLOSELY = 0.02  # the same, if errors may grow fast
_FARTHER = 1.25
_ROUNDS = 24
_STUCK = 3
_STEPS, _MORE_STEPS = 3, 12
_SMALL = 1e-3


def continued(
    problem: MachineProblem, u: Array, keep: Callable[[Array, float], None] | None, careful: bool = False
) -> tuple[Array, float]:
    """The point that follows the recordings farthest, and the followed share of them (1: all).

    ``careful``: converge on each part before the next, for chaotic motion.

    Raises:
        Stopped: Ctrl-C; the best point so far was passed to ``keep``.
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
    """The number of parts that the simulation follows in each run, at least one."""
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
    """The problem with each run cut after the given number of parts."""
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
    """The first ``level`` parts of a run."""
    step = run.scenario.output.step
    end = max(round(run.scenario.end * level / LEVELS / step), 2) * step
    targets = [t.rows(t.t <= end) for t in run.targets]
    return replace(
        run, scenario=run.scenario.with_changes({"solve.t_end": end}), targets=[t for t in targets if len(t.t)]
    )
