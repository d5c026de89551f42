"""What a static fit may lack: terms that were not fitted and that the residual asks for, and what a delay is told by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.log import INTEGRAL, Log
from stribeck.identify.methods.static_start import StaticModel
from stribeck.identify.models.memory import rows_together
from stribeck.identify.models.problem import linear_step
from stribeck.identify.models.separable import Separable, Shape
from stribeck.identify.models.static_problem import Rows
from stribeck.identify.models.terms import OF_POSITION, RIPPLE, TERMS, column
from stribeck.identify.result import Estimate, Fit
from stribeck.identify.statistics import clusters
from stribeck.identify.statistics.linear import Linear
from stribeck.identify.statistics.suspects import BEND, LOAD, LOADS, bends, builds_up, by_load

_SHARE = 0.005  # of the squared residual: what takes less away is left alone
_CLEARLY = 1.5  # halves of a 95 % interval: the best of several terms is looked at
_ONE_SIDED = 0.1  # of what tells a delay: more of it on one side
_BOTH_WAYS = 0.1  # of the fastest speed
_WIDEST = 2.0  # to each side: a wider interval is not determined
_POWERS = (1.25, 3.0)  # of the speed, beside its square
_SHORT = 0.3  # rad: on less way a weight is a constant
_EXPONENT, _USUAL = "delta", 2.0  # of the Stribeck curve, which a law takes as its default says unless it is given
_STEP = 0.05  # of the exponent, for its slope
_ALIKE = 10.0  # twice the logarithm of a likelihood: forms of a bend that differ by less are as good
_NOTHING = 1e-12  # of a coefficient: less is nothing
_EXPONENTS = (0.5, 4.0)  # between which the literature has it


@dataclass(frozen=True)
class Lacking:
    """Terms that the residual asks for: how far they would move each coordinate down and up, and what share of the squared
    residual they would take away."""

    names: tuple[str, ...]
    share: float
    below: Array
    above: Array


def open_terms(log: Log, given: Mapping[str, float] | tuple[str, ...], level: bool) -> list[str]:
    """The terms that may be added to those that are there; ``level``: the law has one, F_c, that may vary."""
    return [
        n for n, t in TERMS.items()
        if n != "mass" and n not in given and n not in (*RIPPLE, "thinning")
        and (not t.needs or getattr(log, t.needs) is not None)
        and (not t.level or level)
        and not (n.startswith("gravity") and float(np.ptp(log.position)) < _SHORT)
        and (n not in OF_POSITION or log.sources.get("position") != INTEGRAL)  # its zero is the record's own
    ]  # fmt: skip


def lacking(rows: Rows, model: StaticModel, values: Mapping[str, float], at: Linear) -> Lacking:
    """The terms that take most of the residual away, one after the other, and beyond what parts of the record differ by; each
    by the linear step from the optimum."""
    slopes, misfit = at.slopes, at.misfit
    count, parts = slopes.shape[1], clusters.parts_of(rows.log.rows(rows.kept)).number
    columns = _columns(rows, model, values)
    found: dict[str, Array] = {}
    whole = rest = float(misfit @ misfit)
    while columns and count and rest > 0:
        left = {n: _left(np.column_stack([slopes, *found.values(), x]), misfit) for n, x in columns.items()}
        name = min(left, key=lambda n: left[n])
        if left[name] > rest - _SHARE * whole:
            break
        wider = np.column_stack([slopes, *found.values(), own := columns.pop(name)])
        told = linear_step(wider, misfit)
        half = clusters.half_widths(wider, misfit - wider @ told, parts, True)[-1]
        if abs(told[-1]) < _CLEARLY * half or (_positive(name) and told[-1] < 0):
            continue
        found[name], rest = own, left[name]
        if name in LOADS:  # more is transmitted than was known
            further = dict(zip(found, told[count:].tolist(), strict=True))
            columns |= _by_load(rows, model, {**values, **further}) if LOAD not in found else {}
    shifts = np.zeros((1, count))
    for added in _forms(rows, model, at, found) if found else []:
        shifts = np.vstack([shifts, _shift(model, values, at, added)])
    return Lacking(tuple(found), 1 - rest / whole if whole > 0 else 0.0, -shifts.min(axis=0), shifts.max(axis=0))


def _positive(name: str) -> bool:
    return name == LOAD or (name in TERMS and TERMS[name].positive)


def _shift(model: StaticModel, values: Mapping[str, float], at: Linear, added: Mapping[str, Array]) -> Array:
    """How far each coordinate goes with further columns; a coefficient goes straight, whose logarithm is the coordinate."""
    step = linear_step(np.column_stack([at.slopes, *added.values()]), at.misfit)
    further = dict(zip(added, step[len(at.names) :].tolist(), strict=True))
    shapes = [s.name for s in model.whole.shapes]
    moved = step[: len(at.names)].copy()
    for k, name in enumerate(at.names):
        if name == "F_s":  # a bend has its whole height where the speed tends to 0
            moved[k] += sum(x for n, x in further.items() if n.startswith(BEND)) / values[name]
        if at.log[k] and name not in shapes:
            moved[k] = np.log(max(1 + moved[k], _NOTHING))
    return np.asarray(moved)


def _forms(rows: Rows, model: StaticModel, at: Linear, found: dict[str, Array]) -> list[dict[str, Array]]:
    """The columns that the residual asks for; with friction that bends with the speed, also other forms of it, as nothing says
    which: other powers, and those bends that the residual does not tell apart from the one that is found."""
    whole, reduce = model.whole, model.whole.columns.reduce
    v, forms = rows.log.velocity, [found]
    if "drag" in found:
        other = (whole.weight * reduce(np.sign(v) * abs(v) ** p) for p in _POWERS)
        forms += [{**found, "drag": x} for x in other]
    for name in (n for n in found if n == "thinning" or n.startswith(BEND)):
        curves = {
            n: x for n, x in {"thinning": column("thinning", rows.log, {}), **bends(rows.log)}.items() if n not in found
        }
        rest = {n: x for n, x in found.items() if n != name}
        best, left = _alone(at, found)
        together = len(left) / rows_together(left)
        for other_name, x in curves.items():
            instead = {**rest, other_name: whole.weight * reduce(x)}
            cost, _ = _alone(at, instead)
            told = linear_step(np.column_stack([at.slopes, *instead.values()]), at.misfit)[-1]
            if together * np.log(cost / max(best, 1e-300)) < _ALIKE and not (_positive(other_name) and told < 0):
                forms.append(instead)
    return forms


def _alone(at: Linear, added: Mapping[str, Array]) -> tuple[float, Array]:
    """What is left with further columns: the sum of its squares, and itself."""
    slopes = np.column_stack([at.slopes, *added.values()])
    rest = at.misfit - slopes @ linear_step(slopes, at.misfit)
    return float(rest @ rest), np.asarray(rest)


def unfitted(rows: Rows, model: StaticModel, values: Mapping[str, float], at: Linear) -> tuple[Array, Array, list[str]]:
    """How far below and above each coordinate may be because of terms that were not fitted, whose shift has a side, and of a
    delay that a filter imitates; and what a reader should know of it."""
    names = at.names
    asked = lacking(rows, model, values, at)
    late, notes = np.zeros(len(names)), []
    if asked.names:
        notes.append(
            f"{' and '.join(asked.names)} would take {asked.share:.0%} of the squared residual away: intervals reach farther to "
            "the side to which that would shift"
        )
    if "delay" in names:
        late = abs(lateness(rows, names.index("delay"), at.slopes, at.misfit))
    there = elsewhere(model, values, names, asked.names)
    return late + np.maximum(asked.below, -there), late + np.maximum(asked.above, there), notes


def elsewhere(model: StaticModel, values: Mapping[str, float], names: Sequence[str], asked: Sequence[str]) -> Array:
    """By how much each coordinate differs where the whole search is made again with the terms that the residual asks for: a bend
    of the curve that is used up by one of them lies at another place then, far from a linear step."""
    whole = model.whole
    added = [n for n in asked if n in TERMS and TERMS[n].column is not None]
    shapes, held = list(whole.shapes), dict(whole.held)
    if _EXPONENT in asked:
        least = model.law.constants()[_EXPONENT].at_least or 0.0
        shapes.append(Shape(_EXPONENT, max(_EXPONENTS[0], least), _EXPONENTS[1]))
        held.pop(_EXPONENT, None)
        values = {**values, _EXPONENT: _USUAL}
    if not (added or _EXPONENT in asked) or not whole.shapes:
        return np.zeros(len(names))
    wider = Separable(whole.columns, held, whole.wanted, (*whole.free, *added), shapes, whole.weight)
    starts = (wider.grid()[0].values, values)
    found = min((wider.refined(start) for start in starts), key=lambda each: each.cost).values
    shifts = []
    for name in names:
        if name not in TERMS or TERMS[name].positive:
            shifts.append(np.log(max(found[name], 1e-30 * values[name]) / values[name]))
        else:
            shifts.append(found[name] - values[name])
    return np.array(shifts)


def _columns(rows: Rows, model: StaticModel, values: Mapping[str, float]) -> dict[str, Array]:
    """What each term that was not fitted would add to the weighted force, per unit."""
    whole = model.whole
    there = {**whole.held, **values}
    of_law = "F_c" in whole.columns.sliding.linear
    names = [n for n in open_terms(rows.log, (*whole.terms, *model.unseen), of_law) if n != "delay"]
    if "F_c" in whole.wanted and "thinning" not in there:  # what such a curve bends by is taken for the level
        names.append("thinning")
    made = whole.columns.at(there, names)
    found = {n: whole.weight * made[n] for n in names}
    if "F_c" in whole.wanted:
        of_speed = bends(rows.log) if "F_s" not in whole.wanted else {}
        made = {**of_speed, **builds_up(rows.log)}
        found |= {n: whole.weight * whole.columns.reduce(x) for n, x in made.items()} | _by_load(rows, model, there)
    shapes = [s.name for s in whole.shapes]
    if "v_s" in shapes and _has_exponent(model) and not {_EXPONENT} & {*shapes, *model.given}:
        more, less = (whole.force_at({**there, _EXPONENT: _USUAL * (1 + by)}) for by in (_STEP, -_STEP))
        found[_EXPONENT] = whole.weight * (more - less) / (2 * _STEP * _USUAL)
    if "delay" not in shapes:
        step = rows.log.step
        later, sooner = (whole.force_at({**there, "delay": there.get("delay", 0.0) + by}) for by in (step, -step))
        found["delay"] = whole.weight * (later - sooner) / (2 * step)
    return {n: x for n, x in found.items() if np.any(x)}


def _by_load(rows: Rows, model: StaticModel, values: Mapping[str, float]) -> dict[str, Array]:
    """The column of friction that grows with what is transmitted, for the terms' coefficients."""
    whole = model.whole
    return {LOAD: whole.weight * whole.columns.reduce(by_load(rows.log, values))} if "F_c" in whole.wanted else {}


