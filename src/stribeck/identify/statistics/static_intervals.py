"""Intervals and verdicts of a static fit."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.details import FitDetails, SeenNoise
from stribeck.identify.features.filtering import smoother_log
from stribeck.identify.features.guess import sizes_of
from stribeck.identify.features.rest import held_force
from stribeck.identify.features.what_to_measure import reachable
from stribeck.identify.log import Log, thinned
from stribeck.identify.methods.static_start import StaticModel, unit_of
from stribeck.identify.models.columns import Columns
from stribeck.identify.models.problem import linear_step
from stribeck.identify.models.separable import Minimum, Separable
from stribeck.identify.models.static_problem import Rows, thinning
from stribeck.identify.models.terms import TERMS, column
from stribeck.identify.result import Estimate, Profile
from stribeck.identify.statistics import clusters
from stribeck.identify.statistics.at_bounds import at_bounds, to_measure, without_curve
from stribeck.identify.statistics.correlated import covariance, noise_memory, supporting_samples
from stribeck.identify.statistics.effects import at_held_speeds
from stribeck.identify.statistics.lacking import Lacking, lacking, one_sided, unfitted
from stribeck.identify.statistics.linear import Linear, linearised
from stribeck.identify.statistics.missed import static_misses

_HUGE = 1e100
_NORMAL, _THRESHOLD = 1.959964, 3.841459
_WIDEST = 0.7  # half a 95 % interval in the logarithm: half to twice the value
_MOST_ALIKE = 200.0  # by how much the others' freedom may inflate a variance
_FEWEST = 12.0
_MOST_BIAS = 0.2
_WHOLE = 1.5  # of the shift that a lower cut-off makes
_REACHED = 0.8  # of F_s: what the curve must come to within the speeds measured
_ONE_SPEED = 1.5  # between slow and fast rows: less is one speed
_MISFIT = 0.1  # of the squared residual; what a plain bend of the speed takes counts however little it is: lacking.py
_PROFILED = ("F_c", "F_s", "v_s", "k_v", "delta")


@dataclass(frozen=True)
class StaticConfidenceIntervals:
    """Estimates by name, covariance of ``names``, profiles, notes, and ``details`` for a report; ``told``: whether anything can
    be said of the numbers."""

    estimates: dict[str, Estimate]
    names: tuple[str, ...]
    covariance: Array
    profiles: dict[str, Profile]
    notes: tuple[str, ...]
    details: FitDetails
    told: bool = True


@dataclass(frozen=True)
class _Reach:
    """How far intervals go (inner): half of what is alike to both sides, and what comes to it below and above; ``asked``: what
    the residual asks for."""

    half: Array
    below: Array
    above: Array
    asked: Lacking | None = None

    @property
    def widest(self) -> Array:
        """To the side that is farther."""
        return self.half + np.maximum(self.below, self.above)


def static_intervals(
    rows: Rows, model: StaticModel, solution: Minimum, profiles: bool = True
) -> StaticConfidenceIntervals:
    """Intervals and verdicts for everything that was to be fitted; none where the fit misses much more of the force than its
    noise."""
    at = linearised(model.whole, solution)
    if missed := static_misses(rows, model.whole.weight, model.whole.force, at.misfit):
        share = clusters.misfit_share(rows.log.velocity[rows.kept], at.misfit, rows.weight)
        asked = lacking(rows, model, solution.values, at)
        return replace(
            untold(model, solution, missed),
            notes=(f"{asked.taken}: terms that a fit of this force may lack",) if asked.names else (),
            details={"misfit_share": share, "noise": _noise(rows, at)},
        )
    wide, notes, details = _half_widths(rows, model, solution, at)
    verdicts = {**_moves_away(at, wide), **_verdicts(rows, model, solution, at, wide.widest)}
    curves: dict[str, Profile] = {}
    low, high = -wide.half, wide.half
    if profiles:
        low, high, curves = _profiles(model, solution, at, wide, verdicts)
    low, high = low - wide.below, high + wide.above
    for k, name in enumerate(at.names):
        if at.log[k] and max(-low[k], high[k]) > _WIDEST:
            verdicts.setdefault(name, "with terms that were not fitted it may be half or twice its value")
    # what nothing determines has a variance that is huge, and finite
    spread = np.minimum(wide.widest / _NORMAL, _HUGE)
    relation = _relation(at)
    inner = relation * np.outer(spread, spread)
    bias = np.array([details.get("filter_bias", {}).get(n, 0.0) for n in at.names])
    stays = bias + np.maximum(wide.below, wide.above)
    noisy = np.minimum(np.sqrt(np.maximum(wide.half**2 - bias**2, 0.0)) / _NORMAL, _HUGE)
    estimates: dict[str, Estimate] = {}
    for k, name in enumerate(at.names):
        unit = unit_of(model.law, name)
        x = at.values[k]
        ends = (
            x * np.exp(np.clip([low[k], high[k]], -50, 50)) if at.log[k] else x + np.array([low[k], high[k]])
        ).tolist()
        first, last = (end if np.isfinite(end) and 1e-12 < abs(end / x) < 1e12 else None for end in ends) if x else ends
        if why := verdicts.get(name):
            what = to_measure(rows, solution, name, verdicts)
            if not ("offset" in model.unseen and name in ("F_c", "F_s")):  # no interval knows of the offset
                what += _effect(rows, model, solution, at, relation * np.outer(noisy, noisy), stays, k, verdicts)
            estimates[name] = Estimate(None, first, last, unit, False, why, what, float(x))
        else:
            estimates[name] = Estimate(float(x), first, last, unit)
    without_curve(rows, solution, estimates, verdicts)
    estimates |= at_bounds(rows, model, solution, at, verdicts, wide.asked.forms if wide.asked else ())
    size = np.where(at.log, at.values, 1.0)
    matrix = np.clip(inner * np.outer(size, size), -(_HUGE**2), _HUGE**2)
    details["noise"] = _noise(rows, at)
    return StaticConfidenceIntervals(estimates, at.names, matrix, curves, tuple(notes), details)


def untold(model: StaticModel, solution: Minimum, why: str) -> StaticConfidenceIntervals:
    """The best values, and nothing that is known of them, nor of what the data show nothing of."""
    whole = model.whole
    names = (*whole.wanted, *whole.free, *(s.name for s in whole.shapes))
    estimates = {
        n: Estimate(None, None, None, unit_of(model.law, n), False, why, best=solution.values.get(n))
        for n in (*names, *model.unseen)
    }
    free = linearised(whole, solution).names
    return StaticConfidenceIntervals(estimates, free, np.full((len(free), len(free)), np.nan), {}, (), {}, told=False)


def _noise(rows: Rows, at: Linear) -> SeenNoise:
    return {
        "standard_deviation": float(np.std(at.misfit[rows.weight > 0])), "memory": len(noise_memory(at.misfit)),
    }  # fmt: skip


def _relation(at: Linear) -> Array:
    """The correlation of the coordinates that the residual's noise makes."""
    inner = covariance(at.slopes, 1.0, noise_memory(at.misfit)) if len(at.names) else np.zeros((0, 0))
    root = np.sqrt(np.maximum(np.diag(inner), np.finfo(float).tiny))
    with np.errstate(all="ignore"):
        relation = np.clip(np.nan_to_num(inner / root / root[:, None], nan=0.0), -1.0, 1.0)
    np.fill_diagonal(relation, 1.0)  # also where rounding leaves a variance below 0: what nothing determines
    return np.asarray(relation)


