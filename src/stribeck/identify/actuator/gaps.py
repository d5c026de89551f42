"""Whether what drove the machine in gaps of a recording is known well enough."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.intervals import Spread
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.runs import RecordedRun

_MOVES = 0.5  # deviations of a number, or of the noise


def unknown(problem: MachineProblem, u: Array, s: Spread | None = None) -> list[str]:
    """The recordings with gaps across which the inputs are not known well enough, in words: what may be wrong there would
    move a number by a good part of its deviation, or, without a spread, would be seen beside the noise."""
    told = []
    for k, run in enumerate(problem.runs):
        if not run.otherwise:
            continue
        rows = slice(problem.first[k], problem.first[k + 1])
        off = np.array([_off(problem, u, replace(run, scenario=each), rows) for each in run.otherwise])
        if s is None:
            much = float(np.sqrt(np.mean(off**2)))
            if not much > _MOVES:
                continue
            words = f"its outputs could be off by {much:.2g} times what is left"
        else:
            asked = [i for i, c in enumerate(problem.sought) if not c.nuisance]
            whole = np.zeros((len(off), problem.size))
            whole[:, rows] = off
            moves = np.sqrt(np.mean([s.moved_by(each)[asked] ** 2 for each in problem.whitened(whole)], axis=0))
            if not moves.max() > _MOVES:
                continue
            name = problem.sought[asked[int(np.argmax(moves))]].name
            words = f"{name} could be off by {moves.max():.2g} of its deviations"
        told.append(
            f"{run.name}: samples of its inputs are missing, and what can be told of them from those around is not enough: "
            f"{words}; leave out what follows the first long gap"
        )
    return told


def _off(problem: MachineProblem, u: Array, other: RecordedRun, rows: slice) -> Array:
    """How far the residuals of a run are off where its inputs are wrong in gaps by as much as they may be."""
    own = replace(problem, runs=[other], noise=dict(problem.noise), tied=False, colours=())
    there = own.raw(u[None])[0][: other.size]
    return np.asarray(other.doubt * (there - problem.raw(u[None])[0][rows]))