def _has_exponent(model: StaticModel) -> bool:
    """Whether the law has the exponent of the Stribeck curve; one of the user's own may mean another thing by that name."""
    constant = model.law.constants().get(_EXPONENT)
    return constant is not None and constant.unit == "" and constant.default in (None, _USUAL)


def _left(slopes: Array, misfit: Array) -> float:
    missed = misfit - slopes @ linear_step(slopes, misfit)
    return float(missed @ missed)


def one_sided(rows: Rows, slopes: Array) -> str:
    """Whether more of what tells a delay, by its slopes, lies where the speed "rises" or "falls", or neither: a filter that
    rounds off a stop makes the speed late there, and early at a start. Runs that go both ways have starts and stops alike."""
    way, own, run = _way(rows), slopes**2, rows.log.run[rows.kept]
    v = rows.log.velocity[rows.kept]
    one_way = [number for number in np.unique(run) if not _turns(v[run == number])]
    own_way = np.isin(run, one_way)
    rising, falling = (float(np.sum(own[own_way & (way == side)])) for side in (1, -1))
    more = (rising - falling) / max(float(np.sum(own)), 1e-300)
    return "rises" if more > _ONE_SIDED else "falls" if more < -_ONE_SIDED else ""


def _turns(v: Array) -> bool:
    """Whether a body goes both ways, and not by noise alone."""
    fastest = float(np.max(abs(v)))
    return bool(v.min() < -_BOTH_WAYS * fastest and v.max() > _BOTH_WAYS * fastest)


