"""Where the verdict changes as one number of the machine is turned: a scan in lanes that is finest where it has to be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, arg, nearest
from stribeck.loops.judge import Judgement, judge
from stribeck.loops.loop import Loop, time_constant

POINTS = 25  # of the first scan
RESOLUTION = 0.03  # of a value: the scan is made so fine, where MOST_STEPS allow it
MOST_STEPS = 40_000_000  # of all lanes of one path: 10 to 30 s of processor time
_PARTS = 5  # into which a step of the scan is divided where the verdict changes
_PRECISE = 0.002  # of its value: how closely a boundary is enclosed
_ROUNDS = 6  # of dividing: enough from a first step that is a tenth of the range, and some for what is found on the way
_TURNS = 0.7  # of a logarithm, from point to point: where amplitude or settling time change by more, what is between is looked at
_SURE = 0.05  # on either side of a boundary the verdict holds that far, at _CHECKS points
_CHECKS = 4
_NARROW = 0.04  # of its value: a change that takes more is no boundary but a mixture
_MOST = 6  # changes of one path: more are a mixture
_CONSTANTS = 9  # points at which the slowest time constant is found; between them it is interpolated
_DECADE = 10.0  # high/low from which a range is divided by ratios


@dataclass(frozen=True)
class Turned:
    """A path of the machine and the range in which it is turned."""

    path: str
    low: float
    high: float

    @classmethod
    def parse(cls, text: str, given: str = "vary") -> Turned:
        """``PATH=LOW:HIGH``.

        Raises:
            InputError: it is something else.
        """
        path, _, ends = text.partition("=")
        try:
            low, high = (float(x) for x in ends.split(":"))
        except ValueError:
            raise InputError(
                f"{arg(given)}: {show(text)}: must be PATH=LOW:HIGH, as controllers.axis.K_p=1:100"
            ) from None
        if not (np.isfinite([low, high]).all() and low < high):
            raise InputError(f"{arg(given)}: {show(text)}: LOW must be below HIGH, both finite")
        return cls(path, low, high)

    @property
    def by_ratios(self) -> bool:
        """Whether it spans a decade: it is then divided by ratios, else evenly."""
        return self.low > 0 and self.high / self.low >= _DECADE

    def points(self, count: int) -> Array:
        """Values over the range."""
        return (np.geomspace if self.by_ratios else np.linspace)(self.low, self.high, count)

    def between(self, low: float, high: float, parts: int) -> Array:
        """Values inside an interval, that divide it."""
        found = np.geomspace if self.by_ratios else np.linspace
        return np.asarray(found(low, high, parts + 1)[1:-1])


@dataclass(frozen=True)
class Boundary:
    """A value of ``path`` at which the verdict changes from ``below`` to ``above``; the change lies within
    ``[low, high]``, and the verdicts hold up to 5 % away on both sides, as simulated at four points each: always ``sure``,
    for where they do not it is :class:`Mixed`."""

    path: str
    value: float
    below: str
    above: str
    low: float
    high: float
    sure: bool = True


@dataclass(frozen=True)
class Mixed:
    """A stretch of ``path``, from ``low`` to ``high``, in which the verdict changes more often than boundaries can be told:
    ``verdicts`` are those met in it, ``below`` and ``above`` those beside it."""

    path: str
    low: float
    high: float
    below: str
    above: str
    verdicts: tuple[str, ...]


@dataclass(frozen=True)
class PathVerdicts:
    """The verdict along one path: the values simulated, in order, the judgement at each, the boundaries, and where it is
    mixed. Stretches narrower than ``resolution``, a share of the value, may be missed."""

    turned: Turned
    values: Array
    found: list[Judgement]
    boundaries: list[Boundary]
    mixed: list[Mixed]
    resolution: float


def known_path(loop: Loop, path: str, given: str = "vary") -> None:
    """Refuse a path that is no number of the machine; ``given`` is the argument that names it.

    Raises:
        InputError: with what is like it.
    """
    from stribeck.simulation.variations import machine_places

    known = list(machine_places(loop.scenario))
    if path not in known:
        raise InputError(f"{arg(given)}: {path}: no number of the machine{nearest(path, known)}")


def line(loop: Loop, turned: Turned, tell: Callable[[float], None] | None = None) -> PathVerdicts:
    """The verdict over a range of one number.

    Raises:
        InputError: the path is no number of the machine.
    """
    known_path(loop, turned.path)
    scan = _Scan(loop, turned)
    scan.look(turned.points(POINTS))
    scan.divide(tell)
    scan.fill()
    scan.divide(tell)
    scan.beside()
    values = np.array(sorted(scan.seen))
    found = [scan.seen[x] for x in values.tolist()]
    return PathVerdicts(turned, values, found, *_named(turned, scan.seen), scan.resolution())


class _Scan:
    """Points of a path with their judgements."""

    def __init__(self, loop: Loop, turned: Turned) -> None:
        self.loop, self.turned = loop, turned
        self.seen: dict[float, Judgement] = {}
        self.known = turned.points(_CONSTANTS)
        ends = [loop.scenario.with_changes({turned.path: float(x)}) for x in self.known]
        self.constants = np.array([time_constant(end)[0] for end in ends])

    @property
    def steps_left(self) -> int:
        """Of the solver."""
        return MOST_STEPS - sum(j.steps for j in self.seen.values())

    def look(self, values: Array) -> None:
        """Judge the loop at these values, but those that are known."""
        new = np.array([x for x in np.unique(values) if x not in self.seen])
        if len(new):
            slowest = np.exp(np.interp(new, self.known, np.log(self.constants)))
            found = judge(self.loop, {self.turned.path: new}, slowest=slowest)
            self.seen.update(zip(new.tolist(), found, strict=True))

    def divide(self, tell: Callable[[float], None] | None) -> None:
        """Divide the steps in which the verdict changes, or something that tells of a change to come."""
        for i in range(_ROUNDS):
            if tell is not None:
                tell(0.1 + 0.15 * i)
            changes = _changes(self.seen)
            wide = (
                [(a, b) for a, b in changes if b - a > _PRECISE * max(abs(a), abs(b))] if len(changes) <= _MOST else []
            )
            turns = [(a, b) for a, b in self._steps() if self._share(a, b) > RESOLUTION / 2 and self._turns(a, b)]
            if not (wide or turns) or self.steps_left < 0:
                return
            new = [self.turned.between(a, b, _PARTS) for a, b in wide]
            self.look(np.concatenate(new + [self.turned.between(a, b, 2) for a, b in turns if (a, b) not in wide]))

    def fill(self) -> None:
        """Divide the widest steps, until all are as fine as :data:`RESOLUTION` or as the solver's steps that are left allow."""
        a_point = max(float(np.mean([j.steps for j in self.seen.values()])), 1.0)
        room = max(int(0.6 * self.steps_left / a_point), 0)  # the rest is for what this finds
        fine = RESOLUTION
        while True:
            new = [
                self.turned.between(a, b, int(np.ceil(self._share(a, b) / fine)))
                for a, b in self._steps() if self._share(a, b) > fine
            ]  # fmt: skip
            if sum(map(len, new)) <= room or fine > 1:
                break
            fine *= 1.25
        if new and fine <= 1:
            self.look(np.concatenate(new))

    def beside(self) -> None:
        """Look at both sides of each change, as far as a boundary's verdicts must hold; again for what that finds."""
        for _ in range(_CHECKS):
            groups, known = _groups(_changes(self.seen)), len(self.seen)
            if 0 < len(groups) <= _MOST:
                self.look(np.concatenate([_around(self.turned, *group) for group in groups]))
            if len(self.seen) == known:
                return

    def resolution(self) -> float:
        """The widest step between equal verdicts, as a share of the value."""
        same = [(a, b) for a, b in self._steps() if self.seen[a].verdict == self.seen[b].verdict]
        return max((self._share(a, b) for a, b in same), default=0.0)

    def _steps(self) -> list[tuple[float, float]]:
        return list(pairwise(sorted(self.seen)))

    def _share(self, a: float, b: float) -> float:
        """How wide a step is: of its value; of the larger end of a range that is divided evenly."""
        if self.turned.by_ratios:
            return (b - a) / abs(b)
        return (b - a) / max(abs(self.turned.low), abs(self.turned.high))

    def _turns(self, a: float, b: float) -> bool:
        """Whether the amplitude of what moves, or the time after which it rests, changes quickly within a step."""
        one, other = self.seen[a], self.seen[b]
        if one.verdict != other.verdict:
            return False
        if one.quiet:
            return bool(abs(np.log((1 + one.rested) / (1 + other.rested))) > _TURNS)
        change = np.log((one.amplitude or 1e-300) / (other.amplitude or 1e-300))
        return bool(abs(change) > _TURNS)