def _effect(
    rows: Rows, model: StaticModel, solution: Minimum, at: Linear, now: Array, stays: Array, k: int, open_: Collection[str]
) -> str:  # fmt: skip
    """What that would do to its interval, in words; ``now``: the covariance by noise, ``stays``: the rest of half intervals."""
    if "v_s" in at.names and _bend_unseen(model, solution) == "highest":
        return ""  # no optimum, and no slope of the cost tells how far the numbers go
    sizes = sizes_of(thinned(rows.log))
    noise = float(np.std(at.misfit[rows.weight > 0]) * np.sqrt(rows.q))  # of a row before they are thinned
    numbers = reachable(solution.values, sizes, open_)
    found = at_held_speeds(
        model.whole, solution, now, at.names, at.names[k], noise, numbers, sizes, np.sqrt(rows.q) * at.slopes
    )
    half = _NORMAL * float(np.sqrt(now[k, k])) + float(stays[k])
    return found.told(half, float(stays[k])) if found else ""


def _half_widths(rows: Rows, model: StaticModel, solution: Minimum, at: Linear) -> tuple[_Reach, list[str], FitDetails]:
    """The widest of noise with memory, parts of the record and bands of speed; with it, as of its own cause, what the filter
    does; and to one side what lacks."""
    count = len(at.names)
    if not count:
        return _Reach(np.zeros(0), np.zeros(0), np.zeros(0)), [], {}
    free = max(int((rows.weight > 0).sum()) - count, 1)
    variance = float(at.misfit @ at.misfit) / free
    noise = _NORMAL * np.sqrt(np.maximum(np.diag(covariance(at.slopes, variance, noise_memory(at.misfit))), 0.0))
    parts = clusters.parts_of(rows.log.rows(rows.kept))
    apart, alone = clusters.over_parts(at.slopes, at.misfit, parts)
    v = rows.log.velocity[rows.kept]
    curve = clusters.half_widths(at.slopes, at.misfit, clusters.by_speed(v, rows.weight), False)
    share = clusters.misfit_share(v, at.misfit, rows.weight)
    half = np.maximum(noise, apart)
    notes = []
    if share > _MISFIT:
        wider = np.maximum(half, curve)
        most = int(np.argmax(wider / np.maximum(half, 1e-300)))
        factor = float(wider[most] / max(half[most], 1e-300))
        told = f"; intervals are wider for it, {at.names[most]}'s by {factor:.1f}" if factor > 1.05 else ""
        notes.append(
            f"misfit: a free curve of the speed would take {share:.0%} of the squared residual away: the law lacks "
            f"something{told}"
        )
        half = wider
    if not parts.repeats:
        notes.append(
            "intervals are for this one run: what changes from run to run (warmth, lubrication) is not in them"
        )
    if alone.any():
        told = ", ".join(n for n, own in zip(at.names, alone, strict=True) if own)
        kind = parts.what.partition(" ")[2].removesuffix("s")
        notes.append(f"one {kind} tells nearly all of {told}: what changes from {kind} to {kind} is not seen in them")
    bias = _filter_bias(rows, model, solution, at)
    if wide := [
        f"{n} by {100 * s:.2g} %" for n, s, h, log in zip(at.names, bias, half, at.log, strict=True) if log and s > h
    ]:
        notes.append("intervals are wider to each side for what the filter of the motion may do: " + ", ".join(wide))
    below, above, why, asked = unfitted(rows, model, solution.values, at)
    details: FitDetails = {
        "intervals_over": parts.what,
        "misfit_share": share,
        "filter_bias": dict(zip(at.names, bias.tolist(), strict=True)),
    }
    return _Reach(np.hypot(half, bias), below, above, asked), notes + why, details


