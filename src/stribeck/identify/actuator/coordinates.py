"""The fitted parameters as coordinates of the optimizer: the target of each number, its bounds, its scale."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError, nearest
from stribeck.identify.actuator.recordings import FAR, Logs, Sought
from stribeck.recorded import listed
from stribeck.scenario import Scenario

_LOG = re.compile(r"log\.(\*|\d+)\.(.+)")
_START = re.compile(r"initial\.(\w+)\.([yv])")
_OUTPUT = re.compile(r"outputs\.(.+)\.(\w+)")
_RATIO = 2.5  # positive bounds whose ratio exceeds it are searched in the logarithm: there relative steps are even
_ABOVE = 1e-6  # of F_c: the least distance of F_s above it, far above rounding
_BELOW = 0.95  # of F_c/sigma_0: the largest z_ba, so that differences of either number stay below 1
SPEED = "m/s"  # the unit of a law's constants that are places of its curve
NEUTRAL = {"offset": 0.0, "gain": 1.0, "delay": 0.0, "clock": 0.0}  # of a sensor without errors


@dataclass(frozen=True)
class MachineCoordinate:
    """A fitted number.

    Attributes:
        name: its label, or its path as the user wrote it (with the log's number).
        targets: the machine's paths that it sets, each with a factor; empty for a sensor's number.
        output: the column and the sensor's parameter: offset, gain, delay (s), clock drift (s of delay per s), or the
            coefficient of a further term.
        log: the recording that it belongs to, or None: all.
        nuisance: a nuisance parameter, such as the initial state of a recording.
        bends: whether it is a speed at which a law's curve bends: a fit may have minima at several.
        plain: whether it is searched by the number itself, whatever its bounds.
    """

    name: str
    low: float
    high: float
    start: float | None = None
    prior: tuple[float, float] | None = None
    targets: Mapping[str, float] = field(default_factory=dict)
    output: tuple[str, str] | None = None
    log: int | None = None
    nuisance: bool = False
    bends: bool = False
    plain: bool = False

    @property
    def logarithmic(self) -> bool:
        """Whether it is searched in the logarithm."""
        return not self.plain and self.low > 0 and self.high / self.low > _RATIO

    @property
    def bounds(self) -> tuple[float, float]:
        """The bounds of the coordinate."""
        return (np.log(self.low), np.log(self.high)) if self.logarithmic else (0.0, 1.0)

    def outer(self, u: float) -> float:
        """The number itself."""
        return float(np.exp(u)) if self.logarithmic else self.low + u * (self.high - self.low)

    def inner(self, x: float) -> float:
        """The coordinate of a number."""
        x = min(max(x, self.low), self.high)
        return float(np.log(x)) if self.logarithmic else (x - self.low) / (self.high - self.low)

    def slope(self, u: float) -> float:
        """d number / d coordinate."""
        return self.outer(u) if self.logarithmic else self.high - self.low


def paths(sought: Sequence[MachineCoordinate]) -> frozenset[str]:
    """The paths of the fitted numbers."""
    return frozenset(path for c in sought for path in c.targets)


def coordinates(scenario: Scenario, logs: Logs) -> list[MachineCoordinate]:
    """The coordinates of all fitted numbers, each path looked up in the machine.

    Raises:
        InputError: a path is not in the machine; a line for each.
    """
    every: list[MachineCoordinate] = []
    problems: list[str] = []
    count = len(logs.recordings)
    for sought in logs.sought:
        of_log = _LOG.fullmatch(sought.path)
        which: list[int | None] = [None]
        if of_log:
            which = [*range(count)] if of_log[1] == "*" else [int(of_log[1])]
        if of_log and which[-1] is not None and which[-1] >= count:
            problems.append(f"unknown.{sought.path}: log.{of_log[1]}: there are {count} recordings, from 0")
            continue
        try:
            every += [_coordinate(scenario, logs, sought, of_log[2] if of_log else sought.path, log) for log in which]
        except InputError as error:
            problems += error.problems
    if problems:
        raise InputError(problems)
    return every


def _coordinate(scenario: Scenario, logs: Logs, s: Sought, rest: str, log: int | None) -> MachineCoordinate:
    """One coordinate; ``rest``: its path without the recording.

    Raises:
        InputError: the path is wrong.
    """
    name = s.label or (rest if log is None else f"log.{log}.{rest}")
    if output := _OUTPUT.fullmatch(rest):
        channels = [r.outputs[output[1]] for r in logs.recordings if output[1] in r.outputs]
        if not channels:
            measured = {column for r in logs.recordings for column in r.outputs}
            hint = nearest(output[1], measured) or f" (measured are {', '.join(sorted(measured))})"
            raise InputError(f"unknown.{s.path}: {output[1]}: is not measured{hint}")
        known = [*NEUTRAL, *dict.fromkeys(n for channel in channels for n in channel.beside)]
        if output[2] not in known:
            raise InputError(f"unknown.{s.path}: {output[2]}: must be {', '.join(known)} of a sensor")
        return MachineCoordinate(name, s.low, s.high, s.start, s.prior, {}, (output[1], output[2]), log, s.nuisance)
    start = _START.fullmatch(rest)
    path = f"bodies.{start[1]}.initial.{start[2]}" if start else rest
    if start and log is None:
        raise InputError(f"unknown.{s.path}: must begin with log.*. or log.0.: a start belongs to a recording")
    if text := impossible(scenario, path, s.low, s.high):
        reach = f" (low and high are {FAR:g} deviations from the prior's mean, unless given)" if s.prior else ""
        raise InputError(f"unknown.{s.path}: {text}{reach}")
    owner, constant = scenario.places.get(path, ("", ""))
    law = scenario.elements.laws.get(owner)
    bends = law is not None and constant in law.constants() and law.constants()[constant].unit == SPEED
    return MachineCoordinate(name, s.low, s.high, s.start, s.prior, {path: 1.0}, None, log, s.nuisance, bends=bends)


def impossible(scenario: Scenario, path: str, *values: float) -> str | None:
    """Why a path cannot take these values, or None."""
    places = scenario.places
    if path not in places:
        with suppress(InputError):  # a constant that is off, such as an omitted backlash
            places = scenario.with_changes({path: values[-1]}).places
    if path not in places:
        return f"no such number of the machine{nearest(path, places) or f' (it has {listed([*places])})'}"
    for x in values:
        try:
            scenario.with_changes({path: x})
        except InputError as error:
            mine = [line for line in error.problems if line.startswith(f"{path}:")]
            if mine and "F_c" not in mine[0].partition(": ")[2]:  # the search maintains relations to other numbers
                return mine[0].partition(": ")[2]
    return None


class Relations:
    """Relations of a law's numbers that every search maintains: F_s >= F_c and z_ba < F_c/sigma_0.

    ``number`` returns the machine's number at a path that is not fitted.
    """

    def __init__(self, sought: Sequence[MachineCoordinate], number: Callable[[str], float | None]) -> None:
        self.sought = sought
        index = {path: i for i, c in enumerate(sought) for path in c.targets if ".law." in path}
        self.above: list[tuple[int | float, int | float]] = []
        for path in dict.fromkeys(f"{path[:-3]}F_s" for path in index if path.endswith((".F_s", ".F_c"))):
            high, low = (index.get(p, number(p)) for p in (path, f"{path.removesuffix('F_s')}F_c"))
            if high is not None and low is not None:
                self.above.append((high, low))
        self.below: list[tuple[int, int | float, int | float]] = []
        for path, i in index.items():
            if path.endswith(".z_ba"):
                wanted = (f"{path.removesuffix('z_ba')}parameters.{n}" for n in ("F_c", "sigma_0"))
                level, stiffness = (index.get(p, number(p)) for p in wanted)
                if level is not None and stiffness is not None:
                    self.below.append((i, level, stiffness))

    def lower(self) -> list[int]:
        """The coordinates with another above them: their difference steps go down."""
        return [j for _, j in self.above if isinstance(j, int)]

    def repaired(self, U: Array) -> Array:
        """The points (lanes, coordinates), within their bounds, moved so that the relations hold."""
        for high, low in self.above:
            for row in U:
                level = self._number(low, row) * (1 + _ABOVE)
                if isinstance(high, int) and self._number(high, row) < level:
                    row[high] = self.sought[high].inner(level)
                if isinstance(low, int) and self._number(high, row) < level * (1 - 1e-12):  # a bound, or fixed
                    row[low] = self.sought[low].inner(self._number(high, row) / (1 + 2 * _ABOVE))
        for i, level_at, stiffness_at in self.below:
            for row in U:
                most = _BELOW * self._number(level_at, row) / self._number(stiffness_at, row)
                if self.sought[i].outer(row[i]) > most:
                    row[i] = self.sought[i].inner(most)
        return U

    def _number(self, which: int | float, row: Array) -> float:
        """The value of a fitted (by index) or fixed parameter."""
        return self.sought[which].outer(float(row[which])) if isinstance(which, int) else which
