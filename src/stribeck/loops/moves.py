"""Tracking errors of a loop: with the file's signal and with standard moves of its size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.loops.loop import Loop, controller_of, replaced, resolution_of, rests_at, simulate_lanes
from stribeck.machine.elements.controllers import Controller
from stribeck.scenario import Scenario
from stribeck.simulation.ensemble import Ensemble
from stribeck.waveforms import Signal

_WAVES = 4  # of the sine: transients die out in the first, and the maximum of three is one
_ROWS = 4000  # of a move: a thousand in each wave of the sine
_AFTER = 0.125  # of a period: the time after a reversal in which friction's error occurs, until 0.7 of full speed
# Slowest time constants after the signals rest, until when the file's own error is simulated: two of SHORTEST.
SETTLES = 50
_SETTLED = 0.01  # of the move: settling tolerance, between the usual 2 % and 0.5 %; two steps of the encoder if more


@dataclass(frozen=True)
class Moves:
    """The size of the standard moves of a controller: amplitude (m or rad) and greatest speed (1/s of that)."""

    amplitude: float
    speed: float

    @property
    def period(self) -> float:
        """Period of the sine with this amplitude and greatest speed, s."""
        return 2 * np.pi * self.amplitude / self.speed


def moves_of(loop: Loop, controller: str) -> Moves:
    """The size of the standard moves, from the file's signal.

    The amplitude is half of the signal's range, or of the way to it if the signal is constant. The speed is the signal's
    greatest; if the signal jumps or is constant, it is the amplitude over ten slowest time constants.
    """
    machine = loop.scenario.elements
    each = controller_of(loop.scenario, controller)
    signal = given_signal(loop, each)
    last = rests_at(signal)
    t_end = loop.scenario.solve.t_end
    t = np.linspace(0.0, max(t_end, last) if last < np.inf else t_end, 4001)
    r = signal.at(t)
    step = resolution_of(loop.scenario, each)
    leader = machine.leader(each.body).name
    starts = machine.initial.get(f"{leader}.y", 0.0)
    begins = abs(float(r[0]) - starts) / 2 if each.body == leader else 0.0
    amplitude = float(np.ptp(r)) / 2 or begins or 1e3 * step or machine.scales[leader].length * 100
    rates = np.abs(np.diff(r)) / (t[1] - t[0])
    fastest = float(np.quantile(rates, 0.98)) if not signal.smooth else float(rates.max())
    slow = amplitude / (10 * loop.slowest)
    return Moves(amplitude, fastest if fastest > 0.1 * slow else slow)


def given_signal(loop: Loop, each: Controller) -> Signal:
    """A controller's signal as in the file, not as it is held: its spline begins and ends at rest."""
    return next(signal for use, signal in loop.given.elements.signals.items() if use.path == each.use.path)


def signals_of(moves: Moves) -> dict[str, tuple[dict[str, object], float]]:
    """Signal and duration (s) of each standard move.

    The reversals of the sine are those of a circle's quadrants on each axis. The ramp passes a reversal at a tenth of the
    speed. The step is as large as the amplitude.
    """
    T, A = moves.period, moves.amplitude
    slow = 2 * A / (0.1 * moves.speed)
    return {
        "sine": ({"kind": "sine", "amplitude": A, "frequency": 1 / T}, _WAVES * T),
        "slow_ramp": ({"kind": "points", "t": [0.0, slow / 2, slow * 3 / 2], "value": [0.0, A, -A]}, slow * 3 / 2),
        "step": ({"kind": "points", "t": [0.0, T], "value": [A, A]}, T),  # of one kind with the ramp: compiled once
    }


def reversal_errors(loop: Loop, controller: str, values: Mapping[str, ArrayLike] | None = None) -> Array:
    """The largest error after reversals of the standard sine, within an eighth of a period, for each lane (m or rad).

    It is nan if the lane's simulation failed.
    """
    moves = moves_of(loop, controller)
    signal, end = signals_of(moves)["sine"]
    lanes = _simulate_lanes(loop, replaced(loop.lean, controller, signal), end, values)
    near = _after_reversals(lanes.t, moves.period)
    y = lanes[f"{controller_of(lanes.scenario, controller).measures}.y"]
    errors = np.abs((lanes[f"{controller}.r"] - y)[:, near]).max(axis=1)
    return np.where([reason is None for reason in lanes.reason], errors, np.nan)


@dataclass(frozen=True)
class Tracked:
    """Signal ``r`` and position ``y`` of the measured body (m or rad) at times ``t`` (s), and the errors."""

    t: Array
    r: Array
    y: Array
    errors: dict[str, float | None]


