"""Where the verdict changes as one number of the machine is turned: found on a grid, then by bisection, in lanes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, arg, nearest
from stribeck.loops.judge import Judgement, judge
from stribeck.loops.loop import Loop, time_constant

POINTS = 13  # of the first grid
_ROUNDS, _AT_MOST = 3, 5  # each divides what encloses a boundary by _PARTS; more where it lies near 0
_PARTS = 6
_SURE = 0.05  # on either side of a boundary the verdict holds that far, at _CHECKS points
_CHECKS = 4
_SPREADS = 4  # rounds in which what is found beside a change widens it
_NARROW = 0.04  # of its value: a change that takes more is no boundary but a mixture
_MOST = 4  # changes of one path: more are a mixture
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
    mixed."""

    turned: Turned
    values: Array
    found: list[Judgement]
    boundaries: list[Boundary]
    mixed: list[Mixed]


def known_path(loop: Loop, path: str, given: str = "vary") -> None:
    """Refuse a path that is no number of the machine; ``given`` is the argument that names it.

    Raises:
        InputError: with what is like it.
    """
    from stribeck.simulation.places import machine_places

    known = list(machine_places(loop.scenario))
    if path not in known:
        raise InputError(f"{arg(given)}: {path}: no number of the machine{nearest(path, known)}")


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
    for i in range(_AT_MOST):
        if tell is not None:
            tell((i + 1) / (_AT_MOST + 2))
        changes = _changes(seen)
        if len(changes) > _MOST or (i >= _ROUNDS and all(_narrow(*change) for change in changes)):
            break
        look(np.concatenate([np.zeros(0), *(turned.between(a, b, _PARTS) for a, b in changes)]))
    for _ in range(_SPREADS):
        groups = _groups(_changes(seen))
        known = len(seen)
        if 0 < len(groups) <= _MOST:
            look(np.concatenate([_around(turned, *group) for group in groups]))
        if len(seen) == known:
            break
    values = np.array(sorted(seen))
    return PathVerdicts(turned, values, [seen[x] for x in values.tolist()], *_named(turned, seen))


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
