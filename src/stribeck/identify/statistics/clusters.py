"""Covariance of least squares whose errors hang together within parts of a record: files, blocks in time, bands of speed.

Residuals of one file, or of one stretch, err together (temperature, lubrication, what the law lacks), which a model of the
noise from one row to the next does not see. Over files it is the jackknife: what the estimate is without each file
(Cameron, Miller, Journal of Human Resources 50(2):317-372, 2015, CV3); over blocks of one record the sandwich (CV1).
Over bands of speed the sandwich shows what a wrong form of the law does: its residuals then err together at one speed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from stribeck.arrays import Array
from stribeck.identify.log import Log

Groups = NDArray[np.intp]
BLOCKS, _BANDS, _BINS = 10, 8, 16
_FEWEST_FILES, _FEWEST_RUNS = 3, 6


@dataclass(frozen=True)
class RowGroups:
    """Which part each row belongs to, what the parts are, and whether they are repeated experiments."""

    number: Groups
    what: str
    repeats: bool

    @property
    def count(self) -> int:
        """How many there are."""
        return int(self.number.max()) + 1


def parts_of(log: Log) -> RowGroups:
    """Files where there are three or more, runs where there are six, else ten blocks in time."""
    names = list(dict.fromkeys(log.files))
    if len(names) >= _FEWEST_FILES:
        number = np.array([names.index(name) for name in log.files])[log.run]
        return RowGroups(_dense(number), f"{len(names)} files", True)
    runs = np.cumsum(np.diff(log.run, prepend=log.run[:1]) != 0)
    if (count := int(runs[-1]) + 1) >= _FEWEST_RUNS:
        return RowGroups(runs.astype(np.intp), f"{count} runs", True)
    return RowGroups((np.arange(len(log)) * BLOCKS // len(log)).astype(np.intp), f"{BLOCKS} blocks in time", False)


def _dense(number: Groups) -> Groups:
    return np.unique(number, return_inverse=True)[1].astype(np.intp)


def by_speed(v: Array, weight: Array, count: int = _BANDS) -> Groups:
    """Bands of the signed speed that hold alike many of the rows that count."""
    inside = v[weight > 0]
    edges = np.unique(np.quantile(inside, np.linspace(0, 1, count + 1)[1:-1]))
    return _dense(np.searchsorted(edges, v).astype(np.intp))


def half_widths(slopes: Array, misfit: Array, parts: Groups, jackknife: bool) -> Array:
    """Half of the 95 % interval of each coefficient, by what parts of the rows differ."""
    size = np.sqrt(np.mean(slopes**2, axis=0))
    size = np.where(size > 0, size, 1.0)
    a = slopes / size
    count = int(parts.max()) + 1
    order = np.argsort(parts, kind="stable")
    cuts = np.searchsorted(parts[order], np.arange(1, count))
    grams = np.array([x.T @ x for x in np.split(a[order], cuts)])
    scores = np.array([x.T @ r for x, r in zip(np.split(a[order], cuts), np.split(misfit[order], cuts), strict=True)])
    whole = grams.sum(axis=0)
    little = 1e-12 * np.trace(whole) * np.eye(len(whole))
    kept = [g for g in range(count) if np.trace(grams[g]) > 0]
    if len(kept) < 2:
        return np.zeros(len(size))
    if jackknife:
        moved = np.array([np.linalg.solve(whole - grams[g] + little, scores[g]) for g in kept])
        factor = (len(kept) - 1) / len(kept)
    else:
        moved = scores[kept] @ np.linalg.inv(whole + little)
        factor = len(kept) / (len(kept) - 1)
    variance = factor * np.sum(moved**2, axis=0)
    return np.asarray(float(student.ppf(0.975, len(kept) - 1)) * np.sqrt(variance) / size)


def misfit_share(v: Array, misfit: Array, weight: Array) -> float:
    """What share of the squared residual a free curve of the speed would take away, less what it takes of noise."""
    band = by_speed(v, weight, _BINS)
    r, band = misfit[weight > 0], band[weight > 0]
    counts = np.bincount(band)
    sums = np.bincount(band, r)
    total = float(r @ r)
    taken = float(np.sum(sums[counts > 0] ** 2 / counts[counts > 0]))
    memory = _rows_together(r)
    noise = memory * len(counts) / max(len(r), 1)
    return float(np.clip(taken / total - noise, 0.0, 1.0)) if total > 0 else 0.0


def _rows_together(r: Array) -> float:
    """How many rows in a row err alike: the sum of the residual's correlation up to its first zero."""
    n = len(r)
    spectrum = abs(np.fft.rfft(r - r.mean(), 2 * n)) ** 2
    correlation = np.fft.irfft(spectrum)[: n // 2]
    if correlation[0] <= 0:
        return 1.0
    correlation = correlation / correlation[0]
    end = int(np.argmax(correlation < 0)) or 1
    return float(1 + 2 * np.sum(correlation[1:end]))
