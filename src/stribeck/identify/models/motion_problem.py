"""The problem of a fit of the motion: measured force in, position or velocity out, in windows of the record.

A body that nothing holds integrates every error twice, and one that sticks a moment too long is elsewhere ever after: over
a long record the distance between simulated and measured motion has many minima. So the record is cut into windows,
each with a first position, velocity and deflection of its own (Bock's multiple shooting without the matching conditions);
they grow as the constants get better (:mod:`stribeck.identify.methods.horizons`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.identify.data.filters import low_pass, spline_derivative
from stribeck.identify.log import Log
from stribeck.identify.models.dynamic_problem import Given, VelocityProblem, form_of
from stribeck.identify.models.problem import Coordinate, Problem
from stribeck.identify.models.terms import column
from stribeck.simulation.response import ForcedBody

OUTPUTS = {"position": "position", "velocity": "velocity"}
ROUGH, FINE = 1e-2, 1e-4  # error of a step as a share of the output's noise; an estimate averages over many samples
FEWEST = 8  # rows of a window
SLIDES = 0.05  # of the largest speed: a window that starts faster needs no deflection of its own
_DRAWN = 1 << 14  # samples of noise that tell what a filter leaves of it


class MotionProblem(Problem):
    """Measured force in, motion out, over windows of the record.

    Args:
        inverse: the problem the other way round, which has the constants and their values.
        output: "position" or "velocity".
        windows: rows of the record, rising; those in none of them do not count.
        noise: standard deviation of the output's noise.
        share: of it, that a step of a simulation may err by.
    """

    def __init__(
        self, inverse: VelocityProblem, output: str, windows: Sequence[slice], noise: float, share: float
    ) -> None:
        self.inverse, self.output, self.noise, self.share = inverse, output, noise, share
        self.log, self.windows = inverse.log, list(windows)
        log = self.log
        self.rows = np.concatenate([np.arange(w.start, w.stop) for w in windows])
        self.first = np.cumsum([0, *(w.stop - w.start for w in windows[:-1])]).astype(np.int64)
        self.parts = [slice(a, a + w.stop - w.start) for a, w in zip(self.first.tolist(), windows, strict=True)]
        self.time, self.force = log.time[self.rows], log.force
        self.beside = [name for name in inverse.body if name != "mass"]
        self.columns = self._columns(log)
        fast = float(np.max(abs(log.velocity)))
        self.begin = np.array([[0.0, log.velocity[w.start], 0.0] for w in windows])
        slides = abs(self.begin[:, 1]) > SLIDES * fast
        self.sliding = slides
        own, self.places = self._own_coordinates(inverse, fast, slides)
        size = noise * max(float(np.ptp(log.position)), 1e-300) / fast if output == "velocity" else noise
        self.tolerance = share * size, share * size * fast / max(float(np.ptp(log.position)), 1e-300)
        measured = self._without_means(raw(log, output)[self.rows][None, :])[0]
        scale = float(np.sqrt(np.mean(measured**2))) or 1.0
        super().__init__(inverse.law, own, inverse.fixed, inverse.tied, measured, scale)
        self.model = ForcedBody(self.law, form_of(self.law, self.fixed))
        assert inverse.home is not None
        self.home = self.from_values(inverse.values(inverse.home))

    def _own_coordinates(
        self, inverse: VelocityProblem, fast: float, slides: NDArray[np.bool_]
    ) -> tuple[list[Coordinate], list[tuple[int, int]]]:
        """The constants, then each window's first velocity, and its deflection where it does not slide; and which
        window and state the latter are."""
        found = [c for c in inverse.coordinates if not c.nuisance]
        places = []
        for k, part in enumerate(self.parts):
            around = float(self.begin[k, 1])
            found.append(Coordinate(f"v_{k}", "", around - 2 * fast, around + 2 * fast, False, fast, True, part))
            places.append((k, 1))
            if not slides[k] and inverse.law.has_z:
                found.append(Coordinate(f"z_{k}", "", -1.2, 1.2, False, 1.0, True, part))
                places.append((k, 2))
        return found, places

    # -- points ------------------------------------------------------------------------------------------------------

    @property
    def shared(self) -> int:
        """How many coordinates are constants, which all windows share."""
        return len(self.coordinates) - len(self.places)

    def from_values(self, values: Given) -> Array:
        """The point of given constants, the windows starting as they were measured."""
        level = max(abs(values.get("F_s", values.get("F_c", 1.0))), 1e-300)
        found = [c.inner(values[c.name]) for c in self.coordinates[: self.shared]]
        driving = self.inverse.driving(self.force, values)
        for k, state in self.places:
            row = self.windows[k].start
            beside = self._of_beside(values)[self.first[k]]
            held = driving[row] - beside - values["mass"] * self.log.acceleration[row]
            found.append(
                self.begin[k, 1] / self.coordinates[len(found)].scale if state == 1 else np.clip(held / level, -1, 1)
            )
        low, high = self.bounds
        return np.asarray(np.clip(found, low, high))

    def driven(self, force: Array) -> MotionProblem:
        """The same problem under another force, given at each row of the record."""
        other = copy(self)
        other.force = force
        return other

    def along(self, log: Log) -> MotionProblem:
        """The same problem where what the force holds beside friction is taken at the motion of another record."""
        other = copy(self)
        other.columns = self._columns(log)
        return other

    def with_inverse(self, inverse: VelocityProblem) -> MotionProblem:
        """The same problem of other coordinates, in what is left of its windows where fewer rows have a force."""
        known = [
            slice(max(w.start, run.start), min(w.stop, run.stop))
            for run, whole in zip(inverse.within, inverse.runs, strict=True)
            for w in self.windows
            if whole.start <= w.start < whole.stop
        ]
        return MotionProblem(
            inverse, self.output, [w for w in known if w.stop - w.start >= FEWEST], self.noise, self.share
        )

    @property
    def follows(self) -> bool:
        """Whether what the force holds beside friction hangs on the measured motion, as an arm's weight does."""
        return not set(self.beside) <= {"offset", "area"}

    def _columns(self, log: Log) -> Array:
        return np.array([column(name, log, {})[self.rows] for name in self.beside]).reshape(-1, len(self.rows))

    # -- outputs -----------------------------------------------------------------------------------------------------

    def outputs(self, points: Array) -> Array | None:
        """The motion at every row of the windows; positions less the mean of their window, as its first one is free."""
        sets = [self.values(u) for u in points]
        found = self.simulated(sets, points)
        return None if found is None else self._without_means(found)

    def simulated(
        self, sets: Sequence[Mapping[str, float]], points: Array, force: Array | None = None, straight: bool = False
    ) -> Array | None:
        """The output along the measured force or another one, which is straight from sample to sample if asked."""
        with np.errstate(all="ignore"):
            length = np.array([self.length(each) for each in sets])
        if not (np.isfinite(length).all() and length[0] > 0):
            return None
        states = np.repeat(self.begin[:, None, :], len(sets), axis=1)
        for i, (k, state) in enumerate(self.places, start=self.shared):
            states[k, :, state] = points[:, i] * (self.coordinates[i].scale if state == 1 else length)
        if (fast := np.flatnonzero(self.sliding)).size:
            for lane, each in enumerate(sets):
                try:
                    law = self.law({n: each[n] for n in self.law.constants() if n in each})
                except InputError:  # a step of a derivative beyond what is allowed: the last lane's will do
                    if not lane:
                        return None
                states[fast, lane, 2] = law.steady_deflection(states[fast, lane, 1])
        if not np.isfinite(states).all():
            return None
        way, speed = self.tolerance
        limits = (min(way, length[0]), speed, min(way, 1e-3 * length[0]))
        given = self.force if force is None else force
        late = {each.get("delay", 0.0): each for each in sets}  # most lanes differ in other numbers
        pushes = {delay: self.inverse.driving(given, each)[self.rows] for delay, each in late.items()}
        driving = np.array([pushes[each.get("delay", 0.0)] - self._of_beside(each) for each in sets])
        found = self.model.of(self.time, driving, sets, self.first, states, limits, straight)
        return None if found is None else found[0 if self.output == "position" else 1]

    def _of_beside(self, values: Given) -> Array:
        """What of the measured force neither moves the body nor is the law's, at the measured position and speed."""
        return np.asarray(np.array([values[name] for name in self.beside]) @ self.columns)

    def _without_means(self, x: Array) -> Array:
        """Positions less their mean in each window: the least squares over its first position, which only shifts it."""
        if self.output == "velocity":
            return x
        for part in self.parts:
            x[:, part] -= x[:, part].mean(axis=1, keepdims=True)
        return x

    @property
    def hidden(self) -> int:
        """Numbers that are fitted beside the coordinates: the first position of each window."""
        return len(self.windows) if self.output == "position" else 0

    def input_noise(self, u: Array, deviation: float) -> float:
        """What the input's errors do to the output, as a standard deviation at its rows, less what the windows' own states
        take up: white noise of the measured force, and its course between samples, which nobody measured."""
        noisy = self.with_force_noise(deviation, np.random.default_rng(0))
        shifts = [self._shift(u, noisy, False), self.between_samples(u)]
        squares = 0.0
        for shift in shifts:
            for part in self.parts:  # a straight line: position and velocity at the start
                x = np.linspace(-1, 1, part.stop - part.start)
                shift[part] -= shift[part].mean() + x * (x @ shift[part]) / max(float(x @ x), 1e-300)
            squares += float(np.mean(shift**2))
        return float(np.sqrt(squares))

    def between_samples(self, u: Array) -> Array:
        """How the output changes where the force goes straight from sample to sample, not along cubics."""
        return self._shift(u, self.force, True)

    def with_force_noise(self, deviation: float, draw: np.random.Generator) -> Array:
        """The force at each row of the record, in the windows with more white noise."""
        noisy = self.force.copy()
        noisy[self.rows] += deviation * draw.standard_normal(len(self.rows))
        return noisy

    def _shift(self, u: Array, force: Array, straight: bool) -> Array:
        sets, points = [self.values(u)], u[None, :]
        usual, other = self.simulated(sets, points), self.simulated(sets, points, force, straight)
        if usual is None or other is None:
            return np.zeros(len(self.measured))
        return np.asarray(self._without_means(other - usual)[0])


