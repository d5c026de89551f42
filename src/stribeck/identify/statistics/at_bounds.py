"""What a static fit tells of numbers at an end: those that the data show nothing of, that come out as 0, or an F_s at F_c."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.features.guess import sizes_of
from stribeck.identify.features.what_to_measure import experiment_for
from stribeck.identify.log import thinned
from stribeck.identify.methods.static_start import StaticModel, unit_of
from stribeck.identify.models.problem import linear_step
from stribeck.identify.models.separable import Minimum, Separable
from stribeck.identify.models.static_problem import Rows
from stribeck.identify.result import Estimate
from stribeck.identify.statistics import clusters
from stribeck.identify.statistics.curves import NO_CURVE, no_curve_seen
from stribeck.identify.statistics.linear import Linear

_LOOSE = 0.1  # of the force: what a number that comes out as 0 may make up at the end of its interval


def to_measure(rows: Rows, solution: Minimum, name: str, open_: Collection[str]) -> str:
    """What to measure for a number that the data leave open."""
    return experiment_for(name, solution.values, sizes_of(thinned(rows.log)), open_)


def at_bounds(
    rows: Rows,
    model: StaticModel,
    solution: Minimum,
    at: Linear,
    verdicts: Collection[str],
    forms: Sequence[Mapping[str, Array]],
) -> dict[str, Estimate]:
    """What the data show nothing of, and what comes out as 0."""
    found: dict[str, Estimate] = {}
    unseen = dict(model.unseen)
    tied = "F_s" in model.whole.wanted and "F_s" not in at.names and "F_c" in at.names
    if tied:
        why = "friction does not rise towards low speed in these data"
        unseen |= {n: why for n in ("F_s", "v_s", "delta") if n in model.free}
    open_ = {*verdicts, *unseen}
    for name, why in unseen.items():
        what = to_measure(rows, solution, name, open_)
        found[name] = Estimate(None, None, None, unit_of(model.law, name), False, why, what)
    for name in (*model.whole.wanted, *model.whole.free):
        if name not in at.names and name not in found:
            bound = _at_its_bound(rows, model.whole, solution, name, at, forms)
            unit, why = unit_of(model.law, name), "at its lower bound, 0"
            high: float | None = bound.high
            force = float(np.linalg.norm(model.whole.weight * model.whole.force))
            if name in ("F_c", "F_s"):
                why = "friction at the lowest speeds comes out as 0"
            elif bound.other:
                what = to_measure(rows, solution, name, {*open_, name})
                why = f"it comes out as 0, and with terms that were not fitted as {bound.other:.3g}"
                found[name] = Estimate(None, 0.0, high, unit, False, why, what, 0.0)
                continue
            elif bound.best < -bound.half:
                why = f"it would come out below 0 ({bound.best:.3g} {unit}): the law bends otherwise than these data"
                high = None
            elif bound.high * bound.size > _LOOSE * force:
                why = "it comes out as 0, and the residuals hardly depend on it"
            else:
                found[name] = Estimate(0.0, 0.0, high, unit, True, why)
                continue
            what = to_measure(rows, solution, name, {*open_, name})
            found[name] = Estimate(None, None, high, unit, False, why, what, solution.values[name])
    return found


@dataclass(frozen=True)
class _Bound:
    """Of a coefficient that comes out as 0: what it would be if it could be negative, all others changing with it; half the
    one-sided interval about that; the interval's end; what it is, beyond chance, with columns that the residual asks for, or
    0; the norm of its column."""

    best: float
    half: float
    high: float
    other: float
    size: float


def _at_its_bound(
    rows: Rows, model: Separable, solution: Minimum, name: str, at: Linear, forms: Sequence[Mapping[str, Array]]
) -> _Bound:
    """For residuals of which ten tell a thing once, or as parts of the record tell it, whichever is wider."""
    own = model.weight * model.columns.at(solution.values, model.terms)[name]
    size = max(float(np.linalg.norm(own)), 1e-300)
    parts = clusters.parts_of(rows.log.rows(rows.kept))
    best = half = high = other = 0.0
    for k, added in enumerate(({}, *forms)):
        beside = np.column_stack([at.slopes, *added.values()])
        alone = own - beside @ linear_step(beside, own) if beside.shape[1] else own
        told = max(float(np.linalg.norm(alone)), 1e-9 * size)
        slopes = np.column_stack([beside, own])
        step = linear_step(slopes, at.misfit)
        rest = at.misfit - slopes @ step
        wide = max(
            float(1.645 * np.std(rest) * np.sqrt(10.0)) / told,
            float(clusters.over_parts(slopes, rest, parts)[0][-1]),
        )
        here = float(step[-1])
        if k == 0:
            best, half = here, wide
        high = max(high, max(here, 0.0) + wide)
        other = max(other, here if here > wide else 0.0)
    return _Bound(best, half, high, other, size)


def without_curve(
    rows: Rows, solution: Minimum, estimates: dict[str, Estimate], verdicts: Collection[str]
) -> None:  # fmt: skip
    """F_s is not told beside a v_s that is not, where it may be F_c: no bend is seen, and another may lie below the slowest
    rows."""
    level, low = estimates.get("F_s"), estimates.get("F_c")
    if level is None or low is None or not level.identifiable or "v_s" not in verdicts:
        return
    if no_curve_seen(level.low, low.high):
        what = to_measure(rows, solution, "F_s", {*verdicts, "F_s"})
        estimates["F_s"] = Estimate(None, None, None, level.unit, False, NO_CURVE, what, level.value)