def lateness(rows: Rows, delay: int, slopes: Array, misfit: Array) -> Array:
    """The shift of each coordinate, where the motion is late while the speed rises by as much as it is early while it falls."""
    return linear_step(np.column_stack([slopes, slopes[:, delay] * _way(rows)]), misfit)[:-1]


def _way(rows: Rows) -> Array:
    """1 where the speed rises, -1 where it falls."""
    return np.asarray(np.sign(rows.log.acceleration[rows.kept] * rows.log.velocity[rows.kept]))


def beside(fit: Fit, values: Mapping[str, float]) -> Fit:
    """A fit that another law beats, with intervals that are wider to each side by what that law's numbers differ by."""

    def wider(name: str, told: Estimate) -> Estimate:
        other = values.get(name)
        if other is None or not told.identifiable or told.value is None or told.low is None or told.high is None:
            return told
        if min(told.value, told.low, other) > 0:
            factor = max(told.value / other, other / told.value)
            low, high = told.low / factor, told.high * factor
            if high / low > _WIDEST**2:
                why = f"another law predicts data left out better, and has {other:.4g} {told.unit} for it"
                return replace(told, value=None, low=low, high=high, identifiable=False, why=why, best=told.value)
            return replace(told, low=low, high=high)
        by = abs(other - told.value)
        return replace(told, low=told.low - by, high=told.high + by)

    return replace(
        fit,
        estimates={n: wider(n, e) for n, e in fit.estimates.items()},
        body={n: wider(n, e) for n, e in fit.body.items()},
    )
