"""Where the verdict changes as one number of the machine is turned: found on a grid, then by bisection, in lanes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.loops.judge import Judgement, judge
from stribeck.loops.loop import Loop, time_constant

POINTS = 13  # of the first grid
_ROUNDS = 3  # each divides what encloses a boundary by _PARTS
_PARTS = 6
_SURE = 0.05  # on either side of a boundary the verdict holds that far, at _CHECKS points
_CHECKS = 4
_MOST = 4  # boundaries of one path: more is no boundary but a mixture
_DECADE = 10.0  # high/low from which a range is divided by ratios


@dataclass(frozen=True)
class Turned:
    """A path of the machine and the range in which it is turned."""

    path: str
    low: float
    high: float

    @classmethod
    def parse(cls, text: str) -> Turned:
        """``PATH=LOW:HIGH``.

        Raises:
            InputError: it is something else.
        """
        path, _, ends = text.partition("=")
        try:
            low, high = (float(x) for x in ends.split(":"))
        except ValueError:
            raise InputError(f"vary: {show(text)}: must be PATH=LOW:HIGH, as controllers.axis.K_p=1:100") from None
        if not (np.isfinite([low, high]).all() and low < high):
            raise InputError(f"vary: {show(text)}: LOW must be below HIGH, both finite")
        return cls(path, low, high)

    def points(self, count: int) -> Array:
        """Values over the range: by ratios where it spans a decade."""
        if self.low > 0 and self.high / self.low >= _DECADE:
            return np.geomspace(self.low, self.high, count)
        return np.linspace(self.low, self.high, count)

    def between(self, low: float, high: float, parts: int) -> Array:
        """Values inside an interval, that divide it."""
        found = np.geomspace if self.low > 0 and self.high / self.low >= _DECADE else np.linspace
        return np.asarray(found(low, high, parts + 1)[1:-1])


@dataclass(frozen=True)
class Boundary:
    """A value of ``path`` at which the verdict changes from ``below`` to ``above``; the change lies within
    ``[low, high]``, and the verdicts hold up to 5 % away on both sides (``sure``), as simulated at four points each."""

    path: str
    value: float
    below: str
    above: str
    low: float
    high: float
    sure: bool


@dataclass(frozen=True)
class PathVerdicts:
    """The verdict along one path: the values simulated, in order, the judgement at each, and the boundaries."""

    turned: Turned
    values: Array
    found: list[Judgement]
    boundaries: list[Boundary]


def known_path(loop: Loop, path: str) -> None:
    """Refuse a path that is no number of the machine.

    Raises:
        InputError: with what is like it.
    """
    from stribeck.simulation.places import machine_places

    known = list(machine_places(loop.scenario))
    if path not in known:
        raise InputError(f"vary: {path}: no number of the machine{nearest(path, known)}")


def line(loop: Loop, turned: Turned, tell: Callable[[float], None] | None = None) -> PathVerdicts:
    """The verdict over a range of one number.

    Raises:
        InputError: the path is no number of the machine.
    """
    known_path(loop, turned.path)
    ends = [loop.scenario.with_changes({turned.path: float(x)}) for x in turned.points(3)]
    loop = replace(loop, slowest=max(loop.slowest, *(time_constant(end)[0] for end in ends)))
    seen: dict[float, Judgement] = {}

    def look(values: Array) -> None:
        new = np.array([x for x in np.unique(values) if x not in seen])
        if len(new):
            seen.update(zip(new.tolist(), judge(loop, {turned.path: new}), strict=True))

    look(turned.points(POINTS))
    for i in range(_ROUNDS):
        if tell is not None:
            tell((i + 1) / (_ROUNDS + 2))
        changes = _changes(seen)
        if len(changes) > _MOST:
            break
        look(np.concatenate([np.zeros(0), *(turned.between(a, b, _PARTS) for a, b in changes)]))
    found = []
    for low, high in _apart(_changes(seen), seen):
        value = float(np.sqrt(low * high)) if low > 0 and high / low >= _DECADE else (low + high) / 2
        found.append((low, high, value))
    if 0 < len(found) <= _MOST:
        look(np.concatenate([_around(turned, low, high) for low, high, _ in found]))
    boundaries = [
        Boundary(turned.path, value, seen[low].verdict, seen[high].verdict, low, high, _sure(seen, turned, low, high))
        for low, high, value in found
    ]
    values = np.array(sorted(seen))
    return PathVerdicts(turned, values, [seen[x] for x in values.tolist()], boundaries)


def _changes(seen: dict[float, Judgement]) -> list[tuple[float, float]]:
    values = sorted(seen)
    return [(a, b) for a, b in pairwise(values) if seen[a].verdict != seen[b].verdict]


def _apart(changes: list[tuple[float, float]], seen: dict[float, Judgement]) -> list[tuple[float, float]]:
    """The changes, those together that are nearer than the verdict is sure: between them stand lanes that the last slip left
    in between, and the boundary is that of the verdicts outside. Where these are one and all that stands between creeps, there
    is none."""
    groups: list[list[tuple[float, float]]] = []
    for low, high in changes:
        if groups and high - groups[-1][0][0] < _SURE * max(abs(groups[-1][0][0]), abs(high)):
            groups[-1].append((low, high))
        else:
            groups.append([(low, high)])
    found = []
    for group in groups:
        low, high = group[0][0], group[-1][1]
        if seen[low].verdict != seen[high].verdict:
            found.append((low, high))
        elif any(seen[end].verdict != "creeping" for _, end in group[:-1] if seen[end].verdict != seen[low].verdict):
            found += group
    return found


def _around(turned: Turned, low: float, high: float) -> Array:
    """Values up to 5 % away on both sides, inside the range."""
    reach = _SURE * max(abs(low), abs(high))
    steps = np.arange(1, _CHECKS + 1) / _CHECKS * reach
    values = np.concatenate([low - steps, high + steps])
    return values[(values >= turned.low) & (values <= turned.high)]


def _sure(seen: dict[float, Judgement], turned: Turned, low: float, high: float) -> bool:
    near = _around(turned, low, high)
    return all(seen[x].verdict == seen[low if x <= low else high].verdict for x in near.tolist() if x in seen)
