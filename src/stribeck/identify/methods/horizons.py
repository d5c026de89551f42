"""Windows that grow: from the time between two reversals to whole runs, as far as the model follows the measurement."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from scipy.stats import qmc

from stribeck.arrays import Array
from stribeck.identify.log import Log
from stribeck.identify.methods.optimise import Optimum, multistart
from stribeck.identify.models.dynamic_problem import VelocityProblem
from stribeck.identify.models.motion_problem import FEWEST, FINE, ROUGH, SLIDES, MotionProblem
from stribeck.identify.models.problem import Coordinate
from stribeck.identify.statistics.profiles import THRESHOLD
from stribeck.identify.statistics.stretches import drifts
from stribeck.identify.work import Work

_SHORTEST = 40  # rows
_GROWS = 4
_MANY = 24  # windows from which the first look is taken
_ENOUGH = 6  # windows that begin in motion: the first look leaves the others out
_MOST = 64  # windows of the last one
_FOLLOWS = 1.15  # times the noise: the residual of a model that follows the measurement
_GROWN = 1.02  # times the residual of shorter windows: more is a drift, or a model, that longer ones do not bear
_MANY_EVALUATIONS, _FEW_EVALUATIONS = 200, 40  # of a descent; of one from the optimum of shorter windows, which is near
_SLOW = 3e-3  # of the largest speed, where friction may fall with it
_BENDS = (3e-4, 1e-3, 3e-3, 1e-2, 3e-2)  # of the largest speed: where the Stribeck curve may end
_RISE = 1.4  # F_s over F_c
_HIDES = 3.0  # times the noise of the position: bristles that bend less at break-away are hidden by it
_STIFFER = (0.3, 3.0)  # times the bristles that were found
_TURNS = 0.05  # of the largest speed: what a reversal must pass


@dataclass(frozen=True)
class Followed:
    """The last problem whose windows the model follows down to the output's noise, its optimum, the residual as a multiple
    of that noise, the length of a window, and whether the residual goes slowly to and fro within windows; the residual as
    a share of the output's changes, also in the longer windows that were given up."""

    problem: MotionProblem
    optimum: Optimum
    ratio: float
    seconds: float
    drifts: bool
    left: float = 0.0
    farther: float = 0.0
    expected: float = 1.0  # the multiple that the noise of the force explains


