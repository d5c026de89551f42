"""The friction level of each file of a log, and what the fit without that file predicts for it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from stribeck.arrays import Array
from stribeck.identify.details import FileLevel
from stribeck.identify.methods.static_start import StaticModel
from stribeck.identify.models.separable import Minimum, Separable
from stribeck.identify.models.static_problem import Rows
from stribeck.identify.models.terms import TERMS, column
from stribeck.identify.statistics.clusters import BLOCKS
from stribeck.identify.statistics.correlated import covariance, noise_memory

_NORMAL = 1.96
_FEWEST_ROWS = 30
_BEYOND_LEVELS = 0.1  # of a column's size: less than this beside a level for each file is told by nothing


def levels(rows: Rows, model: StaticModel, solution: Minimum) -> list[FileLevel]:
    """The level F_c of each file on its own, and as the law predicts it from the others, with 95 % intervals.

    All files share the rest of the model: a pressure's area, the offset, viscous friction. What the levels scatter by about
    the law is part of their intervals: a file measured again would differ by as much. Empty where there is one file, where
    the law has no F_c, or where friction and offset cannot be told apart.
    """
    log, whole = rows.log, model.whole
    files = list(dict.fromkeys(log.files))
    if len(files) < 2 or "F_c" not in whole.wanted or "F_c" not in whole.columns.names or "offset" in model.unseen:
        return []
    of_row = np.array([files.index(f) for f in log.files])[log.run]
    part = np.where(rows.weight > 0, of_row[rows.kept], -1)
    there = [k for k in range(len(files)) if int(np.sum(part == k)) >= _FEWEST_ROWS]
    own, spread = _own(whole, solution.values, part, there)
    varying = [n for n in whole.terms if TERMS[n].level]
    found: list[FileLevel] = []
    for i, k in enumerate(there):
        means = {n: float(np.mean(column(n, log, {})[of_row == k])) for n in varying}
        row: FileLevel = {
            "file": files[k],
            "level": float(own[i]),
            "at": means,
            "rows": int(np.sum(of_row == k)),
        }
        if len(there) > 2:
            row |= _predicted(whole, solution, part == k, means)
        found.append(row)
    _with_intervals(found, spread, 1 + len(varying))
    return found


def _with_intervals(found: list[FileLevel], spread: Array, numbers: int) -> None:
    """Ends of each level: its own spread, and the scatter of all levels about what the others predict."""
    missed = np.array([r["level"] - r["predicted"] for r in found if "predicted" in r])
    free = len(missed) - numbers
    scatter, factor = 0.0, _NORMAL
    if free > 0:
        noise = float(np.mean(spread**2))
        leverage = free / len(missed)  # a prediction without the file errs more than a fit with it
        scatter = max(float(np.mean(missed**2)) * leverage - noise, 0.0)
        factor = float(student.ppf(0.975, free)) if scatter > noise else _NORMAL
    for row, own in zip(found, spread.tolist(), strict=True):
        half = factor * float(np.sqrt(own**2 + scatter))
        row |= {"low": row["level"] - half, "high": row["level"] + half}
        if "predicted" in row:
            half = float(np.hypot(row.pop("spread") * _NORMAL, factor * np.sqrt(scatter)))
            row |= {"predicted_low": row["predicted"] - half, "predicted_high": row["predicted"] + half}


def _own(
    whole: Separable, values: Mapping[str, float], part: NDArray[np.intp], there: list[int]
) -> tuple[Array, Array]:
    """A level for each file, everything else shared, and their standard deviations."""
    columns = whole.columns.at(values, whole.terms)
    sign = columns["F_c"] + columns.get("F_s", 0.0)
    rest = whole.force.copy()
    shared = []
    for name, x in columns.items():
        if name == "F_s":  # what F_s is above F_c keeps its share
            rest -= (values["F_s"] - values["F_c"]) * x
        elif name in (*whole.wanted, *whole.free) and name != "F_c" and not (name in TERMS and TERMS[name].level):
            if values[name] != 0 and _told_beside(sign, x, part, there):
                shared.append(x)
            else:
                rest -= values[name] * x
        elif name not in whole.free and name != "F_c":
            rest -= values[name] * x
    matrix = np.column_stack([*(sign * (part == k) for k in there), *shared])
    w = np.where(np.isin(part, there), whole.weight, 0.0)
    solution = np.linalg.lstsq(w[:, None] * matrix, w * rest, rcond=1e-12)[0]
    missed = w * (rest - matrix @ solution)
    slopes = w[:, None] * matrix
    variance = float(missed @ missed) / max(int((w > 0).sum()) - matrix.shape[1], 1)
    noise = np.sqrt(np.maximum(np.diag(covariance(slopes, variance, noise_memory(missed))), 0.0))[: len(there)]
    return solution[: len(there)], np.maximum(noise, [_in_blocks(sign, missed, w * (part == k)) for k in there])


def _told_beside(sign: Array, x: Array, part: NDArray[np.intp], there: list[int]) -> bool:
    """Whether a column is more than a level for each file: an offset is not, where each file goes one way."""
    left = np.where(np.isin(part, there), x, 0.0)
    size = float(left @ left)
    for k in there:
        s = sign * (part == k)
        left -= s * (float(s @ left) / max(float(s @ s), 1e-300))
    return float(left @ left) > _BEYOND_LEVELS**2 * size


def _in_blocks(sign: Array, missed: Array, w: Array) -> float:
    """The standard deviation of a level by what blocks of its file differ."""
    inside = np.flatnonzero(w > 0)
    s, r = sign[inside] * w[inside], missed[inside]
    block = np.arange(len(s)) * BLOCKS // max(len(s), 1)
    scores = np.bincount(block, s * r)
    return float(np.sqrt(BLOCKS / (BLOCKS - 1) * np.sum(scores**2)) / max(float(s @ s), 1e-300))


def _predicted(whole: Separable, solution: Minimum, out: NDArray[np.bool_], means: Mapping[str, float]) -> FileLevel:
    """The level that the fit to the other files gives for this one, at the same shape of the curve."""
    from stribeck.identify.statistics.linear import linearised

    training = whole.weighted(np.where(out, 0.0, whole.weight))
    found = training.solve({s.name: solution.values[s.name] for s in whole.shapes})
    at, values = linearised(training, found), found.values
    rows = int((training.weight > 0).sum())
    variance = float(at.misfit @ at.misfit) / max(rows - len(at.names), 1)
    inner = covariance(at.slopes, variance, noise_memory(at.misfit[training.weight > 0]))
    by = np.zeros(len(at.names))
    for k, name in enumerate(at.names):
        factor = 1.0 if name == "F_c" else means.get(name, 0.0)
        by[k] = factor * (at.values[k] if at.log[k] else 1.0)
    level = values["F_c"] + sum(values[n] * mean for n, mean in means.items())
    return {"predicted": float(level), "spread": float(np.sqrt(max(float(by @ inner @ by), 0.0)))}
