"""Limit cycles from many starts: what the loop does when it begins off its target, in motion or with a link stretched."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np

from stribeck.loops.judge import Judgement, judge
from stribeck.loops.loop import Loop, controller_of, rests_at
from stribeck.loops.moves import Moves, moves_of
from stribeck.scenario import Scenario

_OFF = (0.003, 0.01, 0.03, 0.1, 0.3, 1.0)  # of the file's move, both ways
_FAST = (0.1, 0.3, 1.0)  # of its greatest speed, both ways
_STRETCHED = 0.1  # of the file's move: one body that is not measured, alone
_ALIKE = 0.1  # amplitudes of cycles that differ by less are one cycle


@dataclass(frozen=True)
class Start:
    """A start, the signals resting where they end: a body's place from there and its speed; and what comes of it."""

    body: str
    off: float
    speed: float
    judgement: Judgement

    def row(self) -> dict[str, object]:
        """What is told of it."""
        j = self.judgement
        cycle = {"amplitude": j.amplitude, "period": j.period} if j.verdict == "hunting" else None
        return {"body": self.body, "off": self.off, "speed": self.speed, "verdict": j.verdict, "limit_cycle": cycle}


def from_starts(loop: Loop, controller: str, tell: Callable[[float], None] | None = None) -> list[Start]:
    """The judgement from each of many starts, in lanes.

    The controllers' signals rest at their last values from t = 0 on, with empty integrals. The measured body begins there,
    0.003 to 1 of the file's move off, both ways, what is linked to it moved with it; or there with 0.1 to 1 of its speed, both
    ways; or another body alone a tenth of the move off, its links stretched.
    """
    moves = moves_of(loop, controller)
    held = _held(loop)
    rig = held.scenario.rig
    each = controller_of(held.scenario, controller)
    main = rig.machine.leader(each.body).name
    last = _last(loop, controller)
    at = _together(held.scenario, each.body)
    held = replace(held, travel={name: 2 * abs(share) * moves.amplitude for name, share in at.items()})
    wanted = _wanted(moves, main, [name for name in at if name != main])
    lanes: dict[str, list[float]] = {f"bodies.{name}.initial.y": [] for name in at}
    lanes |= {f"bodies.{name}.initial.v": [] for name in at}
    for body, off, speed in wanted:
        for name, share in at.items():
            y = share * last + (share * off if body == main else off * share if body == name else 0.0)
            lanes[f"bodies.{name}.initial.y"].append(y)
            lanes[f"bodies.{name}.initial.v"].append(share * speed)
    found = judge(held, {path: np.array(x) for path, x in lanes.items()}, tell)
    return [Start(body, off, speed, j) for (body, off, speed), j in zip(wanted, found, strict=True)]


def kinds(found: list[Start], own: Judgement) -> list[Judgement]:
    """What the loop can do, by the file's own run and from all starts: one of each verdict, and of each cycle's size."""
    different: list[Judgement] = []
    for j in (own, *(start.judgement for start in found)):
        if not any(_alike(j, other) for other in different):
            different.append(j)
    return different


def _alike(a: Judgement, b: Judgement) -> bool:
    if a.verdict != b.verdict or a.verdict != "hunting":
        return a.verdict == b.verdict
    return abs(a.amplitude - b.amplitude) <= _ALIKE * max(a.amplitude, b.amplitude)


def _wanted(moves: Moves, main: str, others: list[str]) -> list[tuple[str, float, float]]:
    found = [(main, sign * share * moves.amplitude, 0.0) for share in _OFF for sign in (1, -1)]
    found += [(main, 0.0, sign * share * moves.speed) for share in _FAST for sign in (1, -1)]
    return found + [(name, sign * _STRETCHED * moves.amplitude, 0.0) for name in others for sign in (1, -1)]


def _held(loop: Loop) -> Loop:
    """The loop with its controllers' signals at rest from t = 0 on."""
    rig, data = loop.scenario.rig, deepcopy(loop.scenario.data)
    for each in rig.machine.controllers:
        table = data["controllers"][each.name]
        table["signal"] = _constant(str(table["signal"]["kind"]), _last(loop, each.name))
    scenario = Scenario(data, folder=loop.scenario.folder, trust=True)
    rest = max([0.0, *(rests_at(signal) for signal in scenario.rig.signals.values())])
    return replace(loop, scenario=scenario, rest=rest)


def _constant(kind: str, value: float) -> dict[str, object]:
    """A signal that has a value from t = 0 on, of a kind: what is compiled for that kind serves."""
    if kind == "step":
        return {"kind": kind, "time": 0.0, "value": value}
    kind = kind if kind in ("point_to_point", "spline") else "points"
    return {"kind": kind, "t": [0.0, 1.0, 2.0], "value": [value] * 3}


def _last(loop: Loop, controller: str) -> float:
    """Where a controller's signal rests in the end."""
    rig = loop.scenario.rig
    signal = rig.signals[controller_of(loop.scenario, controller).use]
    return float(signal.at(np.array([max(rests_at(signal), 0.0) + 1.0]))[0])


def _together(scenario: Scenario, measured: str) -> dict[str, float]:
    """How far each body that obeys forces goes by the measured one while no link is stretched; the leader's first."""
    bodies = scenario.rig.machine.elements.bodies
    return {name: x for name, x in scenario.rig.carried(measured).items() if bodies[name].velocity is None}


def starts_row(found: list[Start], own: Judgement) -> dict[str, object]:
    """What is told of the starts: each, and whether what the loop does in the end depends on them."""
    return {"starts": [start.row() for start in found], "depends_on_the_start": len(kinds(found, own)) > 1}