def _changes(seen: dict[float, Judgement]) -> list[tuple[float, float]]:
    values = sorted(seen)
    return [(a, b) for a, b in pairwise(values) if seen[a].verdict != seen[b].verdict]


def _groups(changes: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Changes nearer to one another than a boundary's verdicts must hold are one: its first and last value."""
    found: list[tuple[float, float]] = []
    for low, high in changes:
        if found and low - found[-1][1] < _SURE * max(abs(low), abs(found[-1][1])):
            found[-1] = (found[-1][0], high)
        else:
            found.append((low, high))
    return found


def _named(turned: Turned, seen: dict[float, Judgement]) -> tuple[list[Boundary], list[Mixed]]:
    """The boundaries, beside which the verdicts hold; and the stretches in which it is mixed."""
    boundaries, mixed = [], []
    groups = _groups(_changes(seen))
    if len(groups) > _MOST:
        groups = [(groups[0][0], groups[-1][1])]
    for low, high in groups:
        below, above = seen[low].verdict, seen[high].verdict
        if below != above and _narrow(low, high) and _sure(seen, turned, low, high):
            boundaries.append(Boundary(turned.path, (low + high) / 2, below, above, low, high))
        else:
            met = dict.fromkeys(seen[x].verdict for x in sorted(seen) if low < x < high)
            mixed.append(Mixed(turned.path, low, high, below, above, tuple(met)))
    return boundaries, mixed


def _narrow(low: float, high: float) -> bool:
    return high - low <= _NARROW * max(abs(low), abs(high))


def _around(turned: Turned, low: float, high: float) -> Array:
    """Values up to 5 % away on both sides, inside the range."""
    reach = _SURE * max(abs(low), abs(high))
    steps = np.arange(1, _CHECKS + 1) / _CHECKS * reach
    values = np.concatenate([low - steps, high + steps])
    return values[(values >= turned.low) & (values <= turned.high)]


def _sure(seen: dict[float, Judgement], turned: Turned, low: float, high: float) -> bool:
    near = _around(turned, low, high)
    return all(x in seen and seen[x].verdict == seen[low if x <= low else high].verdict for x in near.tolist())
