"""Where the verdict changes as one number of the machine is varied.

The number is scanned in lanes (a lane is one simulation of a batch), most finely where the verdict changes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, arg
from stribeck.loops.judge import Judgment, judge
from stribeck.loops.loop import Loop, time_constant

POINTS = 25  # of the first scan, which shows what a point costs: over a decade, steps of 10 %
RESOLUTION = 0.03  # of a value, the finest step of the scan: nobody sets a gain closer; MOST_STEPS may not allow it
MOST_STEPS = 40_000_000  # of all lanes of one path: 10 to 30 s of processor time
# Into which a step of the scan is divided where the verdict changes: more lanes at once, but fewer rounds than 2.
_PARTS = 5
_PRECISE = 0.002  # of its value: how closely a boundary is enclosed, a fifteenth of RESOLUTION
_ROUNDS = 6  # of dividing: a first step of a tenth of the range, at most, needs 3; the others are for changes found on the way
# Of a natural logarithm, a factor of two: a step over which amplitude or settling time change more is divided
_TURNS = 0.7
_SURE = 0.05  # of its value: the verdict must hold so far on either side of a boundary, more than one RESOLUTION
_CHECKS = 4  # points on each side, about 1 % apart, and rounds of judging them where they reveal changes
_NARROW = 0.04  # of its value: a change wider than a step of the scan is a mixture of verdicts, no boundary
_MOST = 6  # changes of one path: more are a mixture, and too many to read
_CONSTANTS = 9  # points at which the slowest time constant is found: it is smooth between, and only sets a run's length
_DECADE = 10.0  # high/low from which a range is divided by ratios: equal steps would leave its lower end one or two


@dataclass(frozen=True)
class Turned:
    """A path of the machine's file and the range in which its value is varied."""

    path: str
    low: float
    high: float

    @classmethod
    def parse(cls, text: str) -> Turned:
        """Read ``PATH=LOW:HIGH``.

        Raises:
            InputError: if the text is not of this form, or LOW is not below HIGH.
        """
        path, _, ends = text.partition("=")
        try:
            low, high = (float(x) for x in ends.split(":"))
        except ValueError:
            raise InputError(
                f"{arg('vary')}: {show(text)}: must be PATH=LOW:HIGH, as controllers.axis.K_p=1:100"
            ) from None
        if not (np.isfinite([low, high]).all() and low < high):
            raise InputError(f"{arg('vary')}: {show(text)}: LOW must be below HIGH, both finite")
        return cls(path, low, high)

    @property
    def by_ratios(self) -> bool:
        """Whether the range spans a decade; it is then divided by ratios, otherwise evenly."""
        return self.low > 0 and self.high / self.low >= _DECADE

    def points(self, count: int) -> Array:
        """``count`` values over the range, both ends included."""
        return (np.geomspace if self.by_ratios else np.linspace)(self.low, self.high, count)

    def between(self, low: float, high: float, parts: int) -> Array:
        """The ``parts - 1`` values that divide an interval."""
        spaced = np.geomspace if self.by_ratios else np.linspace
        return np.asarray(spaced(low, high, parts + 1)[1:-1])


@dataclass(frozen=True)
class Boundary:
    """A value of ``path`` at which the verdict changes from ``below`` to ``above``.

    The change lies within ``[low, high]``. On both sides the verdicts hold up to 5 % away, as simulated at four points
    each. ``sure`` is always true, since any other change is :class:`Mixed`.
    """

    path: str
    value: float
    below: str
    above: str
    low: float
    high: float
    sure: bool = True


@dataclass(frozen=True)
class Mixed:
    """An interval of ``path`` in which the verdict changes too often to report boundaries.

    ``verdicts`` are those simulated inside ``[low, high]``; ``below`` and ``above`` are the verdicts beside it.
    """

    path: str
    low: float
    high: float
    below: str
    above: str
    verdicts: tuple[str, ...]


@dataclass(frozen=True)
class PathVerdicts:
    """The verdict along one path.

    Attributes:
        turned: the path and its range.
        values: the simulated values, in order.
        judgments: the judgment at each value.
        boundaries: where the verdict changes once.
        mixed: intervals in which it changes more often.
        resolution: the widest step between equal verdicts, as a share of the value; narrower intervals may be missed.
    """

    turned: Turned
    values: Array
    judgments: list[Judgment]
    boundaries: list[Boundary]
    mixed: list[Mixed]
    resolution: float


def line(
    loop: Loop, turned: Turned, tell: Callable[[float], None] | None = None, path: str | None = None
) -> PathVerdicts:
    """The verdict over a range of one number; ``path`` is that in the loop's machine if a file of schema 1 has another."""
    scan = _Scan(loop, turned, path or turned.path)
    first = partial(scan.judge_at, turned.points(POINTS))
    for share, work in ((0.0, first), (0.2, scan.fill), (0.6, scan.divide), (0.9, scan.beside)):
        if tell is not None:
            tell(share)
        work()
    values = np.array(sorted(scan.seen))
    judgments = [scan.seen[x] for x in values.tolist()]
    return PathVerdicts(turned, values, judgments, *_classify(turned, scan.seen), scan.resolution())


