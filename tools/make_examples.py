"""Make the synthetic records of the examples 'measured' and 'joint_from_log'."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import stribeck

HERE = Path(__file__).parent.parent / "src" / "stribeck" / "examples"
JOINT = {
    "schema": 2,
    "bodies": {"joint": {"inertia": 0.03}},
    "contacts": {"gearbox": {
        "from": "joint", "law": {"name": "coulomb_viscous", "k_v": 200.0, "parameters": {"F_c": 0.12, "sigma_2": 0.06}},
        "loads": [{"force": {"gravity": 1.0, "motor": -1.0}, "F_c": 0.08}],
    }},
    "loads": {"gravity": {"on": "joint", "kind": "pendulum", "amplitude": 1.5, "phase": 0.0}},
}  # fmt: skip
PERIOD, COUNT = 0.005, 2 * np.pi / 4096  # s, rad


def measured() -> None:
    """measured_velocity.csv: 10 s at 100 Hz, noise 20 um/s, quantized to 5 um/s as an encoder would."""
    rng = np.random.default_rng(1)
    t = np.arange(1001) / 100
    v = 4e-3 * np.sin(2 * np.pi * 0.2 * t) * (1 - np.exp(-t)) * (1 + 0.5 * np.sin(2 * np.pi * 0.05 * t))
    v = np.round((v + 2e-5 * rng.standard_normal(len(t))) / 5e-6) * 5e-6
    rows = "".join(f"{a:.2f},{b:.6f}\n" for a, b in zip(t, v, strict=True))
    (HERE / "measured_velocity.csv").write_text("time_s,velocity_m_per_s\n" + rows)


def joint(seed: int, t_end: float = 8.0) -> None:
    """joint_from_log_SEED.csv: the motor's torque, held for 5 ms, and an encoder of 4096 counts a turn."""
    t, rng = np.arange(0, t_end + 1e-9, PERIOD), np.random.default_rng(seed)
    waves = zip((0.8, 0.35, 0.3, 0.25), (0.15, 0.37, 0.9, 2.1), rng.uniform(0, 2 * np.pi, 4), strict=True)
    torque = sum(a * np.sin(2 * np.pi * f * t + p) for a, f, p in waves) * np.minimum(t / 0.5, 1)
    torque = np.round(torque / 0.002) * 0.002
    signal = {"kind": "points", "t": np.repeat(t, 2)[1:-1].tolist(), "value": np.repeat(torque[:-1], 2).tolist()}
    loads = {**JOINT["loads"], "motor": {"on": "joint", "kind": "signal", "signal": signal}}
    machine = {**JOINT, "loads": loads, "solve": {"t_end": t_end}, "output": {"step": PERIOD}}
    angle = np.round(stribeck.simulate(machine)["joint.y"] / COUNT) * COUNT
    rows = "".join(f"{a:.3f},{b:.3f},{c:.6f}\n" for a, b, c in zip(t, torque, angle, strict=True))
    (HERE / f"joint_from_log_{seed}.csv").write_text("t,torque,angle\n" + rows)


if __name__ == "__main__":
    measured()
    joint(1)
    joint(2)
