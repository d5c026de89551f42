"""The verdict of a loop: quiet, creeping, hunting or unstable, by simulations that are lengthened until it is clear."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import ArrayLike

from stribeck.arrays import Array
from stribeck.loops.loop import MOST_STEPS, Loop, resolution_of, simulate_lanes
from stribeck.loops.oscillation import amplitude_and_period
from stribeck.loops.shaken import swings
from stribeck.simulation.ensemble import Ensemble

TRAVEL = 1e-6  # of its travel: the rest band of a body without an encoder; what is promised of y, so less may be error
# Slowest time constants that are simulated first after the signals rest: in the first half, every linear mode decays to
# e**-12 = 6e-6 of itself, about the rest band.
SHORTEST = 24
# The same at last, eleven doublings: an integral that winds up against friction takes thousands of time constants to
# break away, and a loop that sticks takes few steps.
LONGEST = 49152
_WAITS = 50_000  # steps of a resting lane whose friction force grows too slowly to break away within LONGEST
_ROWS = 1000  # of the judged half: 60 in each of 16 cycles, whose peaks are then exact to 0.14 %
_ENOUGH_CYCLES = 8  # of a sustained oscillation: two in each judged quarter
# Relative change of a sustained oscillation from the first judged quarter to the last: at most this, as one that decays so
# slowly still needs 300 times the judged time to end. An extreme between two rows alone changes it by 0.14 %.
_KEEPS = 0.003
# Of the rest band, such as an encoder's step: an additional allowance for the quarters' differences, as a step at another
# instant shifts an extreme by a part of it.
_COUNTS = 0.2
# Relative spread of the quarters of a regular oscillation: several times the error of a peak between two rows.
_ALIKE = 0.01
# Motion in the second half over that in the first, or its inverse: creep that slows down by more in this time comes to rest
# within some 50 times of it, which is simulated; one that gets faster ends in a slip.
_STEADY = 0.98
# The same of a contact's force: one that slows down less is extrapolated linearly, as the sum of a geometric series with
# a ratio near 1 depends on noise.
_SLOWS = 0.9
_MOVES_ON = 1e-3  # of F_s, in the judged time: at a constant rate, break-away is then a thousand such times away
# Of F_s: a contact whose force settles above may break away.
_NEAR = 0.9
_FAR = 100.0  # of the move: far beyond any overshoot, so only an unstable loop goes there
_AT_LIMIT = 0.999  # of the limit: an output above it saturates, up to rounding and interpolation
_OFTEN = 0.02  # of the time, at each limit: with more, the limit bounds the oscillation; 20 of _ROWS, no single spike
_ONE_WAY = 0.9  # net over total motion: with more, the body creeps; it goes back by 5 % of its way at most
# Rows of a run that ended early, two a third; growth from its first third to its last that no transient has.
_FEW, _GREW = 6, 10.0
_GROWS = 1.15  # growth from one third to the next, at the end of the longest run: more than an irregular cycle's spread

WINDS = "the friction force still changes while the body sticks"
SHAKEN = "the remaining motion is that of the dither"
SLOWING = "the motion still slows down at the end of the longest run: the body may come to rest"
IRREGULAR = "the amplitude still varies at the end of the longest run: the oscillation may stop by chance"

Tell = Callable[[float], None]


@dataclass(frozen=True)
class Judgment:
    """The behavior of a loop after its signals rest.

    Attributes:
        verdict: "quiet", "creeping", "hunting", "unstable"; "failed" where the simulation ended early.
        body: the body whose motion exceeds its rest band most.
        amplitude: half of peak to peak of its motion in the judged time, m or rad.
        period: period of its oscillation, s; nan if it does not oscillate.
        note: the reason, in a few words.
        steps: steps of the solver, in all runs.
        rested: slowest time constants from the rest of the signals until the last motion beyond the rest band; inf if it
            does not rest.
    """

    verdict: str
    body: str
    amplitude: float
    period: float
    note: str = ""
    rested: float = field(default=np.inf, compare=False)
    steps: int = field(default=0, compare=False)

    @property
    def quiet(self) -> bool:
        """Whether every body ends at rest."""
        return self.verdict == "quiet"


def judge(
    loop: Loop,
    values: Mapping[str, ArrayLike] | None = None,
    tell: Tell | None = None,
    slowest: Array | None = None,
    most_steps: int = MOST_STEPS,
) -> list[Judgment]:
    """The judgment of each lane of ``values`` (as for :func:`stribeck.simulate`); of the file if there are none.

    A lane is simulated until its signals rest and then for at least :data:`SHORTEST` of the slowest time constants; the second
    half of these is judged. Unless it shows a steady state (rest with constant friction, a cycle of constant size), the lane is
    simulated twice as long, and so on. While an integral winds up, it is simulated until friction may have broken away.

    Args:
        tell: called with the completed share.
        slowest: the slowest time constant of each lane, s; the loop's unless given.
        most_steps: steps of the solver for one lane; a lane that needs more is judged by the end of a shorter run.
    """
    given = {path: np.atleast_1d(np.asarray(x, float)) for path, x in (values or {}).items()}
    count = max((len(x) for x in given.values()), default=1)
    tau = np.full(count, loop.slowest) if slowest is None else np.asarray(slowest, float)
    judging = _Judging(loop, given, tau, swings(loop, given, count), most_steps)
    while judging.open.any():
        judging.further()
        if tell is not None:
            tell(judging.share_done())
    return [each for each in judging.judgments if each is not None]


class _Judging:
    """Lanes that are simulated until each is judged."""

    def __init__(
        self, loop: Loop, values: dict[str, Array], tau: Array, swing: list[dict[str, float]], most_steps: int
    ) -> None:
        self.loop, self.values, self.tau, self.swing, self.most_steps = loop, values, tau, swing, most_steps
        self.judgments: list[Judgment | None] = [None] * len(tau)
        # The length of each lane's next run is 2**octave s: at least a quarter of the time until the signals rest, which would
        # otherwise take most of the rows.
        self.octave = np.ceil(np.log2(np.maximum(SHORTEST * tau, loop.rest / 4)))
        self.open = np.ones(len(tau), bool)
        self.steps = np.zeros(len(tau), np.int64)

    def share_done(self) -> float:
        """The completed share; an open lane counts by the number of its doublings."""
        doublings = np.maximum(self.octave - np.log2(SHORTEST * self.tau), 0.0) / np.log2(LONGEST / SHORTEST)
        return float(np.where(self.open, np.minimum(doublings, 0.95), 1.0).mean())

    def further(self) -> None:
        """Simulate the open lanes of the shortest length and judge them.

        Lanes of about one length go together, also those whose shorter runs did not decide: a full vector of lanes takes
        hardly longer than one lane.
        """
        octave = self.octave[self.open].min()
        group = np.flatnonzero(self.open & (self.octave == octave))
        length = float(2.0**octave)
        values = {p: x if len(x) == 1 else x[group] for p, x in self.values.items()}
        step = length / 2 / _ROWS  # rows in the second half, which is judged
        end = float(np.ceil((self.loop.rest + length) / step) * step)
        lanes = simulate_lanes(self.loop.lean, values, end, step, len(group))
        for lane, place in enumerate(group):
            self._judge(int(place), lanes, lane, length)

    def _judge(self, place: int, lanes: Ensemble, lane: int, length: float) -> None:
        steps, tau = int(lanes.accepted[lane] + lanes.rejected[lane]), float(self.tau[place])
        gave_up = lanes.reason[lane] is not None and steps >= MOST_STEPS
        longer = min(length * self.most_steps / max(steps, 1), LONGEST * tau)  # the longest run allowed
        last = gave_up or longer < 1.5 * length
        record = _LaneRecord(self.loop, lanes, lane, tau, self.swing[place], last)
        self.steps[place] += steps
        judgment, wanted = record.judge()
        self.judgments[place] = replace(judgment, steps=int(self.steps[place]))
        if record.waits and wanted > longer:  # break-away is later than the longest run
            wanted = 2 * length if 2 * steps < _WAITS else 0.0
        self.open[place] = wanted > length and not last
        self.octave[place] = min(np.ceil(np.log2(max(wanted, 2 * length))), np.rint(np.log2(longer)))


class _LaneRecord:
    """One lane's run and what its last rows show; ``last``: it will not be simulated longer."""

    def __init__(
        self, loop: Loop, lanes: Ensemble, lane: int, tau: float, swing: dict[str, float], last: bool = False
    ) -> None:
        self.loop, self.lanes, self.lane, self.tau, self.swing, self.last = loop, lanes, lane, tau, swing, last
        machine = loop.scenario.elements
        self.main = machine.leader(machine.system.controllers[0].body).name
        self.moving = [b.name for b in machine.bodies.values() if b.free]
        reached = int(np.isfinite(self.column(f"{self.main}.y")).sum())
        self.reached = slice(0, reached)
        last_rows = _ROWS // 4 if last else _ROWS + 1  # if the run cannot be longer, only its end is judged
        self.rows = slice(max(reached - last_rows, 0), reached)
        self.t = lanes.t
        self.waits = False  # at rest, for friction to break away

    def column(self, name: str) -> Array:
        """A column of the lane."""
        return np.asarray(self.lanes[name][self.lane])

    def judge(self) -> tuple[Judgment, float]:
        """The judgment, and the length to simulate next after the signals' rest, s; 0 if it is decided."""
        length = float(self.t[self.rows][-1]) - self.loop.rest if self.reached.stop else 0.0
        if self._diverged() or (self.lanes.not_finite[self.lane] and self._grew()):
            return Judgment("unstable", self.main, np.nan, np.nan, "it grows without end"), 0.0
        ended = self.reached.stop <= _FEW or self.lanes.not_finite[self.lane]  # what was reached shows no rest
        if (reason := self.lanes.reason[self.lane]) is not None and (ended or not self.last):
            return Judgment("unstable" if self._grew() else "failed", self.main, np.nan, np.nan, reason), 0.0
        rest = self._rest_bands()
        excess = {name: self._peak_to_peak(name) / rest[name] if rest[name] else 0.0 for name in self.moving}
        body = self.main if excess.get(self.main, 0.0) > 1 else max(excess, key=excess.__getitem__)
        breaks = self._break_away_time()
        if max(excess.values()) <= 1:
            return self._judge_rest(rest, breaks, length)
        y = self.column(f"{body}.y")[self.rows]
        if _goes_one_way(y):  # which may be a single slip of a cycle, as only the end of the last run is judged
            self.rows = slice(max(self.reached.stop - _ROWS - 1, 0), self.reached.stop)
            y = self.column(f"{body}.y")[self.rows]
        if _goes_one_way(y):
            amplitude = float(np.ptp(y)) / 2
            first, second = abs(y[len(y) // 2] - y[0]), abs(y[-1] - y[len(y) // 2])
            steady = _STEADY * first < second < first / _STEADY
            steady &= breaks is None and length > 4 * SHORTEST * self.tau
            note = SLOWING if self.last and not steady else ""
            return Judgment("creeping", body, amplitude, np.nan, note), (
                0.0 if steady else self._next_length(breaks, length)
            )
        return self._judge_oscillation(body, y, rest[body], length)

    def _judge_rest(self, rest: dict[str, float], breaks: float | None, length: float) -> tuple[Judgment, float]:
        """Quiet; simulated longer if the motion within the rest band grows, or if friction may still break away."""
        main = f"{self.main}.y"
        note = WINDS if breaks is not None else SHAKEN if self.swing else ""
        judgment = Judgment("quiet", self.main, self._peak_to_peak(self.main) / 2, np.nan, note, self._rest_time(rest))
        y = self.column(main)[self.rows]
        before, after = (float(np.ptp(part)) for part in np.array_split(y, 2))
        grows = after > 2 * before and after > 0.1 * rest[self.main]
        self.waits = breaks is not None and not grows
        return judgment, self._next_length(breaks, length) if breaks is not None or grows else 0.0

    def _judge_oscillation(self, body: str, y: Array, rest: float, length: float) -> tuple[Judgment, float]:
        """Hunting or unstable; simulated longer until the oscillation keeps its size."""
        amplitude, period = (float(x) for x in amplitude_and_period(self.t[self.rows], y))
        quarters = [float(np.ptp(part)) for part in np.array_split(y, 4)]
        spread = max(quarters) - min(quarters)
        cycles = float(self.t[self.rows][-1] - self.t[self.rows][0]) / period if period > 0 else 0.0
        change = abs(quarters[3] - quarters[0])
        keeps = cycles >= _ENOUGH_CYCLES and length > 2 * SHORTEST * self.tau and min(quarters) > rest  # else it drifts
        keeps &= spread <= _ALIKE * max(quarters) + _COUNTS * rest and change <= _KEEPS * quarters[0] + _COUNTS * rest
        wanted = 0.0 if keeps else 2 * length
        if self._saturates():
            return Judgment("unstable", body, amplitude, period, "the oscillation is bounded by saturation"), wanted
        thirds = [float(np.ptp(part)) for part in np.array_split(y, 3)]
        grows = thirds[1] > _GROWS * thirds[0] and thirds[2] > _GROWS * thirds[1]
        if self.last and grows and cycles > len(thirds):  # a single slip grows as well, and is no oscillation
            return Judgment("unstable", body, amplitude, period, "the oscillation grows"), wanted
        return Judgment("hunting", body, amplitude, period, IRREGULAR if self.last and not keeps else ""), wanted

    def _next_length(self, breaks: float | None, length: float) -> float:
        """Twice the length, or the time until a cycle after friction may have broken away, s."""
        return max(2 * length, 0.0 if breaks is None else 1.5 * (breaks + length))

    def _peak_to_peak(self, name: str) -> float:
        return float(np.ptp(self.column(f"{name}.y")[self.rows]))

    def _rest_bands(self) -> dict[str, float]:
        """Peak to peak motion at rest of each body: as :func:`rest_bands`, and the swing that a dither causes."""
        travel = {name: float(np.ptp(self.column(f"{name}.y")[self.reached])) for name in self.moving}
        rest = rest_bands(self.loop, travel)
        return {name: x + self.swing.get(name, 0.0) for name, x in rest.items()}

    def _rest_time(self, rest: dict[str, float]) -> float:
        """Slowest time constants from the rest of the signals until all bodies stay in their rest bands."""
        last = 0.0
        for name in self.moving:
            y = self.column(f"{name}.y")[self.reached]
            away = np.flatnonzero(np.abs(y - y[-1]) > max(rest[name], 1e-300))
            last = max(last, float(self.t[away[-1]]) if len(away) else 0.0)
        return max(last - self.loop.rest, 0.0) / self.tau

    def _break_away_time(self) -> float | None:
        """Time until a contact under growing force may break away, s, extrapolated from its mean force.

        None if no contact's force changes, or if it settles below F_s.
        """
        machine, times = self.loop.scenario.elements, list[float]()
        for contact in machine.system.contacts:
            law = machine.laws[contact.law_path]
            most = float(law.scales(law.p).force)
            force = self.column(f"{contact.name}.F")[self.rows]
            means = [float(part.mean()) for part in np.array_split(force, 4)]
            first, second = means[1] - means[0], means[3] - means[2]
            if not abs(means[3] - means[0]) > _MOVES_ON * most:
                continue
            slowing = (
                second / first if first else np.inf
            )  # over half of the judged time; its root is that over a quarter
            if 0 < slowing < _SLOWS:
                settled = means[3] + second * np.sqrt(slowing) / (1 - np.sqrt(slowing))
                if abs(settled) < _NEAR * most:
                    continue
            force_left = (most - abs(means[3])) if second * means[3] > 0 else most + abs(means[3])
            quarter = float(self.t[self.rows][-1] - self.t[self.rows][0]) / 4
            times.append(max(force_left, 0.1 * most) / max(abs(second), 1e-300) * quarter)
        return min(times, default=None)

    def _diverged(self) -> bool:
        """Whether the error exceeds :data:`_FAR` times the move of signal and start."""
        each = self.loop.scenario.system.controllers[0]
        y, r = (self.column(name)[self.reached] for name in (f"{each.measures}.y", f"{each.name}.r"))
        if not len(y):
            return False
        size = max(float(np.ptp(r)), abs(float(y[0] - r[-1])), self.loop.travel.get(self.main, 0.0))
        return bool(size > 0 and np.abs(y - r).max() > _FAR * size)

    def _grew(self) -> bool:
        """Whether a motion whose simulation ended early was growing."""
        y = self.column(f"{self.main}.y")[self.reached]
        thirds = [float(np.ptp(part)) for part in np.array_split(y, 3)] if len(y) > _FEW else [0.0, 1.0]
        return thirds[-1] > _GREW * thirds[0]

    def _saturates(self) -> bool:
        """Whether an output saturates on both sides for part of the time."""
        machine = self.loop.scenario.elements
        outputs = [
            (self.column(f"{each.name}.u"), machine.values[each.path, "limit"])
            for each in machine.system.controllers if each.limit is not None
        ]  # fmt: skip
        outputs += [
            (self.column(f"{motor.name}.V"), machine.values[motor.path, "voltage"])
            for motor in machine.system.motors if motor.voltage is not None
        ]  # fmt: skip
        return any(_saturates_both_ways(x[self.rows], limit) for x, limit in outputs)


def rest_bands(loop: Loop, travel: dict[str, float]) -> dict[str, float]:
    """Peak to peak motion within which each body counts as at rest, by its ``travel``, m or rad.

    It is a millionth of the travel, or the encoder's step, carried over to the other bodies by the ratio of their travels.
    """
    machine = loop.scenario.elements
    rest = {name: TRAVEL * max(x, loop.travel.get(name, 0.0)) for name, x in travel.items()}
    for each in machine.system.controllers:
        step = resolution_of(loop.scenario, each)
        name = machine.leader(each.body).name
        if step and travel.get(name):
            for other, x in travel.items():
                rest[other] = max(rest[other], step if other == name else step * x / travel[name])
    return rest


def _goes_one_way(y: Array) -> bool:
    return bool(abs(y[-1] - y[0]) > _ONE_WAY * np.abs(np.diff(y)).sum())


def _saturates_both_ways(x: Array, limit: float) -> bool:
    high, low = np.mean(x > _AT_LIMIT * limit), np.mean(x < -_AT_LIMIT * limit)
    return bool(min(high, low) > _OFTEN)
