"""A chain of two masses that sticks, slips and turns over chaotically: a SciPy program of its own records it."""

import math

import numpy as np
import pytest
from scipy.integrate import odeint

from stribeck import Scenario, simulate
from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought

TRUTH = {
    "contacts.mesh.law.parameters.F_c": 0.4, "contacts.mesh.law.parameters.sigma_2": 0.03, "bodies.rotor.inertia": 0.02,
    "loads.gravity.amplitude": 2.0,
}  # fmt: skip
STEP, NOISE, START = 0.005, 1e-3, 0.1
DRIVE = {"kind": "sine", "amplitude": 2.2, "frequency": 0.45}


def rates(x, t):
    y, v, arm, w, z = x
    gear = 60.0 * (y - arm) + 0.1 * (v - w)
    level = 0.4 + 0.2 * math.exp(-min((v / 0.3) ** 2, 700.0))
    dz = v - (v * 2 / math.pi * math.atan(1e3 * v) + 2 / (math.pi * 1e3)) * 400.0 / level * z
    friction = 400.0 * z + dz + 0.03 * v
    push = 2.2 * math.sin(2 * math.pi * 0.45 * t)
    return [v, (push - gear - friction) / 0.02, w, (gear - 2.0 * math.sin(arm)) / 0.08, dz]


@pytest.fixture(scope="module")
def motion():
    t = np.arange(round(6.0 / STEP) + 1) * STEP
    x = odeint(rates, [START, 0, START, 0, 0], t, rtol=1e-9, atol=1e-11)
    return t, x[:, 0] + NOISE * np.random.default_rng(0).standard_normal(len(t))


def chain(t_end):
    law = {"sigma_0": 400.0, "sigma_1": 1.0, "sigma_2": 0.05, "F_c": 0.25, "F_s": 0.6, "v_s": 0.3}
    return {
        "schema": 2, "name": "chain",
        "bodies": {"rotor": {"inertia": 0.03}, "arm": {"inertia": 0.08}},
        "links": {"gear": {"from": "rotor", "to": "arm", "stiffness": 60.0, "damping": 0.1}},
        "contacts": {"mesh": {"from": "rotor", "law": {"name": "lugre_majorant", "k_v": 1e3, "parameters": law}}},
        "loads": {"push": {"on": "rotor", "kind": "signal", "signal": DRIVE},
                  "gravity": {"on": "arm", "kind": "pendulum", "amplitude": 1.5, "phase": 0.0}},
        "solve": {"t_end": t_end}, "output": {"step": STEP},
    }  # fmt: skip


def fitted(motion, t_end):
    t, y = (x[: round(t_end / STEP) + 1] for x in motion)
    known = {"bodies.rotor.initial.y": START, "bodies.arm.initial.y": START}
    recording = Recording("chain.csv", t, {"rotor.y": Channel("y", t, y)}, {}, known)
    sought = tuple(Sought(name, x / 4, 4 * x) for name, x in TRUTH.items())
    return fit_machine(chain(t_end), Logs((recording,), sought), starts=6, baselines=False)


@pytest.mark.thorough
def test_a_chaotic_recording_has_intervals_that_hold_the_truth(motion):
    true = Scenario(chain(6.0)).with_changes(TRUTH)
    near, far = (simulate(true.with_changes({"bodies.rotor.initial.y": x})) for x in (START, START + 1e-6))
    assert abs(near["rotor.y"] - far["rotor.y"])[-200:].max() > 30 * 1e-6  # errors grow
    result = fitted(motion, 6.0)
    for name, x in TRUTH.items():
        p = result.estimates[name]
        assert p.state == "identified"
        assert p.low < x < p.high
