"""Advises which further recording would identify the open parameters.

Each candidate is simulated. Its information is J^T J, with the derivatives J of its outputs by the parameters. Derivatives of
a sensitive motion are inexact: parameters of which only a ratio matters would seem identifiable. Therefore each candidate is
also simulated with a second machine for each open parameter, which the recordings cannot distinguish from the fitted one. It
helps only as far as its outputs differ between the two.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.identify.actuator.coordinates import paths
from stribeck.identify.actuator.inputs import number_at
from stribeck.identify.actuator.problem import STEP, MachineProblem
from stribeck.identify.actuator.recordings import Channel
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.actuator.solve import covariance
from stribeck.scenario.changes import entry_at

_BETTER = 1.3  # times narrower interval than from a repeated recording: a smaller gain is not worth an experiment
_LINEAR = 10.0  # times: an interval that shrinks by more spanned most of what was searched
_MOST = 28  # simulated candidates: all changes of seven drives
_CORRECTIONS = 3  # of a second machine by the fit's derivatives: each leaves the share by which these have changed
_SINGULAR = 1e-6  # share below which singular values are zero: its square is the floor of :func:`covariance`
_NOISE = 0.01  # of a column's changes: assumed noise of a sensor that is not installed yet
_LOADS = ("mass", "inertia", "amplitude")
_NONE = (
    "no simulated recording (other loads, drives, speeds, sensors) would identify it: measure it, or a parameter with which "
    "it is confounded, and give its value"
)


def experiments(problem: MachineProblem, u: Array, J: Array, open_: list[int]) -> dict[int, str]:
    """For each open coordinate the recording that would identify it, in words; ``J``: the fit's Jacobian."""
    longest = max(range(len(problem.runs)), key=lambda k: problem.runs[k].scenario.end)
    run, concerned = problem.runs[longest], np.flatnonzero(problem.concerns[longest]).tolist()
    shared = [i for i in concerned if problem.sought[i].log is None and not problem.sought[i].nuisance]
    apart = [i for i in concerned if i not in shared]
    if not (asked := [k for k in shared if k in open_]):
        return {}
    base = J.T @ J
    before = covariance(base)
    moves = _moves(problem, u, J, before, asked)
    gain_of: dict[str, Array] = {}
    for words, other in [("", run), *candidates(problem, run)]:
        gained = _information(problem, u, other, shared, apart, moves)
        if gained is not None:
            information, differences = gained
            more = base.copy()
            more[np.ix_(shared, shared)] += information
            linear = np.sqrt(np.diag(before) / np.diag(covariance(more)))[asked]
            gain_of[words] = np.fmin(linear, np.sqrt(1 + differences))
    if "" not in gain_of:
        return {}
    texts: dict[int, str] = {}
    for n, k in enumerate(asked):
        gains = {words: float(gain[n]) for words, gain in gain_of.items()}
        repeated = gains.pop("")
        good = sorted((g, w) for w, g in gains.items() if g > _BETTER * repeated)[::-1][:2]
        text = "; or ".join(f"{w} (its deviation would fall {_times(g)})" for g, w in good)
        again = f"record {run.name} again {text}; the same recording once more: {_times(repeated)}"
        texts[k] = again if good else _NONE
    return texts


def _times(gain: float) -> str:
    """A gain in words; of a deviation that falls further the old one is too large for its linearization to tell the factor."""
    return f"{gain:.2g} times" if gain < _LINEAR else f"more than {_LINEAR:g} times"


def _moves(problem: MachineProblem, u: Array, J: Array, before: Array, asked: list[int]) -> Array:
    """For each coordinate asked for, a row: the way to its second machine.

    That coordinate moves by its deviation, within the bounds; the others keep the residuals as they are.
    """
    moves = (before[:, asked] / np.sqrt(np.diag(before)[asked])).T
    both = np.stack([moves, -moves])
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.where(both > 0, (problem.high - u) / both, np.where(both < 0, (problem.low - u) / both, np.inf))
    part, rows = np.clip(room.min(axis=2), 0.0, 1.0), np.arange(len(asked))
    side = np.argmax(part, axis=0)
    moves = part[side, rows, None] * both[side, rows]
    at_fit = problem.residuals(u[None])
    for _ in range(_CORRECTIONS):
        changes = problem.residuals(problem.repaired(u + moves)) - at_fit
        for k, move, change in zip(asked, moves, changes, strict=True):
            others = np.arange(len(u)) != k
            if np.isfinite(change).all():
                move[others] -= np.linalg.lstsq(J[:, others], change, rcond=_SINGULAR)[0]
    return np.asarray(problem.repaired(u + moves) - u)


