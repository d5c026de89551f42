"""How well the data determine each parameter: covariance, profiles of the likelihood, verdicts.

The residuals' noise may be correlated in time. An autoregressive model of it, whose order the data choose (BIC), gives
the covariance of least squares under that noise, (J'J)^-1 J'CJ (J'J)^-1; and each profile is scaled so that near its
minimum it agrees with it (Chandler and Bate, Biometrika 94(1):167-183, 2007).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz
from scipy.optimize import least_squares
from scipy.stats import chi2

from stribeck.identify.features.filtering import leeway
from stribeck.identify.features.guess import reversals, scales
from stribeck.identify.features.what_to_measure import experiment_for
from stribeck.identify.log import Log
from stribeck.identify.methods.optimise import descend
from stribeck.identify.models.problem import Coordinate, Problem
from stribeck.identify.result import Estimate, Profile

Array = NDArray[np.float64]
_THRESHOLD = float(chi2.ppf(0.95, 1))
_WIDEST = 0.7  # half a 95 % interval in the logarithm, half to twice the value: a wider one is not determined
_MOST_ALIKE = 200.0  # by how much the others' freedom may inflate a variance: a small error of the model grows with it
_BOUND = 0.95  # correlation with one that is inflated so
_FEWEST = 12.0  # samples that an estimate must rest on
_BRISTLES = ("sigma_0", "sigma_1", "z_ba")  # what only presliding tells
_RESOLVED = 10  # samples in which presliding must be passed through to be seen
_MOST_LEEWAY = 0.2  # of the logarithm, for the motion's filter
_LONGEST_MEMORY = 50  # samples, of the noise model
_FRESH_STARTS = 4
_NOTICEABLE = 0.05  # of twice the log-likelihood
_FARTHEST = 4.0  # of the logarithm, to which a profile is followed


@dataclass(frozen=True)
class Judgement:
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
    noise: dict[str, Any]


class _Lower(Exception):
    """A profile came to a lower cost than the optimum's."""

    def __init__(self, point: Array) -> None:
        super().__init__()
        self.point = point


def judge(problem: Problem, u: Array, log: Log, profiles: bool = True) -> Judgement:
    """Intervals and verdicts for every coordinate that is no nuisance, at the optimum ``u``."""
    for _ in range(_FRESH_STARTS):
        try:
            return _judge(problem, u, log, profiles)
        except _Lower as lower:
            u = problem.nearest(descend(problem, lower.point, 1e-10, 200).point)
    return _judge(problem, u, log, False)


def _judge(problem: Problem, u: Array, log: Log, profiles: bool) -> Judgement:
    slopes, misfit = problem.sensitivities(u), problem.misfit(u)
    assert slopes is not None
    assert misfit is not None
    free = len(misfit) - len(u)
    variance = float(misfit @ misfit) / max(free, 1)
    memory = noise_memory(misfit)
    inner = covariance(slopes, variance, memory)
    plain = covariance(slopes, variance, np.zeros(0))
    support = supporting_samples(slopes)
    alike = _alike(plain, slopes, variance)
    sizes, values = scales(log), problem.values(u)
    unseen = _presliding_unseen(problem, values, log)
    spare = leeway(problem, u, slopes)
    estimates, found = {}, {}
    for k, c in enumerate(problem.coordinates):
        if c.nuisance:
            continue
        inflation = max(inner[k, k] / plain[k, k], 1e-6) if plain[k, k] > 0 else 1.0
        deviation = float(np.sqrt(inner[k, k]))
        low: float | None
        high: float | None
        doubt = unseen if c.name in _BRISTLES and unseen else _doubt(problem, k, u, inner, support[k], alike[k])
        doubt = doubt or _hangs(c, spare[k])
        if profiles and not doubt:
            low, high, found[c.name] = profile(problem, u, k, deviation, variance * inflation, inner)
            doubt = doubt or _open(low, high, c.log)
            low, high = (None if x is None else c.outer(x + side * spare[k]) for x, side in ((low, -1), (high, 1)))
        else:
            ends = [u[k] + side * (np.sqrt(_THRESHOLD) * deviation + spare[k]) for side in (-1, 1)]
            low, high = (c.outer(x) if c.inner(c.low) < x < c.inner(c.high) else None for x in ends)
        if doubt:
            what = experiment_for(c.name, values, sizes)
            estimates[c.name] = Estimate(None, low, high, c.unit, False, doubt, what)
        else:
            estimates[c.name] = Estimate(c.outer(u[k]), low, high, c.unit)
    own = [k for k, c in enumerate(problem.coordinates) if not c.nuisance]
    stretch = np.array([c.outer(u[k]) if c.log else c.scale for k, c in enumerate(problem.coordinates)])
    outer = (inner * np.outer(stretch, stretch))[np.ix_(own, own)]
    notes = [] if free > 10 * len(u) else [f"only {len(misfit)} samples for {len(u)} numbers"]
    notes += _widened(problem, estimates, spare, inner)
    noise = {"standard_deviation": float(np.sqrt(variance)), "memory": len(memory)}
    return Judgement(u, estimates, tuple(problem.coordinates[k].name for k in own), outer, found, tuple(notes), noise)


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


