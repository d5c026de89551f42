"""Static fits of a log's force by inertia, steady friction and other terms, judged by the core.

Force and columns pass the same low-pass filter and are then decimated. This gives all frequencies below the cut-off the same
weight and leaves nearly independent rows (Gautier; Janot, Gautier, Brunot 2019).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from threadpoolctl import threadpool_limits

from stribeck import laws
from stribeck.errors import InputError, arg
from stribeck.identify.beyond import seen
from stribeck.identify.core.choice import Selection
from stribeck.identify.core.judging import EXPLAINED, judged, missed
from stribeck.identify.core.library import UNNOTICED
from stribeck.identify.core.states import Estimate
from stribeck.identify.features.filtering import roughness, smoother_log
from stribeck.identify.features.guess import steady_curve
from stribeck.identify.features.what_to_measure import with_units
from stribeck.identify.log import ENOUGH_ROWS, Log, size_ratio, thinned
from stribeck.identify.models import terms
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.forms import dependences, effect, law_at, sizes_in_words
from stribeck.identify.models.predictor import Predictor, predictor
from stribeck.identify.models.record import Rows, record_of, rows_of, shortened
from stribeck.identify.models.steady import RANK, SteadyLibrary, chosen
from stribeck.identify.models.terms import TERMS, WEIGHT
from stribeck.identify.options import FitOptions
from stribeck.identify.result import LogFit
from stribeck.identify.result_parts import Candidate, FrictionRows
from stribeck.identify.work import Progress

PLAIN = "coulomb_viscous"
MEASURED = {"pressure": "area", "load": "F_c_by_load"}  # the term of a measured column in the model
FOUND = 0.05  # of a measured column's variance: the least that motion leaves, and of this the most that is noise
_STEADY = 0.02  # relative spread of the speed: less is constant velocity
_ROUNDING = 1e-13  # of a position: filtered rounding of a constant position
_SHARP, _SHARPEST = 1e9, 1e6  # s/m, and over the largest speed: steepness for an exact sign


def fit_static(log: Log, names: Sequence[str], options: FitOptions, progress: Progress | None = None) -> LogFit:
    """Fit static laws to a record and report the best one.

    Args:
        log: the log; ``names``: of the laws.
        progress: called with the share done, 0 to 1.

    Raises:
        InputError: constants or terms are unknown or missing.
    """
    terms.check(tuple(options.term), log)
    tell = progress or (lambda _: None)
    whole, log = log, shortened(log, ENOUGH_ROWS)
    with threadpool_limits(1):  # the matrices are too small for more threads
        fitted = estimated(log, names, options, tell)
        rows, choice = fitted.rows, fitted.choice
        wide = rows_of(log, to_choose=True)  # held-out data have all frequencies
        same = wide.q == rows.q or options.published
        predicting = predictor(
            choice if same else _chosen(wide, names, fitted.body, options), log, choice.library.at.speeds[0]
        )
    return _finished(whole, rows, choice, fitted.estimates, fitted.unused, options, predicting)


class Estimated(NamedTuple):
    """The rows that are compared, the chosen model and its estimates; its terms, and the measured columns without one."""

    rows: Rows
    choice: Selection[SteadyLibrary]
    estimates: dict[str, Estimate]
    body: list[str]
    unused: dict[str, str]


def estimated(log: Log, names: Sequence[str], options: FitOptions, tell: Progress = lambda _: None) -> Estimated:
    """The best model of some laws on a record, with both uncertainties.

    Args:
        tell: called with the share done, a third and two thirds: choice, judging and predictor take about the same time.
    """
    rows = rows_of(log)
    body, unused = _terms(log, options)
    choice = _chosen(rows, names, body, options)
    tell(1 / 3)
    estimates = judged(choice, trusted=not unused, lower=_filtered_lower(rows, choice, body, options))
    tell(2 / 3)
    return Estimated(rows, choice, estimates, body, unused)


def _filtered_lower(
    rows: Rows, choice: Selection[SteadyLibrary], body: Sequence[str], options: FitOptions
) -> dict[str, float] | None:
    """The estimates of the reported law at a lower cut-off, or None if the motion was not filtered."""
    if rows.log.bandwidth is None or options.published:
        return None
    again = _chosen(replace(rows, log=smoother_log(rows.log)), [choice.library.curve.law], body, options)
    # levels are compared at the same speeds
    again.library.at = replace(again.library.at, speeds=choice.library.at.speeds)
    return again.library.parameters(again.model, again.coefficients)


def _chosen(rows: Rows, names: Sequence[str], body: Sequence[str], options: FitOptions) -> Selection[SteadyLibrary]:
    """The best model on the rows of a band."""
    record = record_of(rows, body, options.numbers, options.published)
    own = [options.of_law(name) for name in names]
    curves = [
        SteadyCurve(name, {n: x for n, x in each.numbers.items() if n not in TERMS}, each.free)
        for name, each in zip(names, own, strict=True)
    ]
    return chosen(record, curves, options.alone, options.speed)


def _terms(log: Log, options: FitOptions) -> tuple[list[str], dict[str, str]]:
    """The terms of every model, and the measured columns that no model uses, each with the reason.

    A rotary joint has gravity terms. A measured column is in the model if its coefficient is identifiable.
    """
    given = [n for n in options.numbers if n in TERMS]
    terms = list(dict.fromkeys(["offset", *options.term]))
    if log.rotary and not {*WEIGHT} & {*terms, *given}:
        terms += WEIGHT
    unused = dict[str, str]()
    for column, term in MEASURED.items():
        if getattr(log, column) is None or any(TERMS[n].needs == column for n in (*terms, *given)):
            continue
        if why := _hidden(log, column):
            unused[column] = why
        else:
            terms.append(term)
    return [n for n in terms if n not in given], unused


def _hidden(log: Log, column: str) -> str:
    """Why a measured column does not show its coefficient; empty if it does.

    Motion must leave more than a share of the variance. Noise may be the same share of what is left, as it biases the
    coefficient towards 0.
    """
    x = getattr(log, column) - float(np.mean(getattr(log, column)))
    changes, noise = float(x @ x), len(x) * roughness([x[rows] for rows in log.runs()], typical=True) ** 2
    x = x * np.sign(log.velocity) if TERMS[MEASURED[column]].level else x
    beside = np.column_stack([np.ones(len(x)), np.sign(log.velocity), log.velocity, log.acceleration])
    beside = beside / np.maximum(np.max(abs(beside), axis=0), 1e-300)
    left = x - beside @ np.linalg.lstsq(beside, x, rcond=1e-10)[0]
    if noise >= FOUND * changes:
        return "it hardly changes"
    remaining = float(left @ left)
    return "" if remaining > FOUND * changes and noise <= FOUND * remaining else "it depends on the motion only"


def check_motion(log: Log) -> None:
    """Check that a fit is possible.

    Raises:
        InputError: nothing moves, the speed or the force is constant, or the force has the wrong sign.
    """
    v = log.velocity
    fastest = float(np.max(abs(v)))
    ways = [float(np.ptp(x)) - _ROUNDING * float(np.max(abs(x))) for x in map(log.position.__getitem__, log.runs())]
    if fastest <= 0 or max(ways) <= 0:  # a filter leaves the rounding of a constant position
        raise InputError(f"{arg('velocity')}: 0 throughout: nothing moves, so there is no friction to fit")
    few = thinned(log)
    low, middle, high = np.quantile(few.velocity, (0.05, 0.5, 0.95))
    if high - low < 2 * _STEADY * abs(middle):
        raise InputError(
            f"{arg('velocity')}: constant ({middle:.4g} {log.unit('m/s')} within {high - low:.1g}): friction, offset and "
            "inertia cannot be separated; measure several speeds in both directions"
        )
    if not np.ptp(log.force) > 0:
        raise InputError(f"{arg('force')}: {log.force[0]:.6g} {log.unit('N')} throughout: there is no friction to fit")
    thin, y = few.velocity, few.position
    beside = [np.ones(len(thin)), y, np.sin(y), np.cos(y)]
    rough = np.column_stack([few.acceleration, thin, np.sign(thin), *beside])
    coefficients = np.linalg.lstsq(rough / np.maximum(np.abs(rough).max(0), 1e-300), few.force, rcond=1e-10)[0]
    both = v.min() < -0.1 * fastest and v.max() > 0.1 * fastest
    if both and log.force @ v < 0 and coefficients[1] + coefficients[2] < 0 and coefficients[2] < 0:
        raise InputError(
            f"{arg('force')}: acts against the motion: friction would put energy in; the sign is wrong "
            f"({arg('force_gain')} -1 turns it)"
        )


# -- the result --------------------------------------------------------------------------------------------------------


def _finished(
    whole: Log,
    rows: Rows,
    choice: Selection[SteadyLibrary],
    judged_estimates: Mapping[str, Estimate],
    unused: Mapping[str, str],
    options: FitOptions,
    predicting: Predictor,
) -> LogFit:
    """The fit with all results for a report."""
    lib, log, curve = choice.library, rows.log, choice.library.curve
    known = laws.find(curve.law).constants()
    estimates = with_units(judged_estimates, curve.law, curve.given, log)
    fixed = {n: x for n, x in (dict(options.numbers) | _sharp_sign(curve, log)).items() if n in known or n in TERMS}
    body = {n: e.value for n, e in estimates.items() if n in TERMS}
    forms = _rms_of_forms(choice)
    friction, friction_error = _friction(choice)
    r = lib.residual(choice.model, choice.coefficients)
    of_bends = "F_s" not in known and any(effect(f)[0].at_speed for f in forms)
    return LogFit(
        law_name=curve.law, method="static", estimates={n: e for n, e in estimates.items() if n not in lib.levels},
        levels={n: estimates[n] for n in lib.levels}, speeds=lib.levels,
        values=fixed | _used(choice, judged_estimates, float(np.max(abs(log.force)))) | body, given=tuple(fixed),
        relative_force_error=size_ratio(r, lib.record.column(lib.record.log.force)),
        friction_error=friction_error, missed=missed(choice), data_hash=whole.hash, log=whole, predictor=predicting,
        friction=friction, notes=tuple(_notes(choice, estimates, unused, forms, log)), candidates=tuple(_candidates(choice)),
        rest=float(np.mean(rows.rest)), seen=seen(log, ~rows.rest), forms=forms,
        nearest_stribeck=nearest_stribeck(choice) or None if of_bends else None,
    )  # fmt: skip


def _used(choice: Selection[SteadyLibrary], estimates: Mapping[str, Estimate], largest: float) -> dict[str, float]:
    """The law's constants, valid for simulation: levels above 0, by a size that counts as 0, and none below F_c."""
    constants = laws.find(choice.library.curve.law).constants()
    out = {n: estimates[n].value for n in constants if n in estimates}
    for name, least in (("F_c", RANK * largest), ("sigma_2", 0.0)):
        if name in out:
            out[name] = max(out[name], least)
    if {"F_c", "F_s"} <= out.keys():
        out["F_s"] = max(out["F_s"], out["F_c"])
    return out


