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
from stribeck.identify.statistics.suspects import BEND, LAG, LOAD, LOADS, UNSTEADY, bends, builds_up, by_load, turns

_SHARE = 0.005  # of the squared residual: what takes less away is left alone
_CLEARLY = 1.5  # halves of a 95 % interval: the best of several terms is looked at
_ONE_SIDED = 0.1  # of what tells a delay: more of it on one side
_WIDEST = 2.0  # to each side: a wider interval is not determined
_POWERS = (1.25, 3.0)  # of the speed, beside its square
_SHORT = 0.3  # rad: on less way a weight is a constant
_EXPONENT, _USUAL = "delta", 2.0  # of the Stribeck curve, which a law takes as its default says unless it is given
_STEP = 0.05  # of the exponent, for its slope
_ALIKE = 10.0  # twice the logarithm of a likelihood: forms of a bend that differ by less are as good
_AS_GOOD = 1.1  # of what is left: a column that leaves no more may be the first one
_UNSTEADY = 0.05  # of what is left: so much less without memory of the friction
_MOST = 6  # columns, where friction that no term is may be among them: more add up to anything
_MOST_OF_CURVE = 2  # bends of the curve at low speed
_NOTHING = 1e-12  # of a coefficient: less is nothing
_EXPONENTS = (0.5, 4.0)  # between which the literature has it


@dataclass(frozen=True)
class Lacking:
    """What the residual asks for: in words, what share of the squared residual it would take away, and how far they would
    move each coordinate down and up; ``sets``: the columns of terms alone, and of all; ``forms``: all that may stand for them;
    ``unsteady``: friction is not what it is at a steady speed, which no term tells as well."""

    names: tuple[str, ...]
    sets: tuple[dict[str, Array], ...]
    share: float
    below: Array
    above: Array
    forms: tuple[dict[str, Array], ...]
    unsteady: bool

    @property
    def taken(self) -> str:
        """In words, where there are ``names``."""
        return f"{', or '.join(self.names)} would take {self.share:.0%} of the squared residual away"


def open_terms(log: Log, given: Mapping[str, float] | tuple[str, ...], level: bool) -> list[str]:
    """The terms that may be added to those that are there; ``level``: the law has one, F_c, that may vary."""
    return [
        n for n, t in TERMS.items()
        if n != "mass" and n not in given and n not in (*RIPPLE, "thinning", "play", "F_c_by_direction")
        and (not t.needs or getattr(log, t.needs) is not None)
        and (not t.level or level)
        and not (n.startswith("gravity") and float(np.ptp(log.position)) < _SHORT)
        and (n not in OF_POSITION or log.sources.get("position") != INTEGRAL)  # its zero is the record's own
    ]  # fmt: skip


def lacking(rows: Rows, model: StaticModel, values: Mapping[str, float], at: Linear) -> Lacking:
    """What takes most of the residual away: terms alone, and with friction that no term is."""
    terms, whole = _columns(rows, model, values), float(at.misfit @ at.misfit)
    asked = _greedy(rows, model, values, at, terms)
    forms, sets = _forms(rows, model, at, asked, terms), [asked]
    if "F_c" in model.whole.wanted:
        every = {**terms, **_suspects(rows, model, values)}
        for first in ((), (LOAD,)):
            each = _greedy(rows, model, values, at, every, first, _MOST)
            if all(set(each) != set(other) for other in sets):
                sets.append(each)
                forms += _forms(rows, model, at, each, every)
    shifts = np.vstack([np.zeros((1, len(at.names))), *(_shift(model, values, at, added) for added in forms)])
    left = [_alone(at, each)[0] for each in sets]
    best = sets[int(np.argmin(left))]
    unsteady = any(n.startswith(UNSTEADY) for n in best) and min(left) < (1 - _UNSTEADY) * left[0]
    share = 1 - min(left) / whole if whole > 0 else 0.0
    names = tuple(dict.fromkeys(" and ".join(each) for each in sets if each))
    return Lacking(names, tuple(sets), share, -shifts.min(axis=0), shifts.max(axis=0), tuple(forms), unsteady)


