"""Models of a steady law on one record: their columns, the search of the shapes' optima, and the choice among laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.core.choice import Selection, independent
from stribeck.identify.core.library import CELL, LEVELS, STEEP, UNNOTICED, Model, ModelLibrary, seen_speeds
from stribeck.identify.core.search import search_forms
from stribeck.identify.core.states import Estimate, EstimateState, known, one_sided
from stribeck.identify.log import INTEGRAL
from stribeck.identify.models.curves import REACHED, SPEEDS, SteadyCurve
from stribeck.identify.models.forms import SHOWN, WIDTHS, Anchor, Key, effect, fits, forms, sliding, steady
from stribeck.identify.models.over_position import ripple_range, ripple_waves, travel
from stribeck.identify.models.record import LawColumns, Record
from stribeck.identify.models.transmission import Transmission

ASKED = "level at {:.4g}"  # at a speed given by the user
# Nodes of the grid by the number of shapes: factors of 1.5 to 3 apart, where a slope still holds.
CELLS = {0: (), 1: (16,), 2: (9, 6), 3: (5, 4, 4)}
STEPS = 8  # Gauss-Newton steps at most: near an optimum each step squares the distance that is left
REFINED, REFINED_WITH = 4, 12  # sets of forms with a node of their own; sets tried there, as ranks change at an optimum
RANK = 1e-9  # relative size up to which a column, or a direction of the columns, counts as 0
SHORTER = (1.0, 0.4, 0.15, 0.05)  # parts of a step that are tried: a step that fails at a twentieth ends the search
LITTLE = 1e-5  # relative reduction of the squared residual below which the search ends
ROOM = 3.0  # times the range of a shape that is searched: a step of the grid


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

    def largest_hidden(self, form: str, unexplained: float) -> float:
        """A share of the force's standard deviation, which a constant preload does not enlarge; or what is unexplained."""
        return max(UNNOTICED * self.deviation, unexplained)

    def concluded(self, estimates: dict[str, Estimate]) -> dict[str, Estimate]:
        """Keep values to what the law allows, and report bounds if the recorded speeds determine no more.

        A mass below 0 is reported as it is, but never identified.
        """
        for n, e in estimates.items():
            if e.value < (least := self.curve.least(n)):
                estimates[n] = e = e.within(least, np.inf)
            if e.state is EstimateState.IDENTIFIED and n == "mass" and e.value < 0:
                estimates[n] = replace(e, state=EstimateState.MODEL_DEPENDENT)
        viscous, slowest = estimates.get("sigma_2", known(self.record.given.get("sigma_2", 0.0))), self.at.speeds[0]
        if {"F_s", "v_s"} <= estimates.keys() and slowest > REACHED * estimates["v_s"].value:
            levels = [estimates[LEVELS[0]].less(viscous, slowest), estimates["F_c"]]  # F_s is below neither
            estimates["F_s"], estimates["v_s"] = one_sided(estimates["F_s"], estimates["v_s"], levels)
        return estimates

    def level_of(self, name: str, value: Mapping[str, float]) -> tuple[float | None, bool]:
        """The friction level in the parameter's unit. A factor of two is narrow except for a constant force."""
        if name not in self.body or name in ("mass", "sigma_2"):
            return None, False
        column = self.columns[:, 1 + self.body.index(name)]
        return value["F_c"] / max(float(np.max(abs(column))), 1e-300), float(np.ptp(column)) > 0

    def add(self, shapes: Sequence[Mapping[str, float]], heights: Sequence[Mapping[str, float]]) -> None:
        """Add nodes; ``heights``: coefficients of the law's columns with which the slopes are computed."""
        blocks, place = [], self.columns.shape[1]
        for shape, height in zip(shapes, heights, strict=True):
            self.starts.append(place)
            level = max(x * x for x in height.values())
            self.natural += [1.0] * len(self.curve.names) + [level] * len(self.step)
            blocks.append(self.law.with_slopes(shape, height))
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
            if effect(form)[0].peak:
                bends = bends + z * steady(form, u, self.at, rigid=True)
        of_curve = {n: c[n] for n in self.curve.names}
        out = {n: c[n] for n in self.body} | self.curve.constants(of_curve, self.shape(model, x), bends, u)
        return out | dict(
            zip(self.levels, self.level(model, x, np.array(list(self.levels.values()))).tolist(), strict=True)
        )


