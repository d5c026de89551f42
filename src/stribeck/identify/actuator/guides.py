"""Guides: springs and dampers that draw each measured body along its measured motion, as a state observer does.

Under a guide, the distance from the measured motion is the error of the forces, filtered. So errors do not accumulate, and
the simulation can follow where a free one cannot: an unstable motion, or a machine that lacks a force.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.bridges import DRAWS
from stribeck.identify.actuator.inputs import STILL
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.identify.data.smoother import encoder_step, smooth
from stribeck.identify.features.filtering import roughness
from stribeck.scenario import Scenario
from stribeck.scenario.changes import unused_prefix

CARRIED = "noise of the measured motion"  # a cause of error
_LOOSER = 3.0  # ratio of the bandwidths of two guides, half a decade


@dataclass(frozen=True)
class _Motion:
    """A body's measured motion, smoothed; without ``y``, only its speed is measured.

    ``path``, ``inertia``: of the machine's file. ``column``, ``noise``, ``step``: of the measured column; ``step``: of its
    encoder, 0 without one.
    """

    body: str
    path: str
    inertia: float
    column: str
    noise: float
    step: float
    t: Array
    v: Array
    y: Array | None = None

    def spring(self, bandwidth: float) -> tuple[float, float]:
        """The stiffness and the damping of a critically damped guide."""
        return (0.0 if self.y is None else self.inertia * bandwidth**2), 2 * self.inertia * bandwidth


def _motions(scenario: Scenario, recording: Recording) -> Iterator[_Motion]:
    """The measured motions of bodies that forces move."""
    bodies = scenario.system.elements.bodies
    for column, channel in recording.outputs.items():
        name, _, what = column.rpartition(".")
        if name not in bodies or scenario.elements.leader(name).velocity is not None:
            continue
        if what not in ("y", "v") or (what == "v" and f"{name}.y" in recording.outputs):
            continue
        t, x = channel.bridged.t, channel.bridged.x
        if not np.ptp(x) > 0:
            continue
        position, rate = channel.smoothed(t), channel.smoothed.derivative()(t)
        table = scenario.data["bodies"][name]
        inertia = "mass" if "mass" in table else "inertia"
        y, v = (position, rate) if what == "y" else (None, position)
        yield _Motion(
            name, f"bodies.{name}.{inertia}", float(table[inertia]), column, roughness([x]), encoder_step([x]), t, v, y
        )


def _inputs(motions: Sequence[_Motion], bandwidth: float, prefix: str) -> dict[str, Channel]:
    """The forces of guides on bodies at rest at 0, by the path of their signals."""
    inputs = {}
    for m in motions:
        stiffness, damping = m.spring(bandwidth)
        force = damping * m.v + (0.0 if m.y is None else stiffness * m.y)
        inputs[f"loads.{prefix}pull_{m.body}.signal"] = Channel("guide", m.t, force, smooth=True)
    return inputs


def _noisier(recording: Recording, motions: Sequence[_Motion]) -> Iterator[tuple[Recording, list[_Motion]]]:
    """The recording with other noise added to its measured motions, and these, smoothed as before.

    An encoder's noise is that of rounding: none that is random at rest, where it would shake the friction loose.
    """
    rng = np.random.default_rng(0)
    for _ in range(DRAWS):
        outputs, noisier = dict(recording.outputs), list[_Motion]()
        for m in motions:
            c = outputs[m.column]
            noise = np.sqrt(max(m.noise**2 - m.step**2 / 12, 0.0)) * rng.standard_normal(len(c.x))
            if m.step:
                phase = c.smoothed(c.t) + m.step * rng.random()
                noise = m.step * np.round((phase + noise) / m.step) - phase
            outputs[m.column] = replace(c, x=c.x + noise)
            carried = smooth(m.t, np.interp(m.t, c.t, noise), c.smoothing)
            y, v = (None, m.v + carried(m.t)) if m.y is None else (m.y + carried(m.t), m.v + carried.derivative()(m.t))
            noisier.append(replace(m, y=y, v=v))
        yield replace(recording, outputs=outputs), noisier


def _with(recording: Recording, inputs: Mapping[str, Channel]) -> Recording:
    return replace(recording, inputs={**recording.inputs, **inputs})


@dataclass(frozen=True)
class Guided:
    """A machine and its numbered recordings with critically damped guides; ``prefix``: of the guides' elements."""

    scenario: Scenario
    recordings: Sequence[tuple[int, Recording]]
    prefix: str = ""


