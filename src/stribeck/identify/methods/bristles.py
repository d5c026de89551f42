"""A law with bristles as a candidate: where a record shows presliding that no static law describes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from stribeck.errors import StribeckError
from stribeck.identify.details import Candidate
from stribeck.identify.features.guess import reversals, sizes_of
from stribeck.identify.log import Log, thinned
from stribeck.identify.methods.dynamic import fit_dynamic
from stribeck.identify.result import Fit
from stribeck.identify.work import Work

if TYPE_CHECKING:
    from stribeck.identify.options import FitOptions

LAW = "lugre"
STARTS = 4  # on records of the plan's motions all four end in one minimum
HALF = 0.5  # of the static law's error: a law with bristles must leave less, as it has two numbers more
RESOLVED, STEPS = 5, 4.0  # samples of a rise behind a reversal; steps of the position's resolution that it takes
LITTLE = 0.05  # of the force in all rows: the calibration of a force sensor leaves as much
FEWEST = 3  # such reversals
RISE = 0.3  # of the friction level: less is noise or inertia
LOOKED_AT = 20_000  # reversals: more take longer than the fit


def better(log: Log, static: Fit, options: FitOptions, work: Work) -> Fit:
    """The static fit, or LuGre's where the record shows presliding and it leaves less than half as much in all rows."""
    left = _error_everywhere(static, log)
    if left <= LITTLE or not shows_presliding(log):
        return static
    fixed = {n: x for n, x in options.constants.items() if not isinstance(x, str)}
    try:
        found = fit_dynamic(
            log,
            LAW,
            fixed=fixed,
            mass=options.mass,
            body=options.body("offset"),
            starts=STARTS,
            seed=options.seed,
            work=work,
        )
    except StribeckError:  # no compiler, or no simulation that works: the static fit stands
        return static
    if not found.relative_force_error < HALF * left:
        return static
    own: Candidate = {
        "name": LAW, "law": LAW, "forms": [], "numbers": len(found.parameters),
        "relative_force_error": found.relative_force_error, "cross_validated_error": None, "chosen": True,
    }  # fmt: skip
    others: list[Candidate] = [{**c, "chosen": False} for c in static.candidates]
    note = f"The record shows presliding: the best static law ({static.law_name}) leaves {left:.0%} of the force in all rows."
    return replace(found, candidates=(own, *others), notes=(note, *found.notes))


def _error_everywhere(fit: Fit, log: Log) -> float:
    """What a static fit leaves of the force in all rows, at rest too."""
    assert fit.predictor is not None
    size = max(float(np.linalg.norm(log.force)), 1e-300)
    return float(np.linalg.norm(log.force - fit.predictor.force(log))) / size


def shows_presliding(log: Log) -> bool:
    """Whether the force rises over a way that is resolved, behind several reversals: a contact that yields before it slides."""
    level, quantum, count = sizes_of(thinned(log)).force, resolution(log), 0
    for rows in log.runs():
        v, y, force = log.velocity[rows], log.position[rows], log.force[rows]
        for first, last in reversals(v)[:LOOKED_AT]:
            rise = abs(force[first : last + 1] - force[first])
            if len(rise) <= RESOLVED or rise.max() < RISE * level:
                continue
            half = int(np.argmax(rise >= rise.max() / 2))
            count += half >= RESOLVED and abs(y[first + half] - y[first]) > STEPS * quantum
    return count >= FEWEST


def resolution(log: Log) -> float:
    """The smallest step of the position as it was measured; 0 of one that is not rounded."""
    if log.unfiltered is None or log.sources.get("unfiltered") != "position":
        return 0.0
    steps = abs(np.diff(log.unfiltered[:100_000]))
    steps = steps[steps > 0]
    return float(steps.min()) if len(steps) else 0.0