def optimum(
    law: LawColumns, shape: Mapping[str, float], rest: Array, force: Array
) -> tuple[dict[str, float], Array, float]:
    """Optimize the shapes by Gauss-Newton steps, with linear coefficients eliminated. Steps that fail are shortened.

    Args:
        rest: the columns besides the law's.

    Returns:
        Shapes, coefficients (the law's, then those of ``rest``), squared residual.
    """
    size = _sizes(rest)
    basis, spread, back = np.linalg.svd(rest / size, full_matrices=False)
    there = spread > RANK * spread.max(initial=0.0)
    basis, back = basis[:, there], back[there] / spread[there, None]

    def beside(a: Array) -> Array:
        return np.asarray(a - basis @ (basis.T @ a))

    def solved(columns: Array) -> tuple[Array, float]:
        """The law's coefficients and the squared residual, with the coefficients of ``rest`` eliminated."""
        d = _sizes(columns)
        left = beside(columns / d)
        left[:, _sizes(left) < RANK] = 0.0  # in the span of the others: the least squares see only rounding
        x = np.linalg.lstsq(left, target, rcond=RANK)[0]
        r = target - left @ x
        return x / d, float(r @ r)

    n, shape, target = len(law.curve.names), dict(shape), beside(force)
    x, sse = solved(law.at(shape))
    for _ in range(STEPS if shape else 0):
        height = dict(zip(law.curve.names, x.tolist(), strict=False))
        z, _ = solved(law.with_slopes(shape, height))
        step, before = np.clip(z[n : n + len(shape)], -1.0, 1.0), sse
        for part in SHORTER:
            other = {m: s * float(np.exp(part * e)) for (m, s), e in zip(shape.items(), step.tolist(), strict=True)}
            y, remaining = solved(law.at(other))
            if remaining < sse:
                shape, x, sse = other, y, remaining
                break
        if sse > before * (1 - LITTLE):
            break
    further = back.T @ (basis.T @ (force - law.at(shape) @ x)) / size
    return shape, np.concatenate([x, further]), sse


def _sizes(columns: Array) -> Array:
    """The norm of each column."""
    return np.asarray(np.maximum(np.sqrt(np.einsum("ij,ij->j", columns, columns)), 1e-300))


def library(record: Record, curve: SteadyCurve, speeds: Sequence[float] = ()) -> SteadyLibrary:
    """All columns, their Gram matrices, and the models of a beam search.

    Args:
        speeds: of further levels.
    """
    ranges = curve.ranges(record.log.velocity)
    axes = {n: np.geomspace(*ranges[n], c) for n, c in zip(curve.shapes, CELLS[len(curve.shapes)], strict=True)}
    mesh = np.stack([m.ravel() for m in np.meshgrid(*axes.values(), indexing="ij")], -1).tolist() if axes else [[]]
    shapes = [dict(zip(axes, p, strict=True)) for p in mesh]
    body = np.column_stack([np.empty((len(record.force), 0)), *record.body.values()])
    law = LawColumns(curve, record.log.velocity, record.column)
    at_nodes, left = zip(*(_plain(record, law, shape, body) for shape in shapes), strict=True)
    best = int(np.argmin(left))
    shape, x, _ = optimum(law, shapes[best], body, record.force)
    if not _sound(curve, shape, x, ranges):
        shape, x = shapes[best], at_nodes[best]
    at = anchor(record, curve, shape, speeds)
    out = _with_forms(record, law, at, body, [float(np.log(a[1] / a[0])) for a in axes.values()])
    n = len(curve.names)
    out.add([*shapes, shape], [curve.anchored(c[:n].tolist()) for c in (*at_nodes, x)])
    search_forms(out)
    return out


