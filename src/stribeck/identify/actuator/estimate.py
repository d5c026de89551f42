"""Estimates parameters from recordings: chooses the simulated stretches, the columns' weights and the starts.

If errors grow in a whole recording, it is fitted in stretches, each with its own initial state (multiple shooting).
Unmeasured initial states (bristles, currents, unmeasured bodies) continue the stretch before. The ends are tied to the next
starts with the accuracy to which the samples determine these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.guided import GuidedSearch, UnderGuide
from stribeck.identify.actuator.inputs import later, value_at
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording
from stribeck.identify.actuator.residuals import AS_WELL, first_noise, floor_of, leftovers, noise_of, weigh
from stribeck.identify.actuator.solve import ROUGHLY, half_squares, moved_over, search, settled
from stribeck.identify.actuator.starts import problem_of
from stribeck.identify.core.judging import EXPLAINED
from stribeck.identify.work import Stopped, Work
from stribeck.scenario import Scenario

_WEIGHTINGS = 8  # at most: each reduces the noise, and a poor start needs several
_SETTLED = 0.05  # relative change of the prediction errors at the end: a tenth of their own error is not visible
_OFF = 1e-6  # of a position's changes: an error of the initial state that no sensor shows
_STRETCH, _SHORTEST = 6, 0.2  # stretches per recording; s
_MUCH = 3.0  # ratio of the residuals of whole recordings and stretches above which stretches are fitted
_TIED_ROUNDS, _STEPS = 3, 5  # weightings of tied stretches, and steps of the search between two


@dataclass
class BestPoint:
    """The best point of a problem and its search; ``windowed``: in stretches.

    ``under_guide``: if the residual is coloured, by name the coordinates of a second estimate and their deviations.
    """

    problem: MachineProblem
    u: Array
    agreeing: int
    stopped: bool
    notes: list[str]
    windowed: bool
    under_guide: UnderGuide = field(default_factory=dict)

    @property
    def window(self) -> float | None:
        """The length of the stretches, if the fit is in stretches."""
        return float(np.median([run.scenario.end for run in self.problem.runs])) if self.windowed else None

    def values(self) -> dict[str, float]:
        """The parameters' values by name."""
        return self.problem.values(self.u)

    def missed(self) -> list[str]:
        """The columns that the fit does not describe, in words."""
        texts = []
        for column, (left, size) in leftovers(self.problem, self.u).items():
            if not np.isfinite(left):
                texts.append(f"{column}: cannot be simulated with the best values")
            elif left > max(EXPLAINED * size, 3 * floor_of(self.problem, column)):
                texts.append(f"{column}: {100 * left / size if size else np.inf:.0f} % relative residual")
        return texts


def unstable(problem: MachineProblem, u: Array) -> bool:
    """Whether errors grow so fast, as in an upright pendulum, that one of the initial state that no sensor shows is seen later.

    The solver's errors, and those of the inputs between samples, grow as it does, and move estimates beyond their intervals.
    """
    for k, run in enumerate(problem.runs):
        body = next((t.column for t in run.targets if t.column.endswith(".y")), None)
        if body is None or body not in {state.name for state in run.scenario.system.states}:
            continue
        i = next(i for i, t in enumerate(run.targets) if t.column == body)
        off = _OFF * float(np.std(run.targets[i].x))
        x = problem.predicted(run, k, np.stack([u, u]), shift={body: np.array([0.0, off])})[i]
        if not float(np.max(abs(x[1] - x[0]))) <= noise_of(problem, body):
            return True
    return False


def remembers(scenario: Scenario, recordings: Sequence[tuple[int, Recording]]) -> bool:
    """Whether a stretch cannot begin inside a recording, because its initial state is unknown.

    Causes are a controller's integral or samples, and a signal that is not recorded and cannot be cut.
    """
    uncut = {use.path for use in scenario.elements.signals if later(value_at(scenario, use.path), 1.0) is None}
    return bool(scenario.system.controllers) or any(uncut - r.inputs.keys() for _, r in recordings)


