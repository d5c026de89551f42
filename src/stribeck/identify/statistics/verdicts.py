"""Why a fit's number is not to be believed: what the data lack, in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.features.guess import Sizes, reversals
from stribeck.identify.log import Log
from stribeck.identify.models.motion_problem import MotionProblem
from stribeck.identify.models.problem import Coordinate, Problem, linear_step
from stribeck.identify.result import Estimate
from stribeck.identify.statistics.profiles import THRESHOLD

_WIDEST = 0.7  # half a 95 % interval in the logarithm, half to twice the value: a wider one is not determined
_MOST_ALIKE = 200.0  # by how much the others' freedom may inflate a variance: a small error of the model grows with it
_BOUND = 0.95  # correlation with one that is inflated so
_FEWEST = 12.0  # samples that an estimate must rest on
_STRIBECK = ("F_s", "v_s")
_ENDS = 0.3  # of the largest speed
_RESOLVED = 10  # samples in which presliding must be passed through to be seen
_SLIDING = 5.0  # ways to break-away in a stroke: behind three a bristle's force is within a twentieth of its end
_MOST_BIAS = 0.2  # of the logarithm, for the motion's filter
_FARTHEST = 0.35  # of the logarithm: a larger shift is told by one step to a factor of two at best


@dataclass(frozen=True)
class Noise:
    """What a model without error would leave: the standard deviation of the measurement's noise, and that with what the
    noise of its input does; 0 where nothing is known. ``missed``: the share of the output that a fit may miss.
    ``alone``: no other start ended in the minimum. ``farther``: the share that it leaves in longer windows."""

    measured: float = 0.0
    expected: float = 0.0
    missed: float = 0.25
    alone: bool = False
    farther: float = 0.0


def why_not(problem: Problem, k: int, u: Array, inner: Array, support: float, alike: bool) -> str:
    """Why a coordinate is not determined, or nothing."""
    c = problem.coordinates[k]
    low, high = problem.bounds
    room = 1e-3 * (high[k] - low[k])
    if c.log and not low[k] + room < u[k] < high[k] - room:
        return "the fit drives it to the end of what is tried"
    with np.errstate(all="ignore"):
        spread = np.sqrt(np.diag(inner))
        relation = inner[k] / (spread * spread[k])
    deviation = float(spread[k])
    if not np.isfinite(deviation):
        return "its variance is lost in rounding: others make up for it"
    others = [i for i in np.argsort(-abs(relation)) if i != k and abs(relation[i]) > 0.9]
    along = [problem.coordinates[i].name for i in others if not problem.coordinates[i].nuisance][:2]
    together = f"; {' and '.join(along)} can make up for it" if along else ""
    if support < _FEWEST:
        return f"it rests on {max(support, 0):.0f} samples only{together}"
    if c.log and np.sqrt(THRESHOLD) * deviation > _WIDEST:
        return f"the residuals hardly depend on it{together}"
    if alike:
        return f"it can hardly be separated from the others{together}"
    return ""


def indistinct(plain: Array, slopes: Array, variance: float) -> NDArray[np.bool_]:
    """Which coordinates the others can imitate so well that only combinations of them are determined."""
    if variance <= 0:
        return np.zeros(len(plain), bool)
    inflated = np.diag(plain) * np.sum(slopes**2, axis=0) / variance > _MOST_ALIKE
    spread = np.sqrt(np.diag(plain))
    bound = abs(plain) > _BOUND * np.outer(spread, spread)
    return np.asarray(inflated | (bound & inflated[None, :]).any(axis=1))


def presliding_unseen(problem: Problem, values: Mapping[str, float], log: Log) -> str:
    """Why the log does not show presliding, or nothing: after reversals the first moments, in which the bristles bend,
    must be longer than a few samples and than what the filter of the velocity resolves."""
    if not problem.law.has_z or isinstance(problem, MotionProblem):
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


def never_slides(problem: Problem, values: Mapping[str, float], log: Log) -> str:
    """Why the level behind presliding has no name, or nothing: no stroke is so long that the bristles' force ends at it."""
    if not problem.law.has_z:
        return ""
    longest = max((float(np.max(abs(np.diff(_turns(log, rows))), initial=0.0)) for rows in log.runs()), default=0.0)
    times = longest / max(problem.length(values), 1e-300)
    if times >= _SLIDING:
        return ""
    return f"no stroke is longer than {times:.2g} times the way to break-away: the level may as well be F_s as F_c"


