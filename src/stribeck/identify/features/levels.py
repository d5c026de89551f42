"""The friction level of each file of a log, and what the fit without that file predicts for it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.identify.log import Log
from stribeck.identify.methods.optimise import descend
from stribeck.identify.models.static_problem import StaticProblem, kept_rows
from stribeck.identify.models.terms import TERMS
from stribeck.identify.statistics.uncertainty import covariance, noise_memory

Array = NDArray[np.float64]
_NORMAL = 1.96


def levels(problem: StaticProblem, u: Array, log: Log, q: int) -> list[dict[str, Any]]:
    """The level F_c of each file on its own, and as the law predicts it from the others, with 95 % intervals.

    All files share the rest of the model: a pressure's area, the offset, viscous friction. Empty where there is one file,
    or where the law has no F_c.
    """
    files = list(dict.fromkeys(log.files))
    if len(files) < 2 or "F_c" not in problem.names:
        return []
    part = np.array([files.index(f) for f in log.files])[log.run[kept_rows(log, q)]]
    values = problem.values(u)
    own, spread = _own(problem, values, part, len(files))
    varying = [n for n in problem.terms if TERMS[n].level]
    found = []
    for k, name in enumerate(files):
        row: dict[str, Any] = {
            "file": name, "level": own[k], "low": own[k] - _NORMAL * spread[k], "high": own[k] + _NORMAL * spread[k]
        }  # fmt: skip
        at = np.array([files.index(f) for f in log.files])[log.run] == k
        means = {n: float(np.mean(_column(n, log)[at])) for n in varying}
        row |= {"at": means, "rows": int(at.sum())}
        if len(files) > 2:
            row |= _predicted(problem, u, part == k, means)
        found.append(row)
    return found


def _column(name: str, log: Log) -> Array:
    column = TERMS[name].column
    assert column is not None
    return column(log)


def _own(
    problem: StaticProblem, values: Mapping[str, float], part: NDArray[np.intp], count: int
) -> tuple[Array, Array]:
    """A level for each file, everything else shared, and their standard deviations."""
    columns = problem.columns_at(values)
    sign = columns["F_c"] + columns.get("F_s", 0.0)
    rest = problem.force.copy()
    shared = []
    free = {c.name for c in problem.coordinates}
    for name, column in columns.items():
        if name == "F_s":  # what F_s is above F_c keeps its share
            rest -= (values["F_s"] - values["F_c"]) * column
        elif name in free and name != "F_c" and not (name in TERMS and TERMS[name].level):
            shared.append(column)
        elif name not in free:
            rest -= values[name] * column
    matrix = np.column_stack([*(sign * (part == k) for k in range(count)), *shared])
    weight = problem.weight[:, None]
    solution = np.linalg.lstsq(weight * matrix, problem.weight * rest, rcond=1e-12)[0]
    missed = problem.weight * (rest - matrix @ solution)
    variance = float(missed @ missed) / max(len(missed) - matrix.shape[1], 1)
    inner = covariance(weight * matrix, variance, noise_memory(missed))
    return solution[:count], np.sqrt(np.diag(inner))[:count]


def _predicted(
    problem: StaticProblem, u: Array, out: NDArray[np.bool_], means: Mapping[str, float]
) -> dict[str, float]:
    """The level that the fit to the other files gives for this one."""
    training = problem.reweighted(np.where(out, 0.0, problem.weight))
    there = descend(training, u, 1e-8, 20).point
    values, slopes, misfit = training.values(there), training.sensitivities(there), training.misfit(there)
    assert slopes is not None
    assert misfit is not None
    variance = float(misfit @ misfit) / max(int((~out).sum()) - len(u), 1)
    inner = covariance(slopes, variance, noise_memory(misfit[~out]))
    names = [c.name for c in training.coordinates]
    by = np.zeros(len(names))
    for k, c in enumerate(training.coordinates):
        if c.name == "F_c":
            by[k] = values["F_c"] if c.log else c.scale
        elif c.name in means:
            by[k] = means[c.name] * (values[c.name] if c.log else c.scale)
    level = values["F_c"] + sum(values[n] * mean for n, mean in means.items())
    spread = _NORMAL * float(np.sqrt(by @ inner @ by))
    return {"predicted": level, "predicted_low": level - spread, "predicted_high": level + spread}
