"""Models as linear regressions on one record, solved from the Gram matrices of all columns by block."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.core.forms import Anchor, fits, is_bend, steady
from stribeck.identify.core.states import Estimate, EstimateState
from stribeck.identify.models.curves import SPEEDS, SteadyCurve
from stribeck.identify.models.record import LawColumns, Record

RIDGE = 1e-10  # added to a scaled diagonal of 1: above the rounding of a Gram matrix, below correlations that count
DEAD = 1e-16  # relative square below which a column counts as 0: the rounding of double precision
LEVELS = ("level slow", "level middle", "level half", "level fast")  # friction at four recorded speeds
SEEN = (0.02, 0.98)  # quantiles of the recorded speeds: the slowest and the fastest level, without single rows
ASKED = "level at {:.4g}"  # at a speed given by the user
CELL = 1.2  # cells, to which a node's linearization is used: the next node is nearer beyond one
STEEP = 3.0  # factor on the squared residual beyond it: such a model is reported only if all others are much worse
LARGEST = 0.02  # of the force's standard deviation, or of a number: the largest form that may go unnoticed
Model = tuple[int, tuple[str, ...]]  # index of the node, forms


def seen_speeds(speeds: Array) -> tuple[float, float, float, float]:
    """The speeds of the levels: the slowest, the fastest, their geometric mean, and half of the fastest."""
    slow, fast = np.quantile(speeds, SEEN).tolist()
    return slow, float(np.sqrt(slow * fast)), 0.5 * fast, fast


@dataclass(kw_only=True)
class ModelLibrary(ABC):
    """Models of one law on one record: the interface for search, choice and judging.

    Attributes:
        columns, gram: (rows, p); (blocks, p, p).
        groups: columns of each form.
        targets: the target column of each node's models; ``starts``: the first of the node's ``k`` columns.
        natural: the mean square of a column by its unit, the scale relative to which it may count as 0.
        drawn: changes of the rows by known measurement errors (draws, rows), for each source of errors.
        models: kept by the search; ``count``: coefficients of each; ``kinds``: which forms each has.
    """

    columns: Array
    gram: Array
    groups: dict[str, list[int]]
    targets: list[int] = field(default_factory=list)
    starts: list[int] = field(default_factory=list)
    natural: list[float] = field(default_factory=list)
    drawn: list[Array] = field(default_factory=list)
    models: list[Model] = field(default_factory=list)

    @property
    @abstractmethod
    def k(self) -> int:
        """The number of columns of a node."""

    @property
    @abstractmethod
    def beside(self) -> list[int]:
        """The columns of every model besides those of its node."""

    @property
    @abstractmethod
    def files(self) -> Array:
        """The file of each block."""

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
    def largest_hidden(self, form: str) -> float:
        """The largest coefficient of a form that may go unnoticed in a record."""

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
        self._target = np.array([self.targets[s] for s, _ in models])
        self.kinds = np.array([[g in c for g in self.groups] for _, c in models]).reshape(len(models), len(self.groups))

    def solve(self, gram: Array) -> tuple[Array, Array]:
        """Coefficients and squared residual of every model, with a penalty for impossible coefficients."""
        i, t, target = self._at, self._there, self._target
        a = gram[i[:, :, None], i[:, None, :]] * (t[:, :, None] & t[:, None, :])
        diag = np.einsum("mii->mi", a)
        moved = diag / np.array(self.natural)[i]
        seen = t & (moved > DEAD * np.max(moved, axis=1, keepdims=True))  # without columns of 0
        d = np.where(seen, np.sqrt(np.maximum(diag, 1e-300)), 1.0)
        a = np.where(seen[:, :, None] & seen[:, None, :], a, 0.0) / d[:, :, None] / d[:, None, :]
        a[:, np.arange(i.shape[1]), np.arange(i.shape[1])] = 1 + RIDGE
        b = gram[i, target[:, None]] * seen / d
        x = np.linalg.solve(a, b[..., None])[..., 0]
        force = gram[target, target]
        sse = np.maximum(force - np.einsum("mi,mi->m", x, b), 1e-12 * force)
        return x / d, sse * self.fault(x / d)

    def scores(self, sse: Array, rows: float) -> Array:
        """BIC with ``rows`` independent rows, and a penalty for the selection among forms."""
        which = 2 * self.kinds.sum(axis=1) * np.log(max(len(self.groups), 1))
        return np.asarray(rows * np.log(sse) + self.count * np.log(max(rows, 3.0)) + which)

    def residual(self, model: Model, x: Array) -> Array:
        """The residual of a model by row."""
        i = self.index(model)
        return self.columns[:, self.targets[model[0]]] - self.columns[:, i] @ x[: len(i)]


@dataclass(kw_only=True)
class SteadyLibrary(ModelLibrary):
    """Models of a steady law. Columns: the force, the body's, the forms', and those of the nodes of the shapes.

    Attributes:
        nodes: shapes of the law; each has ``k`` columns: the law's, then its slopes by the logarithm of each shape.
        size, name: the rms of each form's column before it was scaled, and its key.
        step: of the grid, by shape, in logarithms.
    """

    record: Record
    law: LawColumns
    at: Anchor
    size: dict[int, float]
    name: dict[int, tuple[str, str]]
    step: list[float]
    nodes: list[dict[str, float]] = field(default_factory=list)

    @property
    def curve(self) -> SteadyCurve:
        """The law's columns."""
        return self.at.curve

    @property
    def levels(self) -> dict[str, float]:
        """The speeds of the levels, by name."""
        names = [*LEVELS, *(ASKED.format(v) for v in self.at.speeds[len(LEVELS) :])]
        return dict(zip(names, self.at.speeds, strict=True))

    @property
    def k(self) -> int:
        """Columns of a node."""
        return len(self.curve.names) + len(self.step)

    @property
    def body(self) -> list[str]:
        """The names of the body's columns."""
        return list(self.record.body)

    @property
    def first_form(self) -> int:
        """The index of the first form's coefficient in a model."""
        return self.k + len(self.body)

    @property
    def files(self) -> Array:
        """The file of each block."""
        return np.array([self.record.file[self.record.block == b][0] for b in range(len(self.gram))])

    @property
    def beside(self) -> list[int]:
        """The body's columns."""
        return list(range(1, 1 + len(self.body)))

    @property
    def by_ratio(self) -> frozenset[str]:
        """The law's shapes."""
        return frozenset(self.curve.shapes)

    def allowed(self, form: str) -> Array:
        """Whether a form differs from the law's own curve at each node."""
        return fits(form, self.nodes, self.at.fast)

    def largest_hidden(self, form: str) -> float:
        """A share of the force's standard deviation, which a constant preload does not enlarge."""
        return LARGEST * self.deviation

    def concluded(self, estimates: dict[str, Estimate]) -> dict[str, Estimate]:
        """Keep values to what the law allows, and report bounds if the recorded speeds determine no more.

        A mass below 0 is reported as it is, but never identified.
        """
        for n, e in estimates.items():
            if e.value < (least := self.curve.least(n)):
                estimates[n] = e = e.within(least, np.inf)
            if e.state is EstimateState.IDENTIFIED and n == "mass" and e.value < 0:
                estimates[n] = replace(e, state=EstimateState.MODEL_DEPENDENT)
        return self.curve.judged(estimates, estimates[LEVELS[0]], self.at.speeds[0])

    def level_of(self, name: str, value: Mapping[str, float]) -> tuple[float | None, bool]:
        """The friction level in the parameter's unit. A factor of two is narrow except for a constant force."""
        if name not in self.body or name in ("mass", "sigma_2"):
            return None, False
        column = self.columns[:, 1 + self.body.index(name)]
        level = value.get("F_c", value[LEVELS[-1]])
        return level / max(float(np.max(abs(column))), 1e-300), float(np.ptp(column)) > 0

    def add(self, shapes: Sequence[Mapping[str, float]], heights: Sequence[Mapping[str, float]]) -> None:
        """Add nodes; ``heights``: coefficients of the law's columns with which the slopes are computed."""
        blocks, place = [], self.columns.shape[1]
        for shape, height in zip(shapes, heights, strict=True):
            columns, known = self.law.with_slopes(shape, height), self.law.known(shape)
            self.targets.append(0 if known is None else place + columns.shape[1])
            self.starts.append(place)
            level = max((x * x for x in height.values()), default=1.0)
            self.natural += [1.0] * len(self.curve.names) + [level] * len(self.step) + [1.0] * (known is not None)
            blocks.append(columns if known is None else np.column_stack([columns, self.columns[:, 0] - known]))
            place += blocks[-1].shape[1]
        new = np.column_stack(blocks)
        both, block, p = np.column_stack([self.columns, new]), self.record.block, self.columns.shape[1]
        side = np.array([both[block == b].T @ new[block == b] for b in range(block.max() + 1)])
        gram = np.empty((len(side), both.shape[1], both.shape[1]))
        gram[:, :p, :p], gram[:, :, p:], gram[:, p:, :p] = self.gram, side, np.swapaxes(side, 1, 2)[:, :, :p]
        self.columns, self.gram = both, gram
        self.nodes += [dict(s) for s in shapes]

    def fault(self, x: Array) -> Array:
        """A penalty factor on the squared residual for negative levels or masses, and for steps out of the grid's cell."""
        n = len(self.curve.names)
        named = dict(zip((*self.curve.names, *[""] * len(self.step), *self.body), x.T, strict=False))
        out = self.curve.fault(named, self.at.fast, self.largest)
        for j, step in enumerate(self.step):
            out = np.where(abs(x[:, n + j]) > CELL * step, out * STEEP, out)
        return out

    def shape(self, model: Model, x: Array) -> dict[str, float]:
        """The shapes of a model: its node's, moved by the coefficients of the slopes."""
        n = len(self.curve.names)
        moved = enumerate(self.nodes[model[0]].items())
        return {m: s * float(np.exp(np.clip(x[n + j], -2, 2))) for j, (m, s) in moved}

    def coefficients(self, x: Array) -> dict[str, float]:
        """The coefficients of the law and of the body, by name."""
        names = [*self.curve.names, *self.body]
        return dict(
            zip(names, [*x[: len(self.curve.names)].tolist(), *x[self.k : self.first_form].tolist()], strict=True)
        )

    def of_forms(self, model: Model, x: Array) -> dict[tuple[str, str], float]:
        """The coefficients of a model's forms, by their columns."""
        i = self.index(model)
        there = zip(i[self.first_form :], x[self.first_form : len(i)].tolist(), strict=True)
        return {self.name[j]: z / self.size[j] for j, z in there}

    def level(self, model: Model, x: Array, v: Array) -> Array:
        """Friction at steady speeds ``v`` > 0, half the difference between both directions."""
        shape, c = self.shape(model, x), self.coefficients(x)
        out = self.curve.force(v, shape, c) + c.get("sigma_2", self.record.given.get("sigma_2", 0.0)) * v
        for (form, _), z in self.of_forms(model, x).items():
            out = out + z * steady(form, v, self.at)
        return np.asarray(out)

    def parameters(self, model: Model, x: Array) -> dict[str, float]:
        """All estimates of a model: the body's, the law's, and the levels at the recorded speeds."""
        c, u = self.coefficients(x), self.at.fast * np.geomspace(1e-3, 1.0, SPEEDS)
        bends = np.zeros(len(u))
        for (form, _), z in self.of_forms(model, x).items():
            if is_bend(form):
                bends = bends + z * steady(form, u, self.at, rigid=True)
        of_curve = {n: c[n] for n in self.curve.names}
        out = {n: c[n] for n in self.body} | self.curve.constants(of_curve, self.shape(model, x), bends, u)
        return out | dict(
            zip(self.levels, self.level(model, x, np.array(list(self.levels.values()))).tolist(), strict=True)
        )
