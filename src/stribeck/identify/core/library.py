"""Models as linear regressions on one record, solved from the Gram matrices of all columns by block."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.core.states import Estimate

RIDGE = 1e-10  # added to a scaled diagonal of 1: above the rounding of a Gram matrix, below correlations that count
DEAD = 1e-16  # relative square below which a column counts as 0: the rounding of double precision
LEVELS = ("level slow", "level middle", "level half", "level fast")  # friction at four recorded speeds
SEEN = (0.02, 0.98)  # quantiles of the recorded speeds: the slowest and the fastest level, without single rows
CELL = 1.2  # cells, to which a node's linearization is used: the next node is nearer beyond one
STEEP = 3.0  # factor on the squared residual beyond it: such a model is reported only if all others are much worse
IMPOSSIBLE = 100.0  # factor on the squared residual: such a model is never reported
UNNOTICED = 0.02  # of the force's standard deviation, or of a number: the largest form that may go unnoticed
Model = tuple[int, tuple[str, ...]]  # index of the node, forms


def seen_speeds(speeds: Array, counts: Array | None = None) -> tuple[float, float, float, float]:
    """The speeds of the levels: the slowest, the fastest, their geometric mean, and half of the fastest.

    Args:
        counts: the weight of each speed; all alike unless some is above 0.
    """
    order = np.argsort(speeds)
    counts = counts[order] if counts is not None and counts.any() else np.ones(len(speeds))
    below = np.cumsum(counts) - counts
    slow, fast = np.interp(SEEN, below / max(below[-1], 1e-300), speeds[order]).tolist()
    return slow, float(np.sqrt(slow * fast)), 0.5 * fast, fast


@dataclass(kw_only=True)
class ModelLibrary(ABC):
    """Models of one law on one record: the interface for search, choice and judging.

    Attributes:
        columns, gram: (rows, p), the target first; (blocks, p, p).
        groups: columns of each form.
        starts: the first of the ``k`` columns of each node.
        natural: the mean square of a column by its unit, the scale relative to which it may count as 0.
        drawn: changes of the rows by known measurement errors (draws, rows), for each source of errors.
        models: kept by the search; ``count``: coefficients of each; ``kinds``: which forms each has.
    """

    columns: Array
    gram: Array
    groups: dict[str, list[int]]
    starts: list[int] = field(default_factory=list)
    natural: list[float] = field(default_factory=list)
    drawn: list[Array] = field(default_factory=list)
    models: list[Model] = field(default_factory=list)

    @property
    @abstractmethod
    def k(self) -> int:
        """The number of columns of a node."""

    @property
    def beside(self) -> list[int]:
        """The columns of every model besides those of its node."""
        return []

    @property
    def files(self) -> Array:
        """The file of each block, if files are runs of one experiment."""
        return np.zeros(len(self.gram), int)

    @property
    @abstractmethod
    def by_ratio(self) -> frozenset[str]:
        """The estimates whose intervals are symmetric in the logarithm."""

    @abstractmethod
    def parameters(self, model: Model, x: Array) -> dict[str, float]:
        """All estimates of a model by name."""

    @abstractmethod
    def fault(self, x: Array) -> Array:
        """A factor on the squared residual that penalizes impossible coefficients (models, columns)."""

    @abstractmethod
    def largest_hidden(self, form: str, unexplained: float) -> float:
        """The largest coefficient of a form that may go unnoticed in a record; ``unexplained``: systematic rms residual."""

    @abstractmethod
    def level_of(self, name: str, value: Mapping[str, float]) -> tuple[float | None, bool]:
        """For a parameter that may be 0: its scale, and whether an interval within a factor of two is narrow too."""

    @abstractmethod
    def concluded(self, estimates: dict[str, Estimate]) -> dict[str, Estimate]:
        """The estimates as reported, with bounds applied and impossible values marked."""

    def allowed(self, form: str) -> Array:
        """Whether a form may be combined with each node's law."""
        return np.ones(len(self.starts), bool)

    @property
    def largest(self) -> float:
        """The largest value of the target."""
        return float(np.max(abs(self.columns[:, 0])))

    @property
    def deviation(self) -> float:
        """The target's standard deviation."""
        return float(np.std(self.columns[:, 0]))

    def index(self, model: Model) -> list[int]:
        """The columns of a model: the law's with slopes, those of every model, the forms'."""
        s, chosen = model
        of_law = range(self.starts[s], self.starts[s] + self.k)
        return [*of_law, *self.beside, *(i for g in chosen for i in self.groups[g])]

    def keep(self, models: list[Model]) -> None:
        """Keep these models only."""
        self.models = models
        rows = [self.index(m) for m in models]
        width = max(map(len, rows))
        self.count = np.array([len(r) for r in rows])
        self._at = np.array([r + [0] * (width - len(r)) for r in rows])
        self._there = np.arange(width)[None] < self.count[:, None]
        self.kinds = np.array([[g in c for g in self.groups] for _, c in models]).reshape(len(models), len(self.groups))

    def solve(self, gram: Array) -> tuple[Array, Array]:
        """Coefficients and squared residual of every model, with a penalty for impossible coefficients."""
        i, t, force = self._at, self._there, gram[0, 0]
        a = gram[i[:, :, None], i[:, None, :]] * (t[:, :, None] & t[:, None, :])
        diag = np.einsum("mii->mi", a)
        moved = diag / np.array(self.natural)[i]
        seen = t & (moved > DEAD * np.max(moved, axis=1, keepdims=True))  # without columns of 0
        d = np.where(seen, np.sqrt(np.maximum(diag, 1e-300)), 1.0)
        a = np.where(seen[:, :, None] & seen[:, None, :], a, 0.0) / d[:, :, None] / d[:, None, :]
        a[:, np.arange(i.shape[1]), np.arange(i.shape[1])] = 1 + RIDGE
        b = gram[i, 0] * seen / d
        x = np.linalg.solve(a, b[..., None])[..., 0]
        sse = np.maximum(force - np.einsum("mi,mi->m", x, b), 1e-12 * force)
        return x / d, sse * self.fault(x / d)

    def scores(self, sse: Array, rows: float) -> Array:
        """BIC with ``rows`` independent rows, and a penalty for the selection among forms."""
        which = 2 * self.kinds.sum(axis=1) * np.log(max(len(self.groups), 1))
        return np.asarray(rows * np.log(sse) + self.count * np.log(max(rows, 3.0)) + which)

    def residual(self, model: Model, x: Array) -> Array:
        """The residual of a model by row."""
        i = self.index(model)
        return self.columns[:, 0] - self.columns[:, i] @ x[: len(i)]
