"""Covariance of least squares whose errors hang together within parts of a record: files, blocks in time, bands of speed.

Residuals of one file, or of one stretch, err together (temperature, lubrication, what the law lacks), which a model of the
noise from one row to the next does not see. Over files, and over blocks of one record, it is the jackknife: what the estimate
is without each of them (Cameron, Miller, Journal of Human Resources 50(2):317-372, 2015, CV3).
Over bands of speed the sandwich shows what a wrong form of the law does: its residuals then err together at one speed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from stribeck.arrays import Array

Groups = NDArray[np.intp]
_LITTLE, _ROUNDING = 1e-12, 1e-14  # of all that is known: a direction of which nothing is
_BANDS = 8


def _dense(number: Groups) -> Groups:
    return np.unique(number, return_inverse=True)[1].astype(np.intp)


def by_speed(v: Array, weight: Array, count: int = _BANDS) -> Groups:
    """Bands of the signed speed that hold alike many of the rows that count."""
    inside = v[weight > 0]
    edges = np.unique(np.quantile(inside, np.linspace(0, 1, count + 1)[1:-1]))
    return _dense(np.searchsorted(edges, v).astype(np.intp))


def half_widths(slopes: Array, misfit: Array, parts: Groups, jackknife: bool) -> Array:
    """Half of the 95 % interval of each coefficient, by what parts of the rows differ: by the jackknife, or the sandwich."""
    order = np.argsort(parts, kind="stable")
    found = np.split(order, np.searchsorted(parts[order], np.arange(1, int(parts.max()) + 1)))
    kept = [rows for rows in found if len(rows) and np.any(slopes[rows])]
    if len(kept) < 2:
        return np.zeros(slopes.shape[1])
    if jackknife:
        return np.asarray(np.sqrt(np.diag(without_each(slopes, misfit, kept, freedom=len(kept) - 1))))
    size = sizes(slopes)
    a = slopes / size
    little = _LITTLE * float(np.sum(a**2)) * np.eye(len(size))
    scores = np.array([a[rows].T @ misfit[rows] for rows in kept])
    moved = scores @ np.linalg.inv(a.T @ a + little)
    variance = len(kept) / (len(kept) - 1) * np.sum(moved**2, axis=0)
    return np.asarray(float(student.ppf(0.975, len(kept) - 1)) * np.sqrt(variance) / size)


def without_each(
    slopes: Array, misfit: Array, parts: Sequence[slice | Groups], shared: int | None = None, freedom: int | None = None
) -> Array:
    """The covariance by what the estimate is without each part, times the square of the quantile of a 95 % interval.

    Parts that tell the most draw the optimum to themselves, so that their residuals, and with them a sandwich, come out too
    small.

    Args:
        slopes, misfit: of the model, row by row.
        parts: the rows of each.
        shared: how many of the coefficients, the first ones, belong to all parts; the others, to one part each. All unless
            given. One of which the other parts say nothing gets a variance that is huge, and finite.
        freedom: of Student's quantile. Unless given it is what the contributions would have if the noise were white, as parts
            that tell the most count as few, whatever their number (Bell and McCaffrey, Survey Methodology 28(2):169-181,
            2002; Hansen, arXiv:2208.07445).
    """
    count, left = len(parts), _left_out(slopes, misfit, parts, shared)
    seen = np.clip(np.sum(left.due, axis=0) ** 2 / np.maximum(np.sum(left.due**2, axis=0), 1e-300), 1.0, count - 1)
    wider = student.ppf(0.975, seen if freedom is None else freedom) / left.size
    return np.asarray((count - 1) / count * (left.moved.T @ left.moved) * np.outer(wider, wider))


@dataclass(frozen=True)
class _LeftOut:
    """By how much each coefficient moves without each part, and the square of that as white noise of variance 1 would have it,
    in units of ``size``; ``inverse``: the covariance that such noise makes."""

    moved: Array
    due: Array
    inverse: Array
    size: Array


def _left_out(slopes: Array, misfit: Array, parts: Sequence[slice | Groups], shared: int | None = None) -> _LeftOut:
    size = sizes(slopes)
    scaled, count = slopes / size, len(parts)
    grams = [scaled[part].T @ scaled[part] for part in parts]
    whole = np.sum(grams, axis=0)
    inverse = np.linalg.pinv(whole, rcond=_LITTLE, hermitian=True)
    little = np.where(np.arange(len(size)) < (len(size) if shared is None else shared), _LITTLE * np.trace(whole), 0.0)
    moved, due = np.empty((count, len(size))), np.empty((count, len(size)))
    for i, (part, gram) in enumerate(zip(parts, grams, strict=True)):
        without = np.linalg.pinv(whole - gram + np.diag(little), rcond=_ROUNDING, hermitian=True)
        moved[i] = without @ (scaled[part].T @ misfit[part])
        due[i] = np.einsum("ij,jk,ki->i", without, gram - gram @ inverse @ gram, without)
    return _LeftOut(moved, np.maximum(due, 0.0), inverse, size)


def sizes(slopes: Array) -> Array:
    """The root of the mean square of each column; 1 for one of nothing."""
    size = np.sqrt(np.mean(slopes**2, axis=0))
    return np.asarray(np.where(size > 0, size, 1.0))
