"""Laws fitted by simulation as candidates: those asked for, or LuGre if a log shows presliding."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from stribeck.errors import StribeckError, arg, first_line
from stribeck.identify.core.choice import rows_together
from stribeck.identify.core.states import EstimateState
from stribeck.identify.data.smoother import encoder_step
from stribeck.identify.features.filtering import roughness
from stribeck.identify.features.guess import rises, sizes_of
from stribeck.identify.log import MANY_ROWS, Log, size_ratio, thinned
from stribeck.identify.models.forms import effect
from stribeck.identify.models.record import shortened
from stribeck.identify.models.terms import TERMS
from stribeck.identify.onebody import Simulated, approached, raw
from stribeck.identify.options import FitOptions
from stribeck.identify.result import LogFit
from stribeck.identify.result_parts import Candidate
from stribeck.identify.work import Progress, part

LAW = "lugre"
STARTS = 4  # on logs of the plan's motions, all four reach the same minimum
HALF = 0.5  # of the static law's error: largest error of a bristle law, which has two more constants
RESOLVED, STEPS = 5, 4.0  # samples of a rise after a reversal; its displacement in steps of the encoder
FEWEST = 3  # least number of such reversals
LOOKED_AT = 20_000  # most reversals: more take longer than the fit


def asked_for(log: Log, static: LogFit) -> bool:
    """Whether a bristle law could be chosen: the log shows presliding, and less noise than the error at which one wins."""
    return _noise_everywhere(log) < HALF * _error_everywhere(static, log) and shows_presliding(log)


def beside_friction(static: LogFit, options: FitOptions) -> tuple[str, ...]:
    """The terms of a bristle law: those beside friction that the static fit has, as a term or as a form."""
    of_forms = (term for form in static.forms or () for term in effect(form)[0].terms)
    usual = {"mass", "offset", *options.numbers}
    return tuple(dict.fromkeys(n for n in (*static.body, *of_forms) if n not in usual and not TERMS[n].level))


def better(
    log: Log, static: LogFit | None, names: Sequence[str], options: FitOptions, progress: Progress | None = None
) -> LogFit:
    """The best bristle law by BIC, or the static fit if its error in all rows is less than twice as large, or if it
    identifies more numbers.

    If there is a static fit, a bristle law whose rough fit is not good enough is neither refined nor judged.

    Raises:
        StribeckError: there is no static fit, and none of the laws could be simulated.
    """
    fits, failed = list[tuple[str, Simulated]](), dict[str, str]()
    left = np.inf if static is None else _error_everywhere(static, log)
    for i, name in enumerate(names):
        try:
            fits.append((name, _simulated(log, name, options.of_law(name), left, part(progress, i, len(names)))))
        except StribeckError as error:  # cannot be simulated
            if len(names) == 1 and static is None:
                raise
            failed[name] = first_line(error)
            continue
        if fits[-1][1].stopped:
            break
    notes = tuple(f"{n} was not fitted: {why}." for n, why in failed.items())
    if not fits:
        if static is None:
            raise StribeckError("; ".join(f"{name}: {why}" for name, why in failed.items()))
        return replace(static, notes=(*static.notes, *notes))
    name, best = fits[_of_least_bic([fit for _, fit in fits])]
    chosen = best.judged() if static is None or best.error < HALF * left else static
    if static is not None and chosen is not static:
        other, leaves, but = f"the best static law ({static.law_name})", left, ""
        if _identified(chosen) < _identified(static):
            chosen, other, leaves = static, name, best.error
            but = f", but it identifies fewer numbers ({arg('law')} {name} shows them)"
        notes = (f"The relative residual of {other} is {100 * leaves:.0f} %, rows at rest included{but}.", *notes)
    candidate_rows = [*(_candidate(n, fit, n == name) for n, fit in fits), *(static.candidates if static else ())]
    candidates = tuple(
        Candidate(**{**c, "chosen": c["chosen"] and c["law"] == chosen.law_name}) for c in candidate_rows
    )
    return replace(
        chosen, candidates=candidates if len(candidates) > 1 else (), notes=(*notes, *chosen.notes),
        status="stopped" if fits[-1][1].stopped else chosen.status,
    )  # fmt: skip


def _identified(fit: LogFit) -> int:
    return sum(e.state is EstimateState.IDENTIFIED for e in fit.parameters.values())


def _simulated(log: Log, name: str, options: FitOptions, left: float, progress: Progress | None) -> Simulated:
    """A law's fit, or its rough fit if the error is too large to be chosen over ``left``.

    A delay is fitted if the law's residual shows one, and kept by BIC.
    """
    fit = approached(log, name, options, part(progress, 0, 2))
    if fit.stopped or not fit.error < HALF * left:
        return fit
    fit = fit.converged()
    if fit.stopped or options.alone or not fit.late:
        return fit
    later = approached(log, name, replace(options, term=(*options.term, "delay")), part(progress, 1, 2)).converged()
    return later if later.stopped else (fit, later)[_of_least_bic([fit, later])]


def _of_least_bic(fits: Sequence[Simulated]) -> int:
    """The fit with the least BIC of the force along the measured motion.

    Rows with correlated residuals count once, and as many for each fit, as BIC compares models of the same data.
    """
    rows = min(len(fit.residual) / rows_together(fit.residual) for fit in fits)
    left = [max(float(np.mean(fit.residual**2)), 1e-300) for fit in fits]
    return int(
        np.argmin([rows * np.log(x) + len(fit.model.first) * np.log(rows) for x, fit in zip(left, fits, strict=True)])
    )


def _candidate(name: str, fit: Simulated, chosen: bool) -> Candidate:
    return {
        "name": name, "law": name, "forms": [], "numbers": len(fit.model.first), "relative_force_error": fit.error,
        "chosen": chosen,
    }  # fmt: skip


def _error_everywhere(fit: LogFit, log: Log) -> float:
    """The relative residual of a static fit in all rows, including rest; of a very long record in stretches of it."""
    assert fit.predictor is not None
    log = shortened(log, MANY_ROWS)
    return size_ratio(log.force - fit.predictor.force(log), log.force)


def _noise_everywhere(log: Log) -> float:
    """The force's noise as a share of the force: the relative residual that no law can undercut."""
    log = shortened(log, MANY_ROWS)
    white = roughness([log.force[rows] for rows in log.runs()], typical=True)
    return size_ratio(np.full(len(log), white), log.force)


def shows_presliding(log: Log) -> bool:
    """Whether the force rises over a resolved displacement after several reversals, as in presliding."""
    level, shortest = sizes_of(thinned(log)).force, STEPS * encoder_step([raw(log, "position")])
    every = rises(log, level, LOOKED_AT)
    return sum(samples >= RESOLVED and way > shortest for samples, _, way in every) >= FEWEST
