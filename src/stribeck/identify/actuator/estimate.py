"""Estimates parameters from recordings: the search, the guide that the simulation needs, and the columns' weights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate
from stribeck.identify.actuator.guided import GuidedSearch, UnderGuide, steps_apart
from stribeck.identify.actuator.guides import CARRIED, Guides
from stribeck.identify.actuator.lacks import RunMotion, errors_of_sensor
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.identify.actuator.residuals import first_noise, floor_of, leftovers, noise_of, weigh
from stribeck.identify.actuator.runs import rms
from stribeck.identify.actuator.solve import HUGE, ROUGHLY, half_squares, search, settled
from stribeck.identify.actuator.starts import problem_of
from stribeck.identify.core.judging import EXPLAINED
from stribeck.identify.work import Stopped, Work
from stribeck.scenario import Scenario

_WEIGHTINGS = 8  # at most: each reduces the noise, and a poor start needs several
_SETTLED = 0.05  # relative change of the prediction errors at the end: a tenth of their own error is not visible
_HIDDEN = 3.0  # deviations of a sensor: a larger error of the simulated state would be seen in a sample
_GUIDED = "a guide draws bodies along their measured motion; errors are those under this guide"
_OFF = 1e-6  # of a position's changes: an error of the initial state that no sensor shows


@dataclass
class BestPoint:
    """The best point of a problem and its search.

    Attributes:
        guides: of the fitted recordings; ``bandwidth``: of the guide, rad/s, 0 without one.
        under_guide: if the residual is colored, by name the coordinates of a second estimate, under the stiffest guide,
            and their deviations.
    """

    problem: MachineProblem
    u: Array
    stopped: bool
    notes: list[str]
    guides: Guides
    bandwidth: float = 0.0
    under_guide: UnderGuide = field(default_factory=dict)

    def values(self) -> dict[str, float]:
        """The parameters' values by name."""
        return self.problem.values(self.u)

    def missed(self) -> list[str]:
        """What the fit does not describe, in words: columns, or under a guide its force."""
        texts = []
        for column, (left, size) in leftovers(self.problem, self.u).items():
            if not np.isfinite(left):
                texts.append(f"{column}: cannot be simulated with the best values")
            elif left > max(EXPLAINED * size, 3 * floor_of(self.problem, column)):
                texts.append(f"{column}: {100 * left / size if size else np.inf:.0f} % relative residual")
        if self.bandwidth and not texts and (share := self._guide_share()) > EXPLAINED:
            texts.append(f"{100 * share:.0f} % of the forces are missing")
        return texts

    def doubtful(self) -> bool:
        """Whether slopes along the free motion may bend the estimates.

        The simulation misses the recordings; or its state errs by more than the sensors, and the estimates are not those under
        the stiffest guide, whose slopes are along the measured motion.
        """
        apart = steps_apart(self.problem, self.u, self.under_guide)
        return bool(self.missed() or (apart.any() and self.state_error() > _HIDDEN**2))

    def state_error(self) -> float:
        """The squared error of the simulated state, relative to that of the sensors of bodies that forces move.

        Other noise in the measured motion shows how much of it a guide carries into the state, and how much it leaves in the
        residual. What the residual exceeds this by is an error of the forces, unless an error of the sensor explains it.
        """
        errors = [0.0]
        for k, run in enumerate(self.problem.runs):
            point, sensors = self.u[None], self.guides.noise(run.log)
            state = self.problem.predicted(run, k, point)
            others = [
                (x.targets, self.problem.predicted(run.instead(x), k, point)) for x in run.as_well.get(CARRIED, ())
            ]
            for i, target in enumerate(run.targets):
                if target.column not in sensors:
                    continue
                noise, carried = np.array([sensors[target.column]]), np.zeros(1)  # without a guide
                if others:
                    noise = np.array([targets[i].x - target.x for targets, _ in others])
                    carried = np.array([x[i][0] - state[i][0] for _, x in others])
                left = _without_errors_of_sensor(target, state[i][0])
                forces = max(float(np.mean(left**2) - np.mean((noise - carried) ** 2)), 0.0)
                errors.append((forces + float(np.mean(carried**2))) / float(np.mean(noise**2)))
        return max(errors)

    def _guide_share(self) -> float:
        """The guides' force, relative to the friction or to the other forces on the guided bodies, whichever is larger."""
        motion, numbers = RunMotion.of(self.problem, self.u), self.problem.numbers(self.u)
        pulls, others = list[float](), [0.0]
        for run, columns in zip(self.problem.runs, motion.runs, strict=True):
            pull, other = self.guides.forces(run.log, self.bandwidth, columns, numbers)
            pulls.append(pull)
            others.append(other)
        contacts = self.problem.runs[0].scenario.data.get("contacts", {})
        friction = [rms(motion.each(f"{contact}.F")) for contact in contacts]
        return float(np.sqrt(np.mean(np.square(pulls)))) / max(*friction, *others, 1e-300)


