"""Estimates parameters from recordings: chooses the simulated stretches, the columns' weights and the starts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.continuation import continued
from stribeck.identify.actuator.coordinates import MachineCoordinate, paths
from stribeck.identify.actuator.drawn import carried
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.runs import RecordedRun, roughness, unshifted
from stribeck.identify.actuator.shooting import joined_stretches, relayed
from stribeck.identify.actuator.solve import Found, agreeing, half_squares, scanned, search
from stribeck.identify.actuator.starts import begun, stretches
from stribeck.identify.work import Stopped, Work
from stribeck.scenario import Scenario

POOR = 0.25  # of a column's changes: with a larger residual, the model does not describe the data
_FIRST = 0.05  # of a column's changes: initial value of the noise
_WEIGHTINGS = 8  # at most: each reduces the noise, and a poor start needs several
_SETTLED = 0.05
# Initial error, as a share of the position's changes; growth of this error above which the motion counts as unstable.
_OFF, _GROWN = 1e-6, 100.0
# Residual in units of the noise: 1.0 for white noise, to some hundredths. A larger one may be a local minimum, unless
# this many starts agree.
_DOUBTED, _AGREEING = 1.2, 3
_STRETCH = 12  # stretches per recording for the comparison of starts, if no recorded motion drives the machine
_SHORTEST = 0.2  # s
_ROUGH = 12  # steps of the search in stretches
_COMPUTED = 0.5  # standard deviations: largest move of an estimate by ten times the solver's error
_CAREFUL = 2  # points from which whole recordings are fitted part by part
_AS_WELL = 1.2  # times the residual of free stretches
_ENOUGH = 6  # recordings for the comparison of starts
_LOOSE = 1e-6  # rtol far from the optimum
FAR_STEP = 1e-3  # of a coordinate: step of the differences far from the optimum
_NEAR = 1e-4  # relative reduction of the cost below which a search far from the optimum ends
_MUCH = 3.0  # ratio of the residuals of whole recordings and stretches above which stretches are fitted
Keep = Callable[[dict[str, float], float], None]


@dataclass
class BestPoint:
    """The best point of a problem and its search; ``ended``: whether no further step reduces the cost."""

    problem: MachineProblem
    u: Array
    found: Found
    notes: list[str]
    windowed: bool
    ended: bool = True

    @property
    def stopped(self) -> bool:
        """Whether Ctrl-C ended it."""
        return self.found.stopped

    def values(self) -> dict[str, float]:
        """The parameters' values by name."""
        return self.problem.values(self.u)

    def missed(self) -> list[str]:
        """The columns that the fit does not describe, in words."""
        told = []
        for column, (left, size) in leftovers(self.problem, self.u).items():
            if not np.isfinite(left):
                told.append(f"{column}: cannot be simulated with the best numbers")
            elif left > max(POOR * size, 3 * floor_of(self.problem, column)):
                told.append(f"{column}: {100 * left / size if size else np.inf:.0f} % of its changes are left")
        return told


def beyond_noise(problem: MachineProblem, u: Array, agreeing: int) -> list[str]:
    """The columns whose residual exceeds their noise and the effect of input errors, in words.

    Empty if several starts agree on the minimum; otherwise there may be a better one.
    """
    if agreeing >= _AGREEING:
        return []
    least = {column: noise_of(problem, column) for column in problem.noise}
    more = {
        n: left for n, (left, _) in leftovers(problem, u).items() if least[n] > 0 and not left <= _DOUBTED * least[n]
    }
    if more and np.isfinite(list(more.values())).all():  # nan: the simulation fails there
        least = {n: float(np.hypot(least[n], x)) for n, x in carried(problem, u).items()}
    return [
        f"{n}: {left:.2g} is left, {left / least[n]:.3g} times the noise of what is measured"
        for n, left in more.items() if not left <= _DOUBTED * least[n]
    ]  # fmt: skip


