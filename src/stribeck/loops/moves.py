"""How well a loop tracks: errors at the file's signal and at standard moves of its size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.loops.loop import Loop, a_number, controller_of, replaced, resolution_of, rests_at
from stribeck.machine.elements.controllers import Controller
from stribeck.scenario import Scenario
from stribeck.signals import Signal
from stribeck.simulation.ensemble import Ensemble, simulate_ensemble

_WAVES = 4  # of the sine; the first lets transients die out
_ROWS = 4000
_AFTER = 0.125  # of a period, after a reversal: where friction's error shows
SETTLES = 50  # slowest time constants after the signals rest: until when the file's own error is shown
_SETTLED = 0.01  # of the move, where no encoder says less


@dataclass(frozen=True)
class Moves:
    """The size of the standard moves of a controller: amplitude (m or rad) and greatest speed (1/s of that)."""

    amplitude: float
    speed: float

    @property
    def period(self) -> float:
        """Of a sine with both, s."""
        return 2 * np.pi * self.amplitude / self.speed


def moves_of(loop: Loop, controller: str) -> Moves:
    """The moves of the file's signal's size: half of its range (of the way there
    where it does not move), and its speed, or what the loop does in ten of its
    slowest time constants where the signal jumps or stands."""
    rig = loop.scenario.rig
    each = controller_of(loop.scenario, controller)
    signal = given_signal(loop, each)
    last = rests_at(signal)
    end = max(loop.scenario.solve.t_end, last) if last < np.inf else loop.scenario.solve.t_end
    t = np.linspace(0.0, end, 4001)
    r = signal.at(t)
    step = resolution_of(loop.scenario, each)
    starts = loop.scenario.initial.get(f"{rig.machine.leader(each.body).name}.y", 0.0)
    begins = abs(float(r[0]) - starts) / 2 if each.measures == rig.machine.leader(each.body).name else 0.0
    amplitude = (
        float(np.ptp(r)) / 2 or begins or 1e3 * step or rig.scales[rig.machine.leader(each.body).name].length * 100
    )
    rates = np.abs(np.diff(r)) / (t[1] - t[0])
    fastest = float(np.quantile(rates, 0.98)) if not signal.smooth else float(rates.max())
    slow = amplitude / (10 * loop.slowest)
    return Moves(amplitude, fastest if fastest > 0.1 * slow else slow)


def given_signal(loop: Loop, each: Controller) -> Signal:
    """A controller's signal as it was given, not as it is held: the spline that comes to rest also begins at rest."""
    rig = (loop.given or loop.scenario).rig
    return next(signal for use, signal in rig.signals.items() if use.path == each.use.path)


def signals_of(moves: Moves) -> dict[str, tuple[dict[str, object], float]]:
    """The standard moves: signal and duration. The sine's reversals are those of a circle's quadrants, for each of its
    two axes; the ramp goes through a reversal at a tenth of the speed; the step is half a move."""
    T, A = moves.period, moves.amplitude
    slow = 2 * A / (0.1 * moves.speed)
    return {
        "sine": ({"kind": "sine", "amplitude": A, "frequency": 1 / T}, _WAVES * T),
        "slow_ramp": ({"kind": "points", "t": [0.0, slow / 2, slow * 3 / 2], "value": [0.0, A, -A]}, slow * 3 / 2),
        "step": ({"kind": "points", "t": [0.0, T], "value": [A, A]}, T),  # of one kind with the ramp: compiled once
    }


def reversal_errors(loop: Loop, controller: str, values: Mapping[str, ArrayLike] | None = None) -> Array:
    """The largest error within an eighth of a period after the reversals of the standard sine, for each lane."""
    moves = moves_of(loop, controller)
    signal, end = signals_of(moves)["sine"]
    lanes = _lanes(loop, replaced(loop.lean, controller, signal), end, values)
    near = _after_reversals(lanes.t, moves.period)
    found = np.abs(_error(lanes.scenario, controller, lanes)[:, near]).max(axis=1)
    return np.where([reason is None for reason in lanes.reason], found, np.nan)


@dataclass(frozen=True)
class Tracked:
    """How a move is followed: signal and position of the measured body at times, and its errors."""

    t: Array
    r: Array
    y: Array
    errors: dict[str, float | None]


def on_a_sine(loop: Loop, controller: str, values: Mapping[str, ArrayLike] | None = None) -> Tracked:
    """How the standard sine is followed, with the error after its reversals."""
    moves = moves_of(loop, controller)
    signal, end = signals_of(moves)["sine"]
    return _tracked(_lanes(loop, replaced(loop.lean, controller, signal), end, values), controller, moves.period)


