"""The project's own synthetic rig: simulated experiments with sensors, noise and known truth.

Nothing here was measured, and everything that comes from here says so.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter, savgol_filter

from stribeck.arrays import Array
from stribeck.errors import StribeckError
from stribeck.identify.log import Log
from stribeck.laws.base import Law
from stribeck.scenario import Scenario
from stribeck.simulation import simulate

LABEL = "SYNTHETIC: simulated by Stribeck, not measured"


@dataclass(frozen=True)
class Sensors:
    """What the rig's sensors do to the truth; SI units, 0 for a perfect one.

    ``force_noise`` is the noise's standard deviation and ``force_memory`` the time over which it stays correlated.
    """

    position_resolution: float = 5e-9
    position_noise: float = 0.0
    force_resolution: float = 0.0
    force_noise: float = 0.0
    force_memory: float = 0.0


@dataclass(frozen=True)
class Slider:
    """What moves with the contact: mass (kg), spring to ground (N/m), constant force (N)."""

    mass: float = 0.0
    stiffness: float = 0.0
    offset: float = 0.0


@dataclass(frozen=True)
class Experiment:
    """A synthetic log and the truth behind it."""

    log: Log
    law: Law
    body: Slider
    sensors: Sensors
    seed: int


def experiment(
    law: Law,
    velocity: tuple[Array, Array],
    sensors: Sensors | None = None,
    body: Slider | None = None,
    seed: int = 0,
    every: int = 1,
) -> Experiment:
    """A log of a rig that moves the body as told and measures its position and the force that it takes.

    Args:
        law: the friction, with its true constants.
        velocity: times (s, evenly spaced, from 0) and the velocity there (m/s), straight between.
        sensors: what they do; by default an encoder of 5 nm and a perfect force sensor.
        body: what moves with the contact; nothing by default.
        seed: of the noise.
        every: the sensors see one of so many samples of the velocity.

    Raises:
        StribeckError: the law cannot be simulated on this motion.
    """
    sensors, body = sensors or Sensors(), body or Slider()
    t, v = velocity
    step = float(t[every] - t[0])
    solution = simulate(
        Scenario(
            law=law.to_dict(),
            drive={"kind": "velocity", "signal": {"kind": "points", "t": t.tolist(), "value": v.tolist()}},
            solve={"t_end": float(t[-1])},
            output={"step": step},
        )
    )
    if solution.reason is not None:
        raise StribeckError(f"the synthetic rig failed: {solution.reason}")
    noise = np.random.default_rng(seed)
    t, v, y = solution.t, v[::every], solution["y"]
    force = body.mass * np.gradient(v, step) + solution["F"] + body.stiffness * y + body.offset
    force = force + _force_noise(noise, len(t), step, sensors)
    position = _rounded(y + sensors.position_noise * noise.standard_normal(len(t)), sensors.position_resolution)
    log = Log(
        time=t, position=position,
        velocity=savgol_filter(position, 5, 4, deriv=1, delta=step),
        acceleration=savgol_filter(position, 5, 4, deriv=2, delta=step),
        force=_rounded(force, sensors.force_resolution),
        run=np.zeros(len(t), np.int32), step=step,
        sources={
            "position": LABEL, "force": LABEL,
            "velocity": f"{LABEL}; from position, quartic through 5 points",
            "acceleration": f"{LABEL}; from position, quartic through 5 points",
        },
        quality=(f"{LABEL}: law {type(law).name}, seed {seed}",),
    )  # fmt: skip
    return Experiment(log, law, body, sensors, seed)


def _rounded(x: Array, resolution: float) -> Array:
    return resolution * np.round(x / resolution) if resolution > 0 else x


def _force_noise(noise: np.random.Generator, count: int, step: float, sensors: Sensors) -> Array:
    """White noise, or noise of the same size that forgets exponentially."""
    white = noise.standard_normal(count)
    if sensors.force_memory <= 0:
        return np.asarray(sensors.force_noise * white)
    keep = np.exp(-step / sensors.force_memory)
    start = keep / np.sqrt(1 - keep**2) * noise.standard_normal(1)  # as if it had run for ever
    return np.asarray(sensors.force_noise * np.sqrt(1 - keep**2) * lfilter([1], [1, -keep], white, zi=start)[0])
