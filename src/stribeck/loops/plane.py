"""The verdict over two numbers of the machine: a grid in lanes, and its boundary by bisection between neighbours."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.loops.boundary import Turned, known_path
from stribeck.loops.judge import Judgement, judge
from stribeck.loops.loop import Loop, time_constant

POINTS = 9  # along each number
_ROUNDS = 4  # of bisection: a sixteenth of a cell


@dataclass(frozen=True)
class Edge:
    """A point of the boundary: between it and its neighbour, a sixteenth of a cell away, the verdict changes."""

    x: float
    y: float
    one: str
    other: str


@dataclass(frozen=True)
class Plane:
    """The verdict over two numbers.

    Attributes:
        across, up: the numbers and their ranges.
        x, y: the values of the grid.
        found: the judgement at each point, ``found[i][k]`` at ``x[i]``, ``y[k]``.
        edges: points of the boundary.
        point: the file's own values of both.
    """

    across: Turned
    up: Turned
    x: Array
    y: Array
    found: list[list[Judgement]]
    edges: list[Edge]
    point: tuple[float, float]

    def row(self) -> dict[str, object]:
        """What is told of it."""
        return {
            "across": {"path": self.across.path, "values": self.x.tolist()},
            "up": {"path": self.up.path, "values": self.y.tolist()},
            "verdicts": [[j.verdict for j in column] for column in self.found],
            "boundary": [[e.x, e.y, e.one, e.other] for e in self.edges],
            "operating_point": list(self.point),
        }


def plane_of(loop: Loop, ranges: Sequence[str]) -> tuple[Turned, Turned]:
    """The two ranges of a map.

    Raises:
        InputError: there are not two, of different numbers of the machine.
    """
    if len(ranges) != 2:
        raise InputError(f"{arg('map')}: {len(ranges)} given: must be two, each PATH=LOW:HIGH")
    across, up = (Turned.parse(text, "map") for text in ranges)
    for each in (across, up):
        known_path(loop, each.path, "map")
    if across.path == up.path:
        raise InputError(f"{arg('map')}: {across.path}: must be two different numbers")
    return across, up


def plane(loop: Loop, across: Turned, up: Turned, tell: Callable[[float], None] | None = None) -> Plane:
    """The verdict over both, simulated."""
    from stribeck.simulation.places import machine_places

    corners = product((across.low, across.high), (up.low, up.high))
    ends = [loop.scenario.with_changes({across.path: a, up.path: b}) for a, b in corners]
    loop = replace(loop, slowest=max(loop.slowest, *(time_constant(end)[0] for end in ends)))

    def look(points: list[tuple[float, float]]) -> list[Judgement]:
        a, b = np.array(points).T
        return judge(loop, {across.path: a, up.path: b})

    x, y = across.points(POINTS), up.points(POINTS)
    flat = look(list(product(x.tolist(), y.tolist())))
    found = [flat[i * POINTS : (i + 1) * POINTS] for i in range(POINTS)]
    if tell is not None:
        tell(0.5)
    pairs = _neighbours(x, y, found)
    for i in range(_ROUNDS):
        if not pairs:
            break
        middles = [(_middle(across, a[0], b[0]), _middle(up, a[1], b[1])) for a, b, _, _ in pairs]
        at = look(middles)
        pairs = [
            (m, b, j.verdict, other) if j.verdict == one else (a, m, one, j.verdict)
            for (a, b, one, other), m, j in zip(pairs, middles, at, strict=True)
        ]
        if tell is not None:
            tell(0.5 + 0.5 * (i + 1) / _ROUNDS)
    edges = [
        Edge(_middle(across, a[0], b[0]), _middle(up, a[1], b[1]), one, other) for a, b, one, other in pairs
    ]  # fmt: skip
    rig, places = loop.scenario.rig, machine_places(loop.scenario)
    point = rig.values.get(places[across.path], 0.0), rig.values.get(places[up.path], 0.0)
    return Plane(across, up, x, y, found, edges, point)


Pair = tuple[tuple[float, float], tuple[float, float], str, str]


def _neighbours(x: Array, y: Array, found: list[list[Judgement]]) -> list[Pair]:
    """Neighbours along either number whose verdicts differ."""
    pairs: list[Pair] = []
    for i, k in product(range(len(x)), range(len(y))):
        for n, m in ((i + 1, k), (i, k + 1)):
            if n < len(x) and m < len(y) and found[i][k].verdict != found[n][m].verdict:
                ends = (float(x[i]), float(y[k])), (float(x[n]), float(y[m]))
                pairs.append((*ends, found[i][k].verdict, found[n][m].verdict))
    return pairs


def _middle(turned: Turned, low: float, high: float) -> float:
    return low if low == high else float(turned.between(low, high, 2)[0])
