"""Files of other programs: the same friction as their formulae."""

from pathlib import Path

import numpy as np
import pytest

from stribeck import Scenario, simulate
from stribeck.exports.exchange import from_bam

SHARED = Path(__file__).parents[3] / "shared" / "data" / "bam"
PLAIN = {"kt": 1.5, "R": 2.0, "armature": 0.02, "friction_base": 0.05, "friction_viscous": 0.06}
CURVE = {"friction_stribeck": 0.08, "dtheta_stribeck": 1.1, "alpha": 1.3}
MODELS = {
    "m1": PLAIN,
    "m2": PLAIN | CURVE,
    "m3": PLAIN | {"load_friction_base": 0.1},
    "m4": PLAIN | CURVE | {"load_friction_base": 0.1, "load_friction_stribeck": 0.2},
    "m5": PLAIN | CURVE | {
        "load_friction_motor": 0.2, "load_friction_external": 0.03, "load_friction_motor_stribeck": 0.25,
        "load_friction_external_stribeck": 0.08,
    },
}  # fmt: skip
MODELS["m6"] = MODELS["m5"] | {"load_friction_motor_quad": 0.4, "load_friction_external_quad": 0.9}
MODELS["m6 without a curve of its own"] = {n: x for n, x in MODELS["m6"].items() if n not in CURVE}


def friction(n, v, outside, motor):
    """BAM's formula, as its README writes it."""
    base, curve = n["friction_base"], n.get("friction_stribeck", 0.0)
    if "load_friction_motor" in n:
        base = base + abs(n["load_friction_external"] * outside - n["load_friction_motor"] * motor)
        curve = curve + abs(n["load_friction_external_stribeck"] * outside - n["load_friction_motor_stribeck"] * motor)
    else:
        base = base + n.get("load_friction_base", 0.0) * abs(outside - motor)
        curve = curve + n.get("load_friction_stribeck", 0.0) * abs(outside - motor)
    opposed = np.sign(outside) != np.sign(motor)
    by_motor = n.get("load_friction_external_quad", 0.0) * outside**2 * (abs(outside) < abs(motor))
    by_load = n.get("load_friction_motor_quad", 0.0) * motor**2 * (abs(outside) > abs(motor))
    curve = curve + opposed * (by_motor + by_load)
    fall = np.exp(-(abs(v / n.get("dtheta_stribeck", 1.0)) ** n.get("alpha", 2.0)))
    return base + fall * curve + n["friction_viscous"] * abs(v)


@pytest.mark.parametrize("model", MODELS)
def test_bam_s_models_have_its_friction(model):
    data = from_bam({**MODELS[model], "model": model[:2], "actuator": "servo"})
    data["loads"]["gravity"]["amplitude"] = 0.8
    data["motors"]["drive"]["signal"] = {"kind": "sine", "amplitude": 6.0, "frequency": 1.0}
    solution = simulate(Scenario(data))
    v = solution["joint.v"]
    fast = abs(v) > 0.3  # the smooth sign is complete to 1 %
    assert fast.sum() > 30
    want = np.sign(v) * friction(MODELS[model], v, solution["gravity.f"], solution["drive.torque"])
    np.testing.assert_allclose(solution["friction.F"][fast], want[fast], rtol=0.02)


@pytest.mark.skipif(not SHARED.exists(), reason="no ../shared/data/bam beside the checkout")
def test_every_file_of_bam_is_a_machine():
    files = sorted(SHARED.rglob("*.json"))
    assert files
    for path in files:
        Scenario(from_bam(path))


def test_the_offset_of_bam_s_encoder_turns_gravity():
    """In BAM the arm's weight acts at q + q_offset."""
    data = from_bam({**PLAIN, "q_offset": -0.05, "model": "m1", "actuator": "servo"})
    data["loads"]["gravity"]["amplitude"] = 0.8
    solution = simulate(Scenario(data))
    np.testing.assert_allclose(solution["gravity.f"], -0.8 * np.sin(solution["joint.y"] - 0.05), rtol=1e-12)
