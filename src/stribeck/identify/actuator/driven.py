"""Whether the noise of what drives the machine explains what is left: a simulation follows it, and slips and drift grow."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.runs import roughness

_ORDER = 6  # of the differences that are noise: an input may be fast
_EXPLAINS = 0.5  # of what is left


def otherwise_held(problem: MachineProblem) -> tuple[MachineProblem, str] | None:
    """The problem with its inputs held from sample to sample, or straight where all are held, and that in words; None
    where no input was recorded."""
    drives = [x for run in problem.runs for x in run.drives.values() if not x.spline]
    if not drives:
        return None
    held = not all(x.held for x in drives)
    runs = [
        run.driven({p: replace(x, held=held and not x.spline) for p, x in run.drives.items()}) for run in problem.runs
    ]
    words = "held from sample to sample (held = true)" if held else "straight from sample to sample (held = false)"
    return replace(problem, runs=runs, noise=dict(problem.noise), tied=False), words


def by_noise(problem: MachineProblem, u: Array) -> list[str]:
    """The recordings in which noise of the inputs, as large as what changes from sample to sample, moves the outputs as
    far as they are missed, in words."""
    rng, told = np.random.default_rng(0), []
    for k, run in enumerate(problem.runs):
        rough = {path: roughness([each.x], _ORDER) for path, each in run.drives.items()}
        if not rough:
            continue
        noisy = run.driven(
            {p: replace(each, x=each.x + rough[p] * rng.standard_normal(len(each.x))) for p, each in run.drives.items()}
        )
        own = replace(problem, runs=[noisy], noise=dict(problem.noise), tied=False)
        r = problem.residuals(u[None])[0][problem.first[k] : problem.first[k + 1]]
        off = own.residuals(u[None])[0][: run.size] - r
        if not np.linalg.norm(off) < _EXPLAINS * np.linalg.norm(r):
            worst = max(rough, key=lambda path: rough[path] / max(float(np.std(run.drives[path].x)), 1e-300))
            told.append(
                f"{run.name}: noise in its inputs ({worst}: {rough[worst]:.2g} from sample to sample) moves the simulated "
                "outputs as far as they are missed: short windows (window = 0.3) keep that from adding up"
            )
    return told[:1]
