"""Laws that are simulated as candidates: LuGre's where a record shows presliding that no static law describes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from stribeck import laws
from stribeck.errors import StribeckError, first_line
from stribeck.identify.core.choice import rows_together
from stribeck.identify.data.smoother import encoder_step
from stribeck.identify.features.guess import rises, sizes_of
from stribeck.identify.log import Log, thinned
from stribeck.identify.onebody import Simulated, raw, simulated
from stribeck.identify.options import FitOptions
from stribeck.identify.result import Candidate, LogFit

Progress = Callable[[float], None]
LAW = "lugre"
STARTS = 4  # on records of the plan's motions all four end in one minimum
HALF = 0.5  # of the static law's error: a law with bristles must leave less, as it has two numbers more
RESOLVED, STEPS = 5, 4.0  # samples of a rise behind a reversal; steps of the position's resolution that it takes
LITTLE = 0.05  # of the force in all rows: the calibration of a force sensor leaves as much
FEWEST = 3  # such reversals
LOOKED_AT = 20_000  # reversals: more take longer than the fit


def asked_for(log: Log, static: LogFit) -> bool:
    """Whether a law with bristles is worth a try: the record shows presliding, and the static fit misses it."""
    return _error_everywhere(static, log) > LITTLE and shows_presliding(log)


def better(
    log: Log, static: LogFit | None, names: Sequence[str], options: FitOptions, progress: Progress | None = None
) -> LogFit:
    """The best of laws that are simulated, by BIC; the static fit if it leaves less than twice as much in all rows.

    Only the reported fit is judged. Beside a static fit, a law whose rough fit misses the mark is not fitted further.

    Raises:
        StribeckError: there is no static fit, and none of the laws could be simulated.
    """
    fits, failed = list[tuple[str, Simulated]](), dict[str, str]()
    known = {constant for name in names for constant in laws.find(name).constants()}
    left = np.inf if static is None else _error_everywhere(static, log)
    for i, name in enumerate(names):
        try:
            fits.append(
                (name, _simulated(log, name, options.of_law(name, known), left, _part(progress, i, len(names))))
            )
        except StribeckError as error:  # no simulation that works
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
    name, best = min(fits, key=lambda each: _bic(each[1]))
    chosen = best.judged() if static is None or best.error < HALF * left else static
    if static is not None and chosen is not static:
        notes = (f"The best static law ({static.law_name}) leaves {100 * left:.0f} % of the force in all rows.", *notes)
    candidate_rows = [*(_candidate(n, fit, n == name) for n, fit in fits), *(static.candidates if static else ())]
    candidates = tuple(
        Candidate(**{**c, "chosen": c["chosen"] and c["law"] == chosen.law_name}) for c in candidate_rows
    )
    return replace(
        chosen, candidates=candidates if len(candidates) > 1 else (), notes=(*notes, *chosen.notes),
        status="stopped" if fits[-1][1].stopped else chosen.status,
    )  # fmt: skip


def _simulated(log: Log, name: str, options: FitOptions, left: float, progress: Progress | None) -> Simulated:
    """A law's fit; a rough one, if that leaves too much to be chosen beside ``left``."""
    if np.isfinite(left):
        rough = simulated(log, name, options, _part(progress, 0, 2), rough=True)
        if rough.stopped or not rough.error < HALF * left:
            return rough
        progress = _part(progress, 1, 2)
    return simulated(log, name, options, progress)


def _part(progress: Progress | None, number: int, count: int) -> Progress | None:
    """The progress of one of several fits that follow each other."""
    return None if progress is None else lambda share: progress((number + share) / count)


def _bic(fit: Simulated) -> float:
    """Of the force along the measured motion; rows that err alike count once."""
    r = fit.residual
    rows = len(r) / rows_together(r)
    return float(rows * np.log(max(float(np.mean(r**2)), 1e-300)) + len(fit.model.first) * np.log(rows))


def _candidate(name: str, fit: Simulated, chosen: bool) -> Candidate:
    return {
        "name": name, "law": name, "forms": [], "numbers": len(fit.model.first), "relative_force_error": fit.error,
        "cross_validated_error": None, "chosen": chosen,
    }  # fmt: skip


def _error_everywhere(fit: LogFit, log: Log) -> float:
    """What a static fit leaves of the force in all rows, at rest too."""
    assert fit.predictor is not None
    size = max(float(np.linalg.norm(log.force)), 1e-300)
    return float(np.linalg.norm(log.force - fit.predictor.force(log))) / size


def shows_presliding(log: Log) -> bool:
    """Whether the force rises over a way that is resolved, behind several reversals: a contact that yields before it slides."""
    level, shortest = sizes_of(thinned(log)).force, STEPS * encoder_step([raw(log, "position")])
    every = rises(log, log.force, level, LOOKED_AT)
    return sum(samples >= RESOLVED and way > shortest for samples, _, way in every) >= FEWEST