def _without_errors_of_sensor(target: Channel, x: Array) -> Array:
    """What a sensor's delay, clock, gain and offset leave of the difference between a measured and a simulated column."""
    errors = np.stack([*errors_of_sensor(target.t, x).values()], axis=1)
    errors /= np.maximum(np.max(abs(errors), axis=0), 1e-300)
    return np.asarray(target.x - x - errors @ np.linalg.lstsq(errors, target.x - x)[0])


def steady(problem: MachineProblem, u: Array) -> bool:
    """Whether an error of the initial state that no sensor shows is not seen later; under a guide, whether it decays.

    Where it grows, as in an upright pendulum, the solver's errors and those of the inputs do too, and move estimates beyond
    their intervals. Under a guide that does not stop the growth, the noise of the measured motion does.
    """
    for k, run in enumerate(problem.runs):
        body = next((t.column for t in run.targets if t.column.endswith(".y")), None)
        if body is None or body not in {state.name for state in run.scenario.system.states}:
            continue
        i = next(i for i, t in enumerate(run.targets) if t.column == body)
        off = _OFF * float(np.std(run.targets[i].x))
        x = problem.predicted(run, k, np.stack([u, u]), shift={body: np.array([0.0, off])})[i]
        later = abs(x[1] - x[0])
        if not (later[-1] <= off if problem.guide else np.max(later) <= noise_of(problem, body)):
            return False
    return True


