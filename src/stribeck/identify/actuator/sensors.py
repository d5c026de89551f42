"""Sensors that err: a delay, a clock, a gain or an offset, of all recordings or of one, that the residuals show."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import NEUTRAL, MachineCoordinate
from stribeck.identify.actuator.driven import otherwise_held
from stribeck.identify.actuator.estimate import POOR, BestPoint, leftovers
from stribeck.identify.actuator.intervals import Spread, inverse, remembered, scores
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.solve import search

_SURE = 4.5  # deviations
_MATTERS = 0.02  # of what is left of the recordings that it concerns
_MOVES = 1.0  # deviations of a number: one that would move by more has no interval
_AS_WELL = 0.9  # of what another suspect explains: how inputs run is said first
_WHOLE = 0.5  # how far from 1 the share of the way to inputs held otherwise may be
_SAMPLES = 50  # sample times: the longest delay that is tried
_CLOCK, _GAIN = 0.05, 2.0
_TRIED, _STEPS, _ROUGHLY = 3, 12, 1e-3


@dataclass(frozen=True)
class Suspect:
    """What may be wrong with a sensor: its number, how far that would be off and its deviation; by how much the sum of
    squares would fall, and by what share of that of the recordings that it concerns; how far each coordinate would move."""

    column: str
    what: str
    log: int | None
    value: float
    wide: float
    fall: float
    share: float
    moves: Array

    @property
    def path(self) -> str:
        """What would be sought."""
        return f"{'' if self.log is None else f'log.{self.log}.'}outputs.{self.column}.{self.what}"


def seen(best: BestPoint, s: Spread) -> tuple[list[str], bool]:
    """A number of a sensor that is not sought but that the residuals show, in words; and whether it would move what is
    sought, so that no interval can be given without it."""
    found = [x for x in _suspects(best.problem, best.u, s.J) if abs(x.value) > _SURE * x.wide and x.share > _MATTERS]
    other = _driven_otherwise(best, s.J)
    if not (found or other):
        return [], False
    first = max(found, key=lambda x: x.fall) if found else None  # the others may be its shadows
    if other and (first is None or other[0].fall > _AS_WELL * first.fall):
        return [
            f"inputs {other[1]} would be followed better: what is left would fall by {100 * other[0].share:.2g} %"
        ], (_moves(best, s, other[0]))
    assert first is not None
    return [f"{_words(best.problem, first)}; seek {first.path} if that can be"], _moves(best, s, first)


def _moves(best: BestPoint, s: Spread, x: Suspect) -> bool:
    """Whether what is asked for would move."""
    asked = [i for i, c in enumerate(best.problem.sought) if not c.nuisance]
    return bool((abs(x.moves[asked]) > _MOVES * s.deviations[asked]).any())


def _driven_otherwise(best: BestPoint, J: Array) -> tuple[Suspect, str] | None:
    """Whether the residuals show that inputs run otherwise between their samples, and how, in words."""
    other = otherwise_held(best.problem)
    if other is None:
        return None
    r = best.problem.residuals(best.u[None])[0]
    off = np.zeros(len(r))  # its ties, if any, stay
    there = other[0].residuals(best.u[None])[0]
    off[: best.problem.first[-1]] = (there - r[: len(there)])[: best.problem.first[-1]]
    if not (np.isfinite(off).all() and off @ off > 0):
        return None
    x = _suspect(best.problem, r, J, off, ("", "held", None))
    sure = abs(x.value) > _SURE * x.wide and abs(x.value - 1) < _WHOLE and x.share > _MATTERS
    return (x, other[1]) if sure else None


def tried(best: BestPoint) -> list[str]:
    """The number of a sensor with which a machine that errs would follow its recordings far better."""
    problem, u = best.problem, best.u
    r, J = (x[0] for x in problem.slopes(u[None], np.full(len(u), problem.step)))
    if not (np.isfinite(r).all() and np.isfinite(J).all()):
        return []
    order = sorted(_suspects(problem, u, J), key=lambda x: -x.fall)[:_TRIED]
    before, told = leftovers(problem, u), list[tuple[float, str]]()
    if (other := otherwise_held(problem)) is not None:
        found = search(other[0], 1, 0, u, steps=_STEPS, small=_ROUGHLY)
        for column, (left, size) in leftovers(other[0], found.u).items():
            if not found.stopped and left < min(0.5 * before[column][0], POOR * size):
                words = f"{column}: with inputs {other[1]}, {left:.2g} is left of it, not {before[column][0]:.2g}"
                told.append((_AS_WELL * left, words))
    for x in order:
        c = _coordinate(problem, x)
        own = replace(problem, sought=[*problem.sought, c], noise=dict(problem.noise))
        there = np.append(u, c.inner(NEUTRAL[x.what] + x.value))
        found = search(own, 1, 0, there, steps=_STEPS, small=_ROUGHLY)
        left, size = leftovers(own, found.u)[x.column]
        if found.stopped or not left < min(0.5 * before[x.column][0], POOR * size):
            continue
        now = replace(x, value=c.outer(found.u[-1]) - NEUTRAL[x.what], wide=0.0)
        told.append(
            (
                left,
                f"{_words(problem, now)}: with {x.path} sought, {left:.2g} is left of it, not {before[x.column][0]:.2g}",
            )
        )
    return [min(told)[1]] if told else []


def _suspects(problem: MachineProblem, u: Array, J: Array) -> Iterator[Suspect]:
    """What each sensor's numbers would be, from the slopes."""
    r = problem.residuals(u[None])[0]
    sought = {(c.output, c.log) for c in problem.sought}
    logs = list(dict.fromkeys(run.log for run in problem.runs))
    for (column, what), slopes in _slopes(problem, u).items():
        if ((column, what), None) in sought:
            continue
        for log in [None, *logs] if len(logs) > 1 else [None]:
            x = np.where(_rows(problem, log), slopes, 0.0)
            if ((column, what), log) not in sought and x @ x > 0:
                yield _suspect(problem, r, J, x, (column, what, log))


