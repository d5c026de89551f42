"""Detects errors in a recording: gaps, columns that end early, units, signs, clocks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain

import numpy as np

from stribeck.identify.actuator.bridges import GAP
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.guided import FOLLOWED
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Channel, Logs, Recording
from stribeck.identify.actuator.residuals import leftovers
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.actuator.solve import ROUGH_STEPS, search
from stribeck.identify.core.judging import EXPLAINED
from stribeck.identify.data.quality import ratio_of_ways

_TAIL = 0.02  # of a recording that a column may lack at its end: a filter's delay, or a slower sensor's last sample
_FACTORS = {
    -1.0: "the other sign", np.pi / 180: "degrees", 180 / np.pi: "radians, not degrees", 1e-3: "thousandths",
    1e3: "thousands", np.pi / 30: "revolutions per minute", 2 * np.pi: "revolutions",
}  # fmt: skip
_OF_INPUTS = (1e-3, 1e3, np.pi / 180)  # the other sign of an input equals that of an output
_LIKE = 0.1  # of a unit factor: tolerance within which a measured factor is taken for it
_CLOCK = 0.05  # s/s: the bound of a clock that drifts; a larger error is a unit of time
_ROUGHLY = 1e-3  # relative reduction of the cost: the search only decides whether the machine describes a recording
_STARTS, _COMPARED = 4, 6  # of a search with the recording as it is; with a changed column, whose numbers lie farther
_TRIED = 6  # recordings that are fitted individually


def before(logs: Logs) -> list[str]:
    """Errors that the recordings show without a fit."""
    return [note for r in logs.recordings for note in (*r.notes, *_gaps(r), *_tails(r), *_rates(r))]


def _gaps(r: Recording) -> list[str]:
    """Missing samples."""
    gaps = np.diff(r.t)
    step = float(np.median(gaps))
    long = gaps > GAP * step
    if not long.any():
        return []
    missing = int(np.sum(np.rint(gaps[long] / step) - 1))
    at = float(r.t[:-1][long][0])
    return [
        f"{r.file}: {missing} samples are missing in {int(long.sum())} gaps (first after {at:.4g} s, longest "
        f"{gaps.max():.3g} s); inputs cross them smoothly, and nothing is compared there"
    ]


def _tails(r: Recording) -> Iterator[str]:
    """Columns with empty cells, columns that end before the others, and columns that never change."""
    for name, c in chain(r.outputs.items(), r.inputs.items()):
        good = np.isfinite(c.x) & np.isfinite(c.t)
        last, empty = float(c.t[good][-1]), int((~good).sum())
        place = f"{r.file}: {name}: column {c.column!r}"
        if last < (1 - _TAIL) * r.t[-1]:
            yield f"{place} ends at {last:.4g} s, the recording at {r.t[-1]:.4g} s: cut short?"
        elif empty:
            yield f"{place} has {empty} empty cells, which are left out"
        if name in r.outputs and not np.ptp(c.x[good]) > 0:
            yield f"{place} never changes"


def _rates(r: Recording) -> Iterator[str]:
    """Contradictions between a measured speed and the derivative of the measured position."""
    for name, c in r.outputs.items():
        body, _, what = name.rpartition(".")
        position = r.outputs.get(f"{body}.y")
        if what != "v" or position is None or (ratio := _ratio_of_rates(position, c)) is None:
            continue
        for factor, words in _FACTORS.items():
            if any(known != 1 and abs(ratio / known - 1) < _LIKE for known in (factor, 1 / factor)):
                doubt = "is the sign wrong?" if factor == -1.0 else f"is one of them in {words}?"
                yield f"{r.file}: {name}: column {c.column!r} is {ratio:.4g} times the rate of {position.column!r}: {doubt}"
                break


def _ratio_of_rates(y: Channel, v: Channel) -> float | None:
    """The factor between a speed and the rate of a position, if they are one motion."""
    good, also = np.isfinite(y.x), np.isfinite(v.x)
    if good.sum() < 30 or also.sum() < 30:
        return None
    t = np.linspace(max(y.t[good][0], v.t[also][0]), min(y.t[good][-1], v.t[also][-1]), 60)
    moved = np.diff(np.interp(t, y.t[good], y.x[good]))
    area = np.concatenate([[0.0], np.cumsum(np.diff(v.t[also]) * 0.5 * (v.x[also][1:] + v.x[also][:-1]))])
    integral = np.diff(np.interp(t, v.t[also], area))
    return ratio_of_ways(moved, integral)


Runs = list[RecordedRun]


def hypotheses(whole: MachineProblem) -> list[str]:
    """Changes with which the machine would describe its recordings: other units, the other sign, another clock.

    Each recording is fitted alone, and the columns of the worst one are tested.
    """
    of_log: dict[int, Runs] = {}
    for run in whole.runs:
        of_log.setdefault(run.log, []).append(run)
    parts = [sorted(runs, key=lambda run: run.scenario.end)[:_TRIED] for runs in of_log.values()]
    recordings = sorted(parts, key=lambda runs: sum(run.scenario.end for run in runs))[:_TRIED]
    alone = []
    for runs in recordings:
        pieces = {run.piece for run in runs}
        sought = [c for c in whole.sought if c.log in (None, runs[0].log) and (not c.nuisance or c.piece in pieces)]
        problem = MachineProblem(runs, sought, whole.noise)
        alone.append((*_left(problem, _STARTS, {}), problem))
    worst, least = (pick(alone, key=lambda each: each[0]) for pick in (max, min))
    values = least[1] if least[0] <= EXPLAINED else {}  # values from a described recording may suit the others
    notes, names = [], [runs[0].name for runs in recordings]
    bad = [name for name, (left, *_) in zip(names, alone, strict=True) if left > EXPLAINED]
    if len(names) > 1 and not bad:
        notes.append(
            "each recording can be followed by itself, but not all with the same numbers: is a unit, a load (known) or "
            "the unit of an input other in one of them?"
        )
    elif len(names) > 1 and bad != names:
        notes.append(f"each recording by itself: {', '.join(bad)} cannot be followed, the others can")
    left, words = min((_left(problem, _COMPARED, values)[0], words) for words, problem in _changed(worst[2]))
    if left < 0.5 * worst[0] and left < FOLLOWED:
        name = worst[2].runs[0].name
        notes.append(
            f"{words}, {name} would be followed to {100 * left:.2g} % of its changes: look at that column and its unit"
        )
    return notes


def _left(problem: MachineProblem, starts: int, values: Mapping[str, float]) -> tuple[float, dict[str, float]]:
    """The largest relative residual of a column after a search from these values and other starts, and its values."""
    shared = {c.name: values[c.name] for c in problem.sought if c.log is None and c.name in values}
    solution = search(problem, problem.point(shared), starts, steps=ROUGH_STEPS, small=_ROUGHLY)
    left = max((left / size if size else np.inf) for left, size in leftovers(problem, solution.u).values())
    return left, problem.values(solution.u)


def _changed(problem: MachineProblem) -> Iterator[tuple[str, MachineProblem]]:
    """The problem of a recording with one column in other units, or with a clock of its own, in words."""
    runs = problem.runs
    for target in runs[0].targets:
        column = target.column
        for factor, unit in _FACTORS.items():
            yield f"{column}: with its column times {factor:.4g} ({unit})", _scaled(problem, column, factor)
        path = f"outputs.{column}.clock"
        clock = MachineCoordinate(path, -_CLOCK, _CLOCK, 0.0, None, {}, (column, "clock"))
        text = f"{column}: with a clock of its own ({path} sought)"
        yield text, MachineProblem(runs, [*problem.sought, clock], problem.noise)
    for path in runs[0].inputs:
        for factor in _OF_INPUTS:
            scaled = [(run, replace(run.inputs[path], x=factor * run.inputs[path].x)) for run in runs]
            changed = [run.driven({path: x}) for run, x in scaled]
            text = f"{path}: with its column times {factor:.4g} ({_FACTORS[factor]})"
            yield text, MachineProblem(changed, problem.sought, problem.noise)


def _scaled(problem: MachineProblem, column: str, factor: float) -> MachineProblem:
    """The problem with a measured column times a factor, and with initial states that follow it."""
    body, runs, sought = column.removesuffix(".y"), [], []
    for run in problem.runs:
        targets = [replace(t, x=t.x * factor) if t.column == column else t for t in run.targets]
        start = {p: x * factor if p.startswith(f"bodies.{body}.") else x for p, x in run.start.items()}
        runs.append(replace(run, targets=targets, start=start))
    for c in problem.sought:
        if c.nuisance and body in c.name:
            low, high = sorted((c.low * factor, c.high * factor))
            c = replace(c, low=low, high=high, start=None if c.start is None else c.start * factor)
        sought.append(c)
    noise = {n: x * abs(factor) if n == column else x for n, x in problem.noise.items()}
    return MachineProblem(runs, sought, noise)
