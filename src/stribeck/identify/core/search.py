"""Searches for the best sets of forms.

Every form is tried at every node of the shapes by Schur complements. The best sets then get nodes at their own optima.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.core.forms import Anchor, Key, forms, ripple_range, ripple_waves
from stribeck.identify.core.library import RIDGE, Model, ModelLibrary, SteadyLibrary, seen_speeds
from stribeck.identify.log import INTEGRAL, Log
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.record import LawColumns, Record

# Nodes of the grid by the number of shapes: factors of 1.5 to 3 apart, where a slope still holds.
CELLS = {0: (), 1: (16,), 2: (9, 6), 3: (5, 4, 4)}
BEAM, KEPT = 6, 250  # sets of forms kept at each depth, and models of all depths
MOST = 4  # forms of a model: six helped 3 and ruined 2 of 17 measured records
STEPS = 8  # Gauss-Newton steps at most: near an optimum each step squares the distance that is left
REFINED, REFINED_WITH = 4, 12  # sets of forms with a node of their own; sets tried there, as ranks change at an optimum
RANK = 1e-9  # share of the largest singular value below which a direction of the columns counts as 0
SHORTER = (1.0, 0.4, 0.15, 0.05)  # parts of a step that are tried: a step that fails at a twentieth ends the search
LITTLE = 1e-5  # relative reduction of the squared residual below which the search ends
HARDLY = 1e-3  # of a column's square: a smaller part independent of the model cannot be separated from it
SHOWN = 0.05  # of a bend's height: the least that must occur in the record
STEEPNESS = 0.02  # of the level: the least coefficient for the slopes at an optimum
COST = 0.04  # fall of the log squared residual per column that pays in the beam: BIC with some 200 independent rows
ROOM = 3.0  # times the range of a shape that is searched: a step of the grid
FAINT = 1e-9  # largest value up to which a column counts as 0


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

    def solved(columns: Array, at: Mapping[str, float]) -> tuple[Array, float]:
        """The law's coefficients and the squared residual, with the coefficients of ``rest`` eliminated."""
        d = _sizes(columns)
        left, target = beside(columns / d), beside(_target(law, at, force))
        left[:, _sizes(left) < RANK] = 0.0  # in the span of the others
        x = np.linalg.lstsq(left, target, rcond=RANK)[0] if len(d) else np.zeros(0)
        r = target - left @ x
        return x / d, float(r @ r)

    n, shape = len(law.curve.names), dict(shape)
    x, sse = solved(law.at(shape), shape)
    for _ in range(STEPS if shape else 0):
        height = dict(zip(law.curve.names, x.tolist(), strict=False))
        z, _ = solved(law.with_slopes(shape, height), shape)
        step, before = np.clip(z[n : n + len(shape)], -1.0, 1.0), sse
        for part in SHORTER:
            other = {m: s * float(np.exp(part * e)) for (m, s), e in zip(shape.items(), step.tolist(), strict=True)}
            y, remaining = solved(law.at(other), other)
            if remaining < sse:
                shape, x, sse = other, y, remaining
                break
        if sse > before * (1 - LITTLE):
            break
    further = back.T @ (basis.T @ (_target(law, shape, force) - law.at(shape) @ x)) / size
    return shape, np.concatenate([x, further]), sse


def _sizes(columns: Array) -> Array:
    """The norm of each column."""
    return np.asarray(np.maximum(np.sqrt(np.einsum("ij,ij->j", columns, columns)), 1e-300))


def _target(law: LawColumns, shape: Mapping[str, float], force: Array) -> Array:
    """The force less that of the law's given constants."""
    known = law.known(shape)
    return force if known is None else force - known


def library(record: Record, curve: SteadyCurve, speeds: Sequence[float] = ()) -> SteadyLibrary:
    """All columns, their Gram matrices, and the models of a beam search.

    Args:
        speeds: of further levels.
    """
    ranges = curve.ranges(record.log.velocity)
    axes = {n: np.geomspace(*ranges[n], c) for n, c in zip(curve.shapes, CELLS[len(curve.shapes)], strict=True)}
    mesh = np.stack([m.ravel() for m in np.meshgrid(*axes.values(), indexing="ij")], -1).tolist() if axes else [[]]
    shapes = [dict(zip(axes, p, strict=True)) for p in mesh]
    body = np.column_stack(list(record.body.values()))
    best, at_nodes = shapes[0], []
    least, law = np.inf, record.of(curve)
    for shape in shapes:
        x, sse = _plain(record, law, shape, body)
        at_nodes.append(x)
        if sse < least:
            least, best = sse, shape
    shape, x, _ = optimum(law, best, body, record.force)
    if not _sound(curve, shape, x, ranges):
        shape, x = best, at_nodes[shapes.index(best)]
    at = anchor(record, law, shape, x, body, speeds)
    out = _with_forms(record, law, at, body, [float(np.log(a[1] / a[0])) for a in axes.values()])
    n = len(curve.names)
    out.add([*shapes, shape], [curve.anchored(c[:n].tolist()) for c in (*at_nodes, x)])
    search(out)
    return out