def follow(
    inverse: VelocityProblem, output: str, starts: Sequence[dict[str, float]], noise: float, force_noise: float,
    work: Work, other: Callable[[], dict[str, float]],
) -> Followed:  # fmt: skip
    """Fit short windows from the first start; from ``other`` and every start where that leaves more than noise; then
    longer windows from what was found, as long as the model follows."""
    log = inverse.log
    rows = max(run.stop - run.start for run in inverse.within)
    length = min(max(between_reversals(log) // _GROWS, _SHORTEST), rows)
    work.section(0.1)
    first = moving(log, windows(inverse, length, _MANY))
    found = _best(inverse, output, starts[:1], noise, force_noise, first, work)
    if not found.optimum.exhausted and not work.stopped:
        work.section(0.2)
        more = [starts[0], other(), *starts[1:]]
        work.section(0.6)
        found = _best(inverse, output, more, noise, force_noise, first, work)
        if not found.optimum.exhausted and not work.stopped:
            again = other_curves(found.problem, found.optimum.point)
            found = _lower(found, _best(inverse, output, again, noise, force_noise, first, work))
    work.section(0.7)
    used, farther = length, 0.0
    while length < rows and not work.stopped:
        length = min(_GROWS * length, rows) if _GROWS * length < 0.7 * rows else rows
        values = found.problem.values(found.optimum.point)
        some = windows(inverse, length, _MOST)
        longer = _best(inverse, output, [values], noise, force_noise, some, work, evaluations=_FEW_EVALUATIONS)
        if (_leaves_more(longer, found) or _begins_to_drift(longer, found)) and longer.ratio > _GROWN * longer.expected:
            again = other_curves(longer.problem, longer.optimum.point)
            longer = _lower(longer, _best(inverse, output, again, noise, force_noise, some, work))
        if _leaves_more(longer, found):
            farther = longer.left
            break
        if _begins_to_drift(longer, found):
            break
        found, used = longer, length
    if work.stopped:
        return found
    values = found.problem.values(found.optimum.point)
    some = windows(inverse, used, _MOST)
    last = _best(inverse, output, [values], noise, force_noise, some, work, FINE)
    if some == found.problem.windows and _leaves_more(last, found) and not work.stopped:
        begun = found.optimum.point  # how a window begins has minima of its own
        last = _lower(last, _best(inverse, output, [values], noise, force_noise, some, work, FINE, begun=begun))
    if work.stopped:
        return last
    last = replace(last, optimum=replace(last.optimum, agreeing=found.optimum.agreeing), farther=farther)
    bent = last.problem.length(last.problem.values(last.optimum.point))
    hidden = output == "velocity" or noise * _HIDES > bent or last.ratio > _FOLLOWS
    return _of_other_bristles(last, work) if hidden else last


def _of_other_bristles(last: Followed, work: Work) -> Followed:
    """The optimum from softer and stiffer bristles, where that is lower by more than chance: what noise hides of presliding
    has minima of its own, whatever the windows."""
    problem, optimum = last.problem, last.optimum
    points = [problem.from_values(each) for each in other_bristles(problem, optimum.point)]
    if not points:
        return last
    other = multistart(problem, points, work, 0.0, _FEW_EVALUATIONS)
    chance = 0.5 * THRESHOLD * 2 * optimum.cost / max(len(problem.measured), 1)
    if work.stopped or other.cost > optimum.cost - chance:
        return last
    smaller = float(np.sqrt(other.cost / optimum.cost))
    other = replace(other, agreeing=optimum.agreeing, starts=optimum.starts)
    return replace(last, optimum=other, ratio=smaller * last.ratio, left=smaller * last.left)


def other_bristles(problem: MotionProblem, point: Array) -> list[dict[str, float]]:
    """The constants of a point with softer and stiffer bristles, half critically damped, and a Stribeck curve that ends
    early."""
    values = problem.values(point)
    if not {"sigma_0", "sigma_1"} <= {c.name for c in problem.coordinates}:
        return []
    found = []
    for share in _STIFFER:
        stiff = share * values["sigma_0"]
        other = {**values, "sigma_0": stiff, "sigma_1": float(np.sqrt(stiff * values["mass"]))}
        if {"v_s", "F_s", "F_c"} <= {c.name for c in problem.coordinates}:
            other |= {"v_s": _SLOW * float(np.max(abs(problem.log.velocity))), "F_s": _RISE * values["F_c"]}
        found.append(other)
    return found


def other_curves(problem: MotionProblem, point: Array) -> list[dict[str, float]]:
    """The constants of a point with other Stribeck curves: one that ends near the largest speed, or none, is a minimum of its
    own, and short windows may not tell."""
    values = problem.values(point)
    free = {c.name for c in problem.coordinates}
    if not {"v_s", "F_s", "F_c"} <= free:
        return [values]
    fast = float(np.max(abs(problem.log.velocity)))
    return [{**values, "v_s": share * fast, "F_s": _RISE * values["F_c"]} for share in _BENDS]


def _leaves_more(longer: Followed, found: Followed) -> bool:
    return longer.ratio > max(_GROWN, found.ratio) and longer.ratio > _GROWN * found.ratio


def _begins_to_drift(longer: Followed, found: Followed) -> bool:
    return longer.drifts and not found.drifts


def _lower(one: Followed, other: Followed) -> Followed:
    """The one that leaves less; the first where that is nothing to speak of."""
    return other if other.ratio < one.ratio / _GROWN else one


def _best(
    inverse: VelocityProblem, output: str, starts: Sequence[dict[str, float]], noise: float, force_noise: float,
    some: Sequence[slice], work: Work, share: float = ROUGH, evaluations: int = _MANY_EVALUATIONS,
    begun: Array | None = None,
) -> Followed:  # fmt: skip
    """The best fit of some windows; from the values, or from a point of these very windows, ``begun``."""
    problem = MotionProblem(inverse, output, some, noise, share)
    free = len(problem.measured) - len(problem.coordinates) - problem.hidden
    points = [problem.from_values(each) for each in starts] if begun is None else [begun]
    level = float(np.hypot(noise, problem.input_noise(points[0], force_noise)))
    enough = 0.5 * free * (_FOLLOWS * level / problem.scale) ** 2
    optimum = multistart(problem, points, work, enough, evaluations)
    deviation = float(np.sqrt(2 * optimum.cost / max(free, 1))) * problem.scale
    length = float(np.median([w.stop - w.start for w in some])) * inverse.log.step
    misfit = problem.misfit(optimum.point)
    slow = misfit is None or drifts(misfit, problem.parts)
    over = max(noise, 1e-300)
    return Followed(problem, optimum, deviation / over, length, slow, deviation / problem.scale, expected=level / over)


def first_values(problem: VelocityProblem, count: int, seed: int) -> list[dict[str, float]]:
    """Constants to start from: what the record suggests, then others around it, evenly (Sobol); the k-th is the same
    however many there are."""
    assert problem.home is not None
    log, base = problem.log, problem.values(problem.home)
    fast = float(np.max(abs(log.velocity)))
    damping = float(
        np.sqrt(base.get("sigma_0", 0.0) * base["mass"])
    )  # of a mass on the bristles: half the critical one
    middle = {"sigma_1": damping, "v_s": _SLOW * fast}
    reach = {"sigma_0": 3.0, "sigma_1": 10.0, "v_s": 30.0, "sigma_2": 10.0, "F_c": 1.3, "F_s": 1.3, "mass": 3.0}
    free = [c for c in problem.coordinates if not c.nuisance]
    centre = {c.name: middle.get(c.name) or base[c.name] for c in free}
    draws = qmc.Sobol(len(free), seed=seed).random_base2(max(int(np.ceil(np.log2(4 * count))), 1))
    found = []
    for k, draw in enumerate(np.vstack([np.full(len(free), 0.5), draws])):
        u = np.array([_spread(c, centre[c.name], 2 * x - 1, reach) for c, x in zip(free, draw, strict=True)])
        values = {**base, **{c.name: c.outer(float(x)) for c, x in zip(free, u, strict=True)}}
        if not k or problem.allowed(problem.point(values)):
            found.append(problem.values(problem.nearest(problem.point(values))))
    return found[:count]


def _spread(c: Coordinate, centre: float, side: float, reach: dict[str, float]) -> float:
    """The inner coordinate at a share of the way from the middle of its range to an end."""
    if c.log:
        return c.inner(centre) + side * float(np.log(reach.get(c.name, 10.0)))
    return c.inner(centre) + side * 0.1


def between_reversals(log: Log) -> int:
    """The median number of rows from one reversal to the next."""
    fast = float(np.max(abs(log.velocity)))
    found: list[int] = []
    for rows in log.runs():
        v = log.velocity[rows]
        clear = np.flatnonzero(abs(v) > _TURNS * fast)
        turns = clear[1:][np.diff(np.sign(v[clear])) != 0]
        found += np.diff(turns).tolist()
    return max(int(np.median(found)) if found else _SHORTEST, _SHORTEST)


def windows(inverse: VelocityProblem, length: int, most: int) -> list[slice]:
    """Windows of about ``length`` rows that tile each run, as far as its force is known, and begin where it is fast; evenly
    chosen where there are more than ``most``."""
    log, found = inverse.log, list[slice]()
    for rows in inverse.within:
        count = max(round((rows.stop - rows.start) / length), 1)
        edges = np.linspace(rows.start, rows.stop, count + 1).astype(int)
        aside = (rows.stop - rows.start) // (2 * count)
        for i in range(1, count):
            near = slice(edges[i] - aside, edges[i] + aside)
            edges[i] = near.start + int(np.argmax(abs(log.velocity[near])))
        found += [slice(a, b) for a, b in pairwise(edges.tolist()) if b - a >= FEWEST]
    if len(found) <= most:
        return found
    return [found[i] for i in np.unique(np.linspace(0, len(found) - 1, most).round().astype(int))]


def moving(log: Log, found: list[slice]) -> list[slice]:
    """The windows that begin in motion, where these are enough: at rest the velocity and deflection that a window has of
    its own have minima of their own, which hold the constants far from the truth."""
    fast = abs(log.velocity[[w.start for w in found]]) > SLIDES * float(np.max(abs(log.velocity)))
    some = [w for w, inside in zip(found, fast.tolist(), strict=True) if inside]
    return some if len(some) >= _ENOUGH else found