def _plain(record: Record, law: LawColumns, shape: Mapping[str, float], body: Array) -> tuple[Array, float]:
    """Coefficients of the law alone, and the squared residual with a penalty for impossible coefficients."""
    curve, a = law.curve, np.column_stack([law.at(shape), body])
    x = np.linalg.lstsq(a, record.force, rcond=RANK)[0]
    r = record.force - a @ x
    coefficients = {n: np.asarray(x[i : i + 1], float) for i, n in enumerate(curve.names)}
    return np.asarray(x, float), float(r @ r) * float(
        curve.fault(coefficients, 0.0, float(np.max(abs(record.force))))[0]
    )


def _sound(curve: SteadyCurve, shape: Mapping[str, float], x: Array, ranges: Mapping[str, tuple[float, float]]) -> bool:
    """Whether the optimum of the law alone is possible, and so may define the forms."""
    n = len(curve.names)
    inside = all(ranges[m][0] / ROOM < s < ROOM * ranges[m][1] for m, s in shape.items())
    return inside and bool(x[0] > 0 and x[:n].min() >= 0)


def _with_forms(record: Record, law: LawColumns, at: Anchor, body: Array, step: list[float]) -> SteadyLibrary:
    """The library without nodes: force, body, and all forms that vary in the record and are not in the body."""
    form_columns: list[Array] = []
    groups, size, name = dict[str, list[int]](), dict[int, float](), dict[int, Key]()
    whole = {key: record.column(column()) for key, column in forms(record.log, at).items()}
    held = {key[0] for key, c in whole.items() if _in_body(c, body)}
    for key, column in whole.items():
        largest = np.max(abs(column))
        if largest <= RANK or key[0] in held or (effect(key[0])[0].peak and largest < SHOWN):
            continue
        groups.setdefault(key[0], []).append(i := 1 + body.shape[1] + len(form_columns))
        size[i], name[i] = float(np.sqrt(np.mean(column**2))), key
        form_columns.append(column / size[i])
    columns = np.column_stack([record.force, body, *form_columns])
    block = record.block
    gram = np.array([columns[block == b].T @ columns[block == b] for b in range(block.max() + 1)])
    natural = [1.0, *np.mean(body**2, axis=0).tolist(), *[1.0] * len(form_columns)]
    return SteadyLibrary(
        record=record,
        law=law,
        at=at,
        groups=groups,
        size=size,
        name=name,
        columns=columns,
        gram=gram,
        step=step,
        natural=natural,
    )


def _in_body(column: Array, body: Array) -> bool:
    """Whether a form equals one of the body's columns, which the user chose."""
    size = float(column @ column)
    return any(size * float(b @ b) * (1 - RANK) < float(column @ b) ** 2 for b in body.T)


def anchor(record: Record, curve: SteadyCurve, shape: Mapping[str, float], speeds: Sequence[float]) -> Anchor:
    """The constants of the forms' columns from a fit of the law behind a filter of the force, and the ripples in its residual."""
    log, v, n = record.log, record.log.velocity, len(curve.names)
    transmission = Transmission(record, curve, shape)
    late = transmission.force_filter()
    columns = transmission.behind_filter(late)
    x = np.asarray(np.linalg.lstsq(columns, record.force, rcond=RANK)[0], float)
    residual = record.force - columns @ x
    basis = np.linalg.qr(columns / np.maximum(np.max(abs(columns), axis=0), 1e-300))[0]
    way = travel(log.position, log.velocity)
    coefficients = record.given | dict(zip([*curve.names, *record.body], x.tolist(), strict=True))
    fast = float(np.max(abs(v)))
    seen = seen_speeds(abs(v[record.at]))
    turns, placed = bool(min(v.max(), -v.min()) > 0.1 * fast), log.sources.get("position") != INTEGRAL
    offset = coefficients.get("offset", 0.0)
    y, carried = record.column(log.position), {"": offset}
    if placed and "offset" in record.body:  # the offset, and a weight by position
        a = np.column_stack([columns, *(record.column(c) for c in (np.sin(log.position), np.cos(log.position)))])
        z = np.linalg.lstsq(a, record.force, rcond=1e-7)[0]
        carried = {"": float(z[n + list(record.body).index("offset")]), "sin": float(z[-2]), "cos": float(z[-1])}
    short = transmission.play(basis, residual, WIDTHS[0] * way) / way if turns else 0.0
    at = Anchor(
        curve,
        shape,
        coefficients,
        fast,
        way,
        log.step,
        turns,
        placed,
        (*seen, *speeds),
        carried,
        float(log.position[record.at].mean()),
        swing=transmission.swing(basis, residual),
        late=late,
        plays=tuple(float(f"{f * short:.2g}") for f in (0.5, 1, 2)) if turns else (),
    )
    if (between := ripple_range(log, record.q)) is None:
        return at
    side = np.sign(record.column(v))
    of_level = tuple(ripple_waves(y, residual * side, *between, 1))
    return replace(at, waves=tuple(ripple_waves(y, residual, *between, 2)), level_waves=of_level)