def _sharp_sign(curve: SteadyCurve, log: Log) -> dict[str, float]:
    """The steepness that represents an exact sign, so that the fitted curve is unchanged."""
    constants = laws.find(curve.law).constants()
    if "k_v" not in constants or constants["k_v"].default is None or "k_v" in (*curve.shapes, *curve.given):
        return {}
    return {"k_v": max(_SHARP, _SHARPEST / float(np.max(abs(log.velocity))))}


def _rms_of_forms(choice: Selection[SteadyLibrary]) -> dict[str, float]:
    """The force of each form of the reported model, N (rms)."""
    lib = choice.library
    of_column = dict(zip(lib.index(choice.model), choice.coefficients.tolist(), strict=True))
    forces = {g: lib.columns[:, lib.groups[g]] @ [of_column[i] for i in lib.groups[g]] for g in choice.model[1]}
    return {g: float(np.sqrt(np.mean(force**2))) for g, force in forces.items()}


def _friction(choice: Selection[SteadyLibrary]) -> tuple[FrictionRows, float]:
    """Measured and fitted friction at the compared rows, and norm(residual)/norm(measured friction)."""
    lib, record, x = choice.library, choice.library.record, choice.coefficients
    i = lib.index(choice.model)
    of_body = [n == "sigma_2" or TERMS[n].level or TERMS[n].friction for n in lib.body]
    effects = [effect(lib.name[j][0])[0] for j in i[lib.first_form :]]
    of_forms = [not (each.beside or each.of_record) for each in effects]
    friction = lib.columns[:, i] @ (x * np.array([*[True] * lib.k, *of_body, *of_forms]))
    friction += record.given.get("sigma_2", 0.0) * record.column(record.log.velocity)
    measured = friction + lib.residual(choice.model, x)
    rows = FrictionRows(record.log.time[record.at], record.log.velocity[record.at], measured, friction)
    return rows, size_ratio(measured - friction, measured)


