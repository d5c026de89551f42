"""Covariance of a fit of the motion by how windows, or stretches, of the record differ; and whether a residual drifts.

What a noisy force does to a position grows along a window, and a sensor's drift goes on over many: a model of the noise
from one row to the next sees neither.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.fft import dct
from scipy.stats import chi2
from scipy.stats import t as student

from stribeck.arrays import Array
from stribeck.identify.models.motion_problem import MotionProblem
from stribeck.identify.models.problem import Problem
from stribeck.identify.statistics.clusters import by_speed, half_widths, without_each
from stribeck.identify.statistics.profiles import THRESHOLD

_FEWEST_WINDOWS = 8  # beyond the number of constants
_BLOCKS = 40  # stretches of a record as clusters
_LOWEST, _SURE = 8, 0.95  # cosines of a window, of which a drift has the most; chance that white noise has less in them


def by_windows(problem: MotionProblem, slopes: Array, misfit: Array, otherwise: Array) -> Array:
    """The covariance with windows as clusters; ``otherwise`` where there are too few."""
    if len(problem.windows) < problem.shared + _FEWEST_WINDOWS:
        return otherwise
    return without_each(slopes, misfit, problem.parts, problem.shared) / THRESHOLD


def at_least_by_blocks(problem: MotionProblem, slopes: Array, misfit: Array, inner: Array) -> Array:
    """The covariance, raised for the constants whose variance is larger with stretches of the record as clusters: a model
    of the residuals' memory does not see a sensor that drifts."""
    count = max(problem.shared + _FEWEST_WINDOWS, _BLOCKS)
    rows = len(misfit)
    if rows < 10 * count:
        return inner
    edges = np.linspace(0, rows, count + 1).astype(int).tolist()
    by_blocks = sandwich(problem, slopes, misfit, [slice(a, b) for a, b in pairwise(edges)])
    more = np.sqrt(np.maximum(np.diag(by_blocks) / np.maximum(np.diag(inner), 1e-300), 1.0))
    more[problem.shared :] = 1.0
    return np.asarray(inner * np.outer(more, more))


def at_least_by_speed(problem: Problem, slopes: Array, misfit: Array, v: Array, inner: Array) -> Array:
    """The covariance of a fit of the force that leaves more than noise, raised for the constants that bands of speed tell
    apart: what the law lacks, or nobody sampled, hangs on the speed, and a model of the residuals' memory does not see it."""
    half = half_widths(slopes, misfit, by_speed(v, np.ones(len(v))), False)
    more = np.maximum(half / np.sqrt(THRESHOLD * np.maximum(np.diag(inner), 1e-300)), 1.0)
    more[[c.nuisance for c in problem.coordinates]] = 1.0
    with np.errstate(over="ignore"):  # told by nothing: infinite
        return np.asarray(inner * np.outer(more, more))


def sandwich(problem: MotionProblem, slopes: Array, misfit: Array, clusters: Sequence[slice]) -> Array:
    """The covariance of least squares whose errors are alike within a cluster in a way that nobody knows, with Student's
    quantile for their number."""
    count = len(clusters)
    size = np.maximum(np.sqrt(np.mean(slopes**2, axis=0)), 1e-300)
    scaled = slopes / size
    normal = scaled.T @ scaled
    inverse = np.linalg.inv(normal + 1e-14 * np.trace(normal) * np.eye(len(normal)))
    scores = np.array([scaled[part].T @ misfit[part] for part in clusters])
    left = count - problem.shared
    wider = count / left * (student.ppf(0.975, left) / np.sqrt(THRESHOLD)) ** 2
    return np.asarray(wider * inverse @ (scores.T @ scores) @ inverse / np.outer(size, size))


def drifts(misfit: Array, parts: Sequence[slice]) -> bool:
    """Whether the lowest cosines of the windows' residuals have more in them than white noise of their size has."""
    level, found, freedom = float(np.mean(misfit**2)), 0.0, 0
    for part in parts:
        if part.stop - part.start > 4 * _LOWEST:
            found += float(np.sum(dct(misfit[part], norm="ortho")[1 : _LOWEST + 1] ** 2))
            freedom += _LOWEST
    return bool(freedom and found > level * chi2.ppf(_SURE, freedom))