def _filter_bias(rows: Rows, model: StaticModel, solution: Minimum, at: Linear) -> Array:
    """How far each coordinate may be off because of the motion's filter: its shift with a cut-off lower by sqrt(2)."""
    log, nothing = rows.log, np.zeros(len(at.names))
    if log.bandwidth is None or not log.step or log.bandwidth * log.step * rows.q > 1.6 or len(log) > 400_000:
        return nothing  # the band that is fitted lies far below, or there are no means to tell
    other = Columns(smoother_log(log), model.whole.columns.sliding, thinning(log, rows.q))
    moved = model.whole.weight * (model.whole.force - model.whole.on(other).force_at(solution.values))
    shift = linear_step(at.slopes, moved - at.misfit)
    return np.asarray(_WHOLE * abs(shift))


# -- verdicts --------------------------------------------------------------------------------------------------------


def _verdicts(rows: Rows, model: StaticModel, solution: Minimum, at: Linear, half: Array) -> dict[str, str]:
    """Why a coordinate is not determined, by name."""
    found: dict[str, str] = {}
    support = supporting_samples(at.slopes) if len(at.misfit) <= 200_000 else np.full(len(half), np.inf)
    plain = covariance(at.slopes, 1.0, np.zeros(0)) if len(at.names) else np.zeros((0, 0))
    alike = np.diag(plain) * np.sum(at.slopes**2, axis=0) > _MOST_ALIKE
    spread = np.sqrt(np.maximum(np.diag(plain), 1e-300))
    for k, name in enumerate(at.names):
        relation = abs(plain[k]) / (spread * spread[k])
        others = [at.names[i] for i in np.argsort(-relation) if i != k and relation[i] > 0.9][:2]
        together = f"; {' and '.join(others)} can make up for it" if others else ""
        shape = next((s for s in model.whole.shapes if s.name == name), None)
        if shape is not None and not 1e-3 < shape.share(solution.values[name]) < 1 - 1e-3:
            found[name] = "the fit drives it to the end of what is tried"
        elif support[k] < _FEWEST:
            found[name] = f"it rests on {max(support[k], 0):.0f} samples only{together}"
        elif at.log[k] and half[k] > _WIDEST:
            found[name] = f"the residuals hardly depend on it{together}"
        elif alike[k]:
            found[name] = f"it is hardly told apart from the others{together}"
        elif unknown := [n for n in others if n in TERMS and TERMS[n].needs and alike[at.names.index(n)]]:
            found[name] = f"it hangs on {unknown[0]}, which is hardly told apart from the others"
    if "F_s" in at.names and (end := _bend_unseen(model, solution)):
        found["F_s"] = f"v_s comes out at the {end} speed measured, and F_s hangs on it"
    if "delay" in at.names and (side := one_sided(rows, at.slopes[:, at.names.index("delay")])):
        found["delay"] = (
            f"more of what tells it lies where the speed {side}, in runs of one direction: there the filter of the motion does "
            "the same; it takes starts and stops alike, or reversals"
        )
    return {**_physical(rows, model, solution, at), **found}


