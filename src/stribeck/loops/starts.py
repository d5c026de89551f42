"""The verdict from many starts: off the target, in motion, or with a stretched link."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np

from stribeck.loops.judge import Judgment, judge
from stribeck.loops.loop import Loop, controller_of, rests_at
from stribeck.loops.moves import Moves, moves_of
from stribeck.scenario import Scenario

# Of the file's move, both ways: basins of cycles differ by orders of magnitude
_OFF = (0.003, 0.01, 0.03, 0.1, 0.3, 1.0)
_FAST = (0.1, 0.3, 1.0)  # of its greatest speed, both ways: the upper decade, as slower starts stick at once
# Of the file's move: one body that is not measured, alone; a link that is stretched in use by a part of it.
_STRETCHED = 0.1
_ALIKE = 0.1  # amplitudes of cycles that differ by less are one cycle: separate ones lie apart by factors


@dataclass(frozen=True)
class Start:
    """A start with constant signals, and its judgment.

    Attributes:
        body: the body that is moved.
        off: its distance from the final value of the signals, m or rad.
        speed: its initial speed, m/s or rad/s.
        judgment: the verdict from this start.
    """

    body: str
    off: float
    speed: float
    judgment: Judgment

    def row(self) -> dict[str, object]:
        """The result as plain data, for JSON."""
        j = self.judgment
        cycle = {"amplitude": j.amplitude, "period": j.period} if j.verdict == "hunting" else None
        return {"body": self.body, "off": self.off, "speed": self.speed, "verdict": j.verdict, "limit_cycle": cycle}


def from_starts(loop: Loop, controller: str, tell: Callable[[float], None] | None = None) -> list[Start]:
    """The judgment from each of many starts, in lanes.

    The controllers' signals are constant at their final values from t = 0 on; integrals are empty. One body starts
    differently, both ways each:

    - the measured body, 0.003 to 1 of the file's move off the target, its linked bodies moved with it;
    - the measured body on the target, with 0.1 to 1 of the file's speed;
    - another body alone, a tenth of the move off, its links stretched.
    """
    moves = moves_of(loop, controller)
    held = _with_resting_signals(loop)
    machine = held.scenario.elements
    each = controller_of(held.scenario, controller)
    main = machine.leader(each.body).name
    last = _final_value(loop, controller)
    travel_ratios = _travel_ratios(held.scenario, each.body)
    held = replace(held, travel={name: 2 * abs(share) * moves.amplitude for name, share in travel_ratios.items()})
    start_points = _start_points(moves, main, [name for name in travel_ratios if name != main])
    lanes: dict[str, list[float]] = {f"bodies.{name}.initial.y": [] for name in travel_ratios}
    lanes |= {f"bodies.{name}.initial.v": [] for name in travel_ratios}
    for body, off, speed in start_points:
        for name, share in travel_ratios.items():
            y = share * last + (share * off if body in (main, name) else 0.0)
            lanes[f"bodies.{name}.initial.y"].append(y)
            lanes[f"bodies.{name}.initial.v"].append(share * speed)
    judgments = judge(held, {path: np.array(x) for path, x in lanes.items()}, tell)
    return [Start(body, off, speed, j) for (body, off, speed), j in zip(start_points, judgments, strict=True)]


def distinct_judgments(starts: list[Start], judgment: Judgment) -> list[Judgment]:
    """The different outcomes of the file's own run and of all starts: one of each verdict and of each cycle's size."""
    different: list[Judgment] = []
    for j in (judgment, *(start.judgment for start in starts)):
        if not any(_same_outcome(j, other) for other in different):
            different.append(j)
    return different


def _same_outcome(a: Judgment, b: Judgment) -> bool:
    if a.verdict != b.verdict or a.verdict != "hunting":
        return a.verdict == b.verdict
    return abs(a.amplitude - b.amplitude) <= _ALIKE * max(a.amplitude, b.amplitude)


def _start_points(moves: Moves, main: str, others: list[str]) -> list[tuple[str, float, float]]:
    start_points = [(main, sign * share * moves.amplitude, 0.0) for share in _OFF for sign in (1, -1)]
    start_points += [(main, 0.0, sign * share * moves.speed) for share in _FAST for sign in (1, -1)]
    return start_points + [(name, sign * _STRETCHED * moves.amplitude, 0.0) for name in others for sign in (1, -1)]


def _with_resting_signals(loop: Loop) -> Loop:
    """The loop with its controllers' signals at rest from t = 0 on."""
    machine, data = loop.scenario.elements, deepcopy(loop.scenario.data)
    for each in machine.system.controllers:
        table = data["controllers"][each.name]
        table["signal"] = _constant_signal(str(table["signal"]["kind"]), _final_value(loop, each.name))
    return replace(loop, scenario=Scenario(data, folder=loop.scenario.folder, trust=True))


def _constant_signal(kind: str, value: float) -> dict[str, object]:
    """The table of a signal that is constant from t = 0 on, of the given kind if possible, whose compiled code is reused."""
    if kind == "step":
        return {"kind": kind, "time": 0.0, "value": value}
    kind = kind if kind in ("point_to_point", "spline") else "points"
    return {"kind": kind, "t": [0.0, 1.0, 2.0], "value": [value] * 3}


def _final_value(loop: Loop, controller: str) -> float:
    """The final value of a controller's signal, m or rad."""
    machine = loop.scenario.elements
    signal = machine.signals[controller_of(loop.scenario, controller).use]
    return float(signal.at(np.array([max(rests_at(signal), 0.0) + 1.0]))[0])


def _travel_ratios(scenario: Scenario, measured: str) -> dict[str, float]:
    """Travel of each force-driven body over that of the measured one, with no link stretched; the leader's first."""
    bodies = scenario.system.elements.bodies
    return {name: x for name, x in scenario.elements.carried(measured).items() if bodies[name].velocity is None}
