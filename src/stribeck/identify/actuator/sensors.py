"""Sensors that err: a delay, a clock, a gain or an offset, of all recordings or of one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import NEUTRAL, MachineCoordinate
from stribeck.identify.actuator.problem import MachineProblem

_SAMPLES = 50  # sample times: the longest delay that is tried
_CLOCK, _GAIN = 0.05, 2.0


def candidates(problem: MachineProblem, u: Array) -> Iterator[tuple[MachineCoordinate, float, Array]]:
    """Each number of a sensor that is not sought, of all recordings and of each, as a coordinate, with its value and the
    residuals' slopes by it."""
    sought = {(c.output, c.log) for c in problem.sought}
    logs = list(dict.fromkeys(run.log for run in problem.runs))
    for (column, what), slopes in _slopes(problem, u).items():
        if ((column, what), None) in sought:
            continue
        for log in [None, *logs] if len(logs) > 1 else [None]:
            x = np.where(rows(problem, log), slopes, 0.0)
            if ((column, what), log) not in sought and x @ x > 0 and _room(problem, column, what)[1] > 0:
                yield _coordinate(problem, column, what, log), NEUTRAL[what], problem.whitened(x)


def rows(problem: MachineProblem, log: int | None) -> Array:
    """Which residuals are those of a recording, or of all."""
    found = np.zeros(problem.size, bool)
    for k, run in enumerate(problem.runs):
        found[problem.first[k] : problem.first[k + 1]] = log in (None, run.log)
    return found


def _coordinate(problem: MachineProblem, column: str, what: str, log: int | None) -> MachineCoordinate:
    """The number of a sensor as one that is sought."""
    path = f"{'' if log is None else f'log.{log}.'}outputs.{column}.{what}"
    return MachineCoordinate(path, *_room(problem, column, what), None, None, {}, (column, what), log)


def _room(problem: MachineProblem, column: str, what: str) -> tuple[float, float]:
    """Between what such a number may lie; nothing can be told of the offset of a column that never changes."""
    targets = [t for run in problem.runs for t in run.targets if t.column == column and len(t.t) > 1]
    span = max((float(np.ptp(t.x)) for t in targets), default=0.0)
    late = _SAMPLES * max((float(np.median(np.diff(t.t))) for t in targets), default=0.0)
    room = {"clock": (-_CLOCK, _CLOCK), "delay": (-late, late), "gain": (1 / _GAIN, _GAIN), "offset": (-span, span)}
    return room[what]


def words(problem: MachineProblem, c: MachineCoordinate, off: float, within: str) -> str:
    """What a sensor does whose number is off by so much."""
    assert c.output is not None
    column, what = c.output
    where = "" if c.log is None else next(f"{run.name}: " for run in problem.runs if run.log == c.log)
    said = f"{abs(off):.3g}{within}"
    if what == "clock":
        text = f"its clock drifts from that of the drive, by {said} s in a second"
    elif what == "delay":
        text = f"it comes {said} s {'late' if off > 0 else 'early'}"
    else:
        text = f"its {what} seems to be {off:+.3g}{within} off"
    return f"{where}{column}: {text}"


def _slopes(problem: MachineProblem, u: Array) -> dict[tuple[str, str], Array]:
    """The slopes of the residuals by each column's delay, clock, gain and offset."""
    found = {(n, what): np.zeros(problem.size) for n in problem.noise for what in ("clock", "delay", "gain", "offset")}
    for k, run in enumerate(problem.runs):
        at, begin = int(problem.first[k]), float(run.piece) if run.piece else 0.0
        for target, x in zip(run.targets, problem.predicted(run, k, u[None]), strict=True):
            if len(target.t) > 2:
                rows, column, noise = slice(at, at + len(target.t)), target.column, problem.noise[target.column]
                rate = np.gradient(x[0], target.t)
                found[column, "delay"][rows] = -rate / noise
                found[column, "clock"][rows] = -rate * (target.t + begin) / noise
                found[column, "gain"][rows] = x[0] / noise
                found[column, "offset"][rows] = 1 / noise
            at += len(target.t)
    return found
