"""Where a static fit begins: the best shape on a grid, and all that is linear solved exactly for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear
from scipy.stats import qmc

from stribeck.errors import InputError, arg
from stribeck.identify.features.guess import Scales, ranges, scales
from stribeck.identify.features.sliding import Sliding
from stribeck.identify.log import Log, thinned
from stribeck.identify.models.dynamic_problem import free_constants
from stribeck.identify.models.problem import Coordinate, Tie
from stribeck.identify.models.static_problem import Reduce, StaticProblem
from stribeck.identify.models.terms import TERMS
from stribeck.laws.base import Law

Array = NDArray[np.float64]
_NOTHING = 1e-7  # share of the force: less is none
_GRID = 25
_REACH = 1e4
_SHARP = 1e9  # s/m


@dataclass(frozen=True)
class Start:
    """A problem and a point near its optimum.

    Attributes:
        free: the law's constants that were to be fitted; ``given``: those that were not.
        unseen: those that the data show nothing of, and why.
        at_bound: those that come out as 0, with the upper end of their interval.
        notes: for the reader.
    """

    problem: StaticProblem
    point: Array
    free: tuple[str, ...]
    unseen: dict[str, str]
    at_bound: dict[str, float]
    notes: tuple[str, ...]
    given: dict[str, float]


def solve(
    log: Log,
    law: type[Law],
    fixed: Mapping[str, float],
    free: Sequence[str] | None,
    mass: float | None,
    body: Sequence[str],
    reduce: Reduce,
    delay: float = 0.0,
) -> Start:
    """The problem of a static fit and where to begin.

    Args:
        log, law, fixed, free, mass: as in :class:`stribeck.identify.methods.static.Setting`.
        body: the terms beside mass.
        reduce: from the log's rows to those that are compared.
        delay: of the motion, where it is not a term to be fitted.

    Raises:
        InputError: a constant is unknown or missing; friction comes out negative.
    """
    held_terms = {n: v for n, v in fixed.items() if n in TERMS}
    given = {n: v for n, v in fixed.items() if n not in TERMS}
    wanted = free_constants(law, given, {}, free)
    if "k_v" in given and "k_v" not in fixed:  # a default: the force changes sign at once then, as in the literature
        given["k_v"] = _SHARP
        fixed = {**fixed, "k_v": _SHARP}  # said and written as a given constant: the law has it from now on
    sizes = scales(thinned(log), mass or 0.0)
    sliding = Sliding(law, given, _typical(law, sizes, given))
    own = law.own_constants()
    unseen = {
        n: "a static fit sees sliding at held speeds only, and there this constant plays no part"
        for n in wanted
        if n not in sliding.seen and n not in own
    }
    terms = [n for n in dict.fromkeys([*(["mass"] if mass is None else []), *body]) if n not in held_terms]
    shapes = [n for n in wanted if n not in sliding.linear and n not in unseen]
    if any(TERMS[n].level for n in terms) and "F_c" not in sliding.linear:
        raise InputError(f"{arg('terms')}: law '{law.name}' has no friction level F_c that could vary")
    held = {**{n: sliding.base[n] for n in unseen}, **given, "delay": delay, **held_terms}
    if mass is not None:
        held["mass"] = mass
    columns = list(dict.fromkeys(["mass", *terms, *held_terms]))
    draft = StaticProblem(log, sliding, [], held, {}, columns, reduce)
    span = {n: _span(n, law, sizes) for n in shapes}
    best, linear = _search(draft, span, held, wanted)
    return replace(_start(draft, sizes, best, linear, wanted, terms, unseen, span), given=dict(fixed))


def _typical(law: type[Law], sizes: Scales, given: Mapping[str, float]) -> dict[str, float]:
    """Rough values that the law allows."""
    found = {n: r.value for n, r in ranges(law, sizes).items()}
    if "F_c" in given or "F_s" in given:
        level = given.get("F_c", 0.8 * given.get("F_s", 1.0))
        found |= {"F_c": level, "F_s": given.get("F_s", 1.5 * level)}
    z_ba = given.get("z_ba", found.get("z_ba"))
    if z_ba is not None and "sigma_0" in found:
        found["sigma_0"] = min(found["sigma_0"], 0.5 * found["F_c"] / z_ba)
    return found


def _span(name: str, law: type[Law], sizes: Scales) -> tuple[float, float]:
    """Where a constant that shapes the curve is looked for."""
    constant = law.constants()[name]
    if constant.unit == "s/m":
        return 0.3 / sizes.fast, 1e4 / sizes.fast
    if constant.unit == "m/s":
        return 1e-3 * sizes.fast, 0.5 * sizes.fast
    middle = constant.example or constant.default or ranges(law, sizes)[name].value
    return 0.2 * middle, 5 * middle


def _search(
    draft: StaticProblem,
    span: Mapping[str, tuple[float, float]],
    held: Mapping[str, float],
    wanted: Sequence[str],
) -> tuple[dict[str, float], dict[str, float]]:
    """The best of a grid of shapes, and the coefficients there."""
    names = list(span)
    if not names:
        trials = np.zeros((1, 0))
    elif len(names) == 1:
        trials = np.linspace(0, 1, _GRID)[:, None]
    else:
        trials = qmc.Sobol(len(names), seed=0).random_base2(6)
    best: tuple[float, dict[str, float], dict[str, float]] | None = None
    for trial in trials:
        shape = {n: span[n][0] * (span[n][1] / span[n][0]) ** x for n, x in zip(names, trial.tolist(), strict=True)}
        found, cost = _linear(draft, {**held, **shape}, wanted)
        if found.get("F_c", 1.0) <= 0:  # a bend that takes the whole level is none
            cost *= 1e6
        if best is None or cost < best[0]:
            best = cost, shape, found
    assert best is not None
    return {**held, **best[1]}, best[2]


def _linear(draft: StaticProblem, values: Mapping[str, float], wanted: Sequence[str]) -> tuple[dict[str, float], float]:
    """The coefficients that fit best for given shapes, physical ones kept positive; and the cost."""
    columns = dict(draft.columns_at(values))
    rest = draft.force.copy()
    for name in [n for n in columns if n not in wanted and (n not in TERMS or n in values)]:
        rest -= (1.0 if name == "" else values[name]) * columns.pop(name)
    if "F_c" in columns and "F_s" in columns:  # the rise above F_c instead of F_s
        columns["F_c"] = columns["F_c"] + columns["F_s"]
    names = list(columns)
    if not names:
        return {}, float(rest @ rest)
    matrix = np.column_stack([columns[n] for n in names])
    size = np.sqrt(np.mean(matrix**2, axis=0))
    size = np.where(size > 0, size, 1.0)
    triangle: Array = np.asarray(np.linalg.qr(np.column_stack([matrix / size, rest]), mode="r"))
    positive = [n not in TERMS or TERMS[n].positive for n in names]
    low = np.where(positive, 0.0, -np.inf)
    solution = np.linalg.lstsq(triangle[:, :-1], triangle[:, -1], rcond=1e-12)[0]
    if np.any(solution < low):
        solution = lsq_linear(triangle[:, :-1], triangle[:, -1], (low, np.inf), tol=1e-14).x
    missed = triangle[:, :-1] @ solution - triangle[:, -1]
    found = dict(zip(names, (solution / size).tolist(), strict=True))
    if "F_s" in found and "F_c" in found:
        found["F_s"] += found["F_c"]
    return found, float(missed @ missed)


def _start(
    draft: StaticProblem,
    sizes: Scales,
    best: dict[str, float],
    linear: dict[str, float],
    wanted: Sequence[str],
    terms: Sequence[str],
    unseen: dict[str, str],
    span: Mapping[str, tuple[float, float]],
) -> Start:
    """Coordinates for what the data show; what comes out as nothing is held and said."""
    law, force = draft.law, sizes.force
    tied: dict[str, Tie] = {}
    at_bound: dict[str, float] = {}
    unseen = dict(unseen)
    values = {**best, **linear}
    level = linear.get("F_c")
    if level is not None and level < _NOTHING * force:
        hint = (
            f"; where all strokes have nearly one speed, give {arg('constants.sigma_2')}=0"
            if "sigma_2" in linear
            else ""
        )
        raise InputError(
            f"{arg('force')}: friction comes out as 0 or negative; check its sign and gain ({arg('force_gain')}){hint}"
        )
    if "F_s" in linear and level is not None and linear["F_s"] - level < 1e-4 * level:
        tied["F_s"] = Tie("F_c", 1.0)
        why = "friction does not rise towards low speed in these data"
        unseen |= {n: why for n in ("F_s", "v_s", "delta") if n in wanted}
    coordinates = []
    for name in wanted:
        if name in unseen or name in tied:
            continue
        if (
            name in linear
            and linear[name] * (sizes.fast if "s" in law.constants()[name].unit else 1.0) < _NOTHING * force
        ):
            at_bound[name], values[name] = _upper(draft, name, {**values, name: 0.0}), 0.0
            continue
        value = values[name]
        low, high = span.get(name, (value / _REACH, value * _REACH))
        coordinates.append(Coordinate(name, law.constants()[name].unit, low / 3, high * 3))
    for name in terms:
        term = TERMS[name]
        if term.positive and term.column is not None and name in linear:
            size = float(np.max(abs(draft.columns_at(values)[name])))
            if linear[name] * size < _NOTHING * force:
                at_bound[name], values[name] = _upper(draft, name, {**values, name: 0.0}), 0.0
                continue
        coordinates.append(_term(name, values.get(name, 0.0), draft, force))
    free = {c.name for c in coordinates} | set(tied)
    fixed = {n: v for n, v in values.items() if n not in free}
    columns = [n for n in draft.terms if n in free or n in fixed]
    problem = StaticProblem(draft.log, draft.sliding, coordinates, fixed, tied, columns, draft.reduce)
    point = np.clip([c.inner(values[c.name]) if values.get(c.name) else 0.0 for c in coordinates], *problem.bounds)
    problem.home = point
    notes = [f"{n}: comes out as 0, at most {high:.3g} {unit_of(law, n)}" for n, high in at_bound.items()]
    return Start(problem, np.asarray(point), tuple(wanted), unseen, at_bound, tuple(notes), {})


def unit_of(law: type[Law], name: str) -> str:
    """The unit of a constant of the law or of a term of the body."""
    return TERMS[name].unit if name in TERMS else law.constants()[name].unit


def _term(name: str, value: float, draft: StaticProblem, force: float) -> Coordinate:
    term = TERMS[name]
    if term.positive and value > 0:
        return Coordinate(name, term.unit, value / _REACH, value * _REACH)
    if term.column is None:
        step = draft.log.step
        return Coordinate(name, term.unit, -50 * step, 50 * step, log=False, scale=step)
    size = force / max(
        float(np.quantile(abs(term.column(draft.log)[:: max(len(draft.log) // 100_000, 1)]), 0.99)), 1e-300
    )
    return Coordinate(name, term.unit, -1e4 * size, 1e4 * size, log=False, scale=size)


def _upper(draft: StaticProblem, name: str, values: Mapping[str, float]) -> float:
    """The upper end of a one-sided interval of a coefficient that comes out as 0."""
    rest = draft.force - draft.model(values)
    column = draft.columns_at(values)[name]
    return float(1.645 * np.std(rest) * np.sqrt(10.0) / np.linalg.norm(column))