def refine(lib: SteadyLibrary, rows: float) -> None:
    """Add nodes at the optima of the best sets of forms and of the law alone, until the best model is at such a node.

    The next best sets are tried at these nodes too. Once a set has a node at its optimum, its models on the grid are
    dropped: there, forms would compensate the error of the slopes. A set whose optimum no law can have is dropped too.
    """
    if not lib.step:
        return
    grid, done, order = len(lib.nodes), set[frozenset[str]](), _ranked(lib, rows)
    of_set = dict[frozenset[str], Model]()
    for model, _ in order:
        of_set.setdefault(frozenset(model[1]), model)
    best = list(of_set.values())
    sought = [*best[:REFINED], *(m for m in best[REFINED:] if not m[1])]
    while sought:
        at, shapes, heights, models = dict(order), list[dict[str, float]](), list[dict[str, float]](), list[Model]()
        n = len(lib.curve.names)
        for model in sought:
            rest = lib.columns[:, lib.index(model)[lib.k :]]
            shape, y, _ = optimum(lib.law, lib.shape(model, at[model]), rest, lib.columns[:, 0])
            possible = lib.curve.possible(y[:n].tolist(), lib.largest)
            done |= {frozenset(model[1])} if possible or model[1] else set()
            if possible:
                with_ = {frozenset(m[1]): m[1] for m in (*best[:REFINED_WITH], model)}
                models += [(len(lib.nodes) + len(shapes), forms) for forms in with_.values()]
                shapes.append(shape)
                heights.append(lib.curve.anchored(y[:n].tolist()))
        if shapes:
            lib.add(shapes, heights)
        lib.keep([*(m for m in lib.models if m[0] >= grid or frozenset(m[1]) not in done), *models])
        order = _ranked(lib, rows)
        sought = [m for m, _ in order[:1] if m[0] < grid and m[1]]


def _ranked(lib: SteadyLibrary, rows: float) -> list[tuple[Model, Array]]:
    """The models and their coefficients, the best first."""
    x, sse = lib.solve(lib.gram.sum(0))
    return [(lib.models[i], x[i]) for i in np.argsort(lib.scores(sse, rows)).tolist()]


def chosen(
    record: Record, curves: Sequence[SteadyCurve], alone: bool = False, speeds: Sequence[float] = ()
) -> Selection[SteadyLibrary]:
    """The model of the least BIC among all laws and forms.

    Args:
        alone: whether forms are excluded.
        speeds: further speeds at which levels are estimated.
    """
    libraries = [library(record, curve, speeds) for curve in curves]
    rows = min(independent(lib, *lib.solve(lib.gram.sum(0))) for lib in libraries)
    for lib in libraries:
        refine(lib, rows)
    out = Selection(libraries, [lib.solve(lib.gram.sum(0))[0] for lib in libraries], rows, alone)
    out.law, out.index, *_ = out.choose(np.ones(len(libraries[0].gram)))
    lib, speed = out.library, abs(record.log.velocity[record.at])
    seen = seen_speeds(speed, sliding(record.log, lib.at, out.model[1])[record.at])
    lib.at = replace(lib.at, speeds=(*seen, *speeds))
    return out
