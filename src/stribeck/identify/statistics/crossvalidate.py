"""Cross-validation: how well a law predicts data that its fit has not seen, and which of several laws to take."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.log import Log

FOLDS = 10
_BLOCKS = 5  # in a part
_CLEARLY = 2.0  # standard errors
_ALIKE = 0.001  # of the error: laws that differ by less are as good, however sure that is


@dataclass(frozen=True)
class LeftOut:
    """What predictions of parts that were left out came to.

    Attributes:
        squares: the sum of squared residuals of each part; ``size``: of squared forces.
        how: how the parts were made.
        parameters: how many numbers were fitted.
    """

    squares: Array
    size: Array
    how: str
    parameters: int

    @property
    def error(self) -> float:
        """norm(residual)/norm(force) over all parts."""
        return float(np.sqrt(self.squares.sum() / self.size.sum()))


def groups(log: Log, folds: int = FOLDS) -> tuple[NDArray[np.intp], str]:
    """Which part each row belongs to: files where there are three or more, runs where there are as many as folds, else
    blocks in time, several to a part; and how the parts were made."""
    rows = np.arange(len(log))
    if len(names := list(dict.fromkeys(log.files))) > 2:
        number = np.array([names.index(name) for name in log.files])[log.run]
        if len(names) > max(folds, 2):
            return (number % folds).astype(np.intp), f"over {len(names)} files in {folds} parts"
        return number.astype(np.intp), f"over {len(names)} files, one left out at a time"
    runs = np.cumsum(np.diff(log.run, prepend=log.run[:1]) != 0)
    if (count := int(runs[-1]) + 1) >= folds:
        return (runs * folds // count).astype(np.intp), f"over {count} runs in {folds} parts"
    folds = max(min(folds, len(log) // 50), 2)
    blocks = rows * (folds * _BLOCKS) // len(log)  # dealt out in turn: each part then holds something of every test
    return (blocks % folds).astype(np.intp), f"over {folds * _BLOCKS} blocks in time, dealt to {folds} parts"


def cross_validate(
    log: Log, folds: int, parameters: int, missed_without: Callable[[NDArray[np.bool_]], tuple[float, float]]
) -> LeftOut:
    """Predict each part of a log by a fit to the others.

    Args:
        log, folds: what is dealt to parts, and to how many.
        parameters: how many numbers are fitted.
        missed_without: fits anew without the rows that it is given, and returns the sums over these of the squared residual
            and of the squared force.
    """
    part, how = groups(log, folds)
    squares, size = zip(*(missed_without(part == number) for number in range(int(part.max()) + 1)), strict=True)
    return LeftOut(np.array(squares), np.array(size), how, parameters)


def beyond_chance(one: LeftOut, other: LeftOut) -> bool:
    """Whether one's squared error is less than another's by more than two standard errors of that over the parts: the best of
    several models is looked at, and neighbouring parts err alike."""
    fall = other.squares - one.squares
    if len(fall) < 2:
        return True
    return bool(float(fall.sum()) > _CLEARLY * float(np.std(fall, ddof=1)) * np.sqrt(len(fall)))


def choose(candidates: Mapping[str, LeftOut]) -> tuple[str, str]:
    """The law to take, and why: the one with the fewest parameters whose error is within a standard error, or within a
    thousandth, of the best.

    The standard error is that of the difference between the two over the parts.
    """
    best = min(candidates, key=lambda name: candidates[name].error)
    kept = best
    for name in sorted(candidates, key=lambda name: (candidates[name].parameters, candidates[name].error)):
        difference = candidates[name].squares - candidates[best].squares
        noise = float(np.std(difference, ddof=1)) * np.sqrt(len(difference)) if len(difference) > 1 else 0.0
        alike = float(candidates[best].squares.sum()) * ((1 - _ALIKE) ** -2 - 1)
        if name == best or float(difference.sum()) <= max(noise, alike):
            kept = name
            break
    if kept == best:
        return best, f"lowest cross-validated error ({candidates[best].error:.4%}), and no simpler law is as good"
    return kept, (
        f"{candidates[kept].parameters} parameters do as well as the {candidates[best].parameters} of {best}: its "
        f"cross-validated error ({candidates[kept].error:.4%}) is within a standard error (or 0.1 %) of the lowest "
        f"({candidates[best].error:.4%})"
    )
