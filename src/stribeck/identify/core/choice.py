"""Chooses the model of the least BIC among all laws and forms, on any weighting of the blocks."""

from __future__ import annotations

from collections.abc import Container
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from scipy.fft import next_fast_len

from stribeck.arrays import Array
from stribeck.identify.core.library import Model, ModelLibrary

Of = TypeVar("Of", bound=ModelLibrary)


@dataclass
class Selection(Generic[Of]):
    """Libraries of the candidate laws, and the reported model.

    Attributes:
        law, index: of the reported library and its model; ``solved``: coefficients of all models, by library.
        rows: the number of independent rows of the record.
        alone: whether only laws without forms may be reported.
    """

    libraries: list[Of]
    solved: list[Array]
    rows: float
    alone: bool = False
    law: int = 0
    index: int = 0

    @property
    def library(self) -> Of:
        """The library of the reported law."""
        return self.libraries[self.law]

    @property
    def model(self) -> Model:
        """The reported model."""
        return self.library.models[self.index]

    @property
    def open(self) -> bool:
        """Whether there was more than one model to choose from."""
        return len([m for m in self.library.models if not (self.alone and m[1])]) > 1

    @property
    def coefficients(self) -> Array:
        """The coefficients of the reported model."""
        return np.asarray(self.solved[self.law][self.index][: len(self.library.index(self.model))])

    def choose(
        self, drawn: Array, withheld: Container[str] = (), within: int | None = None, alone: bool | None = None
    ) -> tuple[int, int, Array, float]:
        """The model of the least BIC on a weighting of the blocks.

        Args:
            withheld: forms that no model may have.
            within: the only library; all unless given.
            alone: whether forms are excluded; as for the report unless given.

        Returns:
            Its library, index and coefficients, and the ratio of its squared residual to the reported model's.
        """
        scored, reported, alone = [], 1.0, self.alone if alone is None else alone
        for n, lib in enumerate(self.libraries):
            if within is not None and n != within:
                continue
            x, sse = lib.solve(np.tensordot(drawn, lib.gram, 1))
            gone = lib.kinds @ np.array([alone or g in withheld for g in lib.groups], dtype=int) > 0
            score = np.where(gone, np.inf, lib.scores(sse, self.rows))
            i = int(np.argmin(score))
            scored.append((float(score[i]), n, i, x[i], float(sse[i])))
            reported = float(sse[self.index]) if n == self.law else reported
        _, n, i, x_best, left = min(scored, key=lambda e: e[0])
        return n, i, x_best, left / max(reported, 1e-300)


def rows_together(r: Array) -> float:
    """How many rows in a row err alike: the sum of the residual's correlation up to its first zero."""
    length = next_fast_len(2 * len(r), real=True)
    correlation = np.fft.irfft(abs(np.fft.rfft(r - r.mean(), length)) ** 2, length)
    if correlation[0] <= 0:
        return 1.0
    correlation = correlation / correlation[0]
    end = int(np.argmax(correlation < 0)) or 1
    return float(1 + 2 * np.sum(correlation[1:end]))


def independent(lib: ModelLibrary, x: Array, sse: Array) -> float:
    """The number of independent rows, from the residual of the best model, then iteratively of the chosen one."""
    rows, i, visited = np.inf, int(np.argmin(sse)), set[int]()
    while i not in visited:
        visited.add(i)
        r = lib.residual(lib.models[i], x[i])
        rows = min(rows, len(r) / rows_together(r))
        i = int(np.argmin(lib.scores(sse, rows)))
    return float(rows)
