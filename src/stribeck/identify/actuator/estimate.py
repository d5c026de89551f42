"""Estimates parameters from recordings: chooses the simulated stretches, the columns' weights and the starts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.afar import SMALL_AFAR, GuidedSearch, Keep, kept
from stribeck.identify.actuator.coordinates import MachineCoordinate, paths
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.residuals import first_noise, floor_of, leftovers
from stribeck.identify.actuator.runs import unshifted
from stribeck.identify.actuator.shooting import joined_stretches, relayed
from stribeck.identify.actuator.solve import Found, half_squares, moved_over, search, settled
from stribeck.identify.actuator.starts import prepared
from stribeck.identify.work import Stopped, Work
from stribeck.scenario import Scenario

POOR = 0.25  # of a column's changes: with a larger residual, the model does not describe the data
_WEIGHTINGS = 8  # at most: each reduces the noise, and a poor start needs several
_SETTLED = 0.05
# Initial error, as a share of the position's changes; growth of this error above which the motion counts as unstable.
_OFF, _GROWN = 1e-6, 100.0
_STRETCH = 6  # stretches per recording
_SHORTEST = 0.2  # s
_COMPUTED = 0.5  # standard deviations: largest move of an estimate by ten times the solver's error
_AS_WELL = 1.2  # times the residual of free stretches
_MUCH = 3.0  # ratio of the residuals of whole recordings and stretches above which stretches are fitted


@dataclass
class BestPoint:
    """The best point of a problem and its search."""

    problem: MachineProblem
    u: Array
    found: Found
    notes: list[str]
    windowed: bool

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


def remembers(scenario: Scenario, recordings: Sequence[tuple[int, Recording]]) -> bool:
    """Whether a stretch cannot begin inside a recording, because its initial state is unknown.

    Causes are a controller's integral or samples, and a signal that is not recorded and cannot be cut.
    """
    return bool(scenario.system.controllers) or any(unshifted(scenario, r) for _, r in recordings)


def estimate(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], sought: Sequence[MachineCoordinate], starts: int, seed: int,
    work: Work, first: dict[str, float] | None = None, keep: Keep | None = None, rough: bool = False,
) -> BestPoint:  # fmt: skip
    """The best fit of these recordings; ``rough``: only as far as its error is to be compared."""
    fitted = {i for i, _ in recordings}
    sought = [c for c in sought if c.log is None or c.log in fitted]
    named = {c.name for c in sought} | paths(sought)
    noise, given = first_noise([r for _, r in recordings])
    asked, notes = any(r.window for _, r in recordings), list[str]()
    starts = starts if sought else 1  # the machine without friction may have no parameter to fit
    near = GuidedSearch(scenario, recordings, sought, noise, work, keep).reached(starts, seed, first or {}, rough)
    runs, own = prepared(scenario, recordings, named)
    problem = MachineProblem(runs, [*sought, *own], dict(noise), work=work)
    found = Found(problem.point(near.values), near.cost, near.agreeing, near.stopped)
    if rough:
        return BestPoint(problem, found.u, found, notes, asked)
    if not found.stopped:
        _weigh(problem, found.u, given)
        found = replace(
            search(problem, 1, seed, found.u, kept(problem, keep), small=SMALL_AFAR), agreeing=near.agreeing
        )
    whole = BestPoint(problem, found.u, found, notes, asked)
    if found.stopped or remembers(scenario, recordings):
        return _weighted(whole, given)
    grows = not asked and any(x.free for x in scenario.system.bodies) and unstable(problem, found.u)
    if grows or (not asked and whole.missed()):
        whole = _in_stretches(scenario, recordings, sought, named, whole, near.guided, work, keep, grows)
    whole = _weighted(whole, given)
    return _joined(whole, given, keep) if whole.windowed and not whole.stopped else whole


def _joined(parts: BestPoint, given: set[str], keep: Keep | None) -> BestPoint:
    """The fit with stretches tied to each other, if it describes the recordings as well."""
    problem = replace(parts.problem, noise=dict(parts.problem.noise))
    found = joined_stretches(problem, parts.u, kept(problem, keep), lambda p, u: _weigh(p, u, given))
    if found is None:
        return parts
    tied = BestPoint(found[0], found[1].u, replace(found[1], agreeing=parts.found.agreeing), [*parts.notes], True)
    if not tied.stopped:
        tied = _weighted(tied, given)
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


def _in_stretches(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], sought: Sequence[MachineCoordinate], named: set[str],
    whole: BestPoint, begin: dict[str, float], work: Work, keep: Keep | None, grows: bool,
) -> BestPoint:  # fmt: skip
    """Multiple shooting: each stretch has its own initial state, so errors cannot grow over a whole recording."""
    window = max(_SHORTEST, float(np.median([r.t[-1] for _, r in recordings])) / _STRETCH)
    runs, own = prepared(scenario, recordings, named, window)
    problem = MachineProblem(runs, [*sought, *own], dict(whole.problem.noise), work=work)
    found = search(problem, 1, 0, problem.point(begin), kept(problem, keep))
    if not found.stopped:
        found = replace(found, u=moved_over(problem, found.u))
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


def _weighted(estimate: BestPoint, given: set[str]) -> BestPoint:
    """The fit at its optimum, with each column weighted by its estimated noise."""
    problem = estimate.problem
    for _ in range(_WEIGHTINGS):
        if estimate.stopped or half_squares(problem.residuals(estimate.u[None]))[0] > 1e200:
            break
        try:
            estimate.u = settled(problem, estimate.u)
        except (KeyboardInterrupt, Stopped):
            problem.work.stop()
            estimate.found = replace(estimate.found, stopped=True)
            break
        old = dict(problem.noise)
        _weigh(problem, estimate.u, given)
        if all(abs(np.log(problem.noise[c] / old[c])) < _SETTLED for c in old):
            break
    return estimate


def _weigh(problem: MachineProblem, u: Array, given: set[str]) -> None:
    """Set the noise of each column to its residual, unless the noise is given and not much smaller."""
    share = problem.size / max(problem.size - len(problem.sought), 1)
    for column, (left, _) in leftovers(problem, u).items():
        told = left * np.sqrt(min(share, 2.0))
        if np.isfinite(told) and not (column in given and told < 1.5 * problem.noise[column]):
            problem.noise[column] = max(float(told), floor_of(problem, column), 1e-12)