def _moves_away(at: Linear, reach: _Reach) -> dict[str, str]:
    """F_s, where the bend at v_s may be one that a term imitates that was not fitted: another may rise below it; and both,
    where friction behind reversals, where the slow rows are, is not what it is at a steady speed."""
    k = at.names.index("v_s") if {"F_s", "v_s"} <= set(at.names) else None
    if k is None:
        return {}
    if reach.asked and reach.asked.unsteady:
        why = "friction lags behind the speed, or builds up behind reversals, and the bend at low speed hangs on the rows there"
        return dict.fromkeys(("F_s", "v_s"), why)
    if max(reach.below[k], reach.above[k]) <= _WIDEST:
        return {}
    return {"F_s": "with terms that were not fitted v_s may be half or twice its value, and F_s hangs on it"}


def _bend_unseen(model: StaticModel, solution: Minimum) -> str:
    """The end of what is tried at which the Stribeck curve bends: below the slowest rows, or as a part of the viscous curve."""
    shape = next((s for s in model.whole.shapes if s.name == "v_s"), None)
    share = 0.5 if shape is None else shape.share(solution.values["v_s"])
    return "lowest" if share <= 1e-3 else "highest" if share >= 1 - 1e-3 else ""


def _physical(rows: Rows, model: StaticModel, solution: Minimum, at: Linear) -> dict[str, str]:
    """What the speeds, the directions and the forces at rest say against a number, whatever its interval."""
    found: dict[str, str] = {}
    values, v = solution.values, rows.log.velocity[rows.kept][rows.weight > 0]
    speed = np.quantile(abs(v), (0.1, 0.9)) if len(v) else np.zeros(2)
    if speed[0] > 0 and speed[1] / speed[0] < _ONE_SPEED and {"F_c", "sigma_2"} <= set(at.names):
        why = f"nearly all rows have one speed ({speed[0]:.3g} to {speed[1]:.3g} m/s): F_c and sigma_2 cannot be told apart"
        found |= dict.fromkeys(("F_c", "sigma_2"), why)
    if "offset" in model.unseen:
        levels = [n for n in ("F_c", "F_s") if n in at.names]
        found |= {n: f"{model.unseen['offset']}; both together are {values[n]:.4g} N" for n in levels}
    if "F_s" in at.names and len(v):
        grid = np.quantile(abs(v), np.linspace(0, 1, 200))
        law = model.whole.columns.sliding
        sliding = {**{n: x for n, x in values.items() if n in law.base or n in model.law.constants()}, "sigma_2": 0.0}
        own = {n: x for n, x in sliding.items() if n in model.law.constants()}
        reached = float(np.max(abs(law.force(own, grid))))
        if reached < _REACHED * values["F_s"]:
            found["F_s"] = (
                f"the curve comes to {reached:.3g} N at the speeds measured: {values['F_s']:.3g} N are extrapolated"
            )
        beside: Array | float = np.zeros(len(rows.log))
        for name in model.whole.terms:
            if not (TERMS[name].level or TERMS[name].friction or name in ("mass", "area")):
                beside = beside + values.get(name, 0.0) * column(name, rows.log, values)
        held = held_force(replace_force(rows, values), rows.rest, beside)
        if held is not None and held > 1.02 * values["F_s"]:
            found["F_s"] = f"the body was held at rest by {held:.3g} N, more than the {values['F_s']:.3g} N of the fit"
    return found


