"""Inverse-model least squares: force = mass * acceleration + friction at the measured speed + offset and the like.

The published procedure for such records (Gautier; Janot, Gautier, Brunot 2019): the force and every column of the model
pass the same low-pass filter and are then thinned, which weighs all frequencies below it alike and leaves nearly
independent rows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from stribeck import laws
from stribeck.errors import InputError, arg
from stribeck.identify.data.segments import constant_speed, distinct_speeds
from stribeck.identify.features.guess import scales
from stribeck.identify.features.levels import levels
from stribeck.identify.features.what_to_measure import experiment_for
from stribeck.identify.log import Log, thinned
from stribeck.identify.methods.optimise import descend
from stribeck.identify.methods.static_start import Start, solve, unit_of
from stribeck.identify.models import terms
from stribeck.identify.models.static_problem import StaticProblem, averaging, decimation, kept_rows, thinning
from stribeck.identify.models.terms import TERMS
from stribeck.identify.result import Estimate, Fit, Prediction
from stribeck.identify.statistics import uncertainty
from stribeck.identify.statistics.crossvalidate import FOLDS, LeftOut, groups

Array = NDArray[np.float64]
_FEWEST_SPEEDS, _FEWEST_SEGMENTS = 5, 8
_STEADY = 0.02  # spread of the speed, as a share: less is constant velocity
_LOOKED_AT = 1_000_000  # rows searched for stretches of constant speed
_HUBER = 1.345
_PARTS = 10  # of a stretch of constant speed


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
        segments: take the curve from stretches of constant speed; None does where the law has a Stribeck velocity and
            there are enough of them.
        folds: of the cross-validation; with several files, one is left out at a time instead.
    """

    fixed: Mapping[str, float]
    free: Sequence[str] | None = None
    mass: float | None = None
    body: Sequence[str] = ("offset",)
    decimate: int | None = None
    robust: bool = False
    segments: bool | None = None
    folds: int = FOLDS


