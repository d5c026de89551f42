"""How well the data determine each parameter: covariance, profiles of the likelihood, verdicts.

The residuals' noise may be correlated in time. An autoregressive model of it, whose order the data choose (BIC), gives
the covariance of least squares under that noise, (J'J)^-1 J'CJ (J'J)^-1; and each profile is scaled so that near its
minimum it agrees with it (Chandler and Bate, Biometrika 94(1):167-183, 2007).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import solve_toeplitz

from stribeck.arrays import Array
from stribeck.identify.details import SeenNoise
from stribeck.identify.features.filtering import filter_bias, sampling
from stribeck.identify.features.guess import Sizes, sizes_of
from stribeck.identify.features.what_to_measure import experiment_for, reachable
from stribeck.identify.log import Log
from stribeck.identify.methods.blockwise import solve_blocks
from stribeck.identify.models.dynamic_problem import VelocityProblem
from stribeck.identify.models.motion_problem import MotionProblem
from stribeck.identify.models.problem import Problem
from stribeck.identify.result import Estimate, Profile
from stribeck.identify.statistics.profiles import THRESHOLD, Lower, profile, straight
from stribeck.identify.statistics.sensor_noise import (
    acceleration_of_full_band,
    again_with_force_noise,
    again_with_noise,
)
from stribeck.identify.statistics.stretches import at_least_by_blocks, at_least_by_speed, by_windows
from stribeck.identify.statistics.verdicts import (
    Noise,
    between_samples,
    effect,
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
NO_CURVE = "F_s comes out at F_c and v_s is open: friction that rises towards lower speeds would look alike"
_CLOSE = 0.005  # half a 95 % interval, of the value: known so well, it is told from the others
_CLOSE_IF_CLEAN = (
    0.1  # the same where the residual is white noise of the measurement's size: no error of the model is seen
)
_MORE = 1.15  # times the measurement's noise: the residual of a model that follows it
_MODEL = 1.5  # times the force's noise: the model's own error is seen
_BEYOND = 3.0  # times what noise explains: a residual that is the model's
_BRISTLES = ("sigma_0", "sigma_1", "z_ba")  # what only presliding tells
_LONGEST_MEMORY = 50  # samples, of the noise model
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
    estimates = {n: Estimate(None, None, None, units[n], False, why, best=x) for n, x in values.items()}
    nothing = np.full((len(values), len(values)), np.nan)
    return ConfidenceIntervals(
        u, estimates, tuple(values), nothing, {}, (), {"standard_deviation": deviation, "memory": 0}
    )


def misses(problem: Problem, misfit: Array, noise: Noise) -> str:
    """Why nothing can be said of a fit, or nothing: it leaves more than noise does, and much of what was measured."""
    left, whole = float(np.linalg.norm(misfit)), float(np.linalg.norm(problem.measured))
    deviation = left / np.sqrt(max(len(misfit), 1))
    if noise.expected <= 0 or deviation <= _BEYOND * noise.expected:
        return ""
    share = max(left / whole, noise.farther)
    text = (
        f"the fit misses {share:.2g} of what was measured, {deviation / noise.expected:.3g} times what noise explains"
    )
    if share > noise.missed:
        return f"{text}: its numbers say nothing about the machine"
    return f"{text}, and one start alone led to it: give more starts" if noise.alone else ""


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
    if why := misses(problem, misfit, expected):
        return without(problem, u, why)
    at, notes = _at_optimum(problem, u, slopes, misfit, expected)
    sizes, values = sizes_of(log), problem.values(u)
    unseen = presliding_unseen(problem, values, log)
    bias = systematic(problem, u, slopes)
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
        stays[k] = farther(c, bias[k], c.name in _BRISTLES and lost)
        low, high = (None if x is None else x + side * stays[k] for x, side in ((low, -1), (high, 1)))
        doubts[k] = doubts[k] or left_open(low, high, c.log)
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
    numbers = reachable(values, sizes, open_)
    estimates = {}
    for k, (low, high) in intervals.items():
        c, best = problem.coordinates[k], float(problem.coordinates[k].outer(u[k]))
        if doubts[k]:
            what = experiment_for(c.name, values, sizes, open_)
            what += effect(problem, k, values, at.inner, at.own, sizes, expected, numbers, stays[k], low is not None)
            estimates[c.name] = Estimate(None, low, high, c.unit, False, doubts[k], what, best)
        else:
            estimates[c.name] = Estimate(best, low, high, c.unit, best=best)
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
    if not {"F_s", "v_s"} <= named.keys() or doubts[named["F_s"]] or not doubts[named["v_s"]]:
        return []
    low, values = intervals[named["F_s"]][0], at.problem.values(at.u)
    high = intervals[named["F_c"]][1] if "F_c" in named else values.get("F_c", 0.0)
    if low is not None and high is not None and low > high:
        return []
    return [named["F_s"], *(named[n] for n in _BRISTLES if n in named and at.beyond and not doubts[named[n]])]


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


# -- noise -----------------------------------------------------------------------------------------------------------


def noise_memory(misfit: Array) -> Array:
    """The coefficients a_1, a_2, ... of r_t = a_1 r_(t-1) + a_2 r_(t-2) + ... + white noise; none for white noise."""
    n = len(misfit)
    longest = min(_LONGEST_MEMORY, n // 20)
    if longest < 1 or not misfit.any():
        return np.zeros(0)
    centred = misfit - misfit.mean()
    spectrum = abs(np.fft.rfft(centred, 2 * n)) ** 2
    correlation = np.fft.irfft(spectrum)[: longest + 1] / n
    best, chosen = n * np.log(correlation[0]), np.zeros(0)
    for order in range(1, longest + 1):
        a = solve_toeplitz(correlation[:order], correlation[1 : order + 1])
        left = correlation[0] - a @ correlation[1 : order + 1]
        score = n * np.log(max(left, 1e-300)) + order * np.log(n)
        if score < best:
            best, chosen = score, a
    return np.asarray(chosen)


def covariance(slopes: Array, variance: float, memory: Array) -> Array:
    """The covariance of a least squares estimate whose residuals have that variance and that memory."""
    size = np.sqrt(np.mean(slopes**2, axis=0))
    size = np.where(size > 0, size, 1.0)
    scaled = slopes / size
    # a direction that nothing determines gets a variance that is huge, and finite
    normal = scaled.T @ scaled
    inverse = np.linalg.inv(normal + 1e-14 * np.trace(normal) * np.eye(len(normal)))
    if not len(memory):
        return np.asarray(variance * inverse / np.outer(size, size))
    n = len(scaled)
    waves = np.fft.rfft(scaled, 2 * n, axis=0)
    frequency = np.exp(-1j * np.pi * np.arange(n + 1) / n)
    gain = abs(1 - np.polyval(np.append(memory[::-1], 0.0), frequency)) ** -2.0
    both = np.ones(n + 1)
    both[1:-1] = 2.0  # the negative frequencies too
    gain *= 2 * n / float(both @ gain)  # the residuals' variance is the one given
    middle = np.real(waves.conj().T @ (waves * (both * gain)[:, None])) / (2 * n)
    return np.asarray(variance * inverse @ middle @ inverse / np.outer(size, size))


def supporting_samples(slopes: Array) -> Array:
    """How many samples each coordinate rests on: of its slopes, less what the others can imitate, (sum s^2)^2/sum s^4."""
    found = np.zeros(slopes.shape[1])
    for k in range(slopes.shape[1]):
        others = np.delete(slopes, k, axis=1)
        own = slopes[:, k]
        if others.shape[1]:
            own = own - others @ np.linalg.lstsq(others, own, rcond=1e-12)[0]
        fourth = float(np.sum(own**4))
        found[k] = float(np.sum(own**2)) ** 2 / fourth if fourth > 0 else 0.0
    return found
