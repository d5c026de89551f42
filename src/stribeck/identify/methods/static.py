"""Inverse-model least squares: force = mass * acceleration + friction at the measured speed + offset and the like.

The published procedure for such records (Gautier; Janot, Gautier, Brunot 2019): the force and every column of the model
pass the same low-pass filter and are then thinned, which weighs all frequencies below it alike and leaves nearly
independent rows.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.identify.beyond import seen
from stribeck.identify.data.segments import constant_speed
from stribeck.identify.features.levels import levels
from stribeck.identify.log import Log
from stribeck.identify.methods.static_start import StaticModel, model
from stribeck.identify.models import terms
from stribeck.identify.models.separable import Minimum, Separable
from stribeck.identify.models.static_problem import Rows, rows_of
from stribeck.identify.models.terms import TERMS, column
from stribeck.identify.result import Estimate, Fit, Prediction
from stribeck.identify.statistics.crossvalidate import FOLDS, LeftOut, cross_validate
from stribeck.identify.statistics.linear import linearised
from stribeck.identify.statistics.static_intervals import StaticConfidenceIntervals, static_intervals

_STEADY = 0.02  # spread of the speed, as a share: less is constant velocity
_LOOKED_AT = 1_000_000  # rows searched for stretches of constant speed
_SIGN_FROM = 200_000  # rows that tell the force's sign
_FIFTH = 0.2  # of the way, left out at an end
_BENDS = 5.0  # k_v times the largest speed: a sign that bends so slowly shows no jump at a reversal
_HUBER = 1.345
_LONGEST_STEP = 0.5  # of a shape's logarithm, in the fit without a part


@dataclass(frozen=True)
class Setting:
    """What a static fit is asked for.

    Attributes:
        fixed: constants that are given.
        free: constants to fit; None for those of the machine.
        mass: kg; None fits it.
        body: terms beside mass (:data:`stribeck.identify.models.terms.TERMS`).
        decimate: rows to thin by; None chooses from the data.
        robust: Huber's loss instead of squares.
        folds: of the cross-validation; with several files, one is left out at a time instead.
    """

    fixed: Mapping[str, float]
    free: Sequence[str] | None = None
    mass: float | None = None
    body: Sequence[str] = ("offset",)
    decimate: int | None = None
    robust: bool = False
    folds: int = FOLDS


@dataclass(frozen=True)
class Settled:
    """A model at its optimum."""

    setting: Setting
    model: StaticModel
    solution: Minimum
    rows: Rows

    @cached_property
    def left_out(self) -> LeftOut:
        """What it comes to on data left out."""
        return cross_validated(self.model.whole, self.solution, self.rows, self.setting.folds, len(self.model.unseen))

    @property
    def shapes(self) -> dict[str, float]:
        """Where a wider model begins."""
        return {s.name: self.solution.values[s.name] for s in self.model.whole.shapes}


def fit_static(
    log: Log, law: str, setting: Setting | None = None, profiles: bool = True, rows: Rows | None = None
) -> Fit:
    """Fit a law's sliding friction and the body's terms by least squares on the force.

    Args:
        log, law, setting: what to fit to what, and how.
        profiles: draw the likelihood's profiles.
        rows: of the log, where other fits of it have made them.

    Raises:
        InputError: constants or terms are unknown or missing; the data do not move enough, or against the force.
    """
    setting = setting or Setting({})
    terms.check(tuple(setting.body), log)
    check_motion(log)
    rows = rows or rows_of(log, setting.decimate)
    return finished(rows, settle(rows, law, setting), profiles)


def settle(
    rows: Rows, law: str, setting: Setting, warm: Sequence[Mapping[str, float]] = (), everywhere: bool = True
) -> Settled:
    """The optimum of a model; no intervals yet.

    Args:
        warm: shapes of narrower models, from which the search begins too.
        everywhere: look over the whole grid of shapes; else only over those that the first of ``warm`` lacks.
    """
    terms.check(tuple(setting.body), rows.log)
    made = model(rows, laws.find(law), setting.fixed, setting.free, setting.mass, setting.body)
    whole = made.whole
    if not (whole.wanted or whole.free or whole.shapes):
        raise InputError(f"law '{made.law.name}': every constant is given: there is nothing to fit")
    solution = whole.search(warm, everywhere)
    whole, solution = whole.as_seen(solution, warm, everywhere)
    made = replace(made, whole=whole)
    if setting.robust:
        whole, solution = _robust(whole, solution)
        made = replace(made, whole=whole)
    _physical(made, solution)
    return Settled(setting, made, solution, rows)


def finished(
    rows: Rows, settled: Settled, profiles: bool = True, judged: StaticConfidenceIntervals | None = None
) -> Fit:
    """The fit with intervals, verdicts and what a report shows."""
    made, solution, log = settled.model, settled.solution, rows.log
    judged = judged or static_intervals(rows, made, solution, profiles)
    law, values = made.law, solution.values
    told, of_bristles = _bristles(judged.estimates, values, log)
    estimates = {n: told[n] for n in law.constants() if n in told}
    body = {n: e for n, e in told.items() if n in TERMS}
    body |= _by_direction(estimates, body, judged.names, judged.covariance)
    known = set(law.constants()) - set(made.unseen)
    prediction, friction = _prediction(made.whole, values, log, rows)
    near = rows.source.rows(slice(0, _LOOKED_AT))
    return Fit(
        law=law.name,
        method="static",
        estimates=estimates,
        body=body,
        fixed=_given(made, values),
        used={n: v for n, v in values.items() if n in known or n in TERMS or n in made.unseen},
        names=judged.names,
        covariance=judged.covariance,
        relative_force_error=_error(made.whole, values),
        data_hash=rows.source.hash,
        cross_validated_error=settled.left_out.error,
        profiles=judged.profiles,
        prediction=prediction,
        notes=(
            *rows.why,
            *made.notes,
            *_zeros(judged.estimates),
            *of_bristles,
            *judged.notes,
            f"cross-validated {settled.left_out.how}",
        ),
        details={
            **judged.details,
            "friction_error": friction,
            "rest": float(np.mean(rows.rest)),
            "seen": seen(rows.log, ~rows.rest),
            "decimation": rows.q,
            "segments": _curve(made.whole, values, constant_speed(near), near),
            "left_out": settled.left_out,
            "levels": levels(rows, made, solution),
        },
    )


def _given(made: StaticModel, values: Mapping[str, float]) -> dict[str, float]:
    """What was given, and the steepness of a sign that was taken as exact: the curve that was fitted, and no other."""
    found = dict(made.given)
    own = made.law.constants()
    if "k_v" in own and own["k_v"].default is not None and "k_v" not in found and "k_v" not in made.free:
        found["k_v"] = values["k_v"]
    return found


def _zeros(estimates: Mapping[str, Estimate]) -> list[str]:
    return [
        f"{n}: comes out as 0, at most {e.high:.3g} {e.unit}" for n, e in estimates.items() if e.value == 0.0 and e.high
    ]


def _bristles(
    estimates: Mapping[str, Estimate], values: Mapping[str, float], log: Log
) -> tuple[Mapping[str, Estimate], list[str]]:
    """What a spring may stand for, beside no friction level or one that hardly comes to its end at the speeds measured: the
    other numbers bend its line to a loop, and are not known."""
    spring, level = estimates.get("stiffness"), estimates.get("F_c")
    if spring is None or level is None or not values["stiffness"] > 0:
        return estimates, []
    found = "no friction level"
    if level.identifiable:
        fastest, reach = float(np.max(abs(log.velocity))), float(np.ptp(log.position)) / 2
        bends = "k_v" in estimates and values["k_v"] * fastest < _BENDS
        if not bends or values["stiffness"] * reach < values["F_c"]:
            return estimates, []
        found = "a sign that bends over all speeds measured"
    why = f"it may imitate the loop of presliding: there is a spring and {found}"
    doubted = {
        n: replace(e, value=None, identifiable=False, why=why, best=e.value)
        for n, e in estimates.items()
        if n != "stiffness" and e.identifiable
    }
    return {**estimates, **doubted}, [
        f"a spring and {found}: if nothing but the contact holds the body, the record is one of presliding, and the "
        "spring is that of the bristles; a law that has them tells it (lugre, fitted by the method 'presliding')"
    ]


def check_motion(log: Log) -> None:
    """Refuse what no fit can use.

    Raises:
        InputError: nothing moves, the speed or the force is constant, the force has the wrong sign.
    """
    v = log.velocity
    fastest = float(np.max(abs(v)))
    if fastest <= 0:
        raise InputError(f"{arg('velocity')}: 0 throughout: nothing moves, so there is no friction to fit")
    low, middle, high = np.quantile(v[:: max(len(v) // 1_000_000, 1)], (0.05, 0.5, 0.95))
    if high - low < 2 * _STEADY * abs(middle):
        raise InputError(
            f"{arg('velocity')}: constant ({middle:.4g} m/s within {high - low:.1g}): friction, offset and inertia cannot be "
            "told apart; measure several speeds in both directions"
        )
    if not np.ptp(log.force) > 0:
        raise InputError(f"{arg('force')}: {log.force[0]:.6g} N throughout: there is no friction to fit")
    every = max(len(log) // _SIGN_FROM, 1)
    thin = v[::every]
    rough = np.column_stack([log.acceleration[::every], thin, np.sign(thin), np.ones(len(thin))])
    rough = np.column_stack(
        [rough, log.position[::every], np.sin(log.position[::every]), np.cos(log.position[::every])]
    )
    coefficients = np.linalg.lstsq(rough / np.maximum(np.abs(rough).max(0), 1e-300), log.force[::every], rcond=1e-10)[0]
    both = v.min() < -0.1 * fastest and v.max() > 0.1 * fastest
    against = float(np.sum((coefficients[1] * thin / fastest + coefficients[2] * np.sign(thin)) * thin))
    if both and against < 0 and coefficients[1] + coefficients[2] < 0 and coefficients[2] < 0:
        raise InputError(
            f"{arg('force')}: acts against the motion: friction would put energy in; the sign is wrong "
            f"({arg('force_gain')} -1 turns it)"
        )


def _robust(whole: Separable, solution: Minimum) -> tuple[Separable, Minimum]:
    """The optimum with Huber's weights, which stay in the model."""
    base = whole.weight
    for _ in range(12):
        rest = whole.force - whole.force_at(solution.values)
        scale = 1.4826 * float(np.median(abs(rest[base > 0]))) or 1.0
        whole = whole.weighted(base * np.sqrt(np.minimum(1.0, _HUBER * scale / np.maximum(abs(rest), 1e-300))))
        before = solution
        solution = whole.refined(solution.values, 6) if whole.shapes else whole.solve({})
        if all(
            abs(solution.values[n] - x) <= 1e-6 * abs(x) for n, x in before.values.items() if not isinstance(x, str)
        ):
            break
    return whole, solution


