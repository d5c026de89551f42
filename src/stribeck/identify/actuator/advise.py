"""Advises which further recording would identify the open parameters.

Each candidate is simulated. Its information is J^T J, with the derivatives J of its outputs by the parameters.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.identify.actuator.coordinates import paths
from stribeck.identify.actuator.estimate import BestPoint
from stribeck.identify.actuator.problem import STEP, MachineProblem
from stribeck.identify.actuator.runs import Compared, RecordedRun

_BETTER = 1.3  # times narrower interval than from a repeated recording: a smaller gain is not worth an experiment
_LINEAR = 10.0  # times: an interval that shrinks by more spanned most of what was searched
_MOST = 28  # simulated candidates
_NOISE = 0.01  # of a column's changes: assumed noise of a sensor that is not installed yet
_LOADS = ("mass", "inertia", "amplitude")


def experiments(best: BestPoint, J: Array, open_: list[int]) -> dict[int, str]:
    """For each open coordinate the recording that would identify it, in words; ``J``: the fit's Jacobian."""
    if not open_:
        return {}
    problem = best.problem
    longest = max(range(len(problem.runs)), key=lambda k: problem.runs[k].scenario.end)
    run, own = problem.runs[longest], np.flatnonzero(problem.concerns[longest]).tolist()
    shared = [i for i in own if problem.sought[i].log is None and not problem.sought[i].nuisance]
    base = J.T @ J
    tried: list[tuple[str, Array]] = []
    for words, other in [("", run), *candidates(best, run)]:
        found = _information(best, other, shared, [i for i in own if i not in shared])
        if found is not None:
            tried.append((words, found))
    if not tried or tried[0][0]:
        return {}
    told: dict[int, str] = {}
    before = _deviations(base)
    again = _deviations(_added(base, tried[0][1], shared))
    for k in open_:
        if k not in shared:
            continue
        gains = [(before[k] / _deviations(_added(base, A, shared))[k], words) for words, A in tried[1:]]
        repeated = before[k] / again[k]
        good = sorted((g, w) for g, w in gains if g > _BETTER * repeated)[::-1][:2]
        if good:
            text = "; or ".join(f"{w} (its deviation would fall {_times(g)})" for g, w in good)
            told[k] = f"record {run.name} again {text}; the same recording once more would make it {_times(repeated)}"
        else:
            told[k] = (
                "none of the recordings that were tried on paper (other loads, drives, speeds, sensors) would tell it"
            )
    return told


def _times(gain: float) -> str:
    """A gain in words; of a deviation that falls further the old one is too large for its linearization to tell the factor."""
    return f"{gain:.2g} times" if gain < _LINEAR else f"more than {_LINEAR:g} times"


def _deviations(A: Array) -> Array:
    size = np.sqrt(np.maximum(np.diag(A), 1e-30))
    values, vectors = np.linalg.eigh(A / np.outer(size, size))
    return np.asarray(np.sqrt(np.sum(vectors**2 / np.maximum(values, 1e-12), axis=1)) / size)


def _added(base: Array, more: Array, at: list[int]) -> Array:
    found = base.copy()
    found[np.ix_(at, at)] += more
    return found


def _information(best: BestPoint, run: RecordedRun, shared: list[int], apart: list[int]) -> Array | None:
    """J^T J of one recording for the shared coordinates; None if the simulation fails.

    ``apart``: coordinates of the recording alone, which a further one has anew. They are eliminated: with them known, the
    same recording once more would narrow an interval by more than the root of 2.
    """
    problem = best.problem
    sought = [problem.sought[i] for i in (*shared, *apart)]
    u = best.u[[*shared, *apart]]
    noise = dict(problem.noise)
    for target in run.targets:
        if target.column not in noise:
            noise[target.column] = 1.0
    own = MachineProblem([run], sought, noise, threads=problem.threads)
    try:
        r, J = own.slopes(u[None], np.full(len(u), 10 * STEP))
    except InputError:
        return None
    if not np.isfinite(r).all() or not np.isfinite(J).all():
        return None
    found, at = np.zeros((len(u), len(u))), 0
    for target in run.targets:
        rows = J[0, at : at + len(target.t)]
        if target.column not in problem.noise:  # a sensor that is not installed yet
            size = float(np.std(r[0, at : at + len(target.t)]))
            rows = rows / (_NOISE * size) if size > 0 else 0 * rows
        found += rows.T @ rows
        at += len(target.t)
    n = len(shared)
    return np.asarray(found[:n, :n] - found[:n, n:] @ np.linalg.pinv(found[n:, n:], hermitian=True) @ found[n:, :n])


def candidates(best: BestPoint, run: RecordedRun) -> Iterator[tuple[str, RecordedRun]]:
    """Candidates: this recording with another load, a larger, smaller, slower or faster drive, or one more column."""
    count = 0
    for words, changes in [*_loads(best, run), *_drives(run)]:
        if count >= _MOST:
            return
        try:
            yield words, replace(run, scenario=run.scenario.with_changes(changes))
            count += 1
        except InputError:
            continue
    there = {t.column for t in run.targets}
    for column in run.scenario.system.columns:
        if column.name not in there and column.name.endswith((".y", ".i", ".torque")) and run.targets:
            t = run.targets[0].t
            extra = Compared(column.name, t, np.zeros(len(t)))
            yield f"with {column.name} measured too", replace(run, targets=[*run.targets, extra])


def _loads(best: BestPoint, run: RecordedRun) -> Iterator[tuple[str, dict[str, object]]]:
    """Numbers that can differ in a further recording: those that differ between recordings, masses and loads."""
    sought = paths(best.problem.sought)
    places = run.scenario.places
    for path in places:
        last = path.split(".")
        if path in sought or last[0] not in ("bodies", "loads") or not any(word in _LOADS for word in last[2:3]):
            continue
        now = _value(run.scenario.data, path)
        if now is None or not now:
            continue
        for factor in (2.0, 0.5):
            yield f"with {path} = {factor * now:.3g} (it is {now:.3g})", {path: factor * now}


def _drives(run: RecordedRun) -> Iterator[tuple[str, dict[str, object]]]:
    """The recording with a changed amplitude or speed of its drives."""
    for use, signal in run.scenario.elements.signals.items():
        table = _table(run.scenario.data, use.path)
        if table is None:
            continue
        name = use.path.removesuffix(".signal")
        for factor, words in ((2.0, "twice"), (0.5, "half")):
            for key in ("value", "amplitude"):
                if key in table:
                    x = table[key]
                    new = [factor * each for each in x] if isinstance(x, list) else factor * x
                    yield f"with {words} the drive of {name}", {f"{use.path}.{key}": new}
        for factor, words in ((2.0, "half as fast"), (0.5, "twice as fast")):
            if "t" in table:
                yield f"with the drive of {name} {words}", {f"{use.path}.t": [factor * each for each in table["t"]]}
            elif signal.kind == "sine":
                new = table["frequency"] / factor
                yield f"with the drive of {name} {words}", {f"{use.path}.frequency": new}


def _table(data: object, path: str) -> Any:
    for word in path.split("."):
        data = data.get(word) if isinstance(data, dict) else None
    return data


def _value(data: object, path: str) -> float | None:
    for word in path.split("."):
        if isinstance(data, dict):
            data = data.get(word)
        elif isinstance(data, list) and word.isdigit() and int(word) < len(data):
            data = data[int(word)]
        else:
            return None
    return float(data) if isinstance(data, int | float) else None