def _suspect(problem: MachineProblem, r: Array, J: Array, slopes: Array, which: tuple[str, str, int | None]) -> Suspect:
    J = np.column_stack([J, slopes])
    covariance = inverse(J)
    move = -(covariance @ (J.T @ r))
    left = r + J @ move  # what is left with it
    lags, _, _ = remembered(problem, left)
    wide = np.sqrt(max((covariance @ scores(problem, left, J, lags) @ covariance)[-1, -1], covariance[-1, -1]))
    own = r[_rows(problem, which[2])]
    fall = float(r @ r) - float(left @ left)
    return Suspect(*which, float(move[-1]), float(wide), fall, fall / max(float(own @ own), 1e-300), move[:-1])


def _rows(problem: MachineProblem, log: int | None) -> Array:
    """Which residuals are those of a recording, or of all."""
    found = np.zeros(problem.size, bool)
    for k, run in enumerate(problem.runs):
        found[problem.first[k] : problem.first[k + 1]] = log in (None, run.log)
    return found


def _coordinate(problem: MachineProblem, x: Suspect) -> MachineCoordinate:
    """The number of a sensor as one that is sought."""
    targets = [t for run in problem.runs for t in run.targets if t.column == x.column and len(t.t) > 1]
    span = max(float(np.ptp(t.x)) for t in targets)
    late = _SAMPLES * max(float(np.median(np.diff(t.t))) for t in targets)
    room = {"clock": (-_CLOCK, _CLOCK), "delay": (-late, late), "gain": (1 / _GAIN, _GAIN), "offset": (-span, span)}
    return MachineCoordinate(x.path, *room[x.what], None, None, {}, (x.column, x.what), x.log)


def _words(problem: MachineProblem, x: Suspect) -> str:
    where = "" if x.log is None else next(f"{run.name}: " for run in problem.runs if run.log == x.log)
    within = f" ± {2 * x.wide:.2g}" if x.wide else ""
    said = f"{abs(x.value):.3g}{within}"
    if x.what == "clock":
        text = f"its clock drifts from that of the drive, by {said} s in a second"
    elif x.what == "delay":
        text = f"it comes {said} s {'late' if x.value > 0 else 'early'}"
    else:
        text = f"its {x.what} seems to be {x.value:+.3g}{within} off"
    return f"{where}{x.column}: {text}"


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
