"""Files of other programs: the same friction as their formulae."""

from pathlib import Path

import numpy as np
import pytest

from stribeck import Scenario, simulate
from stribeck.errors import StribeckNote
from stribeck.exports.exchange import from_bam, from_mujoco_file

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
    found = simulate(Scenario(data))
    v = found["joint.v"]
    fast = abs(v) > 0.3  # the smooth sign is complete to 1 %
    assert fast.sum() > 30
    want = np.sign(v) * friction(MODELS[model], v, found["gravity.f"], found["drive.torque"])
    np.testing.assert_allclose(found["friction.F"][fast], want[fast], rtol=0.02)


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
    found = simulate(Scenario(data))
    np.testing.assert_allclose(found["gravity.f"], -0.8 * np.sin(found["joint.y"] - 0.05), rtol=1e-12)


def test_a_mujoco_model_s_joints(tmp_path):
    pytest.importorskip("mujoco")
    path = tmp_path / "arm.xml"
    path.write_text(
        '<mujoco><option gravity="0 0 0"/><worldbody><body>'
        '<joint name="elbow" type="hinge" axis="0 1 0" frictionloss="0.3" damping="0.2" armature="0.1"/>'
        '<geom type="sphere" size="0.1" mass="2" pos="0.5 0 0"/></body></worldbody></mujoco>'
    )
    data = from_mujoco_file(path)
    moment = 2 * 0.5**2 + 0.4 * 2 * 0.1**2 + 0.1
    assert data["bodies"]["elbow"]["inertia"] == pytest.approx(moment)
    law = data["contacts"]["elbow_friction"]["law"]
    assert law["parameters"] == {"F_c": 0.3, "sigma_2": 0.2}
    Scenario(data)


def test_a_joint_s_spring_is_a_link_to_the_ground(tmp_path):
    """It was left out without a word: the same motion as MuJoCo's, whose spring rests elsewhere than where it begins."""
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "arm.xml"
    path.write_text(
        '<mujoco><option gravity="0 0 0" timestep="1e-4" integrator="RK4"/><worldbody><body><joint name="elbow" type="hinge"'
        ' axis="0 1 0" damping="0.2" stiffness="3" springref="20"/>'
        '<geom type="sphere" size="0.1" mass="2" pos="0.5 0 0"/></body></worldbody></mujoco>'
    )
    data = from_mujoco_file(path)
    assert data["links"] == {"elbow_spring": {"from": "elbow", "to": "ground", "stiffness": 3.0}}
    ours = simulate(Scenario(data))
    model = mujoco.MjModel.from_xml_path(str(path))
    state = mujoco.MjData(model)
    mujoco.mj_step(model, state, 10000)
    assert state.qpos[0] > 0.1
    assert ours["elbow.y"][-1] == pytest.approx(state.qpos[0], rel=1e-4)


DCMOTOR = (
    '<dcmotor name="m" joint="elbow" gear="3" motorconst="0.07" resistance="0.4" inductance="0.002" cogging="0.004 42 0.3" '
    'lugre="20 0.3 0.05 0.08 0.2" damping="0.01"/>\n'
)
ARM = """<mujoco><option timestep="2e-4" integrator="RK4" gravity="0 0 0"/>
<worldbody><body><joint name="elbow" type="hinge" axis="0 1 0" armature="0.1"/>
<geom type="sphere" size="0.1" mass="2" pos="0.5 0 0" contype="0"/></body></worldbody><actuator>{}</actuator></mujoco>"""


def test_a_dcmotor_with_its_lugre_moves_alike_there(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "arm.xml"
    for sigma_1 in ("0", "0.3"):
        path.write_text(ARM.format(DCMOTOR.replace("20 0.3", f"20 {sigma_1}")))
        machine = from_mujoco_file(path)
        assert set(machine["contacts"]) == {"m_lugre"}
    assert machine["motors"]["m"]["L"] == pytest.approx(0.002)
    machine["motors"]["m"]["signal"] = {"kind": "points", "t": [0.0, 1.0], "value": [2.0, -2.0]}
    ours = simulate(Scenario({**machine, "output": {"step": 0.01}}))
    model = mujoco.MjModel.from_xml_path(str(path))
    data, seen = mujoco.MjData(model), [0.0]
    for i in range(5000):
        data.ctrl[0] = 2.0 - 4.0 * i * 2e-4
        mujoco.mj_step(model, data)
        if i % 50 == 49:
            seen.append(float(data.qpos[0]))
    assert np.ptp(seen) > 0.1
    np.testing.assert_allclose(ours["elbow.y"], seen, atol=0.01 * np.ptp(seen))


def test_the_limits_of_a_dcmotor_are_told(tmp_path):
    pytest.importorskip("mujoco")
    path = tmp_path / "arm.xml"
    path.write_text(ARM.format(DCMOTOR.replace("damping", 'saturation="0 2 0" damping')))
    with pytest.warns(StribeckNote, match=r"actuator m: .*left out"):
        from_mujoco_file(path)