def on_a_sine(loop: Loop, controller: str, values: Mapping[str, ArrayLike] | None = None) -> Tracked:
    """Tracking of the standard sine, with the error after its reversals."""
    moves = moves_of(loop, controller)
    signal, end = signals_of(moves)["sine"]
    lanes = _simulate_lanes(loop, replaced(loop.lean, controller, signal), end, values)
    return _track_first_lane(lanes, controller, moves.period)


def errors(loop: Loop, controller: str) -> dict[str, Tracked]:
    """Tracking of the file's signal ("file") and of the standard moves.

    The values are peak, root mean square, error after reversals and at rest (m or rad), and settling time (s).
    """
    moves = moves_of(loop, controller)
    tracked = {"file": _track_file_signal(loop, controller), "sine": on_a_sine(loop, controller)}
    for name in ("slow_ramp", "step"):
        signal, end = signals_of(moves)[name]
        lanes = _simulate_lanes(loop, replaced(loop.lean, controller, signal), end)
        tracked[name] = move = _track_first_lane(lanes, controller)
        t, e = move.t, move.r - move.y
        if name == "slow_ramp":
            turn = end / 3
            move.errors["reversal"] = float(np.abs(e[(t >= turn) & (t <= turn * 1.5)]).max(initial=0.0))
        else:
            move.errors["settling"] = _settling(t, e, _tolerance(loop, controller, moves.amplitude))
            move.errors["standstill"] = float(np.abs(e[-len(e) // 20 :]).max(initial=0.0))
    return tracked


def _track_first_lane(lanes: Ensemble, controller: str, period: float | None = None) -> Tracked:
    """Tracking of the first lane; with the error after reversals if ``period`` is that of a sine."""
    t, r, y = _reached_rows(lanes, controller)
    row: dict[str, float | None] = _error_norms(r - y)
    if period is not None:
        row["reversal"] = float(np.abs((r - y)[_after_reversals(t, period)]).max(initial=0.0))
    if lanes.reason[0] is not None:
        row["failed_at"] = float(t[-1]) if len(t) else 0.0
    return Tracked(t, r, y, row)


def _track_file_signal(loop: Loop, controller: str) -> Tracked:
    lanes = _simulate_lanes(loop, loop.lean, loop.rest + SETTLES * loop.slowest)
    t, r, y = _reached_rows(lanes, controller)
    e, rest = r - y, t >= loop.rest
    tolerance = _tolerance(loop, controller, moves_of(loop, controller).amplitude)
    moving = t, r, y
    if loop.held:  # a held signal stops, which the file's does not
        moving = _reached_rows(_simulate_lanes(loop, loop.given, loop.given.solve.t_end), controller)
    row = {
        **_error_norms(moving[1] - moving[2]),
        "standstill": float(np.abs(e[t >= t[-1] - (t[-1] - loop.rest) / 4]).max(initial=0.0)),
        "settling": _settling(t[rest] - loop.rest, e[rest], tolerance),
        "tolerance": tolerance,
    }
    return Tracked(*moving, row)


def _simulate_lanes(
    loop: Loop, scenario: Scenario, end: float, values: Mapping[str, ArrayLike] | None = None
) -> Ensemble:
    """Simulate a move in lanes; also a single one, so that all remedies share compiled code."""
    scenario = scenario.with_changes({"solve.max_steps": loop.scenario.solve.max_steps})
    return simulate_lanes(scenario, values, end, end / _ROWS)


def _reached_rows(lanes: Ensemble, controller: str) -> tuple[Array, Array, Array]:
    """Times, signal and measured position of the first lane, as far as it was simulated."""
    each = controller_of(lanes.scenario, controller)
    r, y = (np.asarray(lanes[name][0], float) for name in (f"{controller}.r", f"{each.measures}.y"))
    reached = np.isfinite(y)
    return lanes.t[reached], r[reached], y[reached]


def _error_norms(e: Array) -> dict[str, float | None]:
    return {"peak": float(np.abs(e).max(initial=0.0)), "rms": float(np.sqrt(np.mean(e**2))) if len(e) else None}


def _settling(t: Array, e: Array, tolerance: float) -> float | None:
    """The time from which on the error stays within the tolerance, s; None if it does not."""
    outside = np.flatnonzero(np.abs(e) > tolerance)
    if not len(outside):
        return 0.0
    return float(t[outside[-1] + 1]) if outside[-1] + 1 < len(t) else None


def _tolerance(loop: Loop, controller: str, amplitude: float) -> float:
    step = resolution_of(loop.scenario, controller_of(loop.scenario, controller))
    return max(2 * step, _SETTLED * amplitude)


def _after_reversals(t: Array, period: float) -> NDArray[np.bool_]:
    """The rows within an eighth of a period after each reversal of a sine that begins at 0, without the first wave."""
    phase = (t / period - 0.25) % 0.5
    return (phase <= _AFTER) & (t >= period)
