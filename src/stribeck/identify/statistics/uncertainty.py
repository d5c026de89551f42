"""How well the data determine each parameter: covariance, profiles of the likelihood, verdicts.

The residuals' noise may be correlated in time. An autoregressive model of it, whose order the data choose (BIC), gives
the covariance of least squares under that noise, (J'J)^-1 J'CJ (J'J)^-1; and each profile is scaled so that near its
minimum it agrees with it (Chandler and Bate, Biometrika 94(1):167-183, 2007).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.details import SeenNoise
from stribeck.identify.features.filtering import filter_bias, sampling
from stribeck.identify.features.guess import Sizes, sizes_of
from stribeck.identify.features.what_to_measure import experiment_for
from stribeck.identify.log import Log
from stribeck.identify.methods.blockwise import solve_blocks
from stribeck.identify.models.dynamic_problem import VelocityProblem
from stribeck.identify.models.motion_problem import MotionProblem
from stribeck.identify.models.problem import Problem
from stribeck.identify.result import Estimate, Profile, simulated
from stribeck.identify.statistics.correlated import covariance, noise_memory, supporting_samples
from stribeck.identify.statistics.curves import NO_CURVE, no_curve_seen
from stribeck.identify.statistics.late import asked
from stribeck.identify.statistics.missed import misses
from stribeck.identify.statistics.profiles import THRESHOLD, Lower, profile, straight
from stribeck.identify.statistics.sensor_noise import (
    acceleration_of_full_band,
    again_with_force_noise,
    again_with_noise,
)
from stribeck.identify.statistics.stretches import at_least_by_blocks, at_least_by_speed, by_windows
from stribeck.identify.statistics.verdicts import (
    Noise,
    SampledSignal,
    between_samples,
    farther,
    hangs,
    indistinct,
    left_open,
    misled,
    never_slides,
    presliding_unseen,
    shape,
    why_not,
    widened,
)
from stribeck.identify.work import Work

_WHOLE = 1.5  # of the shift by as much noise again: the noise that is there
_FLAT = 1.1  # F_s over F_c: motion that hardly sticks has a minimum there, beside that with a curve
_CLOSE = 0.005  # half a 95 % interval, of the value: known so well, it is told from the others
_CLOSE_IF_CLEAN = (
    0.1  # the same where the residual is white noise of the measurement's size: no error of the model is seen
)
_MORE = 1.15  # times the measurement's noise: the residual of a model that follows it
_MODEL = 1.5  # times the force's noise: the model's own error is seen
_BRISTLES = ("sigma_0", "sigma_1", "z_ba")  # what only presliding tells
_FRESH_STARTS = 4


@dataclass(frozen=True)
class ConfidenceIntervals:
    """Estimates with intervals; covariance of ``names`` (values, not logarithms); profiles; what a reader should know.

    ``point``: the optimum, which may be better than the one given: profiles sometimes find one. ``noise``: its standard
    deviation and the order of the model of its correlation.
    """

    point: Array
    estimates: dict[str, Estimate]
    names: tuple[str, ...]
    covariance: Array
    profiles: dict[str, Profile]
    notes: tuple[str, ...]
    noise: SeenNoise


def judge(
    problem: Problem, u: Array, log: Log, profiles: bool = True, noise: Noise | None = None, work: Work | None = None
) -> ConfidenceIntervals:
    """Intervals and verdicts for every coordinate that is no nuisance, at the optimum ``u``.

    A fit that misses what was measured, by more than noise can, has no intervals: its numbers are those of another machine.
    """
    work, noise = work or Work(), noise or Noise()
    for _ in range(_FRESH_STARTS):
        if work.stopped:
            return without(problem, u, "the fit was stopped before its end")
        try:
            return _judge(problem, u, log, profiles, noise, work)
        except Lower as lower:
            better = problem.nearest(solve_blocks(problem, lower.point, 1e-10, 200).point)
            if problem.sensitivities(better) is None:
                break
            u = better
    return _judge(problem, u, log, False, noise, work)


def systematic(problem: Problem, u: Array, slopes: Array) -> Array:
    """How far each inner coordinate may be off by what no residual shows: the motion's filter, what happens between its
    samples, its noise, and the lower filter of the acceleration. Noise has nothing to do with the others; of a fit of the
    force these all round off the same reversals, and add up."""
    if isinstance(problem, MotionProblem):
        again = _WHOLE * again_with_force_noise(problem, u)
        filtered = filter_bias(problem, u, slopes)
        return np.asarray(np.sqrt(between_samples(problem, u, slopes) ** 2 + again**2 + filtered**2))
    if isinstance(problem, SampledSignal):
        return between_samples(problem, u, slopes)
    shift, spread = again_with_noise(problem, u)
    noise = _WHOLE * abs(shift) + np.sqrt(THRESHOLD) * spread
    filtered = np.maximum(filter_bias(problem, u, slopes), _WHOLE * acceleration_of_full_band(problem, u, slopes))
    return np.asarray(np.sqrt(noise**2 + (filtered + sampling(problem, u, slopes)) ** 2))


def without(problem: Problem, u: Array, why: str) -> ConfidenceIntervals:
    """The best values found, and nothing that is known of them."""
    values = {c.name: c.outer(x) for c, x in zip(problem.coordinates, u.tolist(), strict=True) if not c.nuisance}
    units = {c.name: c.unit for c in problem.coordinates}
    misfit = problem.misfit(u)
    deviation = float("nan") if misfit is None else float(np.sqrt(np.mean(misfit**2)))
    estimates = {n: simulated(None, None, None, units[n], False, why, best=x) for n, x in values.items()}
    nothing = np.full((len(values), len(values)), np.nan)
    return ConfidenceIntervals(
        u, estimates, tuple(values), nothing, {}, (), {"standard_deviation": deviation, "memory": 0}
    )


@dataclass(frozen=True)
class _Optimum:
    """A problem at its best point, and what the residual does to the coordinates there.

    ``plain``: their covariance under white noise; ``inner``: under the noise that is seen; ``memory``: its correlation.
    """

    problem: Problem
    u: Array
    slopes: Array
    variance: float
    memory: Array
    plain: Array
    inner: Array
    expected: Noise

    @property
    def deviation(self) -> float:
        """Of the residual."""
        return float(np.sqrt(self.variance))

    @property
    def deviations(self) -> Array:
        """Of the coordinates."""
        with np.errstate(invalid="ignore"):  # rounding made it negative: nan, which nothing is told by
            return np.asarray(np.sqrt(np.diag(self.inner)))

    @property
    def inflation(self) -> Array:
        """Of the coordinates' variances, by what the noise is beside white."""
        return np.asarray(np.maximum(np.diag(self.inner) / np.maximum(np.diag(self.plain), 1e-300), 1e-6))

    @property
    def own(self) -> list[int]:
        """The coordinates that are no nuisance."""
        return [k for k, c in enumerate(self.problem.coordinates) if not c.nuisance]

    @property
    def beyond(self) -> bool:
        """Whether the force is missed by more than its noise."""
        return not isinstance(self.problem, MotionProblem) and self.deviation > _MODEL * self.expected.expected > 0

    @property
    def differs(self) -> bool:
        """Whether windows of the motion are missed by more than the sensor's noise: no likelihood tells by how much."""
        return isinstance(self.problem, MotionProblem) and self.deviation > _MORE * self.expected.measured > 0

    @property
    def clean(self) -> bool:
        """Whether the residual is the sensor's white noise, which shows no error of the model."""
        motion = isinstance(self.problem, MotionProblem) and not len(self.memory)
        return motion and self.deviation < _MORE * self.expected.expected


