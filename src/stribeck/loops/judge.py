"""What a loop does in the long run: quiet, creeping, hunting or unstable, told from long simulations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.loops.loop import Loop, a_number, resolution_of
from stribeck.loops.oscillation import amplitude_and_period
from stribeck.loops.shaken import swings
from stribeck.simulation.ensemble import Ensemble, simulate_ensemble

STAYS = 100  # slowest time constants that a body has to stay at rest
TRAVEL = 1e-6  # of its travel: rest of a body without an encoder
_ROWS = 2000  # of the window that is judged
_LONGER = (2, 4, 8, 32)  # windows until the end; the second half is judged
_WINDS = 0.01  # of the largest output: an integral that still moves so much may yet break away
_AT_LIMIT = 0.999
_OFTEN = 0.02  # of the window at the limit: the limit is what holds the oscillation
_ONE_WAY = 0.9  # of all that moved, gone one way
_FEW, _FAR = 6, 10.0  # rows of a run that ended early; how far it had grown from its first third to its last
_GROWS = 1.15  # from one third of the window to the next

WINDS = "an integral still winds up behind friction that holds"
SHAKEN = "rest is what its dither alone moves it"
SUSTAINED = "the oscillation keeps its size"

Tell = Callable[[float], None]


@dataclass(frozen=True)
class Judgement:
    """What a loop does once its signals rest.

    Attributes:
        verdict: "quiet", "creeping", "hunting", "unstable"; "failed" where the simulation ended early.
        body: the body that moves most beyond what counts as rest.
        amplitude: half of peak to peak of its motion in the window, m or rad.
        period: of its oscillation, s; nan where there is none.
        note: why, in a few words.
    """

    verdict: str
    body: str
    amplitude: float
    period: float
    note: str = ""

    @property
    def quiet(self) -> bool:
        """Whether every body rests."""
        return self.verdict == "quiet"


def judge(loop: Loop, values: Mapping[str, ArrayLike] | None = None, tell: Tell | None = None) -> list[Judgement]:
    """The judgement of each lane of ``values``, as for :func:`stribeck.simulate_ensemble`; of the file without them.

    A lane is simulated until its signals rest, then for twice :data:`STAYS` of the slowest time constants, and the second
    half of these is judged. Where it moves, or an integral still winds up behind friction that holds, it is simulated for
    2, 4 and 16 times as long, and the second half of that is judged.
    """
    given = {path: np.atleast_1d(np.asarray(x, float)) for path, x in (values or {}).items()}
    count = max((len(x) for x in given.values()), default=1)
    found: list[Judgement | None] = [None] * count
    left, swing = np.arange(count), swings(loop, given, count)
    for i, windows in enumerate(_LONGER):
        lanes = _simulated(loop, {p: x if len(x) == 1 else x[left] for p, x in given.items()}, windows, len(left))
        for lane, place in enumerate(left):
            found[place] = _judged(loop, lanes, lane, swing[place])
        left = np.array([k for k in left if _worth_longer(found[k])], dtype=int)
        if tell is not None:
            tell(1 - len(left) / count * (1 - (i + 1) / len(_LONGER)))
        if not len(left):
            break
    return [each for each in found if each is not None]


def window(loop: Loop, windows: int = 2) -> tuple[float, float, float]:
    """Start and end of what is judged, and the time between rows, s."""
    length = windows / 2 * STAYS * loop.slowest
    step = length / _ROWS
    end = np.ceil((loop.rest + 2 * length) / step) * step
    return float(end - length), float(end), step


def _worth_longer(found: Judgement | None) -> bool:
    if found is None or found.note == SUSTAINED:
        return False
    return found.verdict in ("creeping", "hunting") or found.note == WINDS


def _simulated(loop: Loop, values: Mapping[str, ArrayLike], windows: int, count: int) -> Ensemble:
    _, end, step = window(loop, windows)
    if not values:  # one lane: any number that is there stands for it
        path, x = next(iter(a_number(loop.scenario).items()))
        values = {path: np.full(count, x)}
    return simulate_ensemble(loop.scenario, values, t_end=end, step=step)


def _judged(loop: Loop, lanes: Ensemble, lane: int, swing: dict[str, float]) -> Judgement:
    """The judgement of one lane, by its last rows."""
    rig = loop.scenario.rig
    machine = rig.machine
    main = machine.leader(machine.controllers[0].measures).name
    if (reason := lanes.reason[lane]) is not None:
        grew = "finite" in reason or _grew(np.asarray(lanes[f"{main}.y"][lane]))
        return Judgement("unstable" if grew else "failed", main, np.nan, np.nan, reason)
    moving = [b.name for b in machine.bodies if b.leader is None and b.driven is None]
    last = slice(-_ROWS - 1, None)
    path = {name: np.asarray(lanes[f"{name}.y"][lane]) for name in moving}
    travel = {name: float(np.ptp(y)) for name, y in path.items()}
    rest = _rest(loop, travel)
    rest = {name: x + swing.get(name, 0.0) for name, x in rest.items()}
    excess = {name: float(np.ptp(path[name][last])) / rest[name] if rest[name] else 0.0 for name in moving}
    body = main if excess.get(main, 0.0) > 1 else max(excess, key=excess.__getitem__)
    y, t = path[body][last], lanes.t[last]
    if max(excess.values()) <= 1:
        note = _winding(loop, lanes, lane, last) or (SHAKEN if swing else "")
        return Judgement("quiet", main, float(np.ptp(path[main][last])) / 2, np.nan, note)
    amplitude, period = (float(x) for x in amplitude_and_period(t, y))
    if _limited(loop, lanes, lane, last):
        return Judgement("unstable", body, amplitude, period, "the oscillation is held by a limit")
    if abs(y[-1] - y[0]) > _ONE_WAY * np.abs(np.diff(y)).sum():
        return Judgement("creeping", body, amplitude, np.nan)
    thirds = [float(np.ptp(part)) for part in np.array_split(y, 3)]
    if thirds[1] > _GROWS * thirds[0] and thirds[2] > _GROWS * thirds[1]:
        return Judgement("unstable", body, amplitude, period, "the oscillation grows")
    steady = min(thirds) > 0.97 * max(thirds)
    return Judgement("hunting", body, amplitude, period, SUSTAINED if steady else "")


def _grew(y: Array) -> bool:
    """Whether a motion that could not be followed to its end had grown all the time."""
    y = y[np.isfinite(y)]
    thirds = [float(np.ptp(part)) for part in np.array_split(y, 3)] if len(y) > _FEW else [0.0]
    return thirds[-1] > _FAR * thirds[0]


def _rest(loop: Loop, travel: dict[str, float]) -> dict[str, float]:
    """How far each body may move and still be at rest: its encoder's step, what that step makes of the others, or a
    millionth of its travel."""
    rig = loop.scenario.rig
    rest = {name: TRAVEL * max(x, loop.travel.get(name, 0.0)) for name, x in travel.items()}
    for each in rig.machine.controllers:
        step = resolution_of(loop.scenario, each)
        name = rig.machine.leader(each.measures).name
        if step and travel.get(name):
            for other, x in travel.items():
                rest[other] = max(rest[other], step if other == name else step * x / travel[name])
    return rest


def _winding(loop: Loop, lanes: Ensemble, lane: int, rows: slice) -> str:
    """:data:`WINDS` where an output still moves one way while the bodies rest; else nothing."""
    for each in loop.scenario.rig.machine.controllers:
        u = np.asarray(lanes[f"{each.name}.u"][lane])
        if each.dither is not None:  # where an integral winds, the mean moves
            u = u[rows]
            first, second = (float(x.mean()) for x in np.array_split(u, 2))
            moved = abs(second - first)
        else:
            moved = abs(u[rows][-1] - u[rows][0])
        if moved > _WINDS * np.abs(u).max():
            return WINDS
    return ""


def _limited(loop: Loop, lanes: Ensemble, lane: int, rows: slice) -> bool:
    """Whether an output stands at its limit for part of the time, on both sides."""
    rig = loop.scenario.rig
    found: list[tuple[Array, float]] = [
        (lanes[f"{each.name}.u"][lane][rows], rig.values[each.path, "limit"])
        for each in rig.machine.controllers if "limit" in each.form
    ]  # fmt: skip
    found += [
        (lanes[f"{motor.name}.V"][lane][rows], rig.values[motor.path, "voltage"])
        for motor in rig.machine.motors if "voltage" in motor.form
    ]  # fmt: skip
    return any(_both_sides(x, limit) for x, limit in found)


def _both_sides(x: Array, limit: float) -> bool:
    high, low = np.mean(x > _AT_LIMIT * limit), np.mean(x < -_AT_LIMIT * limit)
    return bool(min(high, low) > _OFTEN)