def _information(
    problem: MachineProblem, u: Array, run: RecordedRun, shared: list[int], apart: list[int], moves: Array
) -> tuple[Array, Array] | None:
    """J^T J of one recording for the shared coordinates, and how far each move changes it; None if the simulation fails.

    ``apart``: coordinates of the recording alone, which a further one has anew. They are eliminated: with them known, the
    same recording once more would narrow an interval by more than the root of 2.

    The change by a move is the sum of the squared differences of the outputs, by their noise.
    """
    concerned = [*shared, *apart]
    sought, point = [problem.sought[i] for i in concerned], u[concerned]
    noise = dict.fromkeys((t.column for t in run.targets), 1.0) | problem.noise
    single = MachineProblem([run], sought, noise, threads=problem.threads)
    try:
        r, J = single.slopes(point[None], 10 * STEP)
        moved = single.residuals(single.repaired(point + moves[:, concerned])) - r
    except InputError:
        return None
    if not np.isfinite(r).all() or not np.isfinite(J).all():
        return None
    information, differences = np.zeros((len(point), len(point))), np.zeros(len(moves))
    for _, target, rows in single.pieces:
        scale = 1.0
        if target.column not in problem.noise:  # a sensor that is not installed yet
            size = _NOISE * float(np.std(r[0, rows]))
            scale = 1 / size if size > 0 else 0.0
        slopes = scale * J[0, rows]
        information += slopes.T @ slopes
        differences += np.sum((scale * moved[:, rows]) ** 2, axis=1)
    n = len(shared)
    between = information[:n, n:]
    own = information[:n, :n] - between @ np.linalg.pinv(information[n:, n:], hermitian=True) @ between.T
    return np.asarray(own), differences


def candidates(problem: MachineProblem, run: RecordedRun) -> Iterator[tuple[str, RecordedRun]]:
    """Candidates: this recording with another load, a larger, smaller, slower or faster drive, or one more column."""
    yield from islice(_changed(problem, run), _MOST)
    there = {t.column for t in run.targets}
    for column in run.scenario.system.columns:
        if column.name not in there and column.name.endswith((".y", ".i", ".torque")) and run.targets:
            t = run.targets[0].t
            extra = Channel(column.name, t, np.zeros(len(t)))
            yield f"with {column.name} measured too", replace(run, targets=[*run.targets, extra])


def _changed(problem: MachineProblem, run: RecordedRun) -> Iterator[tuple[str, RecordedRun]]:
    """The recording with each change that the machine can take."""
    for words, changes in [*_loads(problem, run), *_drives(problem, run)]:
        try:
            yield words, replace(run, scenario=run.scenario.with_changes(changes))
        except InputError:
            continue


def _loads(problem: MachineProblem, run: RecordedRun) -> Iterator[tuple[str, dict[str, object]]]:
    """Numbers that can differ in a further recording: masses and loads."""
    for path in run.scenario.places:
        section, _, *rest = path.split(".")
        if path in paths(problem.sought) or section not in ("bodies", "loads") or not {*rest[:1]} & {*_LOADS}:
            continue
        if now := number_at(run.scenario, path):
            for factor in (2.0, 0.5):
                yield f"with {path} = {factor * now:.3g} (it is {now:.3g})", {path: factor * now}


def _drives(problem: MachineProblem, run: RecordedRun) -> Iterator[tuple[str, dict[str, object]]]:
    """The recording with a changed amplitude or speed of its drives."""
    for use in run.scenario.elements.signals:
        table = entry_at(run.scenario.data, use.path)
        if not isinstance(table, dict) or problem.of_guide(use.path):
            continue
        name = use.path.removesuffix(".signal")
        for factor, words in ((2.0, "twice"), (0.5, "half")):
            for key in ("value", "amplitude"):
                if key in table:
                    yield f"with {words} the drive of {name}", {f"{use.path}.{key}": _scaled(table[key], factor)}
        key, power = ("t", 1.0) if "t" in table else ("frequency", -1.0)
        for factor, words in ((2.0, "half as fast"), (0.5, "twice as fast")):
            if key in table:
                change = {f"{use.path}.{key}": _scaled(table[key], factor**power)}
                yield f"with the drive of {name} {words}", change


def _scaled(x: float | list[float], factor: float) -> object:
    return [factor * each for each in x] if isinstance(x, list) else factor * x