class Estimation:
    """The fit of some recordings. Its search from many starts runs when it is made.

    Args:
        starts: number of starts of the search; ``seed``: makes them reproducible; ``first``: values of the first one.

    Attributes:
        free: the end of the search, without a guide.
    """

    def __init__(
        self, scenario: Scenario, recordings: Sequence[tuple[int, Recording]], sought: Sequence[MachineCoordinate],
        starts: int, seed: int, work: Work, first: dict[str, float] | None = None,
    ) -> None:  # fmt: skip
        fitted = {i for i, _ in recordings}
        self._sought, self._work = [c for c in sought if c.log is None or c.log in fitted], work
        self._noise, self._given = first_noise([r for _, r in recordings])
        self._search = GuidedSearch(scenario, recordings, self._sought, self._noise, work)
        starts = starts if self._sought else 1  # the machine without friction may have no parameter to fit
        self._near = self._search.reached(starts, seed, first or {})
        self._guides = Guides(scenario, recordings)
        self.free = self._begun(0.0, self._near.values)

    def best(self) -> BestPoint:
        """The best fit, which begins at the end of the search."""
        if not self.free.stopped and (near := self._search.followed(self._near)) != self._near:
            self._near, self.free = near, self._begun(0.0, near.values)
        if self.free.stopped:
            return self.free
        fitted_sensor = any(c.output is not None for c in self._sought)  # which guides nothing
        guided = [] if fitted_sensor else self._guides.bandwidths[1:]
        best = self._converged(guided)
        if not best.bandwidth and guided and not best.stopped and best.doubtful():
            other = self._converged(guided, best)
            best = other if other.bandwidth else best
        return best

    def _begun(self, bandwidth: float, values: dict[str, float]) -> BestPoint:
        guided = self._guides.at(bandwidth, noisy=True)
        problem = problem_of(
            guided.scenario, guided.recordings, self._sought, dict(self._noise), work=self._work, known_noise=self._given,
            guide=guided.prefix,
        )  # fmt: skip
        return BestPoint(problem, problem.point(values), self._near.stopped, [], self._guides, bandwidth)

    def _converged(self, guided: Sequence[float], last: BestPoint | None = None) -> BestPoint:
        best = _weighted(self._as_free_as_possible(guided, last))
        if best.problem.colored and not best.stopped:
            try:
                best.under_guide = self._search.under_guide(self._near)
            except (KeyboardInterrupt, Stopped):
                self._work.stop()
            best.stopped = self._work.stopped
        return best

    def _as_free_as_possible(self, guides: Sequence[float], last: BestPoint | None = None) -> BestPoint:
        """The free simulation, unless its errors grow or it misses the recordings; then that under a guide.

        It is the loosest guide under which errors decay, little force is missing, and the error of the simulated state hides in
        the sensors' noise: slopes along another motion than the real one bend the estimates. Guides stiffer than one that hides
        the error hide it, too, so the loosest is found by bisection. If none hides it, the one with the least error is taken.

        Args:
            guides: the bandwidths of the guides, the loosest first.
            last: a converged free fit that strays; each guide begins at the values under the one before it.
        """
        moves, why = any(x.free for x in self.free.problem.runs[0].scenario.system.bodies), ""

        def error(best: BestPoint) -> float:
            """The error of the simulated state, once converged; infinite where the fit cannot be used."""
            nonlocal why
            weigh(best.problem, best.u, white=False)
            solution = search(best.problem, best.u, small=ROUGHLY)
            best.u, best.stopped = solution.u, solution.stopped
            missed = not best.stopped and best.missed()
            if not best.stopped and (missed or (moves and not steady(best.problem, best.u))):
                why = why or (
                    "the machine alone does not follow the recordings" if missed else "errors grow fast in this motion"
                )
                return np.inf
            return best.state_error() if best.bandwidth and not best.stopped else 0.0

        if last is not None:
            why = "the machine alone strays from the measured motion"
        elif error(self.free) == 0.0:
            return self.free
        chosen, least, low, high = self.free, np.inf, 0, len(guides)
        while low < high:
            middle = (low + high) // 2
            best = self._begun(guides[middle], last.values() if last else self._near.at(guides[middle]))
            off = error(best)
            if best.stopped:
                return best
            last, hidden = best if last else None, off <= _HIDDEN**2
            if hidden or off < least:
                chosen, least = best, off
            low, high = (low, middle) if hidden else (middle + 1, high)
        chosen.notes += [f"{why}: {_GUIDED}"] if chosen is not self.free else []
        return chosen


def _weighted(best: BestPoint) -> BestPoint:
    """The fit at its optimum, with each column weighted by its estimated noise, and whitened where this is colored."""
    problem = best.problem
    if not best.stopped:
        weigh(problem, best.u)  # else the first steps follow a drift to needless digits
    try:
        for _ in range(_WEIGHTINGS):
            if best.stopped or half_squares(problem.residuals(best.u[None]))[0] >= HUGE:
                break
            best.u = settled(problem, best.u)
            old = problem.deviations()
            weigh(problem, best.u)
            if all(abs(np.log(new / old[c])) < _SETTLED for c, new in problem.deviations().items()):
                break
    except (KeyboardInterrupt, Stopped):
        problem.work.stop()
        best.stopped = True
    return best
