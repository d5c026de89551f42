"""Whether the noise of what drives the machine explains what is left: a simulation follows it, and slips and drift grow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.runs import RecordedRun, roughness

_RECORDED = 8  # values of a signal: fewer were not recorded
_ORDER = 6  # of the differences that are noise: an input may be fast
_EXPLAINS = 0.5  # of what is left


def recorded_inputs(run: RecordedRun) -> Iterator[tuple[str, Array]]:
    """The signals that were recorded: path and values."""
    for use in run.scenario.rig.signals:
        table: object = run.scenario.data
        for word in use.path.split("."):
            table = table.get(word, {}) if isinstance(table, dict) else {}
        values = table.get("value") if isinstance(table, dict) else None
        if isinstance(values, list) and len(values) > _RECORDED:
            yield use.path, np.asarray(values, float)


def by_noise(problem: MachineProblem, u: Array) -> list[str]:
    """The recordings in which noise of the inputs, as large as what changes from sample to sample, moves the outputs as
    far as they are missed, in words."""
    rng, told = np.random.default_rng(0), []
    for k, run in enumerate(problem.runs):
        inputs = dict(recorded_inputs(run))
        rough = {path: roughness([x], _ORDER) for path, x in inputs.items()}
        changes = {f"{p}.value": (x + rough[p] * rng.standard_normal(len(x))).tolist() for p, x in inputs.items()}
        if not changes:
            continue
        noisy = replace(run, scenario=run.scenario.with_changes(changes))
        own = replace(problem, runs=[noisy], noise=dict(problem.noise), tied=False)
        r = problem.residuals(u[None])[0][problem.first[k] : problem.first[k + 1]]
        off = own.residuals(u[None])[0][: run.size] - r
        if not np.linalg.norm(off) < _EXPLAINS * np.linalg.norm(r):
            worst = max(rough, key=lambda path: rough[path] / max(float(np.std(inputs[path])), 1e-300))
            told.append(
                f"{run.name}: noise in its inputs ({worst}: {rough[worst]:.2g} from sample to sample) moves the simulated "
                "outputs as far as they are missed: short windows (window = 0.3) keep that from adding up"
            )
    return told[:1]