def _judge(problem: Problem, u: Array, log: Log, profiles: bool, expected: Noise, work: Work) -> ConfidenceIntervals:
    slopes, misfit = problem.sensitivities(u), problem.misfit(u)
    if slopes is None or misfit is None:
        return without(problem, u, "the simulation fails beside the best values")
    late = asked(problem, u)
    if why := misses(misfit, problem.measured, expected):
        return without(problem, u, f"{why}; {late.told}" if late and late.told else why)
    at, notes = _at_optimum(problem, u, slopes, misfit, expected)
    sizes, values = sizes_of(log), problem.values(u)
    unseen = presliding_unseen(problem, values, log)
    bias = systematic(problem, u, slopes)
    notes += [late.told] if late and late.told else []
    lost = misled(problem, bias)
    doubts = _doubts(at, bias, values, sizes, unseen)
    ends = _profiled(at, [k for k in at.own if not doubts[k]], work) if profiles else {}
    intervals: dict[int, tuple[float | None, float | None]] = {}
    stays: dict[int, float] = {}
    for k in at.own:
        c, half = problem.coordinates[k], np.sqrt(THRESHOLD) * at.deviations[k]
        low: float | None
        high: float | None
        if k in ends:
            low, high, _ = ends[k]
        else:
            low, high = (x if c.inner(c.low) < x < c.inner(c.high) else None for x in (u[k] - half, u[k] + half))
        stays[k] = farther(c, bias[k], c.name in _BRISTLES and lost) + (late.bias[k] if late else 0.0)
        low, high = (None if x is None else x + side * stays[k] for x, side in ((low, -1), (high, 1)))
        doubts[k] = doubts[k] or (late.doubt(k, c.log) if late else "") or left_open(low, high, c.log)
        low, high = (None if x is None else c.outer(x) for x in (low, high))
        if (unseen and doubts[k].endswith(unseen)) or doubts[k].startswith(("v_s comes", "v_s is not")):
            low = high = None  # the numbers of a curve that nobody has seen
        intervals[k] = low, high
    for k in _of_no_curve(at, intervals, doubts):
        doubts[k], intervals[k] = NO_CURVE, (None, None)
    for k in _of_no_name(at, doubts):
        if never := never_slides(problem, values, log):
            doubts[k], intervals[k] = never, (None, None)
    open_ = {problem.coordinates[k].name for k in at.own if doubts[k]}
    estimates = {}
    for k, (low, high) in intervals.items():
        c, best = problem.coordinates[k], float(problem.coordinates[k].outer(u[k]))
        if doubts[k]:
            what = experiment_for(c.name, values, sizes, open_)
            estimates[c.name] = simulated(None, low, high, c.unit, False, doubts[k], what, best)
        else:
            estimates[c.name] = simulated(best, low, high, c.unit, best=best)
    names = tuple(problem.coordinates[k].name for k in at.own)
    stretch = np.array([c.outer(u[k]) if c.log else c.scale for k, c in enumerate(problem.coordinates)])
    outer = (at.inner * np.outer(stretch, stretch))[np.ix_(at.own, at.own)]
    notes += widened(problem, estimates, bias, at.inner)
    seen: SeenNoise = {"standard_deviation": at.deviation, "memory": len(at.memory)}
    curves = {problem.coordinates[k].name: ends[k][2] for k in at.own if k in ends}
    return ConfidenceIntervals(u, estimates, names, outer, curves, tuple(notes), seen)