def _plain(record: Record, law: LawColumns, shape: Mapping[str, float], body: Array) -> tuple[Array, float]:
    """Coefficients of the law alone, and the squared residual with a penalty for impossible coefficients."""
    curve, a, target = law.curve, np.column_stack([law.at(shape), body]), _target(law, shape, record.force)
    x = np.linalg.lstsq(a, target, rcond=RANK)[0]
    r = target - a @ x
    coefficients = {n: np.asarray(x[i : i + 1], float) for i, n in enumerate(curve.names)}
    fault = float(curve.fault(coefficients, 0.0, float(np.max(abs(record.force))))[0]) if coefficients else 1.0
    return np.asarray(x, float), float(r @ r) * fault


def _sound(curve: SteadyCurve, shape: Mapping[str, float], x: Array, ranges: Mapping[str, tuple[float, float]]) -> bool:
    """Whether the optimum of the law alone is possible, and so may define the forms."""
    n = len(curve.names)
    inside = all(ranges[m][0] / ROOM < s < ROOM * ranges[m][1] for m, s in shape.items())
    return inside and (n == 0 or (x[0] > 0 and float(x[:n].min()) >= 0))


def _with_forms(record: Record, law: LawColumns, at: Anchor, body: Array, step: list[float]) -> SteadyLibrary:
    """The library without nodes: force, body, and all forms that vary in the record and are not in the body."""
    form_columns: list[Array] = []
    groups, size, name = dict[str, list[int]](), dict[int, float](), dict[int, Key]()
    whole = {key: record.column(column()) for key, column in forms(record.log, at).items()}
    held = {key[0] for key, c in whole.items() if _in_body(c, body)}
    for key, column in whole.items():
        largest = np.max(abs(column))
        if largest <= FAINT or key[0] in held or (key[0].startswith(("bend", "uneven bend")) and largest < SHOWN):
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
    return any(size * float(b @ b) * (1 - FAINT) < float(column @ b) ** 2 for b in body.T)


def anchor(
    record: Record, law: LawColumns, shape: Mapping[str, float], x: Array, body: Array, speeds: Sequence[float]
) -> Anchor:
    """The constants of the forms' columns from a fit of the law alone, and the ripples in its residual."""
    curve, log, v, n = law.curve, record.log, record.log.velocity, len(law.curve.names)
    coefficients = record.given | dict(zip([*curve.names, *record.body], x.tolist(), strict=True))
    fast = float(np.max(abs(v)))
    seen = seen_speeds(abs(v[record.at]))
    columns, target = np.column_stack([law.at(shape), body]), _target(law, shape, record.force)
    turns, placed = bool(min(v.max(), -v.min()) > 0.1 * fast), log.sources.get("position") != INTEGRAL
    offset = coefficients.get("offset", 0.0)
    y, carried = record.column(log.position), {"": offset}
    if placed and "offset" in record.body:  # the offset, and a weight by position
        a = np.column_stack([columns, *(record.column(c) for c in (np.sin(log.position), np.cos(log.position)))])
        z = np.linalg.lstsq(a, target, rcond=1e-7)[0]
        carried = {"": float(z[n + list(record.body).index("offset")]), "sin": float(z[-2]), "cos": float(z[-1])}
    at = Anchor(curve, shape, coefficients, fast, _way(log), log.step, turns, placed, (*seen, *speeds), carried)
    if (between := ripple_range(log, record.q)) is None:
        return at
    residual, side = target - columns @ x, np.sign(record.column(v))
    of_level = tuple(ripple_waves(y, residual * side, *between, 1))
    return replace(at, waves=tuple(ripple_waves(y, residual, *between, 2)), level_waves=of_level)


def _way(log: Log) -> float:
    """The travel between reversals: half of the total travel is in longer strokes."""
    moving = np.flatnonzero(np.sign(log.velocity))
    turn = moving[1:][np.diff(np.sign(log.velocity[moving])) != 0]
    ways = np.sort(abs(np.diff(log.position[turn]))) if len(turn) > 1 else np.array([np.ptp(log.position)])
    gone = np.cumsum(ways)
    return float(ways[np.searchsorted(gone, 0.5 * gone[-1])])


Met = dict[tuple[int, frozenset[str]], tuple[float, tuple[str, ...]]]  # squared residual and forms, by node and set


def search(lib: ModelLibrary) -> None:
    """Beam search: every form is added to each set of the beam at every node, and the best models are kept."""
    total, met, allowed = lib.gram.sum(0), Met(), {g: lib.allowed(g) for g in lib.groups}
    beam: list[tuple[str, ...]] = [()]
    for depth in range(MOST + 1):
        tried: dict[frozenset[str], tuple[float, tuple[str, ...]]] = {}
        for chosen in beam:
            _try_beside(lib, total, chosen, allowed if depth < MOST else {}, met, tried)
        beam = [c for _, c in sorted(tried.values(), key=lambda e: e[0])[:BEAM]]
    taken: list[Model] = []
    many = [0] * (MOST + 1)
    for (s, _), (_, chosen) in sorted(met.items(), key=lambda e: e[1][0]):
        if many[len(chosen)] < KEPT // (MOST + 1):
            taken.append((s, chosen))
            many[len(chosen)] += 1
    lib.keep(taken)


