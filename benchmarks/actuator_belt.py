"""A belt slide with a noisy recorded current: do 95 % intervals hold the truth?

Motor, belt and a carriage with LuGre friction under a position loop, recorded for 3 s at 250 Hz by SciPy on equations written
here: the motor's encoder (10 µm of noise) and its current (20 mA of up to about 2 A). Each experiment draws a mass and a
friction, and fits them by ``stribeck.identify.actuator``.

    python benchmarks/actuator_belt.py --experiments 16
"""

from __future__ import annotations

import argparse

import numpy as np
from actuator import counted, row
from scipy.integrate import solve_ivp

from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought

STEP, T_END, CURRENT, ENCODER = 0.004, 3.0, 0.02, 1e-5
GAIN, MOTOR, BELT, DAMPING = 25.0, 1.5, 2e5, 30.0
BRISTLES = {"sigma_0": 2e5, "sigma_1": 300.0, "v_s": 0.02}
LAW = "contacts.guide.law.parameters."


def recorded(rng: np.random.Generator, mass: float, F_c: float, sigma_2: float) -> Recording:
    """What the drive and the encoder record while the position loop follows two sines."""
    n = round(T_END / STEP)
    t = np.arange(n + 1) * STEP
    a, w = rng.uniform(0.04, 0.08), 2 * np.pi * rng.uniform(0.4, 0.8)
    b, p = rng.uniform(0.01, 0.02), 2 * np.pi * rng.uniform(1.3, 2.2)
    sigma_0, sigma_1, v_s = BRISTLES.values()

    def current(s: float, y: float, v: float) -> float:
        r = a * (1 - np.cos(w * s)) + b * (1 - np.cos(p * s))
        dr = a * w * np.sin(w * s) + b * p * np.sin(p * s)
        return (4000.0 * (r - y) + 120.0 * (dr - v)) / GAIN

    def rates(s: float, x: np.ndarray) -> list[float]:
        y, v, q, u, z = x
        level = F_c + 0.25 * F_c * np.exp(-min((u / v_s) ** 2, 700.0))
        speed = u * 2 / np.pi * np.arctan(1e4 * u) + 2 / (np.pi * 1e4)
        dz = u - speed * sigma_0 / level * z
        pull = BELT * (y - q) + DAMPING * (v - u)
        friction = sigma_0 * z + sigma_1 * dz + sigma_2 * u
        return [v, (GAIN * current(s, y, v) - pull) / MOTOR, u, (pull - friction) / mass, dz]

    x = solve_ivp(rates, (0.0, T_END), np.zeros(5), "LSODA", t, rtol=1e-9, atol=1e-12, max_step=STEP).y
    i = current(t, x[0], x[1]) + CURRENT * rng.standard_normal(n + 1)
    y = x[0] + ENCODER * rng.standard_normal(n + 1)
    return Recording("run", t, {"motor.y": Channel("y", t, y)}, {"loads.drive.signal": Channel("i", t, i)})


def experiment(seed: int) -> dict[str, bool | None]:
    """For each number whether its interval holds the truth; None: it has none."""
    rng = np.random.default_rng(seed)
    drawn = lambda x, spread: x * float(np.exp(spread * rng.standard_normal()))  # noqa: E731
    mass, sigma_2, F_c = drawn(4.0, 0.2), drawn(20.0, 0.3), drawn(12.0, 0.3)
    truth = {"bodies.carriage.mass": mass, f"{LAW}F_c": F_c, f"{LAW}sigma_2": sigma_2, f"{LAW}F_s": 1.25 * F_c}
    rest = {"initial": {"y": 0.0, "v": 0.0}}
    law = {"name": "lugre_majorant", "k_v": 1e4, "parameters": {**BRISTLES, "F_c": 10.0, "F_s": 12.0, "sigma_2": 15.0}}
    machine = {
        "schema": 2, "name": "slide", "bodies": {"motor": {"mass": MOTOR, **rest}, "carriage": {"mass": 4.0, **rest}},
        "links": {"belt": {"from": "motor", "to": "carriage", "stiffness": BELT, "damping": DAMPING}},
        "contacts": {"guide": {"from": "carriage", "law": law}},
        "loads": {"drive": {"on": "motor", "kind": "signal", "gain": GAIN,
                            "signal": {"kind": "step", "time": 0.0, "value": 0.0}}},
        "solve": {"t_end": T_END}, "output": {"step": STEP},
    }  # fmt: skip
    sought = tuple(Sought(n, x / 4, 4 * x) for n, x in truth.items())
    logs = Logs((recorded(rng, mass, F_c, sigma_2),), sought)
    found = fit_machine(machine, logs, starts=1, baselines=False)
    return {n: row(e, truth[n]) for n, e in found.parameters.items()}


def main() -> None:
    """Count."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--experiments", type=int, default=16)
    parser.add_argument("--first", type=int, default=100)
    given = parser.parse_args()
    rows = [experiment(seed) for seed in range(given.first, given.first + given.experiments)]
    for name in rows[0]:
        print(f"{name}: {counted([x[name] for x in rows])}")
    print(f"all: {counted([e for x in rows for e in x.values()])}")


if __name__ == "__main__":
    main()