def _physical(made: StaticModel, solution: Minimum) -> None:
    """Refuse a fit in which nothing opposes the motion.

    Raises:
        InputError: friction comes out as nothing.
    """
    whole, values = made.whole, solution.values
    own = [n for n in whole.wanted if n in values]
    if own and whole.wanted and all(values[n] <= 2 * whole.least for n in own) and "F_c" in own:
        raise InputError(
            f"{arg('force')}: friction comes out as 0 or negative, Coulomb and viscous: check the sign and gain of the force "
            f"({arg('force_gain')}), and what it holds beside friction ({arg('terms')})"
        )


def _by_direction(
    estimates: Mapping[str, Estimate], body: Mapping[str, Estimate], names: Sequence[str], covariance: Array
) -> dict[str, Estimate]:
    """Friction forwards and backwards, where the fit tells the two apart."""
    found: dict[str, Estimate] = {}
    if "sigma_2_by_direction" not in body:
        return found
    for name, other in (("F_c", "offset"), ("sigma_2", "sigma_2_by_direction")):
        if name not in names or other not in names:
            continue
        i, k = names.index(name), names.index(other)
        mean, half = estimates[name], body[other]
        if mean.value is None or half.value is None or not (mean.identifiable and half.identifiable):
            continue
        for sign, word in ((1, "forwards"), (-1, "backwards")):
            value = mean.value + sign * half.value
            spread = 1.96 * float(np.sqrt(max(covariance[i, i] + covariance[k, k] + 2 * sign * covariance[i, k], 0.0)))
            found[f"{name}_{word}"] = Estimate(value, value - spread, value + spread, mean.unit)
    return found


