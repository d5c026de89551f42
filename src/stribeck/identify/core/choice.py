"""The choice: the law first, then the model of the least BIC within it, on any weighting of the blocks."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.core.library import Model, ModelLibrary, SteadyLibrary
from stribeck.identify.core.search import library, refine
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.memory import rows_together
from stribeck.identify.models.record import Record

Of = TypeVar("Of", bound=ModelLibrary)
ROUNDS = 4  # of choosing by the rows that are independent by the chosen model's residual


@dataclass
class Selection(Generic[Of]):
    """Libraries of the candidate laws, and the model that is reported.

    Attributes:
        law, index: of the reported library and its model; ``solved``: coefficients of all models, by library.
        rows: how many of the record's are independent.
        alone: only laws without forms may be reported.
    """

    libraries: list[Of]
    solved: list[Array]
    rows: float
    alone: bool = False
    law: int = 0
    index: int = 0

    @property
    def library(self) -> Of:
        """Of the reported law."""
        return self.libraries[self.law]

    @property
    def model(self) -> Model:
        """The reported model."""
        return self.library.models[self.index]

    @property
    def open(self) -> bool:
        """Whether there was anything to choose."""
        return len([m for m in self.library.models if not (self.alone and m[1])]) > 1

    @property
    def coefficients(self) -> Array:
        """Of the reported model."""
        return np.asarray(self.solved[self.law][self.index][: len(self.library.index(self.model))])

    def choose(
        self, drawn: Array, withheld: Container[str] = (), within: int | None = None, alone: bool | None = None
    ) -> tuple[int, int, Array, float]:
        """The model of the least BIC on a weighting of the blocks.

        Args:
            withheld: forms that no model may have.
            within: the only library; all unless given.
            alone: without any form; as the report unless given.

        Returns:
            Its library, index and coefficients, and its squared residual beside that of the reported model.
        """
        found, reported, alone = [], 1.0, self.alone if alone is None else alone
        for n, lib in enumerate(self.libraries):
            if within is not None and n != within:
                continue
            x, sse = lib.solve(np.tensordot(drawn, lib.gram, 1))
            gone = lib.kinds @ np.array([alone or g in withheld for g in lib.groups], dtype=int) > 0
            score = np.where(gone, np.inf, lib.scores(sse, self.rows))
            i = int(np.argmin(score))
            found.append((float(score[i]), n, i, x[i], float(sse[i])))
            reported = float(sse[self.index]) if n == self.law else reported
        _, n, i, x_best, left = min(found, key=lambda e: e[0])
        return n, i, x_best, left / max(reported, 1e-300)


def independent(lib: ModelLibrary, x: Array, sse: Array) -> float:
    """Rows that are independent: by the residual of the best model of all, then of the chosen one, until it stays."""
    rows, i = np.inf, int(np.argmin(sse))
    for _ in range(ROUNDS):
        r = lib.residual(lib.models[i], x[i])
        rows = min(rows, len(r) / rows_together(r))
        i = int(np.argmin(lib.scores(sse, rows)))
    return float(rows)


def chosen(
    records: Sequence[tuple[Record, SteadyCurve]], alone: bool = False, speeds: Sequence[float] = ()
) -> Selection[SteadyLibrary]:
    """The model of the least BIC among all laws and forms.

    Args:
        records: each law's columns with the rows that it is compared on, the same blocks for all.
        alone: of the laws alone.
        speeds: at which the levels are estimated.
    """
    libraries = [library(record, curve, speeds) for record, curve in records]
    rows = min(independent(lib, *lib.solve(lib.gram.sum(0))) for lib in libraries)
    for lib in libraries:
        refine(lib, rows)
    out = Selection(libraries, [lib.solve(lib.gram.sum(0))[0] for lib in libraries], rows, alone)
    out.law, out.index, *_ = out.choose(np.ones(len(libraries[0].gram)))
    return out