def _greedy(
    rows: Rows,
    model: StaticModel,
    values: Mapping[str, float],
    at: Linear,
    columns: Mapping[str, Array],
    first: Sequence[str] = (),
    most: int | None = None,
) -> dict[str, Array]:
    """The columns that take most of the residual away, one after the other, and beyond what parts of the record differ by;
    ``first``: of those that are as good to begin with, the one to take; ``most``: how many."""
    slopes, misfit = at.slopes, at.misfit
    count, parts = slopes.shape[1], clusters.parts_of(rows.log.rows(rows.kept))
    found: dict[str, Array] = {}
    open_, whole = dict(columns), float(misfit @ misfit)
    rest = whole
    while open_ and count and rest > 0 and (most is None or len(found) < most):
        left = {n: _left(np.column_stack([slopes, *found.values(), x]), misfit) for n, x in open_.items()}
        best = min(left.values())
        name = next((n for n in first if not found and left.get(n, np.inf) < _AS_GOOD * best), "")
        name = name or min(left, key=lambda n: left[n])
        if left[name] > rest - _SHARE * whole:
            break
        wider = np.column_stack([slopes, *found.values(), own := open_.pop(name)])
        told = linear_step(wider, misfit)
        half = clusters.over_parts(wider, misfit - wider @ told, parts)[0][-1]
        if abs(told[-1]) < _CLEARLY * half or (_positive(name) and told[-1] < 0):
            continue
        found[name], rest = own, left[name]
        if sum(map(_of_curve, found)) >= _MOST_OF_CURVE:  # more would add up to anything
            open_ = {n: x for n, x in open_.items() if not _of_curve(n)}
        if LOAD in columns and name in LOADS and LOAD not in found:
            further = dict(zip(found, told[count:].tolist(), strict=True))
            open_ |= _by_load(rows, model, {**values, **further})
    return found


def _of_curve(name: str) -> bool:
    return name.startswith(BEND) or name == "thinning"


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


def _forms(
    rows: Rows, model: StaticModel, at: Linear, found: Mapping[str, Array], columns: Mapping[str, Array]
) -> list[dict[str, Array]]:
    """The columns that the residual asks for; other powers of the speed, as nothing says which; and each with one in its place
    that the residual does not tell apart from it."""
    whole, v = model.whole, rows.log.velocity
    forms = [dict(found)] if found else []
    if "drag" in found:
        other = (whole.weight * whole.columns.reduce(np.sign(v) * abs(v) ** p) for p in _POWERS)
        forms += [{**found, "drag": x} for x in other]
    best, left = _alone(at, found)
    together = len(left) / rows_together(left)
    for name in found:
        rest = {n: x for n, x in found.items() if n != name}
        for instead, x in columns.items():
            if instead in found:
                continue
            cost, _ = _alone(at, {**rest, instead: x})
            if together * np.log(max(cost, 1e-300) / max(best, 1e-300)) > _ALIKE:
                continue
            told = linear_step(np.column_stack([at.slopes, *rest.values(), x]), at.misfit)[-1]
            if not (_positive(instead) and told < 0):
                forms.append({**rest, instead: x})
    return forms


def _alone(at: Linear, added: Mapping[str, Array]) -> tuple[float, Array]:
    """What is left with further columns: the sum of its squares, and itself."""
    slopes = np.column_stack([at.slopes, *added.values()])
    rest = at.misfit - slopes @ linear_step(slopes, at.misfit)
    return float(rest @ rest), np.asarray(rest)


def unfitted(
    rows: Rows, model: StaticModel, values: Mapping[str, float], at: Linear
) -> tuple[Array, Array, list[str], Lacking]:
    """How far below and above each coordinate may be because of terms that were not fitted, whose shift has a side, and of a
    delay that a filter imitates; what a reader should know of it; and what the residual asks for."""
    names = at.names
    asked = lacking(rows, model, values, at)
    late, notes = np.zeros(len(names)), []
    if asked.names:
        notes.append(f"{asked.taken}: intervals reach farther to the side to which that would shift")
    if "delay" in names:
        late = abs(lateness(rows, names.index("delay"), at.slopes, at.misfit))
    there = elsewhere(model, values, at, asked)
    below = np.maximum(asked.below, -there.min(axis=0))
    return late + below, late + np.maximum(asked.above, there.max(axis=0)), notes, asked