def _of_no_curve(
    at: _Optimum, intervals: dict[int, tuple[float | None, float | None]], doubts: dict[int, str]
) -> list[int]:
    """The coordinates that hang on a Stribeck curve where the optimum has none: F_s reaches down to F_c, so that any v_s fits
    and no profile crosses to where the curve may be; bristles too where more is missed than noise."""
    named = {at.problem.coordinates[k].name: k for k in at.own}
    if not {"F_s", "v_s"} <= named.keys() or not doubts[named["v_s"]]:
        return []
    low, values = intervals[named["F_s"]][0], at.problem.values(at.u)
    high = intervals[named["F_c"]][1] if "F_c" in named else values.get("F_c", 0.0)
    flat = isinstance(at.problem, MotionProblem) and values["F_s"] < _FLAT * values.get("F_c", 0.0)
    if not flat and (doubts[named["F_s"]] or not no_curve_seen(low, high)):
        return []
    # a curve that ends early, and other bristles with it, may leave as little
    beside = _BRISTLES if at.beyond or flat else ()
    return [named[n] for n in ("F_s", *beside) if n in named and not doubts[named[n]]]


def _of_no_name(at: _Optimum, doubts: Mapping[int, str]) -> list[int]:
    """F_c, where it is told and neither F_s nor v_s is: the level of slow motion, which may be F_s."""
    named = {at.problem.coordinates[k].name: k for k in at.own}
    if not {"F_c", "F_s", "v_s"} <= named.keys() or not (doubts[named["F_s"]] and doubts[named["v_s"]]):
        return []
    return [] if doubts[named["F_c"]] else [named["F_c"]]