# -- verdicts --------------------------------------------------------------------------------------------------------


def _doubt(problem: Problem, k: int, u: Array, inner: Array, support: float, alike: bool) -> str:
    """Why a coordinate is not determined, or nothing."""
    c, deviation = problem.coordinates[k], float(np.sqrt(inner[k, k]))
    low, high = problem.bounds
    room = 1e-3 * (high[k] - low[k])
    if c.log and not low[k] + room < u[k] < high[k] - room:
        return "the fit drives it to the end of what is tried"
    spread = np.sqrt(np.diag(inner))
    with np.errstate(all="ignore"):
        relation = inner[k] / (spread * spread[k])
    others = [i for i in np.argsort(-abs(relation)) if i != k and abs(relation[i]) > 0.9]
    along = [problem.coordinates[i].name for i in others if not problem.coordinates[i].nuisance][:2]
    together = f"; {' and '.join(along)} can make up for it" if along else ""
    if support < _FEWEST:
        return f"it rests on {max(support, 0):.0f} samples only{together}"
    if c.log and np.sqrt(_THRESHOLD) * deviation > _WIDEST:
        return f"the residuals hardly depend on it{together}"
    if alike:
        return f"it is hardly told apart from the others{together}"
    return ""


def _alike(plain: Array, slopes: Array, variance: float) -> NDArray[np.bool_]:
    """Which coordinates the others can imitate so well that only combinations of them are determined."""
    if variance <= 0:
        return np.zeros(len(plain), bool)
    inflated = np.diag(plain) * np.sum(slopes**2, axis=0) / variance > _MOST_ALIKE
    spread = np.sqrt(np.diag(plain))
    bound = abs(plain) > _BOUND * np.outer(spread, spread)
    return np.asarray(inflated | (bound & inflated[None, :]).any(axis=1))


def _presliding_unseen(problem: Problem, values: Mapping[str, float], log: Log) -> str:
    """Why the log does not show presliding, or nothing: after reversals the first moments, in which the bristles bend,
    must be longer than a few samples and than what the filter of the velocity resolves."""
    if not problem.law.has_z:
        return ""
    length = 2 * problem.length(values)
    needed = max(_RESOLVED, int(np.ceil(1 / (log.bandwidth * log.step))) if log.bandwidth and log.step else 0)
    longest = 0
    for rows in log.runs():
        y = log.position[rows]
        for first, last in reversals(log.velocity[rows]):
            gone = abs(y[first : last + 1] - y[first]) > length
            longest = max(longest, int(np.argmax(gone)) if gone.any() else last - first)
            if longest >= needed:
                return ""
    if not longest:
        return "there is no reversal and no start from rest in the log, so no presliding"
    return f"no reversal passes through presliding in {needed} samples or more (at best {longest})"


def _hangs(c: Coordinate, spare: float) -> str:
    """Why the filter of the motion leaves a coordinate open, or nothing."""
    if not c.log or spare <= _MOST_LEEWAY:
        return ""
    why = "the position is too coarse or noisy, or sampled too slowly"
    return f"it hangs on the filter of the motion, which may shift it by {spare:.0%}: {why}"


def _widened(problem: Problem, estimates: Mapping[str, Estimate], spare: Array, inner: Array) -> list[str]:
    """What to say of intervals that the motion's filter has made wider."""
    wider = [
        f"{c.name} by {100 * spare[k]:.2g} %"
        for k, c in enumerate(problem.coordinates)
        if c.log and not c.nuisance and estimates[c.name].identifiable and spare[k] > 2 * np.sqrt(inner[k, k])
    ]
    why = "intervals are wider to each side for what the filter of the motion may do: "
    return [why + ", ".join(wider)] if wider else []


