"""What a static fit may lack: terms that were not fitted and that the residual asks for, and what a delay is told by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.log import INTEGRAL, Log
from stribeck.identify.methods.static_start import StaticModel
from stribeck.identify.models.problem import linear_step
from stribeck.identify.models.separable import Separable, Shape
from stribeck.identify.models.static_problem import Rows
from stribeck.identify.models.terms import OF_POSITION, RIPPLE, TERMS
from stribeck.identify.result import Estimate, Fit
from stribeck.identify.statistics import clusters

_SHARE = 0.005  # of the squared residual: what takes less away is left alone
_CLEARLY = 1.5  # halves of a 95 % interval: the best of several terms is looked at
_ONE_SIDED = 0.1  # of what tells a delay: more of it on one side
_BOTH_WAYS = 0.1  # of the fastest speed
_WIDEST = 2.0  # to each side: a wider interval is not determined
_POWERS = (1.25, 3.0)  # of the speed, beside its square
_SHORT = 0.3  # rad: on less way a weight is a constant
_EXPONENT, _USUAL = "delta", 2.0  # of the Stribeck curve, which a law takes as its default says unless it is given
_STEP = 0.05  # of the exponent, for its slope
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
        if n != "mass" and n not in given and n not in (*RIPPLE, "thinning", "play")
        and (not t.needs or getattr(log, t.needs) is not None)
        and (not t.level or level)
        and not (n.startswith("gravity") and float(np.ptp(log.position)) < _SHORT)
        and (n not in OF_POSITION or log.sources.get("position") != INTEGRAL)  # its zero is the record's own
    ]  # fmt: skip


def lacking(rows: Rows, model: StaticModel, values: Mapping[str, float], slopes: Array, misfit: Array) -> Lacking:
    """The terms that take most of the residual away, one after the other, and beyond what parts of the record differ by; each
    by the linear step from the optimum."""
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
        told = linear_step(wider, misfit)[-1]
        half = clusters.half_widths(wider, misfit - wider @ linear_step(wider, misfit), parts, True)[-1]
        if abs(told) < _CLEARLY * half or (name in TERMS and TERMS[name].positive and told < 0):
            continue
        found[name], rest = own, left[name]
    shifts = np.zeros((1, count))
    for added in _forms(rows, model, found) if found else []:
        step = linear_step(np.column_stack([slopes, *added.values()]), misfit)[:count]
        shifts = np.vstack([shifts, step])
    return Lacking(tuple(found), 1 - rest / whole if whole > 0 else 0.0, -shifts.min(axis=0), shifts.max(axis=0))


def _forms(rows: Rows, model: StaticModel, found: dict[str, Array]) -> list[dict[str, Array]]:
    """The columns that the residual asks for; with friction that bends with the speed, also by other powers of it, as nothing
    says which."""
    if "drag" not in found:
        return [found]
    v, whole = rows.log.velocity, model.whole
    other = {p: whole.weight * whole.columns.reduce(np.sign(v) * abs(v) ** p) for p in _POWERS}
    return [found, *({**found, "drag": x} for x in other.values())]


def unfitted(
    rows: Rows, model: StaticModel, values: Mapping[str, float], names: Sequence[str], slopes: Array, misfit: Array
) -> tuple[Array, Array, list[str]]:
    """How far below and above each coordinate may be because of terms that were not fitted, whose shift has a side, and of a
    delay that a filter imitates; and what a reader should know of it."""
    asked = lacking(rows, model, values, slopes, misfit)
    late, notes = np.zeros(len(names)), []
    if asked.names:
        notes.append(
            f"{' and '.join(asked.names)} would take {asked.share:.0%} of the squared residual away: intervals reach farther to "
            "the side to which that would shift"
        )
    if "delay" in names:
        late = abs(lateness(rows, names.index("delay"), slopes, misfit))
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
    if "F_s" in whole.wanted and "thinning" not in there:  # what such a curve bends by is taken for the Stribeck bend
        names.append("thinning")
    made = whole.columns.at(there, names)
    found = {n: whole.weight * made[n] for n in names}
    shapes = [s.name for s in whole.shapes]
    if "v_s" in shapes and _has_exponent(model) and not {_EXPONENT} & {*shapes, *model.given}:
        more, less = (whole.force_at({**there, _EXPONENT: _USUAL * (1 + by)}) for by in (_STEP, -_STEP))
        found[_EXPONENT] = whole.weight * (more - less) / (2 * _STEP * _USUAL)
    if "delay" not in shapes:
        step = rows.log.step
        later, sooner = (whole.force_at({**there, "delay": there.get("delay", 0.0) + by}) for by in (step, -step))
        found["delay"] = whole.weight * (later - sooner) / (2 * step)
    return {n: x for n, x in found.items() if np.any(x)}


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
