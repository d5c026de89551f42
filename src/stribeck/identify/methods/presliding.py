"""Presliding: the bristles' stiffness and damping from small reversals.

The law's own equations are simulated along the measured motion of every loop; slopes read off a loop would not do: right
behind a reversal out of sliding it is 2 sigma_0, and less than sigma_0 further on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.identify.details import MeasuredLoop
from stribeck.identify.features.guess import Sizes, sizes_of
from stribeck.identify.features.what_to_measure import experiment_for
from stribeck.identify.log import Log
from stribeck.identify.methods.dynamic import fit_dynamic
from stribeck.identify.result import Estimate, Fit, simulated
from stribeck.identify.work import Work

_NOISES = 6.0  # standard deviations that a reversal must stand above the noise
_LONGEST = 8.0  # natural lengths (friction level / stiffness) that a small reversal may be long
_FEWEST_TURNS = 3
_FEWEST_ROWS = 20  # between two turns, on average
_FALLS = 3.0  # fastest speeds of the loops: the v_s that is held
_SPREAD = 0.25  # of the friction level: what the force must change by in a loop


@dataclass(frozen=True)
class HysteresisLoop:
    """Small reversals that follow each other: rows of the log, and the travel between turns (m)."""

    rows: slice
    travel: Array


def loops(log: Log, sizes: Sizes) -> list[HysteresisLoop]:
    """The stretches of a log in which the motion turns before the contact slides for long."""
    length = _LONGEST * sizes.force / sizes.stiffness
    found = []
    for rows in log.runs():
        y = log.position[rows]
        noise = float(np.std(np.diff(y, 3)) / np.sqrt(20.0)) if len(y) > 10 else 0.0
        turns = turning_points(y, max(_NOISES * noise, 1e-3 * length))
        travel = abs(np.diff(y[turns]))
        small = np.append(travel < length, False)
        first = None
        for i, here in enumerate(small):
            if here and first is None:
                first = i
            elif not here and first is not None:
                part = slice(rows.start + turns[first], rows.start + turns[i] + 1)
                many = i - first >= _FEWEST_TURNS and part.stop - part.start >= _FEWEST_ROWS * (i - first)
                if many and np.ptp(log.force[part]) > _SPREAD * sizes.force:
                    found.append(HysteresisLoop(part, travel[first:i]))
                first = None
    return found


def turning_points(y: Array, threshold: float) -> list[int]:
    """The rows at which y turns by more than a threshold; its first and last row too."""
    turns, low, high, up = [0], 0, 0, 0
    for i, value in enumerate(y.tolist()):
        if value > y[high]:
            high = i
        if value < y[low]:
            low = i
        if up >= 0 and y[high] - value > threshold:
            if up or high:
                turns.append(high)
            up, low = -1, i
        elif up <= 0 and value - y[low] > threshold:
            if up or low:
                turns.append(low)
            up, high = 1, i
        if up == 1 and value > y[high]:
            high = i
    if turns[-1] != len(y) - 1:
        turns.append(len(y) - 1)
    return list(dict.fromkeys(turns))


def fit_presliding(
    log: Log,
    law: str,
    *,
    fixed: Mapping[str, float] | None = None,
    mass: float | None = 0.0,
    starts: int = 8,
    seed: int = 0,
    profiles: bool = True,
    work: Work | None = None,
) -> Fit:
    """Fit sigma_0, sigma_1 and the force level of break-away to the small reversals of a log.

    In a presliding loop the speed stays far below v_s, so that F_s is the level there; F_c, v_s and sigma_2 cannot be told
    from it. (sigma_1 is sigma_1 + sigma_2 there.)

    Raises:
        InputError: the law has no bristles.
    """
    found = laws.find(law)
    if "sigma_0" not in found.constants():
        raise InputError(f"{arg('method')}: 'presliding': law '{law}' has no sigma_0; must be a law with bristles")
    sizes = sizes_of(log, mass or 0.0)
    small = loops(log, sizes)
    if not small:
        return _without(found, log, sizes, dict(fixed or {}))
    cut = _cut(log, [loop.rows for loop in small])
    given, free = _arranged(found, dict(fixed or {}), float(np.max(abs(cut.velocity))))
    fit = fit_dynamic(
        cut, law, fixed=given, free=free, mass=mass, starts=starts, seed=seed,
        profiles=profiles, work=work,
    )  # fmt: skip
    level = "F_s" if "F_s" in found.uses else "F_c"
    unseen = [n for n in found.uses if n not in ("sigma_0", "sigma_1", level) and n not in (fixed or {})]
    why = "the small reversals are slower than the speeds at which it matters"
    estimates = dict(fit.estimates)
    estimates |= {n: _unknown(found.constants()[n].unit, why, n, sizes) for n in unseen}
    travel = np.concatenate([loop.travel for loop in small])
    note = (
        f"{len(travel)} small reversals in {len(small)} stretches, {travel.min():.3g} m to {travel.max():.3g} m long, "
        f"{len(cut)} rows"
    )
    notes = [note]
    if {"sigma_1", "sigma_2"} <= set(found.uses) and "sigma_2" not in (fixed or {}):
        notes.append(
            "sigma_1 stands for sigma_1 + sigma_2, which are one in presliding; giving the constant sigma_2 takes it off"
        )
    told = [i for i, n in enumerate(fit.names) if n not in unseen]
    return replace(
        fit,
        method="presliding",
        names=tuple(fit.names[i] for i in told),
        covariance=fit.covariance[np.ix_(told, told)],
        profiles={n: p for n, p in fit.profiles.items() if n not in unseen},
        estimates={n: estimates[n] for n in found.constants() if n in estimates},
        fixed=dict(fixed or {}),
        data_hash=log.hash,
        notes=(*notes, *fit.notes),
        details={**fit.details, "loops": _shown(fit, cut)},
    )


def _arranged(law: type[laws.Law], given: dict[str, float], fastest: float) -> tuple[dict[str, float], list[str]]:
    """What is held and what is fitted in presliding.

    With v_s held at a few times the fastest motion, F_c lets the level fall with speed as it may, so that sigma_1 does
    not have to; neither is a result.
    """
    held = {n: v for n, v in (("sigma_2", 0.0), ("v_s", _FALLS * fastest)) if n in law.uses}
    fixed = {**held, **given}
    return fixed, [n for n in ("sigma_0", "sigma_1", "F_c", "F_s") if n in law.uses and n not in fixed]


def _cut(log: Log, parts: Sequence[slice]) -> Log:
    """The parts of a log as runs of their own."""
    rows = np.concatenate([np.arange(p.start, p.stop) for p in parts])
    run = np.repeat(np.arange(len(parts), dtype=np.int32), [p.stop - p.start for p in parts])
    files = tuple(log.files[log.run[p.start]] for p in parts) if log.files else ()
    return log.rows(rows).with_columns(run=run, files=files)


def _unknown(unit: str, why: str, name: str, sizes: Sizes) -> Estimate:
    return simulated(None, None, None, unit, False, why, experiment_for(name, {}, sizes))


def _without(law: type[laws.Law], log: Log, sizes: Sizes, given: dict[str, float]) -> Fit:
    """The verdict on a log without small reversals: nothing is known."""
    why = "the log holds no small reversals: the contact slides all the time"
    names = [n for n in law.uses if n not in given]
    return Fit(
        law_name=law.name, method="presliding", body={}, fixed=given, used={}, names=(), covariance=np.zeros((0, 0)),
        estimates={n: _unknown(law.constants()[n].unit, why, n, sizes) for n in names},
        relative_force_error=float("nan"), data_hash=log.hash, notes=(why,),
    )  # fmt: skip


def _shown(fit: Fit, cut: Log) -> list[MeasuredLoop]:
    """Measured and fitted loops for the report."""
    p = fit.prediction
    assert p is not None
    return [
        {"position": p.position[r], "measured": p.measured[r], "fitted": p.fitted[r], "time": p.time[r]}
        for r in cut.runs()
    ]