def _open(low: float | None, high: float | None, log: bool) -> str:
    if low is None or high is None:
        side = "below" if low is None else "above"
        both = low is None and high is None
        return "the data fit as well whatever it is" if both else f"the data set no limit {side}"
    if log and high - low > 2 * _WIDEST:
        return f"its 95 % interval spans a factor of {np.exp(high - low):.2g}"
    return ""


# -- profiles --------------------------------------------------------------------------------------------------------


def profile(
    problem: Problem, u: Array, k: int, deviation: float, variance: float, inner: Array
) -> tuple[float | None, float | None, Profile]:
    """The 95 % interval of a coordinate (inner) by its profile likelihood, an open side being None; and the profile."""
    base = _cost(problem, u)
    unit = variance / problem.scale**2  # of twice the cost
    tried: list[tuple[float, float]] = [(float(u[k]), 0.0)]
    ends = [_end(problem, u, k, side, deviation, base, unit, inner, tried) for side in (-1, 1)]
    tried.sort()
    c = problem.coordinates[k]
    curve = Profile(np.array([c.outer(x) for x, _ in tried]), np.array([fall for _, fall in tried]))
    return ends[0], ends[1], curve


def _end(
    problem: Problem, u: Array, k: int, side: int, deviation: float, base: float, unit: float, inner: Array,
    tried: list[tuple[float, float]],
) -> float | None:  # fmt: skip
    """Where twice the log-likelihood has fallen by the threshold, going from the optimum to one side."""
    low, high = problem.bounds
    edge = high[k] if side > 0 else low[k]
    coordinate = problem.coordinates[k]
    farthest = u[k] + side * _FARTHEST if coordinate.log else edge
    limit = min(edge, farthest) if side > 0 else max(edge, farthest)
    root = np.sqrt(_THRESHOLD)
    near, far = (0.0, 0.0), None  # distance, root of the fall
    distance = root * deviation
    # where the others go along, as far as the data tell that
    along = np.where(np.diag(inner) < 1.0, inner[:, k] / inner[k, k], 0.0)
    for _ in range(12):
        distance = min(distance, abs(limit - u[k]))
        x = float(u[k] + side * distance)
        start = u + along * (x - u[k])
        found, best = _cost_at(problem, start, k, x)
        fall = 2 * (found - base) / unit
        if fall < -_NOTICEABLE:
            raise _Lower(best)
        fall = max(fall, 0.0)
        tried.append((x, fall))
        here = (distance, float(np.sqrt(fall)))
        if abs(here[1] - root) < 0.02:
            return x
        if here[1] < root:
            near = here
            if distance >= abs(limit - u[k]) * (1 - 1e-9):
                return None
        else:
            far = here
        if far is None:
            distance = min(distance * max(root / max(here[1], 1e-3), 1.05), 3 * distance)
        else:
            share = (root - near[1]) / max(far[1] - near[1], 1e-12)
            distance = near[0] + min(max(share, 0.1), 0.9) * (far[0] - near[0])
    return float(u[k] + side * distance)


def _cost(problem: Problem, u: Array) -> float:
    r = problem.residual(u)
    return 0.5 * float(r @ r)


def _cost_at(problem: Problem, start: Array, k: int, value: float) -> tuple[float, Array]:
    """The smallest cost with one coordinate held, and the point."""
    rest = np.array([i for i in range(len(start)) if i != k], int)
    low, high = problem.bounds
    if not len(rest):
        return _cost(problem, np.array([value])), np.array([value])

    def whole(part: Array) -> Array:
        u = np.empty(len(start))
        u[rest], u[k] = part, value
        return u

    room = 1e-9 * (high - low)
    inside = np.clip(start, low + room, high - room)[rest]

    def residual(part: Array) -> Array:
        return problem.residual(whole(part))

    def jacobian(part: Array) -> Array:
        return problem.jacobian(whole(part))[:, rest]

    found = least_squares(
        residual, inside, jacobian, bounds=(low[rest], high[rest]), ftol=1e-7, xtol=1e-7, gtol=1e-15, max_nfev=20,
    )  # fmt: skip
    return float(found.cost), whole(found.x)
