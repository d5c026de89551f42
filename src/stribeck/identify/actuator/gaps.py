"""Whether what drove the machine in gaps of a recording is known well enough."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.intervals import Spread
from stribeck.identify.actuator.problem import MachineProblem

_MOVES = 0.5  # deviations of a number, or of the noise


def unknown(problem: MachineProblem, u: Array, s: Spread | None = None) -> list[str]:
    """The recordings with gaps across which the inputs are not known well enough, in words: what may be wrong there would
    move a number by a good part of its deviation, or, without a spread, would be seen beside the noise."""
    told = []
    for k, run in enumerate(problem.runs):
        if run.otherwise is None or run.doubt <= 0:
            continue
        own = replace(
            problem, runs=[replace(run, scenario=run.otherwise)], noise=dict(problem.noise), tied=False, colours=()
        )
        rows = slice(problem.first[k], problem.first[k + 1])
        there = own.raw(u[None])[0][: run.size]
        off = run.doubt * (there - problem.raw(u[None])[0][rows])
        if s is None:
            much = float(np.sqrt(np.mean(off**2)))
            if not much > _MOVES:
                continue
            words = f"its outputs could be off by {much:.2g} times what is left"
        else:
            asked = [i for i, c in enumerate(problem.sought) if not c.nuisance]
            whole = np.zeros(problem.size)
            whole[rows] = off
            moves = s.moved_by(problem.whitened(whole))[asked]
            if not moves.max() > _MOVES:
                continue
            name = problem.sought[asked[int(np.argmax(moves))]].name
            words = f"{name} could be off by {moves.max():.2g} of its deviations"
        told.append(
            f"{run.name}: samples of its inputs are missing, and what can be told of them from those around is not enough: "
            f"{words}; leave out what follows the first long gap"
        )
    return told