def fit_static(log: Log, law: str, setting: Setting | None = None, profiles: bool = True) -> Fit:
    """Fit a law's sliding friction and the body's terms by least squares on the force.

    Raises:
        InputError: constants or terms are unknown or missing; the data do not move enough, or against the force.
    """
    setting = setting or Setting({})
    found = laws.find(law)
    terms.check(tuple(setting.body), log)
    check_motion(log)
    q, why = (setting.decimate, f"one row in {setting.decimate} is fitted") if setting.decimate else decimation(log)
    begun = solve(log, found, setting.fixed, setting.free, setting.mass, setting.body, thinning(log, q))
    problem, u = begun.problem, _settled(begun.problem, begun.point, setting.robust)
    notes = [why, *begun.notes]
    near = log.rows(slice(0, _LOOKED_AT))
    segments = constant_speed(near)
    speeds = distinct_speeds(log, segments)
    wanted = setting.segments
    if wanted is None:
        wanted = "v_s" in begun.free
    if wanted and speeds >= _FEWEST_SPEEDS and len(segments) >= _FEWEST_SEGMENTS:
        fit = _by_segments(log, begun, u, setting, segments, profiles)
    else:
        if wanted:
            notes.append(
                f"{len(segments)} stretches of constant speed at {speeds} speeds are too few for a curve of their own "
                f"({_FEWEST_SPEEDS} speeds, {_FEWEST_SEGMENTS} stretches): all rows were fitted together"
            )
        fit = _judged(begun, problem, u, log, profiles)
    values = {**problem.values(u), **fit.used}
    left_out = cross_validate(problem, u, log, q, setting.folds)
    left_out = replace(left_out, parameters=len(u) + len(begun.unseen))  # what the law wants to know
    return replace(
        fit,
        relative_force_error=_error(problem, values),
        cross_validated_error=left_out.error,
        prediction=_prediction(problem, values, log, kept_rows(log, q)),
        notes=(*notes, *fit.notes, f"cross-validated {left_out.how}"),
        details={
            **fit.details,
            "decimation": q,
            "segments": _curve(problem, values, segments, near),
            "left_out": left_out,
            "levels": levels(problem, u, log, q),
        },
    )


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
    every = max(len(log) // 1_000_000, 1)
    thin = v[::every]
    rough = np.column_stack([log.acceleration[::every], thin, np.sign(thin), np.ones(len(thin))])
    coefficients = np.linalg.lstsq(rough / np.maximum(np.abs(rough).max(0), 1e-300), log.force[::every], rcond=1e-10)[0]
    both = v.min() < -0.1 * fastest and v.max() > 0.1 * fastest
    if both and coefficients[1] + coefficients[2] < 0 and coefficients[2] < 0:
        raise InputError(
            f"{arg('force')}: acts against the motion: friction would put energy in; the sign is wrong "
            f"({arg('force_gain')} -1 turns it)"
        )


def _settled(problem: StaticProblem, u: Array, robust: bool) -> Array:
    """The optimum; with Huber's weights where the loss is to be robust (they stay in the problem)."""
    if not len(u):
        raise InputError(f"law '{problem.law.name}': every constant is given: there is nothing to fit")
    u = descend(problem, u, 1e-14, 60).point
    for _ in range(12 if robust else 0):
        rest = problem.force - problem.model(problem.values(u))
        scale = 1.4826 * float(np.median(abs(rest))) or 1.0
        problem.reweigh(np.sqrt(np.minimum(1.0, _HUBER * scale / np.maximum(abs(rest), 1e-300))))
        u = descend(problem, u, 1e-10, 30).point
    return u


def _judged(begun: Start, problem: StaticProblem, u: Array, log: Log, profiles: bool) -> Fit:
    """The fit of one problem, without what is told of all rows."""
    judged = uncertainty.judge(problem, u, thinned(log), profiles)
    values = problem.values(judged.point)
    judgements = {**judged.estimates, **_unseen(begun, log, values)}
    estimates = {n: e for n, e in judgements.items() if n not in TERMS}
    order = [n for n in problem.law.constants() if n in estimates]
    body = {n: e for n, e in judgements.items() if n in TERMS}
    body |= _by_direction(estimates, body, judged.names, judged.covariance)
    return Fit(
        law=problem.law.name,
        method="static",
        estimates={n: estimates[n] for n in order},
        body=body,
        fixed=dict(begun.given),
        used={n: v for n, v in values.items() if n in problem.law.constants() or n in TERMS},
        names=judged.names,
        covariance=judged.covariance,
        relative_force_error=_error(problem, values),
        data_hash=log.hash,
        profiles=judged.profiles,
        notes=judged.notes,
        details={"noise": judged.noise},
    )


def _unseen(begun: Start, log: Log, values: Mapping[str, float]) -> dict[str, Estimate]:
    """Verdicts on the constants that a static fit cannot see, or that the data show nothing of."""
    found = {}
    for name, why in begun.unseen.items():
        unit = begun.problem.law.constants()[name].unit
        advice = experiment_for(name, values, scales(thinned(log)))
        found[name] = Estimate(None, None, None, unit, False, why, advice)
    for name, high in begun.at_bound.items():
        unit = unit_of(begun.problem.law, name)
        found[name] = Estimate(0.0, 0.0, high, unit, True, "at its lower bound, 0")
    return found


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
        if mean.value is None or half.value is None:
            continue
        for sign, word in ((1, "forwards"), (-1, "backwards")):
            value = mean.value + sign * half.value
            spread = 1.96 * float(np.sqrt(covariance[i, i] + covariance[k, k] + 2 * sign * covariance[i, k]))
            found[f"{name}_{word}"] = Estimate(value, value - spread, value + spread, mean.unit)
    return found


# -- constant speeds -------------------------------------------------------------------------------------------------


def _by_segments(log: Log, begun: Start, u: Array, setting: Setting, segments: Sequence[slice], profiles: bool) -> Fit:
    """The curve from stretches of constant speed; what needs acceleration stays as all rows tell it."""
    whole = _judged(begun, begun.problem, u, log, profiles=False)
    held: dict[str, float] = {n: x for n, x in begun.problem.values(u).items() if n in ("mass", "delay")}
    body = [n for n in setting.body if n != "delay"]
    again = solve(
        log, begun.problem.law, setting.fixed, setting.free, held.get("mass", 0.0), body, averaging(_parts(segments)),
        delay=held.get("delay", 0.0),
    )  # fmt: skip
    point = _settled(again.problem, again.point, setting.robust)
    fit = _judged(again, again.problem, point, log, profiles)
    kept = {n: e for n, e in whole.body.items() if n in ("mass", "delay")}
    note = (
        f"friction from {len(segments)} stretches of constant speed (their error {100 * fit.relative_force_error:.3g} % of "
        "their force), mass from all rows"
    )
    return replace(fit, body={**kept, **fit.body}, used={**fit.used, **held}, notes=(*again.notes, *fit.notes, note))


def _parts(segments: Sequence[slice]) -> list[slice]:
    """Each stretch in up to ten parts: what they differ by is noise, and tells how sure the curve is."""
    found = []
    for s in segments:
        count = min(_PARTS, (s.stop - s.start) // 20 or 1)
        edges = np.linspace(s.start, s.stop, count + 1).astype(int).tolist()
        found += [slice(a, b) for a, b in pairwise(edges)]
    return found


def _curve(
    problem: StaticProblem, values: Mapping[str, float], segments: Sequence[slice], log: Log
) -> list[dict[str, float]]:
    """Speed and friction of each stretch of constant speed."""
    delay = values.get("delay", 0.0)
    rest = np.zeros(len(log))
    for name in problem.terms:
        term = TERMS[name]
        if term.column is not None and not (term.level or term.friction):
            rest += values.get(name, 0.0) * term.column(log)
    found = []
    for s in segments:
        friction = log.force[s] - rest[s]
        found.append(
            {
                "time": float(log.time[s.start]), "duration": float(log.time[s.stop - 1] - log.time[s.start]),
                "velocity": float(np.mean(log.velocity[s])), "friction": float(np.mean(friction)),
                "deviation": float(np.std(friction)), "delay": delay,
            }
        )  # fmt: skip
    return found


# -- all rows --------------------------------------------------------------------------------------------------------


def _error(problem: StaticProblem, values: Mapping[str, float]) -> float:
    return float(np.linalg.norm(problem.force - problem.model(values)) / np.linalg.norm(problem.force))


def _prediction(problem: StaticProblem, values: Mapping[str, float], log: Log, rows: NDArray[np.intp]) -> Prediction:
    """Friction, measured and fitted, at the rows that were compared."""
    body = np.zeros(len(rows))
    for name, column in problem.columns_at(values).items():
        if name in TERMS and not (TERMS[name].level or TERMS[name].friction):
            body += values[name] * column
    fitted = problem.model(values) - body
    return Prediction(log.time[rows], log.position[rows], log.velocity[rows], problem.force - body, fitted)


def cross_validate(problem: StaticProblem, u: Array, log: Log, q: int, folds: int) -> LeftOut:
    """Fit the problem anew without each part of the log and predict the part."""
    group, how = groups(log.rows(kept_rows(log, q)), folds)
    squares, size = [], []
    for number in range(int(group.max()) + 1):
        out = group == number
        training = problem.reweighted(np.where(out, 0.0, problem.weight))
        there = descend(training, u, 1e-6, 10).point
        missed = (problem.force - problem.model(problem.values(there)))[out]
        squares.append(float(missed @ missed))
        size.append(float(problem.force[out] @ problem.force[out]))
    return LeftOut(np.array(squares), np.array(size), how, len(u))
