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
    """Errors of the rig's sensors: resolution of the position, standard deviation of the force; 0 for none."""

    position_resolution: float = 5e-9
    force_noise: float = 0.0


@dataclass(frozen=True)
class Experiment:
    """A synthetic log and the truth behind it."""

    log: Log
    law: Law
    seed: int


def experiment(
    law: Law, velocity: tuple[Array, Array], sensors: Sensors | None = None, seed: int = 0, every: int = 1
) -> Experiment:
    """A log of a rig that moves a contact as prescribed and measures its position and its friction.

    Args:
        law: the friction, with its true constants.
        velocity: times (s, evenly spaced, from 0) and the velocity there (m/s), straight between.
        sensors: what they do; by default an encoder of 5 nm and a perfect force sensor.
        seed: of the noise.
        every: the sensors see one of so many samples of the velocity.

    Raises:
        StribeckError: the law cannot be simulated on this motion.
    """
    sensors, (t, v) = sensors or Sensors(), velocity
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
    t, y = solution.t, solution["y"]
    force = solution["F"] + sensors.force_noise * noise.standard_normal(len(t))
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
