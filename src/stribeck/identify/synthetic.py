"""The project's own synthetic rig: simulated experiments with sensors, noise and known truth.

Nothing here was measured, and everything that comes from here says so.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.signal import savgol_filter

from stribeck.arrays import Array
from stribeck.errors import StribeckError
from stribeck.identify.log import Log
from stribeck.laws.base import Law
from stribeck.scenario import Scenario
from stribeck.simulation import simulate

LABEL = "SYNTHETIC: simulated by Stribeck, not measured"


@dataclass(frozen=True)
class Sensors:
    """What the rig's sensors do to the truth: steps of the position, standard deviation of the force; 0 for a perfect one."""

    position_resolution: float = 5e-9
    force_noise: float = 0.0


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
    seed: int


def experiment(
    law: Law,
    velocity: tuple[Array, Array],
    sensors: Sensors | None = None,
    body: Slider | None = None,
    seed: int = 0,
    every: int = 1,
) -> Experiment:
    """A log of a rig that moves the body as prescribed and measures its position and the force that it takes.

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
    force = force + sensors.force_noise * noise.standard_normal(len(t))
    position = y if not (tick := sensors.position_resolution) else tick * np.round(y / tick)
    log = Log(
        time=t, position=position,
        velocity=savgol_filter(position, 5, 4, deriv=1, delta=step),
        acceleration=savgol_filter(position, 5, 4, deriv=2, delta=step),
        force=force,
        run=np.zeros(len(t), np.int32), step=step,
        sources={
            "position": LABEL, "force": LABEL,
            "velocity": f"{LABEL}; from position, quartic through 5 points",
            "acceleration": f"{LABEL}; from position, quartic through 5 points",
        },
        quality=(f"{LABEL}: law {type(law).name}, seed {seed}",),
    )  # fmt: skip
    return Experiment(log, law, seed)
