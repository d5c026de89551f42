"""The fitted parameters as coordinates of the optimizer: the target of each number, its bounds, its scale."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from stribeck.constants import Constant
from stribeck.errors import InputError, nearest
from stribeck.identify.actuator.recordings import Logs, Sought
from stribeck.scenario import Scenario

_LOG = re.compile(r"log\.(\*|\d+)\.(.+)")
_START = re.compile(r"initial\.(\w+)\.([yv])")
_OUTPUT = re.compile(r"outputs\.(.+)\.(\w+)")
_DECADES = 2.5  # positive bounds whose ratio exceeds this factor are searched in the logarithm
SPEED = "m/s"  # the unit of a law's constants that are places of its curve
NEUTRAL = {"offset": 0.0, "gain": 1.0, "delay": 0.0, "clock": 0.0}


@dataclass(frozen=True)
class MachineCoordinate:
    """A fitted number.

    Attributes:
        name: its path as the user wrote it (with the log's number).
        targets: the machine's paths that it sets, each with a factor; empty for a sensor's number.
        output: the column and the sensor's parameter: offset, gain, delay (s), clock drift (s of delay per s), or the
            coefficient of a further term.
        log: the recording that it belongs to, or None: all.
        nuisance: a nuisance parameter, such as the initial state of a recording.
        piece: its stretch of a recording.
        bends: whether it is a speed at which a law's curve bends: a fit may have minima at several.
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
    piece: str | None = None
    bends: bool = False

    @property
    def logarithmic(self) -> bool:
        """Whether it is searched in the logarithm."""
        return self.low > 0 and self.high / self.low > _DECADES

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
    found: list[MachineCoordinate] = []
    problems: list[str] = []
    for sought in logs.sought:
        whole = _LOG.fullmatch(sought.path)
        which: list[int | None] = [None]
        rest = sought.path
        if whole:
            rest = whole[2]
            which = list(range(len(logs.recordings))) if whole[1] == "*" else [int(whole[1])]
            if which[-1] is not None and which[-1] >= len(logs.recordings):
                problems.append(
                    f"unknown.{sought.path}: log.{whole[1]}: there are {len(logs.recordings)} recordings, from 0"
                )
                continue
        for log in which:
            name = sought.path if log is None else f"log.{log}.{rest}"
            made = _one(scenario, logs, sought, rest, name, log)
            if isinstance(made, str):
                problems.append(made)
                break
            found.append(made)
    if problems:
        raise InputError(problems)
    return found


def _one(scenario: Scenario, logs: Logs, s: Sought, rest: str, name: str, log: int | None) -> MachineCoordinate | str:
    """One coordinate, or the error in its path."""
    if output := _OUTPUT.fullmatch(rest):
        measured = {column for r in logs.recordings for column in r.outputs}
        if output[1] not in measured:
            hint = nearest(output[1], measured) or f" (measured are {', '.join(sorted(measured))})"
            return f"unknown.{s.path}: {output[1]}: is not measured{hint}"
        known = {
            **NEUTRAL,
            **dict.fromkeys(n for r in logs.recordings if output[1] in r.outputs for n in r.outputs[output[1]].beside),
        }
        if output[2] not in known:
            return f"unknown.{s.path}: {output[2]}: must be {', '.join(known)} of a sensor"
        return MachineCoordinate(name, s.low, s.high, s.start, s.prior, {}, (output[1], output[2]), log, s.nuisance)
    start = _START.fullmatch(rest)
    path = f"bodies.{start[1]}.initial.{start[2]}" if start else rest
    if start and log is None:
        return f"unknown.{s.path}: must begin with log.*. or log.0.: a start belongs to a recording"
    if text := impossible(scenario, path, s.low, s.high):
        return f"unknown.{s.path}: {text}"
    constant = constant_at(scenario, path)
    bends = constant is not None and constant.unit == SPEED
    return MachineCoordinate(name, s.low, s.high, s.start, s.prior, {path: 1.0}, None, log, s.nuisance, bends=bends)


def constant_at(scenario: Scenario, path: str) -> Constant | None:
    """The declaration of a law's constant at a path."""
    owner, name = scenario.places.get(path, ("", ""))
    return scenario.elements.laws[owner].constants().get(name) if owner in scenario.elements.laws else None


def impossible(scenario: Scenario, path: str, *values: float) -> str | None:
    """Why a path cannot take these values, or None."""
    places = scenario.places
    if path not in places:
        try:  # a constant that is off, such as an omitted backlash
            places = scenario.with_changes({path: values[-1]}).places
        except InputError:
            places = scenario.places
    if path not in places:
        return "no such number of the machine" + (
            nearest(path, places) or f" (it has {', '.join(_like(path, list(places)))})"
        )
    for x in values:
        try:
            scenario.with_changes({path: x})
        except InputError as error:
            mine = [line for line in error.problems if line.startswith(f"{path}:")]
            if mine and "F_c" not in mine[0].partition(": ")[2]:  # the search maintains relations to other numbers
                return f"{x:g}: {mine[0].partition(': ')[2]}"
    return None


def _like(path: str, places: Sequence[str]) -> list[str]:
    """Suggestions for an unknown path: the machine's numbers of the same element, or of the same kind."""
    words = path.split(".")
    for most in (2, 1):
        if same := [x for x in places if x.split(".")[:most] == words[:most]]:
            return [*same[:5], *["..."] * (len(same) > 5)]
    return [*places[:3], "..."]
