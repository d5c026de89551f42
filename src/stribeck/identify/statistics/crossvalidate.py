"""Cross-validation: how well a law predicts data that its fit has not seen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.log import Log

FOLDS = 10
_BLOCKS = 5  # in a part


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