def replace_force(rows: Rows, values: dict[str, float]) -> Log:
    """The record with the pressure's push taken off its force."""
    if "area" not in values or rows.log.pressure is None:
        return rows.log
    return rows.log.with_columns(force=rows.log.force - values["area"] * rows.log.pressure)


# -- profiles --------------------------------------------------------------------------------------------------------


def _profiles(
    model: StaticModel, solution: Minimum, at: Linear, reach: _Reach, verdicts: dict[str, str]
) -> tuple[Array, Array, dict[str, Profile]]:
    """Ends of the intervals by what holding a number costs; parabolas for those that the force is linear in.

    A valley that bends, along which several numbers change together, is flatter than its covariance says: it is found by
    going there. What may be half or twice its value is not determined.
    """
    half = reach.half
    low, high, found = -half.copy(), half.copy(), {}
    free = max(len(at.misfit) - len(at.names), 1)
    plain = covariance(at.slopes, solution.cost / free, np.zeros(0)) if len(at.names) else np.zeros((0, 0))
    for k, name in enumerate(at.names):
        if half[k] <= 0:
            continue
        across = np.linspace(-1.5, 1.5, 13) * half[k]
        x = at.values[k] * np.exp(np.clip(across, -30, 30)) if at.log[k] else at.values[k] + across
        found[name] = Profile(x, _THRESHOLD * (across / half[k]) ** 2)
        if name in verdicts or name not in _PROFILED or not model.whole.shapes:
            continue
        unit = max(solution.cost / free * (half[k] / _NORMAL) ** 2 / max(plain[k, k], 1e-300), 1e-300)
        tried = {0.0: 0.0}
        for side in (-1, 1):
            end = _end(model.whole, solution, name, side, float(half[k]), unit, tried)
            if end is None:
                word = "half" if side < 0 else "twice"
                verdicts[name] = f"the data fit nearly as well with {word} its value, the others changing with it"
            elif side < 0:
                low[k] = -end
            else:
                high[k] = end
        places = np.array(sorted(tried))
        found[name] = Profile(at.values[k] * np.exp(places), np.array([tried[p] for p in places.tolist()]))
    return low, high, found


def _end(
    model: Separable, solution: Minimum, name: str, side: int, half: float, unit: float, tried: dict[float, float]
) -> float | None:
    """How far (in the logarithm) a number goes until the cost has risen by the threshold; None beyond half and twice."""
    near = (0.0, 0.0)
    for distance in (min(half, 0.6 * _WIDEST), _WIDEST):
        fall = max((_held_at(model, solution, name, side * distance) - solution.cost) / unit, 0.0)
        tried[side * distance] = fall
        root = float(np.sqrt(fall / _THRESHOLD))
        if root >= 1:
            share = (1 - near[1]) / max(root - near[1], 1e-12)
            return max(near[0] + share * (distance - near[0]), 0.0)
        near = (distance, root)
    return None


def _held_at(model: Separable, solution: Minimum, name: str, distance: float) -> float:
    """The cost with one number held at a distance (in the logarithm), all others fitted anew."""
    value = solution.values[name] * float(np.exp(distance))
    wanted = [n for n in model.wanted if n != name]
    shapes = [s for s in model.shapes if s.name != name]
    held = {**model.held, name: value}
    other = Separable(model.columns, held, wanted, model.free, shapes, model.weight)
    if not shapes:
        return other.solve({}).cost
    start = {s.name: solution.values[s.name] for s in shapes}
    return min(other.refined(start, 8).cost, other.solve(start).cost)
