"""Advises which further recording would identify the open parameters.

Each candidate is simulated. Its information is J^T J, with the derivatives J of its outputs by the parameters.
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
from stribeck.scenario.changes import entry_at

_BETTER = 1.3  # times narrower interval than from a repeated recording: a smaller gain is not worth an experiment
_LINEAR = 10.0  # times: an interval that shrinks by more spanned most of what was searched
_MOST = 28  # simulated candidates: all changes of seven drives
_NOISE = 0.01  # of a column's changes: assumed noise of a sensor that is not installed yet
_LOADS = ("mass", "inertia", "amplitude")
_NONE = "none of the recordings that were tried on paper (other loads, drives, speeds, sensors) would tell it"


def experiments(problem: MachineProblem, u: Array, J: Array, open_: list[int]) -> dict[int, str]:
    """For each open coordinate the recording that would identify it, in words; ``J``: the fit's Jacobian."""
    if not open_:
        return {}
    longest = max(range(len(problem.runs)), key=lambda k: problem.runs[k].scenario.end)
    run, concerned = problem.runs[longest], np.flatnonzero(problem.concerns[longest]).tolist()
    shared = [i for i in concerned if problem.sought[i].log is None and not problem.sought[i].nuisance]
    apart = [i for i in concerned if i not in shared]
    base = J.T @ J
    deviations: dict[str, Array] = {}
    for words, other in [("", run), *candidates(problem, run)]:
        information = _information(problem, u, other, shared, apart)
        if information is not None:
            more = base.copy()
            more[np.ix_(shared, shared)] += information
            deviations[words] = _deviations(more)
    if "" not in deviations:
        return {}
    before, texts = _deviations(base), dict[int, str]()
    for k in set(open_) & set(shared):
        gains = {words: before[k] / after[k] for words, after in deviations.items()}
        repeated = gains.pop("")
        good = sorted((g, w) for w, g in gains.items() if g > _BETTER * repeated)[::-1][:2]
        text = "; or ".join(f"{w} (its deviation would fall {_times(g)})" for g, w in good)
        again = f"record {run.name} again {text}; the same recording once more would make it {_times(repeated)}"
        texts[k] = again if good else _NONE
    return texts


def _times(gain: float) -> str:
    """A gain in words; of a deviation that falls further the old one is too large for its linearization to tell the factor."""
    return f"{gain:.2g} times" if gain < _LINEAR else f"more than {_LINEAR:g} times"


def _deviations(A: Array) -> Array:
    """The standard deviations from a matrix of information, which may be singular."""
    size = np.sqrt(np.maximum(np.diag(A), 1e-30))
    values, vectors = np.linalg.eigh(A / np.outer(size, size))
    return np.asarray(np.sqrt(np.sum(vectors**2 / np.maximum(values, 1e-12), axis=1)) / size)


def _information(
    problem: MachineProblem, u: Array, run: RecordedRun, shared: list[int], apart: list[int]
) -> Array | None:
    """J^T J of one recording for the shared coordinates; None if the simulation fails.

    ``apart``: coordinates of the recording alone, which a further one has anew. They are eliminated: with them known, the
    same recording once more would narrow an interval by more than the root of 2.
    """
    sought, point = [problem.sought[i] for i in (*shared, *apart)], u[[*shared, *apart]]
    noise = dict.fromkeys((t.column for t in run.targets), 1.0) | problem.noise
    single = MachineProblem([run], sought, noise, threads=problem.threads)
    try:
        r, J = single.slopes(point[None], np.full(len(point), 10 * STEP))
    except InputError:
        return None
    if not np.isfinite(r).all() or not np.isfinite(J).all():
        return None
    information = np.zeros((len(point), len(point)))
    for _, target, rows in single.pieces:
        slopes = J[0, rows]
        if target.column not in problem.noise:  # a sensor that is not installed yet
            size = float(np.std(r[0, rows]))
            slopes = slopes / (_NOISE * size) if size > 0 else 0 * slopes
        information += slopes.T @ slopes
    n = len(shared)
    between = information[:n, n:]
    return np.asarray(information[:n, :n] - between @ np.linalg.pinv(information[n:, n:], hermitian=True) @ between.T)


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
    for words, changes in [*_loads(problem, run), *_drives(run)]:
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


def _drives(run: RecordedRun) -> Iterator[tuple[str, dict[str, object]]]:
    """The recording with a changed amplitude or speed of its drives."""
    for use in run.scenario.elements.signals:
        table = entry_at(run.scenario.data, use.path)
        if not isinstance(table, dict):
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