def unstable(problem: MachineProblem, u: Array) -> bool:
    """Whether a small error of the initial state grows fast, as in an upright pendulum."""
    for k, run in enumerate(problem.runs):
        body = next((t.column for t in run.targets if t.column.endswith(".y")), None)
        if body is None or body not in {state.name for state in run.scenario.system.states}:
            continue
        off = _OFF * max(float(np.std(x)) for x in (t.x for t in run.targets if t.column == body))
        columns = problem.predicted(run, k, np.stack([u, u]), shift={body: np.array([0.0, off])})
        apart = max(
            float(np.max(abs(x[1] - x[0]))) for t, x in zip(run.targets, columns, strict=True) if t.column == body
        )
        if not apart <= _GROWN * off:
            return True
    return False


def beyond_solver(problem: MachineProblem, u: Array) -> list[str]:
    """A warning if ten times the solver's error could move an estimate by much of its standard deviation.

    Errors then grow so fast that the Jacobian over whole recordings is more sensitive than the solver is accurate.
    """
    runs = []
    for run in problem.runs:
        scenario = run.scenario.with_changes({"solve.rtol": min(10 * run.scenario.solve.rtol, 1e-3)})
        runs.append(replace(run, scenario=scenario))
    off = replace(problem, runs=runs).residuals(u[None])[0] - problem.residuals(u[None])[0]
    size = float(np.linalg.norm(off))  # bound of any estimate's move, in its standard deviations
    if size <= _COMPUTED:
        return []
    worst = max(range(len(runs)), key=lambda k: np.linalg.norm(off[problem.first[k] : problem.first[k + 1]]))
    return [
        f"{runs[worst].name}: the motion lets errors grow so fast that the solver's could move numbers by {size:.2g} of their "
        "deviations (chaotic, or unstable): nothing is identified (shorter recordings, or a smaller solve.rtol, may help)."
    ]


def leftovers(problem: MachineProblem, u: Array) -> dict[str, tuple[float, float]]:
    """By column: the rms residual, and the rms of the column's changes within a recording."""
    r = problem.residuals(u[None])[0]
    left: dict[str, list[Array]] = {}
    size: dict[str, list[Array]] = {}
    for k, run in enumerate(problem.runs):
        at = int(problem.first[k])
        for target in run.targets:
            left.setdefault(target.column, []).append(r[at : at + len(target.t)] * problem.noise[target.column])
            size.setdefault(target.column, []).append(target.x - target.x.mean())
            at += len(target.t)
    rms: Callable[[list[Array]], float] = lambda parts: float(np.sqrt(np.mean(np.concatenate(parts) ** 2)))  # noqa: E731
    return {name: (rms(parts), rms(size[name])) for name, parts in left.items()}


def noise_of(problem: MachineProblem, column: str) -> float:
    """The noise of a column, from its changes between samples."""
    rough = roughness([t.x for run in problem.runs for t in run.targets if t.column == column])
    return max(rough, floor_of(problem, column))


def floor_of(problem: MachineProblem, column: str) -> float:
    """The least noise of a column: its quantization noise."""
    steps = [
        np.diff(np.unique(t.x)).min(initial=np.inf) for run in problem.runs for t in run.targets if t.column == column
    ]
    least = min(steps, default=np.inf)
    return float(least / np.sqrt(12)) if np.isfinite(least) else 0.0


def first_noise(recordings: Sequence[Recording]) -> tuple[dict[str, float], set[str]]:
    """The initial value of each column's noise, and the columns whose noise is given."""
    found: dict[str, float] = {}
    given: set[str] = set()
    for column in dict.fromkeys(c for r in recordings for c in r.outputs):
        channels = [r.outputs[column] for r in recordings if column in r.outputs]
        told = [c.noise for c in channels if c.noise is not None]
        if told:
            found[column] = float(np.sqrt(np.mean(np.square(told))))
            given.add(column)
        else:
            size = float(np.sqrt(np.mean([np.nanvar(c.x) for c in channels])))
            found[column] = _FIRST * size if size > 0 else 1.0
    return found, given


