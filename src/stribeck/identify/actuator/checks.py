"""Detects errors in a recording: gaps, an early end, units, signs, clocks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import chain

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.bridges import GAP
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.estimate import POOR
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Channel, Logs, Recording
from stribeck.identify.actuator.residuals import leftovers
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.actuator.solve import search
from stribeck.scenario import Scenario

_SHORT = 0.7  # of the typical length: a shorter recording may be truncated
_TAIL = 0.02
_REPEATS, _SELDOM = 10, 0.1  # least number of equal samples in a row; largest share of repeated samples elsewhere
_FACTORS = {
    -1.0: "the other sign", np.pi / 180: "degrees", 180 / np.pi: "radians, not degrees", 1e-3: "thousandths",
    1e3: "thousands", np.pi / 30: "revolutions per minute", 2 * np.pi: "revolutions",
}  # fmt: skip
_LIKE = 0.1  # of a unit factor: tolerance within which a measured factor is taken for it
_CLOCK = 0.05
_STEPS, _ROUGHLY = 10, 1e-3  # of a search that only decides whether the machine describes a recording
_FOLLOWED = 0.1  # of its changes: with a larger residual, a recording gives no evidence of its units
_TRIED = 6  # recordings that are fitted individually


def before(logs: Logs, scenario: Scenario) -> list[str]:
    """Errors that the recordings show without a fit."""
    found: list[str] = []
    lengths = [float(r.t[-1]) for r in logs.recordings]
    for i, (r, length) in enumerate(zip(logs.recordings, lengths, strict=True)):
        found += [*r.notes, *_gaps(r), *_tails(r), *_rates(r)]
        typical = float(np.median([*lengths[:i], *lengths[i + 1 :]] or lengths))
        if len(lengths) > 1 and length < _SHORT * typical:
            found.append(f"{r.file}: ends at {length:.4g} s, the others at about {typical:.4g} s: was it cut short?")
    if (longest := max(lengths)) < _SHORT * scenario.solve.t_end:
        which = logs.recordings[0].file if len(lengths) == 1 else "all recordings"
        ends = "ends at" if len(lengths) == 1 else "end by"
        found.append(
            f"{which}: {ends} {longest:.4g} s, and the machine's t_end is {scenario.solve.t_end:g} s: cut short?"
        )
    return found


def _gaps(r: Recording) -> list[str]:
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


def _tails(r: Recording) -> list[str]:
    """Columns with empty cells, and columns that end before the others."""
    found = []
    for name, c in chain(r.outputs.items(), r.inputs.items()):
        good = np.isfinite(c.x) & np.isfinite(c.t)
        last, empty = float(c.t[good][-1]), int((~good).sum())
        if last < (1 - _TAIL) * r.t[-1]:
            found.append(
                f"{r.file}: {name}: column {c.column!r} ends at {last:.4g} s, the recording at {r.t[-1]:.4g} s: cut short?"
            )
        elif empty:
            found.append(f"{r.file}: {name}: column {c.column!r} has {empty} empty cells, which are left out")
        if len(np.unique(c.x[good])) == 1 and name in r.outputs:
            found.append(f"{r.file}: {name}: column {c.column!r} never changes")
        elif name in r.outputs and (stood := _stood(c.t[good], c.x[good])):
            found.append(
                f"{r.file}: {name}: column {c.column!r} repeats one value from {stood[0]:.4g} to {stood[1]:.4g} s, and "
                "changes with each sample elsewhere: did its source stop?"
            )
    return found


def _stood(t: Array, x: Array) -> tuple[float, float] | None:
    """The times between which a column is constant, if nearly each sample changes elsewhere."""
    same = np.diff(x) == 0
    edges = np.flatnonzero(np.diff(np.concatenate([[False], same, [False]])))
    begin, end = edges[::2], edges[1::2]
    if not len(begin) or (longest := int((end - begin).max())) < _REPEATS:
        return None
    i = int(np.argmax(end - begin))
    if np.sum(same) - longest > _SELDOM * (len(same) - longest):
        return None
    return float(t[begin[i]]), float(t[end[i]])


def _rates(r: Recording) -> list[str]:
    """Contradictions between a measured speed and the derivative of the measured position."""
    found = []
    for name, c in r.outputs.items():
        body, _, what = name.rpartition(".")
        position = r.outputs.get(f"{body}.y")
        if what != "v" or position is None:
            continue
        factor = _factor_between(position, c)
        if factor is not None:
            found.append(
                f"{r.file}: {name}: column {c.column!r} is {factor[0]:.4g} times the rate of {position.column!r}"
                + (f": is one of them in {factor[1]}?" if factor[1] != _FACTORS[-1.0] else ": is the sign wrong?")
            )
    return found


def _factor_between(y: Channel, v: Channel) -> tuple[float, str] | None:
    good, also = np.isfinite(y.x), np.isfinite(v.x)
    if good.sum() < 30 or also.sum() < 30:
        return None
    t = np.linspace(max(y.t[good][0], v.t[also][0]), min(y.t[good][-1], v.t[also][-1]), 60)
    moved = np.diff(np.interp(t, y.t[good], y.x[good]))
    area = np.concatenate([[0.0], np.cumsum(np.diff(v.t[also]) * 0.5 * (v.x[also][1:] + v.x[also][:-1]))])
    sum_ = np.diff(np.interp(t, v.t[also], area))
    if not (moved @ moved) > 0 or abs(np.corrcoef(moved, sum_)[0, 1]) < 0.9:
        return None
    ratio = float(moved @ sum_ / (moved @ moved))
    for factor, words in _FACTORS.items():
        for known in (factor, 1 / factor):
            if known != 1 and abs(ratio / known - 1) < _LIKE:
                return ratio, words
    return None


Runs = list[RecordedRun]


def _alone(whole: MachineProblem, runs: Runs) -> tuple[float, list[MachineCoordinate], dict[str, float]]:
    """The relative residual of one recording fitted alone, the coordinates of this fit, and their values."""
    log, pieces = runs[0].log, {run.piece for run in runs}
    sought = [c for c in whole.sought if c.log in (None, log) and (not c.nuisance or c.piece in pieces)]
    problem = MachineProblem(runs, sought, whole.noise)
    left, u = _left(problem, None, {})
    return left, sought, problem.values(u)


def hypotheses(whole: MachineProblem) -> list[str]:
    """Changes with which the machine would describe its recordings: other units, the other sign, another clock.

    Each recording is fitted alone, and the columns of the worst one are tested.
    """
    of_log: dict[int, Runs] = {}
    for each in whole.runs:
        of_log.setdefault(each.log, []).append(each)
    parts = [sorted(runs, key=lambda each: each.scenario.end)[:_TRIED] for runs in of_log.values()]
    recordings = sorted(parts, key=lambda each: sum(run.scenario.end for run in each))[:_TRIED]
    alone = [_alone(whole, each) for each in recordings]
    k = int(np.argmax([left for left, _, _ in alone]))
    runs, (now, sought, _) = recordings[k], alone[k]
    told, least = [], min(alone, key=lambda each: each[0])
    values = least[2] if least[0] <= POOR else {}  # values from a described recording may suit the others
    names = [each[0].name for each in recordings]
    bad = [name for name, each in zip(names, alone, strict=True) if each[0] > POOR]
    if len(names) > 1 and bad != names:
        others = ", ".join(bad) if bad else ""
        told.append(
            f"each recording by itself: {others} cannot be followed, the others can" if bad else
            "each recording can be followed by itself, but not all with the same numbers: is a unit, a load (known) or "
            "the unit of an input other in one of them?"
        )  # fmt: skip
    return [*told, *_columns_tried(whole, runs, sought, now, values)]


def _columns_tried(
    whole: MachineProblem, runs: Runs, sought: list[MachineCoordinate], now: float, values: dict[str, float]
) -> list[str]:
    """The change of a column with which the machine describes the recording, if there is one."""
    found: list[tuple[float, str]] = []
    for target in runs[0].targets:
        for factor, words in _FACTORS.items():
            left = _tried(
                [_scaled(run, target.column, factor) for run in runs], sought, whole, factor, target.column, values
            )
            found.append((left, f"{target.column}: with its column times {factor:.4g} ({words})"))
        clock = MachineCoordinate(
            f"outputs.{target.column}.clock", -_CLOCK, _CLOCK, 0.0, None, {}, (target.column, "clock")
        )
        left = _left(MachineProblem(runs, [*sought, clock], whole.noise), 6, values)[0]
        found.append((left, f"{target.column}: with a clock of its own (outputs.{target.column}.clock sought)"))
    for path, other, factor in _inputs_scaled(runs):
        words = f"{path}: with its column times {factor:.4g} ({_FACTORS[factor]})"
        found.append((_left(MachineProblem(other, sought, whole.noise), 6, values)[0], words))
    left, words = min(found)
    if left < 0.5 * now and left < _FOLLOWED:
        return [
            f"{words}, {runs[0].name} would be followed to {100 * left:.2g} % of its changes: look at that column and its unit"
        ]
    return []


def _inputs_scaled(runs: Runs) -> Iterator[tuple[str, Runs, float]]:
    """The recording with one input in other units. The other sign is not tried: it equals that of an output."""
    for path in runs[0].inputs:
        for factor in (1e-3, 1e3, np.pi / 180):
            scaled = [(run, replace(run.inputs[path], x=factor * run.inputs[path].x)) for run in runs]
            yield path, [run.driven({path: x}) for run, x in scaled], factor


def _scaled(run: RecordedRun, column: str, factor: float) -> RecordedRun:
    targets = [replace(t, x=t.x * factor) if t.column == column else t for t in run.targets]
    body = column.removesuffix(".y")
    start = {p: x * factor if p.startswith(f"bodies.{body}.") else x for p, x in run.start.items()}
    return replace(run, targets=targets, start=start)


def _tried(
    runs: Runs, sought: list[MachineCoordinate], whole: MachineProblem, factor: float, column: str,
    values: dict[str, float],
) -> float:  # fmt: skip
    """The relative residual of the columns with one of them scaled."""
    own = []
    for c in sought:
        if c.nuisance and column.removesuffix(".y") in c.name:
            ends = sorted((c.low * factor, c.high * factor))
            c = replace(c, low=ends[0], high=ends[1], start=None if c.start is None else c.start * factor)
        own.append(c)
    noise = {n: x * abs(factor) if n == column else x for n, x in whole.noise.items()}
    return _left(MachineProblem(runs, own, noise), 6, values)[0]


def _left(problem: MachineProblem, starts: int | None, values: dict[str, float]) -> tuple[float, Array]:
    """The largest relative residual of a column after a search from these values and other starts, and its point."""
    shared = {c.name: values[c.name] for c in problem.sought if c.log is None and c.name in values}
    found = search(problem, starts or 4, 0, problem.point(shared), steps=_STEPS, small=_ROUGHLY)
    return max((left / size if size else np.inf) for left, size in leftovers(problem, found.u).values()), found.u
