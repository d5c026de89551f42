"""A two-link arm that MuJoCo simulates with friction in its joints: found back from its motion and torques."""

import numpy as np
import pytest

from stribeck.errors import InputError
from stribeck.identify import from_mujoco, read_logs
from stribeck.scenario import Scenario

ARM = """<mujoco><option timestep="5e-4" integrator="RK4"/><worldbody><body>
<joint name="shoulder" type="hinge" axis="0 1 0" damping="{0}" frictionloss="{1}" solreffriction="0.001 1" armature="0.01"/>
<geom type="capsule" size="0.03" fromto="0 0 0 0 0 -0.4" mass="1.2" contype="0"/>
<body pos="0 0 -0.4">
<joint name="elbow" type="hinge" axis="0 1 0" damping="{2}" frictionloss="{3}" solreffriction="0.001 1" armature="0.005"/>
<geom type="capsule" size="0.03" fromto="0 0 0 0 0 -0.3" mass="0.7" contype="0"/></body></body></worldbody>
<actuator><motor joint="shoulder"/><motor joint="elbow"/></actuator></mujoco>"""
TRUTH = {"shoulder": (0.2, 0.5), "elbow": (0.05, 0.15)}  # damping, frictionloss

PUSHES = (
    lambda t: 2.5 * np.sin(4.1 * t) + 1.0 * np.sin(11 * t),
    lambda t: 0.5 * np.sin(6.3 * t + 1) + 0.3 * np.sin(17 * t),
)


@pytest.fixture(scope="module")
def arm():
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(ARM.format(*TRUTH["shoulder"], *TRUTH["elbow"]))
    data, rows, rng = mujoco.MjData(model), [], np.random.default_rng(1)
    for i in range(8000):
        push = [f(5e-4 * i) for f in PUSHES]
        data.ctrl[:] = [f(5e-4 * i + 2.5e-4) for f in PUSHES]  # held over the step: its mean
        if i % 10 == 0:
            rows.append([5e-4 * i, *data.qpos, *push])
        mujoco.mj_step(model, data)
    table = dict(zip(("t", "shoulder.position", "elbow.position", "shoulder.torque", "elbow.torque"),
                     np.array(rows).T, strict=True))  # fmt: skip
    for name in TRUTH:
        table[f"{name}.position"] = table[f"{name}.position"] + 1e-4 * rng.standard_normal(len(rows))
    return model, table


@pytest.mark.thorough
def test_each_joint_s_friction_is_found(arm):
    model, table = arm
    before = model.dof_damping.copy()
    joints = from_mujoco(model, table)
    assert (model.dof_damping == before).all()
    assert set(joints) == set(TRUTH)
    for name, (damping, loss) in TRUTH.items():
        fitted = joints[name].fit(starts=1, baselines=False).estimates
        assert fitted["contacts.friction.law.parameters.F_c"].value == pytest.approx(loss, rel=0.05), name
        assert fitted["contacts.friction.law.parameters.sigma_2"].value == pytest.approx(damping, rel=0.05), name


def test_what_is_written_is_what_the_command_reads(arm, tmp_path):
    model, table = arm
    short = {name: x[:200] for name, x in table.items()}
    joint = from_mujoco(model, [short, table], hold_out=[0])["elbow"]
    machine, logs = joint.write(tmp_path / "elbow")  # the folder is made
    result = read_logs(logs)
    assert Scenario.of(machine).data == joint.machine.data
    assert [s.path for s in result.sought] == [s.path for s in joint.logs.sought]
    for one, other in zip(result.recordings, joint.logs.recordings, strict=True):
        assert one.hold_out == other.hold_out
        for path in other.inputs:
            np.testing.assert_array_equal(one.inputs[path].x, other.inputs[path].x)


def test_what_is_missing_is_told(arm, tmp_path):
    model, table = arm
    with pytest.raises(InputError, match=r"elbow\.position"):
        from_mujoco(model, {n: x for n, x in table.items() if n != "elbow.position"})
    with pytest.raises(InputError, match="wrist"):
        from_mujoco(model, table, torques={"wrist": "t"})
    with pytest.raises(InputError, match="torques: no joint has a torque in every recording"):
        from_mujoco(model, [table, {n: x for n, x in table.items() if not n.endswith(".torque")}])
    with pytest.raises(InputError, match="evenly sampled"):
        from_mujoco(model, table | {"t": table["t"] ** 1.1})
    (tmp_path / "arm.xml").write_text("<mujoco><nothing/></mujoco>")
    with pytest.raises(InputError, match="MuJoCo cannot read it"):
        from_mujoco(tmp_path / "arm.xml", table)
    with pytest.raises(InputError, match="cannot be read: No such file"):
        from_mujoco(tmp_path / "none.xml", table)