def _turns(log: Log, rows: slice) -> Array:
    """The positions at the ends of a run's strokes."""
    inner = [first for first, _ in reversals(log.velocity[rows])]
    return np.asarray(log.position[rows][[0, *inner, -1]])


def shape(c: Coordinate, values: Mapping[str, float], sizes: Sizes, unseen: str) -> str:
    """Why the Stribeck curve of a fit that leaves more than noise is the model's freedom and not the data's, or nothing."""
    if c.name not in _STRIBECK:
        return ""
    if unseen:
        return f"the fit leaves more than the force's noise, and {unseen}"
    if values.get("v_s", 0.0) > _ENDS * sizes.fast:
        return (
            f"v_s comes out as {values['v_s']:.2g} m/s, near the largest speed ({sizes.fast:.2g} m/s), in a fit that leaves "
            "more than the force's noise: no Stribeck curve ends within the record"
        )
    return ""


def hangs(c: Coordinate, bias: float) -> str:
    """Why the filter of the motion leaves a coordinate open, or nothing."""
    if not c.log or bias <= _MOST_BIAS:
        return ""
    why = "the position is too coarse or noisy, or sampled too slowly"
    return f"it hangs on the filter of the motion, which may shift it by {bias:.0%}: {why}"


def misled(problem: Problem, bias: Array) -> bool:
    """Whether the filter of the motion moves one of the law's numbers so far that a step tells it, and what moves with it, to
    a factor of two at best."""
    return any(c.log and not c.nuisance and bias[k] > _FARTHEST for k, c in enumerate(problem.coordinates))


def farther(c: Coordinate, bias: float, along: bool = False) -> float:
    """How far the ends of an interval move for a systematic shift, inner coordinates; ``along``: with a number that the filter
    moves far."""
    return 2 * bias if c.log and (bias > _FARTHEST or along) else bias


@runtime_checkable
class SampledSignal(Protocol):
    """A problem whose input nobody measured between its samples."""

    def between_samples(self, u: Array) -> Array:
        """How the output may be off by that."""


def between_samples(problem: SampledSignal, u: Array, slopes: Array) -> Array:
    """How far each inner coordinate may be off because nobody measured the force between its samples: the shift of the
    optimum, by a step of Gauss and Newton, if it went straight."""
    return abs(np.asarray(linear_step(slopes, problem.between_samples(u))))


def widened(problem: Problem, estimates: Mapping[str, Estimate], bias: Array, inner: Array) -> list[str]:
    """What to say of intervals that the motion's filter has made wider."""
    wider = [
        f"{c.name} by {100 * bias[k]:.2g} %"
        for k, c in enumerate(problem.coordinates)
        if c.log and not c.nuisance and estimates[c.name].identifiable and bias[k] > 2 * np.sqrt(inner[k, k])
    ]
    why = "intervals are wider to each side for what the filter of the motion may do: "
    return [why + ", ".join(wider)] if wider else []


def left_open(low: float | None, high: float | None, log: bool) -> str:
    """Why an interval (inner coordinates) tells too little, or nothing."""
    if low is None or high is None:
        side = "below" if low is None else "above"
        both = low is None and high is None
        return "the data fit as well whatever it is" if both else f"the data set no limit {side}"
    if log and high - low > 2 * _WIDEST:
        return f"its 95 % interval spans a factor of {np.exp(high - low):.2g}"
    return ""