# -- what a report shows -----------------------------------------------------------------------------------------------


def _curve(
    whole: Separable, values: Mapping[str, float], segments: Sequence[slice], log: Log
) -> list[dict[str, float]]:
    """Speed and friction of each stretch of constant speed."""
    rest = np.zeros(len(log))
    for name in whole.terms:
        if not (TERMS[name].level or TERMS[name].friction):
            rest += values.get(name, 0.0) * column(name, log, values)
    found = []
    for s in segments:
        friction = log.force[s] - rest[s]
        found.append(
            {
                "time": float(log.time[s.start]), "duration": float(log.time[s.stop - 1] - log.time[s.start]),
                "velocity": float(np.mean(log.velocity[s])), "friction": float(np.mean(friction)),
                "deviation": float(np.std(friction)), "delay": values.get("delay", 0.0),
            }
        )  # fmt: skip
    return found


def _error(whole: Separable, values: Mapping[str, float]) -> float:
    w = whole.weight > 0
    return float(np.linalg.norm((whole.force - whole.force_at(values))[w]) / np.linalg.norm(whole.force[w]))


def _prediction(whole: Separable, values: Mapping[str, float], log: Log, rows: Rows) -> tuple[Prediction, float]:
    """Friction, measured and fitted, at the rows that were compared; and norm(residual)/norm(measured friction)."""
    body = np.zeros(len(rows.kept))
    for name, x in whole.columns.at(values, whole.terms).items():
        if name in TERMS and not (TERMS[name].level or TERMS[name].friction):
            body += values[name] * x
    measured, fitted, w = whole.force - body, whole.force_at(values) - body, rows.weight > 0
    kept = rows.kept[w]
    found = Prediction(log.time[kept], log.position[kept], log.velocity[kept], measured[w], fitted[w])
    size = float(np.linalg.norm(measured[w]))
    return found, float(np.linalg.norm((measured - fitted)[w])) / max(size, 1e-300)