def _candidates(choice: Selection[SteadyLibrary]) -> list[Candidate]:
    """The best model of each law, and the simplest model, on the compared rows."""
    every, candidates = np.ones(len(choice.library.gram)), list[Candidate]()
    for n, lib in enumerate(choice.libraries):
        kinds = {choice.alone: lib.curve.law}
        if lib.curve.law == PLAIN and not choice.alone:
            kinds[True] = f"{PLAIN} without forms"
        for alone, name in kinds.items():
            _, i, x, _ = choice.choose(every, within=n, alone=alone)
            r, model = lib.residual(lib.models[i], x), lib.models[i]
            error = size_ratio(r, lib.record.column(lib.record.log.force))
            is_fit = n == choice.law and alone == choice.alone
            candidates.append({
                "name": name, "law": lib.curve.law, "forms": list(model[1]), "numbers": len(lib.index(model)),
                "relative_force_error": error, "chosen": is_fit,
            })  # fmt: skip
    return candidates


def nearest_stribeck(choice: Selection[SteadyLibrary]) -> dict[str, float]:
    """The Stribeck law nearest to a piecewise curve over the measured speeds, for simulations."""
    lib = choice.library
    slow, fast = lib.at.speeds[0], lib.at.speeds[3]
    v = np.geomspace(max(slow, 1e-3 * fast), fast, 60)
    level = lib.level(choice.model, choice.coefficients, v)
    _, values, left = steady_curve(v, [], level, np.geomspace(v[0], fast, 60))
    if not values["F_s"] > values["F_c"] > 0:
        return {}
    return {**values, "sigma_2": max(values["sigma_2"], 0.0), "deviation": left}