def prepared(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], named: set[str], window: float | None = None,
    free: bool = True,
) -> tuple[list[RecordedRun], list[MachineCoordinate]]:  # fmt: skip
    """The runs, whole or in stretches, and the coordinates of their initial states.

    Without ``free``, the initial states are fixed at their estimates.
    """
    runs: list[RecordedRun] = []
    starts: list[MachineCoordinate] = []
    for log, recording in recordings:
        length = recording.window or window
        spans: list[tuple[float, float] | None] = [None]
        if length is not None and length < 0.9 * recording.t[-1]:
            spans = list(stretches(recording, length))
        for span in spans:
            run, own = begun(scenario, recording, log, named, span)
            if run.size:
                runs.append(run)
                starts += own
    return runs, starts if free else []


def remembers(scenario: Scenario, recordings: Sequence[tuple[int, Recording]]) -> bool:
    """Whether a stretch cannot begin inside a recording, because its initial state is unknown.

    Causes are a controller's integral or samples, and a signal that is not recorded and cannot be cut.
    """
    return bool(scenario.system.controllers) or any(unshifted(scenario, r) for _, r in recordings)


def estimate(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], sought: Sequence[MachineCoordinate], starts: int, seed: int,
    work: Work, first: dict[str, float] | None = None, keep: Keep | None = None, thorough: bool = True,
) -> BestPoint:  # fmt: skip
    """The best fit of these recordings. Without ``thorough``: a faster search for models that are only compared."""
    fitted = {i for i, _ in recordings}
    sought = [c for c in sought if c.log is None or c.log in fitted]
    named = {c.name for c in sought} | paths(sought)
    noise, given = first_noise([r for _, r in recordings])
    asked = any(r.window for _, r in recordings)
    notes: list[str] = []
    starts = starts if sought else 1  # the machine without friction may have no parameter to fit
    begin, many = dict(first or {}), starts > 1
    loose = loosened(scenario)
    agreed, others = 0, list[dict[str, float]]()
    whole_only, led = remembers(scenario, recordings), not any(x.free for x in scenario.system.bodies)
    if not whole_only and not led and many:
        rough = _roughly(loose, recordings, sought, named, noise, work)
        found = search(
            rough, starts, seed, point_of(rough, begin) if begin else None, _kept(rough, keep), wide=True, steps=_ROUGH,
            small=_NEAR,
        )  # fmt: skip
        begin = rough.values(found.u)
        others = [rough.values(u) for u in found.others]
        if found.stopped:
            return BestPoint(rough, found.u, found, notes, True)
        agreed, starts = found.agreeing, 1
    runs, own = prepared(loose, recordings, named)
    problem = MachineProblem(runs, [*sought, *own], dict(noise), work=work, step=FAR_STEP)
    points = [begin, *others] if thorough else [begin]
    if led:  # with a recorded motion, no error persists
        found = search(problem, starts, seed, point_of(problem, begin), _kept(problem, keep), wide=True, small=_NEAR)
    else:
        found = _whole(problem, points, starts, seed, {i for i, _ in _some(recordings)}, keep)
    if thorough and many and not found.stopped:
        found = _confirmed(problem, found, seed, keep)
    runs, own = prepared(scenario, recordings, named)
    problem = MachineProblem(runs, [*sought, *own], dict(noise), work=work)
    if not found.stopped:
        found = replace(search(problem, 1, seed, found.u, _kept(problem, keep)), agreeing=found.agreeing)
    whole = BestPoint(problem, found.u, replace(found, agreeing=max(agreed, found.agreeing)), notes, asked)
    if found.stopped or whole_only:
        return _weighted(whole, given, keep)
    grows = not asked and unstable(problem, found.u)
    if grows or (not asked and whole.missed()):
        whole = _in_stretches(scenario, recordings, sought, named, whole, begin, work, keep, grows)
    whole = _weighted(whole, given, keep)
    return _joined(whole, given, keep) if whole.windowed and not whole.stopped else whole