def raw(log: Log, output: str) -> Array:
    """The measured output as it was before any filter, where the log has it."""
    kept = log.unfiltered if log.sources.get("unfiltered") == output else None
    return np.asarray(getattr(log, output) if kept is None else kept)


def white_noise(x: Array, runs: Sequence[slice]) -> float:
    """The standard deviation of white noise on a signal that is smooth from sample to sample: by third differences."""
    squares = [np.diff(x[rows], 3) ** 2 / 20.0 for rows in runs if rows.stop - rows.start > 8]
    # a few jumps are the signal's own: the median tells the level, for normal noise 0.455 of the mean square
    smooth = float(np.sqrt(float(np.median(np.concatenate(squares))) / 0.455)) if squares else 0.0
    return max(smooth, float(_quantum(x) / np.sqrt(12)))


def output_noise(log: Log, output: str) -> float:
    """The standard deviation of the output's noise; of a velocity that is the slope of a filtered position, which is not
    white, from that of the position."""
    runs = list(log.runs())
    if output != "velocity" or log.sources.get("unfiltered") != "position" or log.unfiltered is None:
        return white_noise(raw(log, output), runs)
    noise = white_noise(log.unfiltered, runs) * np.random.default_rng(0).standard_normal(_DRAWN)
    if log.bandwidth is not None:
        noise = low_pass(noise, log.bandwidth, log.step)
    return float(np.std(spline_derivative(noise, log.step)[_DRAWN // 8 : -_DRAWN // 8]))


def _quantum(x: Array) -> float:
    """The step of a signal that takes only multiples of one; 0 for another."""
    steps = abs(np.diff(x))
    steps = steps[steps > 1e-12 * np.ptp(x)]
    if not len(steps):
        return 0.0
    smallest = float(np.min(steps))
    count = steps / smallest
    whole = float(np.quantile(abs(count - np.round(count)), 0.9)) < 0.01 and float(np.median(count)) < 1e3
    return smallest if whole else 0.0
