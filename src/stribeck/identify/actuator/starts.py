"""The initial states of recordings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stribeck.identify.actuator.coordinates import MachineCoordinate, paths
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import FAR, Channel, Recording
from stribeck.identify.actuator.runs import RecordedRun, least_step, recorded_run
from stribeck.identify.features.filtering import roughness
from stribeck.identify.log import FEWEST_SAMPLES, FIRST_SAMPLES
from stribeck.scenario import Scenario

_BENDS = 2.0  # times the noise: a larger residual shows that a parabola does not describe the samples
_SIGNIFICANT = 3.0, 2.5  # standard deviations of an initial speed, and of the slope of the first samples, of a motion


def problem_of(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], sought: Sequence[MachineCoordinate],
    noise: dict[str, float], **options: object,
) -> MachineProblem:  # fmt: skip
    """The problem of some recordings, with the coordinates of their initial states behind ``sought``.

    ``options``: further attributes of the problem.
    """
    runs, starts = prepared(scenario, recordings, sought)
    return MachineProblem(runs, [*sought, *starts], noise, **options)  # type: ignore[arg-type]


def prepared(
    scenario: Scenario, recordings: Sequence[tuple[int, Recording]], sought: Sequence[MachineCoordinate]
) -> tuple[list[RecordedRun], list[MachineCoordinate]]:
    """The runs, and the coordinates of their initial states."""
    runs: list[RecordedRun] = []
    starts: list[MachineCoordinate] = []
    for log, recording in recordings:
        run, begins = _Beginning(scenario, recording, log, sought).states()
        if run.size:
            runs.append(run)
            starts += begins
    return runs, starts


def state_at(channel: Channel) -> tuple[float, float, float, float]:
    """A measured position and its rate at time 0, and their standard deviations.

    Both come from a parabola through the nearest samples, as many as it describes.
    """
    good = np.isfinite(channel.x)
    t, x = channel.t[good], channel.x[good]
    order = np.argsort(abs(t))[:FIRST_SAMPLES]
    noise = roughness([x[np.sort(order)]])
    for count in range(len(order), 0, -2):
        near = np.sort(order[:count])
        s, span = t[near], max(np.ptp(t[near]), 1e-12)
        A = np.stack([np.ones(len(s)), s / span, (s / span) ** 2], axis=1)
        parabola, *_ = np.linalg.lstsq(A, x[near], rcond=None)
        left = x[near] - A @ parabola
        rough = float(np.sqrt(left @ left / max(len(s) - 3, 1)))
        if rough <= _BENDS * noise or count <= FEWEST_SAMPLES // 2:
            break
    spread = max(rough, least_step(x[near]) / 3) * np.sqrt(np.diag(np.linalg.pinv(A.T @ A)))
    spread[:2] += np.ptp(x[near]) / FAR  # the motion may bend more than a parabola: bounds must not cut it off
    return float(parabola[0]), float(parabola[1] / span), float(spread[0]), float(spread[1] / span)


def moves(channel: Channel) -> bool:
    """Whether the first samples of a measured position or speed show a motion: a large range or a significant slope."""
    good = channel.x[np.isfinite(channel.x)]
    x = good[:FIRST_SAMPLES]
    noise = max(roughness([x]), least_step(good) / np.sqrt(12), channel.noise or 0.0)
    if not np.ptp(x) > 0:
        return False
    index = np.arange(len(x)) - (len(x) - 1) / 2
    slope = abs(float(index @ x)) / np.sqrt(float(index @ index))
    return bool(np.ptp(x) > FAR * noise or slope > _SIGNIFICANT[1] * noise)


@dataclass(frozen=True)
class _Beginning:
    """The start of a recording.

    If the file, the recording or the user gives a body's initial state, it is used. Otherwise the first samples give an
    estimate, which the fit refines.
    """

    scenario: Scenario
    recording: Recording
    log: int
    sought: Sequence[MachineCoordinate]

    def states(self) -> tuple[RecordedRun, list[MachineCoordinate]]:
        """The run to simulate, and the coordinates of its initial state."""
        sensors = {(c.output, c.log) for c in self.sought if c.output is not None}
        late = any(what in ("delay", "clock") or log is not None for (_, what), log in sensors)
        run = recorded_run(self.scenario, self.recording, self.log, late)
        starts: list[MachineCoordinate] = []
        known: set[str] = set()
        outputs = sorted(self.recording.outputs.items(), key=lambda each: each[0].endswith(".v"))
        for column, channel in outputs:
            name, _, what = column.rpartition(".")
            offsets = {((column, "offset"), log) for log in (None, self.log)}
            if what not in ("y", "v") or not self._free(name) or offsets & sensors:
                continue
            carried = {b: f for b, f in self.scenario.elements.carried(name).items() if b not in known}
            known |= set(carried)
            x, rate, dx, drate = state_at(channel)
            states = {"y": (x, dx), "v": (rate, drate)} if what == "y" else {"v": (x, dx)}
            for kind, (value, deviation) in states.items():
                targets = {f"bodies.{b}.initial.{kind}": f for b, f in carried.items() if not self._given(b, kind)}
                if targets and self._differs(channel, what, kind, value):
                    starts.append(self._coordinate(run, f"{name}.{kind}", targets, value, deviation))
        return run, starts

    def _free(self, body: str) -> bool:
        machine = self.scenario.system
        return body in machine.elements.bodies and machine.elements.leader(body).velocity is None

    def _given(self, body: str, kind: str) -> bool:
        """Whether a body's initial state is given."""
        path = f"bodies.{body}.initial.{kind}"
        inside = self.scenario.data["bodies"].get(body, {}).get("initial", {})
        return kind in inside or path in self.recording.known or path in paths(self.sought)

    def _differs(self, channel: Channel, what: str, kind: str, value: float) -> bool:
        """Whether the first samples may tell the state from 0, the machine's own."""
        if kind == "v":
            return what == "v" or moves(channel)
        return not abs(value) < 1e-12 * max(1.0, float(np.nanmax(abs(channel.x))))

    def _coordinate(
        self, run: RecordedRun, name: str, targets: dict[str, float], value: float, deviation: float
    ) -> MachineCoordinate:
        """The coordinate of one state, at which the run begins."""
        room = FAR * max(deviation, 1e-9 * max(abs(value), 1e-3))
        still = name.endswith(".v") and abs(value) < _SIGNIFICANT[0] * deviation
        first = 0.0 if still else value  # rest unless motion is significant: a false speed would deflect bristles
        run.start |= {path: f * first for path, f in targets.items()}
        label = f"log.{self.log}.initial.{name}"
        low, high = min(value - room, first), max(value + room, first)
        return MachineCoordinate(label, low, high, first, None, targets, None, self.log, True)
