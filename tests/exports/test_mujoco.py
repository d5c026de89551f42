"""The exported models in MuJoCo itself: its own LuGre, and the callback for every law, against Stribeck's simulation."""

import numpy as np
import pytest

import stribeck
from stribeck.exports import export
from stribeck.laws import builtin, find
from tests.laws.test_sanity import CANUDAS, make

mujoco = pytest.importorskip("mujoco")
from tests.exports.in_mujoco import load, run  # noqa: E402


@pytest.fixture(autouse=True)
def _no_callbacks(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)  # MuJoCo writes its log where it runs
    yield
    mujoco.set_mjcb_act_dyn(None)
    mujoco.set_mjcb_act_bias(None)


def test_a_contact_that_turns_is_on_a_hinge(tmp_path):
    model, *_ = load(stribeck.law("lugre", CANUDAS, rotary=True), tmp_path)
    assert model.joint("hinge").type == mujoco.mjtJoint.mjJNT_HINGE
    assert model.body("body").inertia[0] == 1.0


def simulated(law, drive, t_end, step):
    own = {n: x for n, x in law.values.items() if n in law.own_constants() and x is not None}
    table, times = (
        {"name": law.name, **own, "parameters": CANUDAS},
        {"solve": {"t_end": t_end}, "output": {"step": step}},
    )
    return stribeck.simulate(stribeck.Scenario(law=table, plant={"mass": 1.0}, drive=drive, **times))


LUGRE = stribeck.law("lugre", "canudas1995")
MAJORANT = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6)
ELASTIC = stribeck.law("elastoplastic_majorant", "canudas1995", k_v=1e6, z_ba=7e-6)


@pytest.mark.parametrize("law", [LUGRE, stribeck.law("dahl", "canudas1995")], ids=["lugre", "dahl"])
def test_dcmotor_is_this_very_law(law, tmp_path):
    """Force and rate at given v and z, and the exact step of z at held velocity."""
    model, data, _ = load(law, tmp_path, own=True)
    rng = np.random.default_rng(0)
    for v, z in zip(rng.normal(size=20) * 10 ** rng.uniform(-5, 0, 20), rng.uniform(-1e-5, 1e-5, 20), strict=True):
        mujoco.mj_resetData(model, data)
        data.qvel[0], data.act[0] = v, z
        mujoco.mj_forward(model, data)
        force = -(data.qfrc_actuator[0] + data.qfrc_passive[0])
        assert force == pytest.approx(float(law.force(v, z)), rel=1e-12, abs=1e-12)
        assert data.act_dot[0] == pytest.approx(float(law.rate(v, z)), rel=1e-12)