def cross_validated(whole: Separable, solution: Minimum, rows: Rows, folds: int, unseen: int = 0) -> LeftOut:
    """The model fitted anew without each part of the log, and what it misses there.

    Coefficients are solved for exactly; shapes move by a step of Gauss and Newton where that fits the rest better. All that
    was sought counts as a parameter, also where it came out at its bound: rounding decides about that.
    """
    missed_without = _foretelling(whole, solution, rows)
    sought = len(whole.wanted) + len(whole.free) + len(whole.shapes) + unseen
    return cross_validate(rows.log.rows(rows.kept), folds, sought, missed_without)


def missed_beyond(settled: Settled) -> Array:
    """The sums of the squared residuals at both ends of the way, a fifth of it each, of fits without that end."""
    position = settled.rows.log.position[settled.rows.kept]
    foretold = _foretelling(settled.model.whole, settled.solution, settled.rows)
    low, high = np.quantile(position, (0.0, 1.0))
    ends = (position < low + _FIFTH * (high - low), position > high - _FIFTH * (high - low))
    return np.array([foretold(end)[0] for end in ends])


def _foretelling(whole: Separable, solution: Minimum, rows: Rows) -> Callable[[NDArray[np.bool_]], tuple[float, float]]:
    """What tells the sums of the squared residual and the squared force at rows, of a fit without them."""
    at = linearised(whole, solution)
    here = {s.name: solution.values[s.name] for s in whole.shapes}

    def missed_without(out: NDArray[np.bool_]) -> tuple[float, float]:
        training = whole.weighted(np.where(out, 0.0, whole.weight))
        found = training.solve(here)
        if whole.shapes:
            there = training.solve(_stepped(whole, here, at.names, at.slopes[~out], at.misfit[~out]))
            found = min(found, there, key=lambda s: s.cost)
        counted = out & (rows.weight > 0)
        missed, force = (whole.force - whole.force_at(found.values))[counted], whole.force[counted]
        return float(missed @ missed), float(force @ force)

    return missed_without


def _stepped(
    whole: Separable, here: Mapping[str, float], names: Sequence[str], slopes: Array, misfit: Array
) -> dict[str, float]:
    """Shapes after a step of Gauss and Newton, within their range."""
    size: Array = np.maximum(np.sqrt(np.mean(slopes**2, axis=0)), 1e-300)
    step = dict(zip(names, (np.linalg.lstsq(slopes / size, misfit, rcond=1e-10)[0] / size).tolist(), strict=True))
    moved = {}
    for s in whole.shapes:
        by = step.get(s.name, 0.0)
        by = float(np.clip(by, -_LONGEST_STEP, _LONGEST_STEP)) if s.log else by
        moved[s.name] = s.at(s.share(here[s.name] * np.exp(by) if s.log else here[s.name] + by))
    return moved