def _confirmed(problem: MachineProblem, found: Found, seed: int, keep: Keep | None) -> Found:
    """The best point after a converged search.

    If its residual exceeds the noise, the starts that were given up are converged too, and the best of all is returned.
    If there are none, the search is repeated from points elsewhere.
    """
    kept = _kept(problem, keep)
    try:
        end = search(problem, 1, seed, found.u, kept, small=_NEAR)
        if end.stopped or not beyond_noise(problem, end.u, found.agreeing):
            return replace(end, agreeing=found.agreeing)
        if found.others:
            ends = [end]
            for u in found.others:
                ends.append(search(problem, 1, seed, u, kept, small=_NEAR))
                if ends[-1].stopped or not beyond_noise(problem, ends[-1].u, 1):
                    break
            best = min(ends, key=lambda each: each.cost)
            return replace(best, agreeing=agreeing(np.array([each.cost for each in ends]), best.cost))
        again = search(problem, 1, seed, end.u, kept, scanned(problem, end), small=_NEAR)
    except (KeyboardInterrupt, Stopped):
        problem.work.stop()
        return replace(found, stopped=True)
    before = found.agreeing if agreeing(np.array([end.cost]), again.cost) else 0
    return replace(again, agreeing=max(again.agreeing, before))


def _joined(parts: BestPoint, given: set[str], keep: Keep | None) -> BestPoint:
    """The fit with stretches tied to each other, if it describes the recordings as well."""
    problem = replace(parts.problem, noise=dict(parts.problem.noise))
    found = joined_stretches(problem, parts.u, _kept(problem, keep), lambda p, u: _weigh(p, u, given))
    if found is None:
        return parts
    tied = BestPoint(found[0], found[1].u, replace(found[1], agreeing=parts.found.agreeing), [*parts.notes], True)
    if not tied.stopped:
        tied = _weighted(tied, given, keep)
        tied.problem = replace(tied.problem, runs=relayed(tied.problem, tied.u), noise=dict(tied.problem.noise))
    left, right = leftovers(parts.problem, parts.u), leftovers(tied.problem, tied.u)
    if not all(right[c][0] <= _AS_WELL * left[c][0] for c in left):
        parts.notes.append(
            "the ends of the stretches do not meet the starts of the next within the noise: they are left free (the model "
            "errs, or something moved that is not in it)"
        )
        return parts
    tied.notes.append("stretches begin where those before end, within the noise")
    return tied


def loosened(scenario: Scenario) -> Scenario:
    """The machine with the looser solver tolerance that is used far from the optimum."""
    return scenario.with_changes({"solve.rtol": max(scenario.solve.rtol, _LOOSE)})


def _some(recordings: Sequence[tuple[int, Recording]]) -> list[tuple[int, Recording]]:
    """At most ``_ENOUGH`` recordings, one of each load if possible."""
    some: list[tuple[int, Recording]] = []
    left = list(recordings)
    while left and len(some) < _ENOUGH:
        loads = [each[1].known for each in left]
        first = [i for i, known in enumerate(loads) if known not in loads[:i]]
        some += [left[i] for i in first]
        left = [each for i, each in enumerate(left) if i not in first]
    return sorted(some[:_ENOUGH], key=lambda each: each[0])


def _roughly(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], sought: Sequence[MachineCoordinate], named: set[str],
    noise: dict[str, float], work: Work,
) -> MachineProblem:  # fmt: skip
    """The problem for the comparison of starts: short stretches of some recordings."""
    some = _some(recordings)
    window = max(
        _SHORTEST, min(float(np.median([r.t[-1] for _, r in some])) / _STRETCH, *(r.window or np.inf for _, r in some))
    )
    runs, _ = prepared(scenario, [(i, replace(r, window=None)) for i, r in some], named, window, free=False)
    return MachineProblem(runs, list(sought), dict(noise), work=work, step=FAR_STEP)