@pytest.mark.parametrize("name", builtin())
def test_callback_is_the_law(name, tmp_path):
    law = make(builtin()[name])
    _, _, scope = load(law, tmp_path)
    p = [x for x in law.values.values() if x is not None]
    rng, scales = np.random.default_rng(1), law.scales(law.p)
    for v, z in zip(rng.normal(size=50) * scales.speed * 3, rng.uniform(-1.2, 1.2, 50) * scales.length, strict=True):
        rate, force, rate_v, rate_z, _, _ = scope["equations"](np.array(p), np.float64(v), np.float64(z))
        size = abs(law.force(v, z)) + abs(law.force(v, -z))
        assert abs(force - law.force(v, z)) <= 1e-13 * size
        assert rate == pytest.approx(float(law.rate(v, z)), rel=1e-12, abs=1e-14 * abs(v))
        assert (rate_v, rate_z) == pytest.approx([float(x) for x in law.jacobian(v, z)], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("step", [1e-3, 4e-3])
def test_stick_slip(step, tmp_path):
    drive = {"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}}
    reference = simulated(MAJORANT, drive, 20.0, step)["y"]
    model, data, _ = load(MAJORANT, tmp_path, step)
    _, y, *_ = run(model, data, lambda t, y: 2 * (0.1 * t - y), 20.0)
    error = np.max(abs(y - reference))
    assert 1e-5 < error < 2.5 * step * np.ptp(reference)  # of the first order in the step


def test_break_away(tmp_path):
    """theory.md: 1.31321 N at 5 N/s under LuGre, by two solvers of others."""
    for own, step, within in ((True, 1e-3, 1e-3), (False, 1e-3, 1e-3), (False, 4e-3, 3e-3)):
        model, data, _ = load(LUGRE, tmp_path, step, own=own)
        *_, force = run(model, data, lambda t, y: 5 * t, 0.5)
        first = force[np.flatnonzero(np.diff(force) < 0)[0]]
        assert first == pytest.approx(1.31321, rel=within), (own, step)


def test_constants_of_the_model_are_those_of_the_law(tmp_path):
    """What is changed in the XML changes the friction."""
    model, data, scope = load(MAJORANT, tmp_path, change=lambda text: text.replace(" 1.5 ", " 3.0 "))
    data.qvel[0], data.act[0] = 2e-4, 1e-5
    mujoco.mj_forward(model, data)
    other = stribeck.law("lugre_majorant", "canudas1995", k_v=1e6, F_s=3.0)
    assert scope["force"](model, data) == pytest.approx(float(other.force(2e-4, 1e-5)), rel=1e-13)


def test_a_hinge_with_a_gear_and_other_actuators(tmp_path):
    def change(text):
        text = text.replace('type="slide"', 'type="hinge"').replace('joint="slide"', 'joint="slide" gear="3"')
        return text.replace("<actuator>", '<actuator><motor name="drive" joint="slide"/>')

    model, data, scope = load(MAJORANT, tmp_path, 1e-3, change=change)
    inertia = model.dof_M0[0]
    data.ctrl[0] = 30.0 * inertia
    force = []
    for _ in range(300):
        mujoco.mj_step(model, data)
        mujoco.mj_forward(model, data)
        force.append(scope["force"](model, data))
    v = 3 * data.qvel[0]
    assert force[-1] == pytest.approx(float(MAJORANT.force(v, data.act[0])), rel=1e-12)


def test_two_laws_in_one_model(tmp_path):
    """Each answers for its own actuators, and the other's are left to it."""

    def change(text):
        second = (
            text.split("<actuator>")[1]
            .split("</actuator>")[0]
            .replace("elastoplastic_majorant", "elastoplastic_majorant:b")
        )
        third = (tmp_path / "lugre.xml").read_text(encoding="utf-8").split("<actuator>")[1].split("</actuator>")[0]
        return text.replace("</actuator>", f"{second}{third}</actuator>")

    export(LUGRE, "mujoco", tmp_path)
    model, data, scope = load(ELASTIC, tmp_path, change=change)
    lugre = {}
    exec(compile((tmp_path / "lugre_mujoco.py").read_text(encoding="utf-8"), "callback", "exec"), lugre)
    lugre["install"](model)
    data.qvel[0], data.act[:] = 3e-4, [2e-6, 8e-6, 9e-6]
    mujoco.mj_forward(model, data)
    wanted = [ELASTIC.force(3e-4, 2e-6), ELASTIC.force(3e-4, 8e-6), LUGRE.force(3e-4, 9e-6)]
    names = ("elastoplastic_majorant", "elastoplastic_majorant:b")
    got = [*(scope["force"](model, data, n) for n in names), lugre["force"](model, data)]
    assert got == pytest.approx([float(x) for x in wanted], rel=1e-12)
    mujoco.mj_step(model, data)
    assert np.all(abs(data.act) > 0)
    assert data.qvel[0] < 3e-4


def test_static_laws_need_no_activation(tmp_path):
    law = stribeck.law("coulomb_viscous", F_c=1.0, sigma_2=0.4, k_v=1e4)
    model, data, _ = load(law, tmp_path, 1e-3)
    assert model.na == 0
    run(model, data, lambda t, y: 3.0, 20.0)
    assert data.qvel[0] == pytest.approx((3.0 - 1.0) / 0.4, rel=1e-3)


def test_wrong_integrators_and_models_are_refused(tmp_path):
    with pytest.raises(ValueError, match="integrator must be"):
        load(MAJORANT, tmp_path, change=lambda text: text.replace("implicitfast", "RK4"))
    with pytest.raises(ValueError, match="no actuator called"):
        load(MAJORANT, tmp_path, change=lambda text: text.replace('name="lugre_majorant"', 'name="other"'))


def test_laws_with_more_constants_than_an_actuator_carries_are_refused(tmp_path):
    class Many(type(MAJORANT)):
        """Has too many constants."""

    for i in range(5):
        setattr(Many, f"c{i}", stribeck.laws.terms.K_V)
    law = Many({**MAJORANT.values, **{f"c{i}": 1.0 for i in range(5)}})
    with pytest.raises(stribeck.InputError, match="at most 10"):
        export(law, "mujoco", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_awkward_names_of_a_users_law(tmp_path):
    (tmp_path / "mine.py").write_text(
        "from stribeck.constants import Constant\nfrom stribeck.laws import BristleLaw\nfrom stribeck.laws.terms import g\n"
        "class Odd(BristleLaw):\n    \"\"\"Says '''hello''' \\\\ and --> and ---> and ---->.\"\"\"\n"
        '    force_v = Constant("1", "is taken", above=0)\n    abs = Constant("1", "is a function", above=0)\n'
        "    @staticmethod\n    def dz_dt(p, v, z):\n        return p.force_v * v - p.abs * abs(v) / g(p, v) * z\n",
        encoding="utf-8",
    )
    law = find("mine.py:Odd", tmp_path)({**CANUDAS, "force_v": 2.0, "abs": 3.0})
    model, data, scope = load(law, tmp_path / "out")
    data.qvel[0], data.act[0] = 2e-4, 1e-5
    mujoco.mj_forward(model, data)
    assert scope["force"](model, data) == pytest.approx(float(law.force(2e-4, 1e-5)), rel=1e-13)