def _at_one_frequency(choice: Selection[SteadyLibrary]) -> bool:
    """Whether the acceleration is proportional to the position, as is the force of a spring."""
    record = choice.library.record
    y, a = (x - np.mean(x) for x in map(record.column, (record.log.position, record.log.acceleration)))
    return bool((y @ a) ** 2 > (1 - UNNOTICED**2) * (y @ y) * (a @ a))


def _notes(
    choice: Selection[SteadyLibrary],
    estimates: Mapping[str, Estimate],
    unused: Mapping[str, str],
    forms: Mapping[str, float],
    log: Log,
) -> list[str]:
    """The notes of the report, a sentence each, the most important first."""
    out, left = [], missed(choice)
    if left > EXPLAINED:
        out.append(
            f"The residual is {100 * left:.0f} % of the force's deviation: the model does not describe the data, and no "
            "parameter is identified."
        )
    out += [f"The column {n} was not used, as {why}: give {MEASURED[n]} with --set." for n, why in unused.items()]
    if differ := [n for n, e in estimates.items() if e.files_differ]:
        out.append(f"The files differ in {', '.join(differ)}: fit each file by itself, or give more files.")
    if "mass" in estimates and (estimates["mass"].interval[1] < 0 or _at_one_frequency(choice)):
        out.append(
            "At a single frequency, a spring or weight cannot be separated from mass: the estimated mass may contain it."
        )
    out += dependences(estimates)
    out += [text for name, e in estimates.items() if (text := e.advice(name))]
    if forms:
        out.append(f"Further terms of the force: {sizes_in_words(forms, log.unit('N'))}.")
    by_column = [
        f"level by {TERMS[n].needs} column" for n in estimates if n in TERMS and TERMS[n].level and TERMS[n].needs
    ]
    if places := law_at([*forms, *by_column], choice.library.at.middle, log.unit("m")):
        out.append(f"F_c and the levels are those at {' and '.join(places)}.")
    if len(set(log.files)) < 2:
        out.append("The intervals are from a single file: another day or motion may differ by more.")
    return out
