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
from stribeck.identify.statistics.clusters import by_speed, half_widths
from stribeck.identify.statistics.profiles import THRESHOLD

_FEWEST_WINDOWS = 8  # beyond the number of constants
_BLOCKS = 40  # stretches of a record as clusters
_LOWEST, _SURE = 8, 0.95  # cosines of a window, of which a drift has the most; chance that white noise has less in them
_LOST = 1e-12  # of the largest eigenvalue: a direction that nothing is left of


def by_windows(problem: MotionProblem, slopes: Array, misfit: Array, otherwise: Array) -> Array:
    """The covariance with windows as clusters; ``otherwise`` where there are too few."""
    if len(problem.windows) < problem.shared + _FEWEST_WINDOWS:
        return otherwise
    return jackknife(slopes, misfit, problem.parts)


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


def jackknife(slopes: Array, misfit: Array, clusters: Sequence[slice]) -> Array:
    """The covariance by what the estimate is without each cluster. A few windows that tell the most draw the optimum to
    themselves, so that their residuals, and with them a sandwich, come out too small; and they count as few, whatever the
    number of windows: Student's quantile is for the freedom that the contributions would have if the noise were white
    (Bell and McCaffrey, Survey Methodology 28(2):169-181, 2002; Hansen, arXiv:2208.07445)."""
    size = np.maximum(np.sqrt(np.mean(slopes**2, axis=0)), 1e-300)
    scaled, count = slopes / size, len(clusters)
    grams = [scaled[part].T @ scaled[part] for part in clusters]
    whole = np.sum(grams, axis=0)
    inverse = np.linalg.pinv(whole, rcond=_LOST, hermitian=True)
    moved, due = np.empty((count, len(size))), np.empty((count, len(size)))
    for i, (part, gram) in enumerate(zip(clusters, grams, strict=True)):
        without = np.linalg.pinv(whole - gram, rcond=_LOST, hermitian=True)
        moved[i] = without @ (scaled[part].T @ misfit[part])
        due[i] = np.einsum("ij,jk,ki->i", without, gram - gram @ inverse @ gram, without)
    due = np.maximum(due, 0.0)
    freedom = np.sum(due, axis=0) ** 2 / np.maximum(np.sum(due**2, axis=0), 1e-300)
    wider = student.ppf(0.975, np.clip(freedom, 1.0, count - 1)) / np.sqrt(THRESHOLD) / size
    return np.asarray((count - 1) / count * (moved.T @ moved) * np.outer(wider, wider))


def drifts(misfit: Array, parts: Sequence[slice]) -> bool:
    """Whether the lowest cosines of the windows' residuals have more in them than white noise of their size has."""
    level, found, freedom = float(np.mean(misfit**2)), 0.0, 0
    for part in parts:
        if part.stop - part.start > 4 * _LOWEST:
            found += float(np.sum(dct(misfit[part], norm="ortho")[1 : _LOWEST + 1] ** 2))
            freedom += _LOWEST
    return bool(freedom and found > level * chi2.ppf(_SURE, freedom))