def _try_beside(
    lib: ModelLibrary, total: Array, chosen: tuple[str, ...], allowed: Mapping[str, Array], met: Met,
    tried: dict[frozenset[str], tuple[float, tuple[str, ...]]],
) -> None:  # fmt: skip
    """The squared residual of one set of forms at all nodes, and of this set with each other form that is allowed added."""
    nodes, target = range(len(lib.starts)), np.array(lib.targets)
    a_i = np.array([lib.index((s, chosen)) for s in nodes])
    rest = {g: lib.groups[g] for g in allowed if g not in chosen}
    b_i = np.array([i for members in rest.values() for i in members], dtype=int)
    a = total[a_i[:, :, None], a_i[:, None, :]]
    d = np.sqrt(np.maximum(np.einsum("mii->mi", a), 1e-300))
    to_force = total[a_i, target[:, None]]
    b = np.concatenate([total[a_i[:, :, None], b_i[None, None]], to_force[:, :, None]], axis=2) / d[:, :, None]
    y = np.linalg.solve(a / d[:, :, None] / d[:, None, :] + RIDGE * np.eye(a_i.shape[1]), b)
    force, diag = total[target, target], np.diag(total)[b_i]
    sse = np.maximum(force - np.einsum("mi,mi->m", b[:, :, -1], y[:, :, -1]), 1e-12 * force)
    left = diag - np.einsum("mij,mij->mj", b[:, :, :-1], y[:, :, :-1])
    share = total[b_i[None, :], target[:, None]] - np.einsum("mi,mij->mj", b[:, :, -1], y[:, :, :-1])
    fault = lib.fault(y[:, :, -1] / d)
    for s in nodes:
        met[s, frozenset(chosen)] = (float(sse[s] * fault[s]), chosen)
    j = 0
    for g, members in rest.items():
        w = list(range(j, j + len(members)))
        j += len(members)
        ok = np.all(left[:, w] / diag[w] > HARDLY, axis=1) & allowed[g]
        gain = _gain(total, left, share, b, y, b_i, w)
        after = np.where(ok, np.maximum(sse - gain, 1e-12) * np.where(fault > 50, fault, 1.0), np.inf)
        new, key = (*chosen, g), frozenset((*chosen, g))
        cost = float(np.log(after.min())) + COST * sum(len(lib.groups[h]) for h in new)
        if np.isfinite(cost) and (key not in tried or cost < tried[key][0]):
            tried[key] = cost, new
        for s in np.argsort(after)[:3].tolist():
            if np.isfinite(after[s]):
                met.setdefault((s, key), (float(after[s]), new))


def _gain(total: Array, left: Array, share: Array, b: Array, y: Array, b_i: Array, w: list[int]) -> Array:
    """The reduction of the squared residual by a form of one or two columns, at every node."""
    if len(w) == 1:
        return np.asarray(share[:, w[0]] ** 2 / np.maximum(left[:, w[0]], 1e-300))
    p, q = w
    pq = total[b_i[p], b_i[q]] - np.einsum("mi,mi->m", b[:, :, p], y[:, :, q])
    det = np.maximum(left[:, p] * left[:, q] - pq**2, 1e-12 * left[:, p] * left[:, q])
    crossed = share[:, p] ** 2 * left[:, q] + share[:, q] ** 2 * left[:, p] - 2 * pq * share[:, p] * share[:, q]
    return np.asarray(crossed / det)


def refine(lib: SteadyLibrary, rows: float) -> None:
    """Add nodes at the optima of the best sets of forms and of the law alone. The next best sets are tried there too.

    Without these nodes, forms would compensate the grid's error.
    """
    if not lib.step:
        return
    x, sse = lib.solve(lib.gram.sum(0))
    order = np.argsort(lib.scores(sse, rows)).tolist()
    sets: dict[frozenset[str], Model] = {}
    for i in order:
        sets.setdefault(frozenset(lib.models[i][1]), lib.models[i])
    ranked = list(sets.values())
    alone = [m for m in ranked[REFINED:] if not m[1]]
    at = {lib.models[i]: i for i in order}
    shapes, heights, models = list[dict[str, float]](), list[dict[str, float]](), list[Model]()
    n = len(lib.curve.names)
    for model in (*ranked[:REFINED], *alone):
        rest = lib.columns[:, lib.index(model)[lib.k :]]
        shape, y, _ = optimum(lib.law, lib.shape(model, x[at[model]]), rest, lib.columns[:, 0])
        if not lib.curve.possible(y[:n].tolist(), lib.largest):
            continue
        with_ = ranked[:REFINED_WITH] if model not in alone else [model]
        models += [(len(lib.nodes) + len(shapes), m[1]) for m in with_]
        shapes.append(shape)
        heights.append(lib.curve.anchored(y[:n].tolist(), STEEPNESS))
    if shapes:
        lib.add(shapes, heights)
        lib.keep([*lib.models, *models])