def _whole(
    problem: MachineProblem, points: Sequence[dict[str, float]], starts: int, seed: int, logs: set[int], keep: Keep | None
) -> Found:  # fmt: skip
    """The best point for whole recordings by continuation from each of ``points``.

    The first result whose residual is noise is returned, otherwise the best. ``logs``: the recordings fitted first.
    """
    kept, tried = _kept(problem, keep), list[tuple[float, Array]]()
    some = replace(problem, runs=[run for run in problem.runs if run.log in logs])
    best = point_of(problem, points[0])
    try:
        for i, values in enumerate(points):
            u = point_of(problem, values)
            if starts > 1:
                u = search(problem, starts, seed, u, kept, steps=_ROUGH, small=_NEAR).u
            u, share = continued(some, u, None if i else kept)
            if share == 1.0:
                u = continued(problem, u, kept)[0] if len(some.runs) < len(problem.runs) else u
                found = search(problem, 1, seed, u, kept, steps=_ROUGH, small=_NEAR)
                if found.stopped or not beyond_noise(problem, found.u, 1):
                    return found
                u = found.u
            tried.append((float(half_squares(problem.residuals(u[None]))[0]), u))
            best = min(tried, key=lambda each: each[0])[1]
        for values in points[:_CAREFUL] if len(points) > 1 else []:
            u, _ = continued(problem, point_of(problem, values), None, careful=True)
            found = search(problem, 1, seed, u, kept, steps=_ROUGH, small=_NEAR)
            if found.stopped or not beyond_noise(problem, found.u, 1):
                return found
            tried.append((found.cost, found.u))
            best = min(tried, key=lambda each: each[0])[1]
    except (KeyboardInterrupt, Stopped):
        problem.work.stop()
        return Found(best, np.inf, 1, True)
    return search(problem, 1, seed, best, kept, small=_NEAR)


def _in_stretches(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], sought: Sequence[MachineCoordinate], named: set[str],
    whole: BestPoint, begin: dict[str, float], work: Work, keep: Keep | None, grows: bool,
) -> BestPoint:  # fmt: skip
    """Multiple shooting: each stretch has its own initial state, so errors cannot grow over a whole recording."""
    window = max(_SHORTEST, float(np.median([r.t[-1] for _, r in recordings])) / _STRETCH * 2)
    runs, own = prepared(scenario, recordings, named, window)
    problem = MachineProblem(runs, [*sought, *own], dict(whole.problem.noise), work=work)
    found = search(problem, 1, 0, point_of(problem, begin), _kept(problem, keep))
    parts = BestPoint(problem, found.u, found, whole.notes, True)
    left, right = leftovers(whole.problem, whole.u), leftovers(problem, found.u)
    least = 1 / _AS_WELL if grows else _MUCH  # whole recordings may be the only information on unmeasured states
    if all(not left[c][0] > least * right[c][0] for c in left):
        return whole
    why = "errors grow fast in this motion" if grows else "whole recordings cannot be followed from their start"
    parts.notes.append(
        f"{why}: recordings are fitted in {len(runs)} stretches of about {window:.2g} s, each with a start of its own; errors "
        "are those within stretches"
    )
    return parts


def _weighted(estimate: BestPoint, given: set[str], keep: Keep | None) -> BestPoint:
    """The fit with each column weighted by its estimated noise."""
    problem = estimate.problem
    for _ in range(_WEIGHTINGS):
        if estimate.stopped or half_squares(problem.residuals(estimate.u[None]))[0] > 1e200:
            return estimate
        old = dict(problem.noise)
        _weigh(problem, estimate.u, given)
        if all(abs(np.log(problem.noise[c] / old[c])) < _SETTLED for c in old):
            break
        found = search(problem, 1, 0, estimate.u, _kept(problem, keep))
        estimate.u, estimate.found = found.u, replace(found, agreeing=estimate.found.agreeing)
    else:
        _weigh(problem, estimate.u, given)  # the last search may have reduced the residual
    return estimate


def _weigh(problem: MachineProblem, u: Array, given: set[str]) -> None:
    """Set the noise of each column to its residual, unless the noise is given and not much smaller."""
    share = problem.size / max(problem.size - len(problem.sought), 1)
    for column, (left, _) in leftovers(problem, u).items():
        told = left * np.sqrt(min(share, 2.0))
        if np.isfinite(told) and not (column in given and told < 1.5 * problem.noise[column]):
            problem.noise[column] = max(float(told), floor_of(problem, column), 1e-12)


def point_of(problem: MachineProblem, values: dict[str, float]) -> Array:
    """A point from values by name; other coordinates have the machine's values."""
    u = problem.start()
    for i, c in enumerate(problem.sought):
        if c.name in values:
            u[i] = c.inner(values[c.name])
    return np.asarray(problem.repaired(u[None])[0])


def _kept(problem: MachineProblem, keep: Keep | None) -> Callable[[Array, float], None] | None:
    return None if keep is None else lambda u, value: keep(problem.values(u), value)
