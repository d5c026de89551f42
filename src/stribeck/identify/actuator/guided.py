"""Draws each measured body along its measured motion, by a spring and a damper.

One slip more or less changes all later samples, so the cost of a whole recording has many local minima. Under a stiff guide,
the distance from the measured motion is the error of the forces, filtered, and its cost has few. No derivative of a noisy
position is needed: the speed in the friction is the simulated one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.interpolate import UnivariateSpline

from stribeck.arrays import Array
from stribeck.identify.actuator.recordings import Channel, Recording
from stribeck.identify.actuator.runs import roughness
from stribeck.scenario import Scenario
from stribeck.scenario.changes import unused_prefix

_LOOSER = 3.0  # ratio of the bandwidths of two guides, half a decade
_EXACT = 1e-9  # of a column's changes: least noise of a smoothing spline, against rounding
_STILL = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}


@dataclass(frozen=True)
class _Motion:
    """A body's measured motion, smoothed, and the body's inertia; without ``y``, only its speed is measured."""

    body: str
    inertia: float
    t: Array
    v: Array
    y: Array | None = None


class Guides:
    """Guides of several bandwidths along some recordings of a machine.

    Attributes:
        bandwidths: rad/s; 0 (no guide), then from below the motion's own frequency to the inverse of the sampling interval.
    """

    def __init__(self, scenario: Scenario, recordings: Sequence[tuple[int, Recording]]) -> None:
        self._scenario, self._recordings = scenario, recordings
        self._motions = {i: list(_motions(scenario, r)) for i, r in recordings}
        every = [m for motions in self._motions.values() for m in motions]
        own = [1 / np.ptp(m.t) if m.y is None else np.std(m.v) / np.std(m.y) for m in every]
        low, high = min(own, default=np.inf) / _LOOSER, 1 / min(float(np.median(np.diff(r.t))) for _, r in recordings)
        count = max(int(np.log(high / low) / np.log(_LOOSER)) + 1, 0) if own else 0
        self.bandwidths = [0.0, *(low * _LOOSER**n for n in range(count))]

    def with_guide(self, level: int) -> tuple[Scenario, list[tuple[int, Recording]]]:
        """The machine with critically damped guides of a bandwidth, and its recordings."""
        bandwidth, changes = self.bandwidths[level], dict[str, object]()
        prefix = unused_prefix(self._scenario.data, "guide_")
        found = list[tuple[int, Recording]]()
        for i, recording in self._recordings:
            inputs = dict(recording.inputs)
            for m in self._motions[i]:
                stiffness = 0.0 if m.y is None else m.inertia * bandwidth**2
                damping = 2 * m.inertia * bandwidth
                spring, pull = f"{prefix}spring_{m.body}", f"{prefix}pull_{m.body}"
                changes[f"links.{spring}"] = {
                    "from": m.body, "to": "ground", "stiffness": stiffness, "damping": damping
                }  # fmt: skip
                changes[f"loads.{pull}"] = {"on": m.body, "kind": "signal", "signal": _STILL}
                force = damping * m.v + (0.0 if m.y is None else stiffness * m.y)
                inputs[f"loads.{pull}.signal"] = Channel("guide", m.t, force, smooth=True)
            found.append((i, replace(recording, inputs=inputs)))
        return self._scenario.with_changes(changes), found


def _motions(scenario: Scenario, recording: Recording) -> Iterator[_Motion]:
    """The measured motions of bodies that forces move."""
    bodies = scenario.system.elements.bodies
    for column, channel in recording.outputs.items():
        name, _, what = column.rpartition(".")
        if name not in bodies or scenario.system.leader(name).velocity is not None:
            continue
        if what not in ("y", "v") or (what == "v" and f"{name}.y" in recording.outputs):
            continue
        t, x = channel.bridged.t, channel.bridged.x
        if not np.ptp(x) > 0:
            continue
        noise = max(roughness([x]), _EXACT * float(np.std(x)))
        spline = UnivariateSpline(t, x, w=np.full(len(t), 1 / noise), s=len(t), k=4)
        table, smooth, rate = scenario.data["bodies"][name], spline(t), spline.derivative()(t)
        inertia = float(table.get("mass", table.get("inertia", 1.0)))
        yield _Motion(name, inertia, t, rate, smooth) if what == "y" else _Motion(name, inertia, t, smooth)
