"""Upright pendulums: errors of a free simulation grow, so that it needs a guide. Records by SciPy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought

STEP, NOISE, STEEP = 0.005, 5e-4, 50.0
LAW = "contacts.joint.law.parameters."
TRUTH = {"bodies.arm.inertia": 0.2, "loads.gravity.amplitude": 3.5, f"{LAW}F_c": 0.12, f"{LAW}sigma_2": 0.05}
T = STEP * np.arange(901)


def torque(t, y, v, inertia, weight):
    """Energy is pumped in until the pendulum is upright; there it is held."""
    off = np.arctan2(np.sin(y - np.pi), np.cos(y - np.pi))
    if abs(off) < 0.35 and abs(v) < 3.0:
        return float(np.clip(-14 * off - 2.2 * v + 0.5 * np.sin(5 * t) + 0.4 * np.sin(13 * t), -6, 6))
    energy = 0.5 * inertia * v**2 - weight * np.cos(y)
    return float(np.clip(6 * (1.05 * weight - energy) * np.sign(v + 1e-9), -1.9, 1.9) + 0.15 * np.sin(7 * t))


def swung():
    inertia, weight, level, viscous = TRUTH.values()
    x, y, u = np.array([0.05, 0.0]), np.empty(len(T)), np.empty(len(T))

    def rates(_, z, push):
        friction = level * 2 / np.pi * np.arctan(STEEP * z[1]) + viscous * z[1]
        return [z[1], (push - weight * np.sin(z[0]) - friction) / inertia]

    for i, t in enumerate(T):
        y[i], u[i] = x[0], torque(t, *x, inertia, weight)
        x = solve_ivp(rates, (0, STEP), x, rtol=1e-8, atol=1e-10, args=(u[i],)).y[:, -1]
    return y, u


def pendulum():
    still = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}
    law = {"name": "coulomb_viscous", "k_v": STEEP, "parameters": {"F_c": 0.1, "sigma_2": 0.05}}
    return {
        "schema": 2, "name": "pendulum", "bodies": {"arm": {"inertia": 0.17}},
        "contacts": {"joint": {"from": "arm", "law": law}},
        "loads": {"gravity": {"on": "arm", "kind": "pendulum", "amplitude": 3.0, "phase": 0.0},
                  "motor": {"on": "arm", "kind": "signal", "signal": still}},
        "solve": {"t_end": float(T[-1])}, "output": {"step": STEP},
    }  # fmt: skip


@pytest.mark.thorough
def test_a_pendulum_that_is_swung_up_and_balanced_is_fitted_under_a_guide():
    """Whole, it ended a hundred deviations off, as errors of the solver decide what follows."""
    y, u = swung()
    assert abs(abs(y[-200:]) - np.pi).max() < 0.2  # it stands
    y = y + NOISE * np.random.default_rng(0).standard_normal(len(T))
    channels = {"arm.y": Channel("y", T, y)}, {"loads.motor.signal": Channel("u", T, u, held=True)}
    sought = tuple(Sought(n, x / 5, 5 * x) for n, x in TRUTH.items())
    fitted = fit_machine(pendulum(), Logs((Recording("up", T, *channels, {}),), sought), starts=3, baselines=False)
    assert any(n.startswith("errors grow fast in this motion: a guide draws ") for n in fitted.notes)
    for name, truth in TRUTH.items():
        e = fitted.estimates[name]
        assert e.state == "identified"
        assert e.range[0] < truth < e.range[1], (name, e)
        half = (e.interval[1] - e.interval[0]) / 2
        assert abs(e.value - truth) < 1.6 * half, (name, e)