def elsewhere(model: StaticModel, values: Mapping[str, float], at: Linear, asked: Lacking) -> Array:
    """By how much each coordinate differs where the whole search is made again with what the residual asks for: a bend of the
    curve that is used up by one of them lies at another place then, far from a linear step. A row for each set of columns."""
    shifts = [np.zeros(len(at.names))]
    for found in asked.sets if model.whole.shapes else ():
        if (wider := _wider(model, found)) is not None:
            known = {**values, _EXPONENT: _USUAL} if _EXPONENT in found else values
            starts = (wider.grid()[0].values, known)
            there = min((wider.refined(start) for start in starts), key=lambda each: each.cost).values
            shifts.append(np.array([_moved(name, values, there) for name in at.names]))
    return np.array(shifts)


def _wider(model: StaticModel, found: Mapping[str, Array]) -> Separable | None:
    """The model with what the residual asks for, as far as that is no linear step alone."""
    whole = model.whole
    added = [n for n in found if n in TERMS and TERMS[n].column is not None]
    shapes, held = list(whole.shapes), dict(whole.held)
    if _EXPONENT in found:
        least = model.law.constants()[_EXPONENT].at_least or 0.0
        shapes.append(Shape(_EXPONENT, max(_EXPONENTS[0], least), _EXPONENTS[1]))
        held.pop(_EXPONENT, None)
    weight = np.where(whole.weight > 0, whole.weight, np.inf)
    beside = {n: x / weight for n, x in found.items() if n not in TERMS and n != _EXPONENT}
    if not (added or beside or _EXPONENT in found):
        return None
    return Separable(whole.columns, held, whole.wanted, (*whole.free, *added), shapes, whole.weight, beside)


def _moved(name: str, values: Mapping[str, float], there: Mapping[str, float]) -> float:
    """How far a coordinate goes from one solution to another."""
    if name in TERMS and not TERMS[name].positive:
        return there[name] - values[name]
    # a bend has its whole height where the speed tends to 0
    other = there[name] + (sum(x for n, x in there.items() if n.startswith(BEND)) if name == "F_s" else 0.0)
    return float(np.log(max(other, 1e-30 * values[name]) / values[name]))


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


def _suspects(rows: Rows, model: StaticModel, values: Mapping[str, float]) -> dict[str, Array]:
    """What friction that no term is would add to the weighted force, per unit; of a law without a Stribeck bend also the
    root of the speed and a bend."""
    whole, there = model.whole, {**model.whole.held, **values}
    memory, made = builds_up(rows.log), dict[str, Array]()
    if "F_s" not in whole.wanted:
        made |= bends(rows.log, float(np.max(abs(rows.log.velocity))))
        made |= {"thinning": column("thinning", rows.log, {})} if "thinning" not in there else {}
    elif "v_s" in there:
        made |= bends(rows.log, there["v_s"])
    found = {n: whole.weight * whole.columns.reduce(x) for n, x in {**memory, **made}.items()}
    if memory:  # in one direction the filter rounds off starts and stops as a lag would
        found |= {LAG: _late_friction(rows, model, there)}
    return {n: x for n, x in {**found, **_by_load(rows, model, there)}.items() if np.any(x)}


def _late_friction(rows: Rows, model: StaticModel, there: Mapping[str, float]) -> Array:
    """What a friction level that lags behind the speed adds to the weighted force, per second."""
    whole, step = model.whole, rows.log.step

    def level(delay: float) -> Array:
        columns = whole.columns.at({**there, "delay": there.get("delay", 0.0) + delay}, ())
        return np.asarray(sum(there[n] * x for n, x in columns.items() if n in ("F_c", "F_s")))

    return np.asarray(whole.weight * (level(step) - level(-step)) / (2 * step))


def _by_load(rows: Rows, model: StaticModel, values: Mapping[str, float]) -> dict[str, Array]:
    """The column of friction that grows with what is transmitted, for the terms' coefficients."""
    whole = model.whole
    return {LOAD: whole.weight * whole.columns.reduce(by_load(rows.log, values))}


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
    one_way = [number for number in np.unique(run) if not turns(v[run == number])]
    own_way = np.isin(run, one_way)
    rising, falling = (float(np.sum(own[own_way & (way == side)])) for side in (1, -1))
    more = (rising - falling) / max(float(np.sum(own)), 1e-300)
    return "rises" if more > _ONE_SIDED else "falls" if more < -_ONE_SIDED else ""


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