class _Scan:
    """Points of a path with their judgments."""

    def __init__(self, loop: Loop, turned: Turned, path: str) -> None:
        self.loop, self.turned, self.path = loop, turned, path
        self.seen: dict[float, Judgment] = {}
        self.known = turned.points(_CONSTANTS)
        ends = [loop.scenario.with_changes({path: float(x)}) for x in self.known]
        self.constants = np.array([time_constant(end) for end in ends])

    @property
    def steps_left(self) -> int:
        """Steps of the solver that the scan may still take."""
        return MOST_STEPS - sum(j.steps for j in self.seen.values())

    def judge_at(self, values: Array) -> None:
        """Judge the loop at those of these values that are not yet judged."""
        new = np.array([x for x in np.unique(values) if x not in self.seen])
        if len(new):
            slowest = np.exp(np.interp(new, self.known, np.log(self.constants)))
            judgments = judge(self.loop, {self.path: new}, slowest=slowest)
            self.seen.update(zip(new.tolist(), judgments, strict=True))

    def fill(self) -> None:
        """Divide the widest steps until all are as fine as :data:`RESOLUTION`, or as the remaining solver steps allow."""
        steps_a_point = max(float(np.mean([j.steps for j in self.seen.values()])), 1.0)
        points_left = max(int(0.6 * self.steps_left / steps_a_point), 0)  # the rest is for changes found
        resolution = RESOLUTION
        while True:
            new = [
                self.turned.between(a, b, int(np.ceil(self._share(a, b) / resolution)))
                for a, b in self._steps() if self._share(a, b) > resolution
            ]  # fmt: skip
            if sum(map(len, new)) <= points_left or resolution > 1:
                break
            resolution *= 1.25
        if new and resolution <= 1:
            self.judge_at(np.concatenate(new))

    def divide(self) -> None:
        """Divide the steps in which the verdict changes, or in which amplitude or settling time change quickly."""
        for _ in range(_ROUNDS):
            changes = _changes(self.seen)
            unresolved = (
                [(a, b) for a, b in changes if b - a > _PRECISE * max(abs(a), abs(b))] if len(changes) <= _MOST else []
            )
            quick = [(a, b) for a, b in self._steps() if self._share(a, b) > RESOLUTION / 2 and self._turns(a, b)]
            if not (unresolved or quick) or self.steps_left < 0:
                return
            new = [self.turned.between(a, b, _PARTS) for a, b in unresolved]
            self.judge_at(
                np.concatenate(new + [self.turned.between(a, b, 2) for a, b in quick if (a, b) not in unresolved])
            )

    def beside(self) -> None:
        """Judge both sides of each change, as far as a boundary's verdicts must hold; again if that finds changes."""
        for _ in range(_CHECKS):
            groups, known = _groups(_changes(self.seen)), len(self.seen)
            if 0 < len(groups) <= _MOST:
                self.judge_at(np.concatenate([_check_points(self.turned, *group) for group in groups]))
            if len(self.seen) == known:
                return

    def resolution(self) -> float:
        """The widest step between equal verdicts, as a share of the value."""
        same = [(a, b) for a, b in self._steps() if self.seen[a].verdict == self.seen[b].verdict]
        return max((self._share(a, b) for a, b in same), default=0.0)

    def _steps(self) -> list[tuple[float, float]]:
        return list(pairwise(sorted(self.seen)))

    def _share(self, a: float, b: float) -> float:
        """The width of a step as a share of its value; of the larger end of the range if that is divided evenly."""
        if self.turned.by_ratios:
            return (b - a) / abs(b)
        return (b - a) / max(abs(self.turned.low), abs(self.turned.high))

    def _turns(self, a: float, b: float) -> bool:
        """Whether the amplitude, or the settling time of a quiet loop, changes quickly within a step."""
        first, second = self.seen[a], self.seen[b]
        if first.verdict != second.verdict:
            return False
        if first.quiet:
            return bool(abs(np.log((1 + first.rested) / (1 + second.rested))) > _TURNS)
        change = np.log((first.amplitude or 1e-300) / (second.amplitude or 1e-300))
        return bool(abs(change) > _TURNS)


def _changes(seen: dict[float, Judgment]) -> list[tuple[float, float]]:
    values = sorted(seen)
    return [(a, b) for a, b in pairwise(values) if seen[a].verdict != seen[b].verdict]


def _groups(changes: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Merge changes that are nearer to one another than a boundary's verdicts must hold; first and last value of each."""
    groups: list[tuple[float, float]] = []
    for low, high in changes:
        if groups and low - groups[-1][1] < _SURE * max(abs(low), abs(groups[-1][1])):
            groups[-1] = (groups[-1][0], high)
        else:
            groups.append((low, high))
    return groups


def _classify(turned: Turned, seen: dict[float, Judgment]) -> tuple[list[Boundary], list[Mixed]]:
    """The boundaries, beside which the verdicts hold, and the mixed intervals."""
    boundaries, mixed = [], []
    groups = _groups(_changes(seen))
    if len(groups) > _MOST:
        groups = [(groups[0][0], groups[-1][1])]
    for low, high in groups:
        below, above = seen[low].verdict, seen[high].verdict
        narrow = high - low <= _NARROW * max(abs(low), abs(high))
        if below != above and narrow and _verdicts_hold(seen, turned, low, high):
            boundaries.append(Boundary(turned.path, (low + high) / 2, below, above, low, high))
        else:
            met = dict.fromkeys(seen[x].verdict for x in sorted(seen) if low < x < high)
            mixed.append(Mixed(turned.path, low, high, below, above, tuple(met)))
    return boundaries, mixed


def _check_points(turned: Turned, low: float, high: float) -> Array:
    """Values up to 5 % away on both sides, inside the range."""
    reach = _SURE * max(abs(low), abs(high))
    steps = np.arange(1, _CHECKS + 1) / _CHECKS * reach
    values = np.concatenate([low - steps, high + steps])
    return values[(values >= turned.low) & (values <= turned.high)]


def _verdicts_hold(seen: dict[float, Judgment], turned: Turned, low: float, high: float) -> bool:
    near = _check_points(turned, low, high)
    return all(x in seen and seen[x].verdict == seen[low if x <= low else high].verdict for x in near.tolist())
