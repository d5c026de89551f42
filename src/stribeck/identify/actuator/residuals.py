"""The residuals of a problem by column, and the noise of the measured columns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.runs import least_step, rms
from stribeck.identify.actuator.whitening import prediction_filter
from stribeck.identify.core.judging import EXPLAINED
from stribeck.identify.features.filtering import roughness

_FIRST = 0.05  # of a column's changes: initial value of the noise, between that of good and of poor models
_GIVEN = 1.5  # times a given noise: the least residual that takes its place


def first_noise(recordings: Sequence[Recording]) -> tuple[dict[str, float], frozenset[str]]:
    """The initial value of each column's noise, and the columns whose noise is given."""
    noise: dict[str, float] = {}
    given: set[str] = set()
    for column in dict.fromkeys(c for r in recordings for c in r.outputs):
        channels = [r.outputs[column] for r in recordings if column in r.outputs]
        known = [c.noise for c in channels if c.noise is not None]
        if known:
            noise[column] = float(np.sqrt(np.mean(np.square(known))))
            given.add(column)
        else:
            size = float(np.sqrt(np.mean([np.nanvar(c.x) for c in channels])))
            noise[column] = _FIRST * size if size > 0 else 1.0
    return noise, frozenset(given)


def noise_of(problem: MachineProblem, column: str) -> float:
    """The noise of a column, from its changes between samples."""
    rough = roughness([t.x for _, t, _ in problem.pieces if t.column == column])
    return max(rough, floor_of(problem, column))


def floor_of(problem: MachineProblem, column: str) -> float:
    """The least noise of a column: its quantization noise."""
    steps = [least_step(t.x) for _, t, _ in problem.pieces if t.column == column]
    return float(min(filter(None, steps), default=0.0) / np.sqrt(12))


def by_column(problem: MachineProblem, r: Array) -> dict[str, list[Array]]:
    """Plain residuals in the columns' units, by column and run."""
    columns: dict[str, list[Array]] = {}
    for _, target, rows in problem.pieces:
        columns.setdefault(target.column, []).append(r[rows] * problem.noise[target.column])
    return columns


def leftovers(problem: MachineProblem, u: Array) -> dict[str, tuple[float, float]]:
    """By column: the rms residual, and the rms of the column's changes within a recording."""
    left = by_column(problem, problem.plain(u[None])[0])
    size: dict[str, list[Array]] = {}
    for _, target, _ in problem.pieces:
        size.setdefault(target.column, []).append(target.x - target.x.mean())
    return {name: (rms(parts), rms(size[name])) for name, parts in left.items()}


def weigh(problem: MachineProblem, u: Array, white: bool = True) -> None:
    """Set the noise of each column to its residual, unless the noise is given and not much smaller.

    Args:
        white: also whiten the residual. If the model should describe it, or the search has not reduced it yet, it is no
            noise, and prediction would hide it.
    """
    share = problem.size / max(problem.size - len(problem.sought), 1)
    columns = by_column(problem, problem.plain(u[None])[0])
    for column, (left, size) in leftovers(problem, u).items():
        noise = left * np.sqrt(min(share, 2.0))
        if not np.isfinite(noise) or (column in problem.known_noise and noise < _GIVEN * problem.noise[column]):
            continue
        problem.noise[column] = max(float(noise), floor_of(problem, column), 1e-12)
        random = [x / problem.noise[column] for x in columns[column]] if white and left <= EXPLAINED * size else []
        problem.whitening[column] = prediction_filter(random)