def _at_optimum(
    problem: Problem, u: Array, slopes: Array, misfit: Array, expected: Noise
) -> tuple[_Optimum, list[str]]:
    """The spread of the coordinates that the residual makes, and what a reader should know of it."""
    free = len(misfit) - len(u) - getattr(problem, "hidden", 0)
    variance = float(misfit @ misfit) / max(free, 1)
    memory = noise_memory(misfit)
    inner, plain = covariance(slopes, variance, memory), covariance(slopes, variance, np.zeros(0))
    notes = [] if free > 10 * len(u) else [f"only {len(misfit)} samples for {len(u)} numbers"]
    at = _Optimum(problem, u, slopes, variance, memory, plain, inner, expected)
    if isinstance(problem, MotionProblem) and at.differs:
        inner = by_windows(problem, slopes, misfit, inner)
        notes.append(
            f"the residual is {np.sqrt(variance) / expected.measured:.3g} times the noise of the {problem.output}: the "
            f"intervals are from how the {len(problem.windows)} windows of the record differ"
        )
    elif isinstance(problem, MotionProblem):
        inner = at_least_by_blocks(problem, slopes, misfit, inner)
    elif at.beyond and isinstance(problem, VelocityProblem):
        inner = at_least_by_speed(problem, slopes, misfit, problem.log.velocity[problem.rows], inner)
    at = replace(at, inner=inner)
    if at.beyond and problem.law.has_z:
        notes.append(
            f"the residual is {at.deviation / expected.expected:.2g} times the noise of the force: the intervals hold as "
            "far as the model does"
        )
    return at, notes


def _doubts(at: _Optimum, bias: Array, values: dict[str, float], sizes: Sizes, unseen: str) -> dict[int, str]:
    """Why the data do not determine a coordinate, for each that is no nuisance; nothing where they seem to."""
    support = supporting_samples(at.slopes)
    alike = indistinct(at.plain, at.slopes, at.variance)
    close = _CLOSE_IF_CLEAN if at.clean else _CLOSE
    doubts = {}
    for k in at.own:
        c = at.problem.coordinates[k]
        if c.name in _BRISTLES and unseen:
            doubt = unseen
        else:
            confused = bool(alike[k]) and np.sqrt(THRESHOLD) * at.deviations[k] > close
            doubt = why_not(at.problem, k, at.u, at.inner, np.inf if at.clean else support[k], confused)
        doubts[k] = doubt or hangs(c, bias[k]) or (shape(c, values, sizes, unseen) if at.beyond else "")
    names = {at.problem.coordinates[k].name: k for k in at.own}
    if at.differs and {"F_s", "v_s"} <= set(names) and doubts[names["v_s"]]:
        # no likelihood is followed there: beside a v_s that nothing tells, F_s may be at another minimum
        doubts[names["F_s"]] = doubts[names["F_s"]] or "v_s is not determined, and F_s hangs on it"
    return doubts


def _profiled(at: _Optimum, wanted: list[int], work: Work) -> dict[int, tuple[float | None, float | None, Profile]]:
    """Ends of intervals by profiles of the likelihood; of all that could be followed."""
    if not wanted:
        return {}
    units = at.variance * at.inflation / at.problem.scale**2
    ends = dict(straight(at.problem, at.u, at.inner, at.deviations, units, wanted))
    bent = [k for k in wanted if k not in ends and not at.differs]

    def followed(k: int) -> tuple[float | None, float | None, Profile]:
        found = profile(at.problem, at.u, k, at.deviations[k], at.variance * at.inflation[k], at.inner)
        work.tick()
        return found

    return ends | {k: curve for k, curve in zip(bent, work.each(followed, bent), strict=True) if curve is not None}