def estimate(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], sought: Sequence[MachineCoordinate], starts: int, seed: int,
    work: Work, first: dict[str, float] | None = None, rough: bool = False,
) -> BestPoint:  # fmt: skip
    """The best fit of these recordings; ``rough``: only as far as its error is to be compared."""
    fitted = {i for i, _ in recordings}
    sought = [c for c in sought if c.log is None or c.log in fitted]
    noise, given = first_noise([r for _, r in recordings])
    asked = any(r.window for _, r in recordings)
    starts = starts if sought else 1  # the machine without friction may have no parameter to fit
    guided = GuidedSearch(scenario, recordings, sought, noise, work)
    near = guided.reached(starts, seed, first or {}, rough)
    problem = problem_of(scenario, recordings, sought, dict(noise), work=work, known_noise=given)
    whole = BestPoint(problem, problem.point(near.values), near.agreeing, near.stopped, [], asked)
    if rough:
        return whole
    if not whole.stopped:
        weigh(problem, whole.u, white=False)
        solution = search(problem, whole.u, small=ROUGHLY)
        whole.u, whole.stopped = solution.u, solution.stopped
    cut = not (whole.stopped or asked or remembers(scenario, recordings))
    grows = cut and any(x.free for x in scenario.system.bodies) and unstable(problem, whole.u)
    if grows or (cut and whole.missed()):
        window = max(_SHORTEST, float(np.median([r.t[-1] for _, r in recordings])) / _STRETCH)
        noise = dict(problem.noise)
        parts = problem_of(scenario, recordings, sought, noise, window, work=work, known_noise=given)
        whole = _in_stretches(whole, parts, near.guided, grows, window)
    best = _weighted(whole)
    if best.windowed and not (best.stopped or remembers(scenario, recordings)):
        best = _joined(best)
    if best.problem.coloured and not best.stopped:
        try:
            best.under_guide = guided.under_guide(near)
        except (KeyboardInterrupt, Stopped):
            work.stop()
        best.stopped = work.stopped
    return best


def _in_stretches(
    whole: BestPoint, problem: MachineProblem, begin: dict[str, float], grows: bool, window: float
) -> BestPoint:
    """The fit in stretches, if it leaves much less than that of whole recordings."""
    solution = search(problem, problem.point(begin))
    if solution.stopped:
        return replace(whole, stopped=True)
    u = moved_over(problem, solution.u)
    left, right = leftovers(whole.problem, whole.u), leftovers(problem, u)
    least = 1 / AS_WELL if grows else _MUCH  # whole recordings may be the only information on unmeasured states
    if all(not left[c][0] > least * right[c][0] for c in left):
        return whole
    why = "errors grow fast in this motion" if grows else "the model does not follow whole recordings from their start"
    note = (
        f"{why}: recordings are fitted in {len(problem.runs)} stretches of about {window:.2g} s, each with its own initial "
        "state; errors are those within stretches"
    )
    return BestPoint(problem, u, solution.agreeing, False, [*whole.notes, note], True)


def _joined(parts: BestPoint) -> BestPoint:
    """The fit with stretches tied to each other, if it describes the recordings as well."""
    problem = replace(parts.problem, noise=dict(parts.problem.noise), tied=True)
    if not problem.ties:
        return parts
    tied = BestPoint(problem, parts.u, parts.agreeing, False, [*parts.notes], True)
    for _ in range(_TIED_ROUNDS):  # while the residual is large, the ties are loose
        weigh(problem, tied.u, white=False)
        solution = search(problem, tied.u, steps=_STEPS)
        tied.u, tied.stopped = solution.u, solution.stopped
        if tied.stopped:
            break
    tied = _weighted(tied)
    if tied.stopped:
        return replace(parts, stopped=True)
    tied.problem = replace(problem, runs=problem.handed_on(tied.u))
    left, right = leftovers(parts.problem, parts.u), leftovers(tied.problem, tied.u)
    if not all(right[c][0] <= AS_WELL * left[c][0] for c in left):
        parts.notes.append(
            "consecutive stretches do not join within the noise, so that their initial states are free; the model may lack "
            "an effect"
        )
        return parts
    tied.notes.append("each stretch begins at the end of the previous one, within the noise")
    return tied


def _weighted(best: BestPoint) -> BestPoint:
    """The fit at its optimum, with each column weighted by its estimated noise, and whitened where this is coloured."""
    problem = best.problem
    try:
        for _ in range(_WEIGHTINGS):
            if best.stopped or half_squares(problem.residuals(best.u[None]))[0] > 1e200:
                break
            best.u = settled(problem, best.u)
            old, plain = problem.deviations(), not problem.coloured
            weigh(problem, best.u)
            if plain and problem.coloured:  # drift has hidden other minima
                best.u = moved_over(problem, best.u)
            if all(abs(np.log(new / old[c])) < _SETTLED for c, new in problem.deviations().items()):
                break
    except (KeyboardInterrupt, Stopped):
        problem.work.stop()
        best.stopped = True
    return best