class Guides:
    """Guides of several bandwidths along some recordings of a machine."""

    def __init__(self, scenario: Scenario, recordings: Sequence[tuple[int, Recording]]) -> None:
        self._scenario, self._recordings = scenario, recordings

    @cached_property
    def _motions(self) -> dict[int, list[_Motion]]:
        return {i: list(_motions(self._scenario, r)) for i, r in self._recordings}

    @cached_property
    def _noisier(self) -> dict[int, list[tuple[Recording, list[_Motion]]]]:
        """The recordings with other noise added to their measured motions, and these motions."""
        return {i: list(_noisier(r, self._motions[i])) for i, r in self._recordings}

    def noise(self, i: int) -> dict[str, float]:
        """The noise of the sensors that can guide bodies in recording i, by column."""
        return {m.column: max(m.noise, m.step / np.sqrt(12)) for m in self._motions[i]}

    @cached_property
    def bandwidths(self) -> list[float]:
        """0 (no guide), then rad/s from below the motion's own frequency to the inverse of the sampling interval."""
        every = [m for motions in self._motions.values() for m in motions]
        frequencies = [1 / np.ptp(m.t) if m.y is None else np.std(m.v) / np.std(m.y) for m in every]
        low = min(frequencies, default=np.inf) / _LOOSER
        high = 1 / min(float(np.median(np.diff(r.t))) for _, r in self._recordings)
        count = int(np.log(high / low) / np.log(_LOOSER)) + 1 if every else 0
        return [0.0, *(float(low * _LOOSER**n) for n in range(count))]

    def at(self, bandwidth: float, noisy: bool = False) -> Guided:
        """The machine and its recordings with guides of a bandwidth; without any at 0.

        Args:
            noisy: the recordings have alternatives with the noise of their measured motion added once more.
        """
        if not bandwidth:
            return Guided(self._scenario, self._recordings)
        changes, guided = dict[str, object](), list[tuple[int, Recording]]()
        prefix = unused_prefix(self._scenario.data, "guide_")
        for i, recording in self._recordings:
            for m in self._motions[i]:
                stiffness, damping = m.spring(bandwidth)
                link = {"from": m.body, "to": "ground", "stiffness": stiffness, "damping": damping}
                changes[f"links.{prefix}spring_{m.body}"] = link
                changes[f"loads.{prefix}pull_{m.body}"] = {"on": m.body, "kind": "signal", "signal": STILL}
            pulls = _inputs(self._motions[i], bandwidth, prefix)
            others = {cause: [_with(x, pulls) for x in same] for cause, same in recording.as_well.items()}
            if noisy:
                others[CARRIED] = [_with(x, _inputs(motions, bandwidth, prefix)) for x, motions in self._noisier[i]]
            guided.append((i, replace(_with(recording, pulls), as_well=others)))
        return Guided(self._scenario.with_changes(changes), guided, prefix)

    def forces(
        self, i: int, bandwidth: float, motion: Mapping[str, Array], numbers: Mapping[str, float]
    ) -> tuple[float, float]:
        """The rms force of the guides along a simulated motion of recording i, and of the other forces on the bodies.

        Args:
            motion: simulated columns, and their times ``t``.
            numbers: the machine's fitted numbers by path.
        """
        pulls, others, t = [0.0], [0.0], motion["t"]
        for m in self._motions[i]:
            stiffness, damping = m.spring(bandwidth)
            y, v = motion[f"{m.body}.y"], motion[f"{m.body}.v"]
            pull = damping * (np.interp(t, m.t, m.v) - v)
            if m.y is not None:
                pull += stiffness * (np.interp(t, m.t, m.y) - y)
            pulls.append(float(np.mean(pull**2)))
            total = numbers.get(m.path, m.inertia) * np.gradient(v, t)
            others.append(float(np.mean((total - pull) ** 2)))
        return float(np.sqrt(np.sum(pulls))), float(np.sqrt(np.sum(others)))