def errors(loop: Loop, controller: str) -> dict[str, Tracked]:
    """Peak, root mean square, error after reversals and at rest, and settling time: of the file's signal ("file") and
    of the standard moves."""
    found = {"file": _of_file(loop, controller)}
    moves = moves_of(loop, controller)
    found["sine"] = on_a_sine(loop, controller)
    for name, (signal, end) in signals_of(moves).items():
        if name == "sine":
            continue
        found[name] = move = _tracked(_lanes(loop, replaced(loop.lean, controller, signal), end), controller)
        t, e = move.t, move.r - move.y
        if name == "slow_ramp":
            turn = end / 3
            move.errors["reversal"] = float(np.abs(e[(t >= turn) & (t <= turn * 1.5)]).max(initial=0.0))
        else:
            move.errors["settling"] = _settling(t, e, _tolerance(loop, controller, moves.amplitude))
            move.errors["standstill"] = float(np.abs(e[-len(e) // 20 :]).max(initial=0.0))
    return found


def _tracked(lanes: Ensemble, controller: str, period: float | None = None) -> Tracked:
    """The first lane's course and the sizes of its error; after the reversals of a sine too."""
    t, r, y = _courses(lanes, controller)
    row: dict[str, float | None] = _sizes(r - y)
    if period is not None:
        row["reversal"] = float(np.abs((r - y)[_after_reversals(t, period)]).max(initial=0.0))
    if lanes.reason[0] is not None:
        row["failed_at"] = float(t[-1]) if len(t) else 0.0
    return Tracked(t, r, y, row)


def _of_file(loop: Loop, controller: str) -> Tracked:
    lanes = _lanes(loop, loop.lean, loop.rest + SETTLES * loop.slowest)
    t, r, y = _courses(lanes, controller)
    e, rest = r - y, t >= loop.rest
    tolerance = _tolerance(loop, controller, moves_of(loop, controller).amplitude)
    moving = t, r, y
    if loop.held and loop.given is not None:  # held, it would be asked for what the file does not ask
        moving = _courses(_lanes(loop, loop.given, loop.given.solve.t_end), controller)
    row = {
        **_sizes(moving[1] - moving[2]),
        "standstill": float(np.abs(e[t >= t[-1] - (t[-1] - loop.rest) / 4]).max(initial=0.0)),
        "settling": _settling(t[rest] - loop.rest, e[rest], tolerance),
        "tolerance": tolerance,
    }
    return Tracked(*moving, row)


def _lanes(loop: Loop, scenario: Scenario, end: float, values: Mapping[str, ArrayLike] | None = None) -> Ensemble:
    """The motion in lanes, of which the first are shared: what is simulated here is compiled once for all remedies."""
    scenario = scenario.with_changes({"solve.max_steps": loop.scenario.solve.max_steps})
    return simulate_ensemble(
        scenario, values or {p: [x] for p, x in a_number(scenario).items()}, t_end=end, step=end / _ROWS
    )


def _courses(lanes: Ensemble, controller: str) -> tuple[Array, Array, Array]:
    """Times, signal and measured position of the first lane, as far as it came."""
    each = controller_of(lanes.scenario, controller)
    r, y = (np.asarray(lanes[name][0], float) for name in (f"{controller}.r", f"{each.measures}.y"))
    reached = np.isfinite(y)
    return lanes.t[reached], r[reached], y[reached]


def _sizes(e: Array) -> dict[str, float | None]:
    return {"peak": float(np.abs(e).max(initial=0.0)), "rms": float(np.sqrt(np.mean(e**2))) if len(e) else None}


def _settling(t: Array, e: Array, tolerance: float) -> float | None:
    """From when on the error stays within the tolerance, s; None where it does not."""
    outside = np.flatnonzero(np.abs(e) > tolerance)
    if not len(outside):
        return 0.0
    return float(t[outside[-1] + 1]) if outside[-1] + 1 < len(t) else None


def _tolerance(loop: Loop, controller: str, amplitude: float) -> float:
    step = resolution_of(loop.scenario, controller_of(loop.scenario, controller))
    return max(2 * step, _SETTLED * amplitude)


def _error(scenario: Scenario, controller: str, lanes: Ensemble) -> Array:
    each = controller_of(scenario, controller)
    return np.asarray(lanes[f"{controller}.r"] - lanes[f"{each.measures}.y"], float)


def _after_reversals(t: Array, period: float) -> NDArray[np.bool_]:
    """The rows within an eighth of a period after each reversal of a sine that begins at 0, without the first wave."""
    phase = (t / period - 0.25) % 0.5
    return (phase <= _AFTER) & (t >= period)
