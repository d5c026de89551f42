"""The friction of a contact whose level follows loads, a position and a signal: the same in every target as in the machine."""

import importlib.util

import numpy as np
import pytest
import tomli_w

import stribeck
from stribeck import InputError, Scenario
from stribeck.cli import _status
from stribeck.exports import contact_law
from stribeck.exports.c.selftest import at_a_load
from stribeck.exports.python import to_jax, to_torch
from tests.exports.harness import need, output_of
from tests.machine.machines import law, machine

LOADS = [
    {"force": {"press": 1.0, "push": -0.5}, "F_c": 0.1, "F_s": 0.2},
    {"force": "push", "against": "press", "F_s": 0.05},
]
FACTORS = {
    "level": {"amplitude": [0.1], "waves": [300.0], "phase": [0.2]},
    "sigma_2": {"signal": {"kind": "points", "t": [0.0, 0.7], "value": [1.0, 2.0]}},
}


def sine(amplitude, frequency):
    return {"on": "a", "kind": "signal", "signal": {"kind": "sine", "amplitude": amplitude, "frequency": frequency}}


def rig(**contact):
    """A body that is pushed by two forces, on which its friction depends."""
    own = {"loads": LOADS, "factors": FACTORS, **contact}
    rub, loads = {"from": "a", "law": law(v_d=0.1), **own}, {"press": sine(4.0, 3.0), "push": sine(3.0, 2.0)}
    return Scenario(machine({"a": {"mass": 0.5}}, energy=False, contacts={"rub": rub}, loads=loads))


RIG = rig()
PRESSED = rig(loads=[{"force": "press", "F_c": 0.1, "F_s": 0.2}], factors={})  # one input


@pytest.fixture(scope="module")
def run():
    return stribeck.simulate(RIG)


def given(run):
    """What the contact is given at the rows of a run, in the order of the law's inputs."""
    columns = {
        "load_press": run["press.f"], "load_push": run["push.f"], "position": run["a.y"],
        "factor_sigma_2": 1 + np.asarray(run.t) / 0.7,
    }  # fmt: skip
    return np.array([columns[n] for n in contact_law(RIG).inputs]).T


def test_the_law_of_the_contact_is_the_machines_own(run):
    """To rounding: its equations are the contact's, of one number here and of many there."""
    chosen = contact_law(RIG)
    assert set(chosen.inputs) == {"load_press", "load_push", "position", "factor_sigma_2"}
    forces = [
        chosen.replace(**dict(zip(chosen.inputs, row, strict=True))).force(v, z)
        for row, v, z in zip(given(run), run["rub.w"], run["rub.z"], strict=True)
    ]
    np.testing.assert_allclose(np.array(forces), run["rub.F"], rtol=1e-15, atol=1e-15)
    assert {-1.0, 1.0} <= {*np.sign(run["rub.F"])}
    alone = rig(loads=[], factors={})
    assert contact_law(alone) == alone.law
    assert contact_law(PRESSED).inputs == ("load_press",)


def test_c(run, tmp_path):
    """Compiled without a warning; its force is the machine's, and its own test passes in both precisions."""
    stribeck.export(RIG, "c", tmp_path, part="law", self_test=True)
    for flags in (("-O0",), ("-O0", "-DLUGRE_MAJORANT_FLOAT")):
        assert "all checks passed" in output_of(tmp_path, "lugre_majorant.c", "lugre_majorant_test.c", flags=flags)
    tested = at_a_load(contact_law(RIG))
    assert all(tested.values[name] for name in tested.inputs)
    inputs = ", ".join(f"&load.{n}" for n in tested.inputs)
    (tmp_path / "main.c").write_text(f"""#include <stdio.h>
#include "lugre_majorant.h"
int main(void)
{{
    lugre_majorant_parameters p;
    lugre_majorant_load load;
    double v, z, F;
    lugre_majorant_defaults(&p);
    while (scanf("%lf %lf %lf %lf %lf %lf", &v, &z, {inputs}) == 6) {{
        if (lugre_majorant_force(&p, &load, v, z, &F)) return 1;
        printf("%.17g\\n", F);
    }}
    return 0;
}}
""")
    rows = np.column_stack([run["rub.w"], run["rub.z"], given(run)])
    text = "\n".join(" ".join(map(repr, row)) for row in rows.tolist())
    forces = np.array(output_of(tmp_path, "lugre_majorant.c", "main.c", given=text).split(), float)
    assert np.abs(forces - run["rub.F"]).max() <= 1e-9 * np.abs(run["rub.F"]).max()


@pytest.mark.parametrize("fmi", [2, 3])
def test_fmu(fmi, run, tmp_path):
    """The loads are inputs, and the force is the machine's."""
    need("gcc")
    fmpy = pytest.importorskip("fmpy", reason="fmpy is not installed")
    from fmpy.validation import validate_fmu

    (path,) = stribeck.export(RIG, "fmu", tmp_path / "rub.fmu", part="law", fmi=fmi)
    assert validate_fmu(str(path)) == []
    forces = []
    for v, z, row in list(zip(run["rub.w"], run["rub.z"], given(run), strict=True))[1::9]:
        start = {"v": v, "z": z, **dict(zip(contact_law(RIG).inputs, row, strict=True))}
        solution = fmpy.simulate_fmu(str(path), stop_time=1e-3, step_size=1e-3, start_values=start, output=["F"])
        forces.append(solution["F"][0])
    assert np.abs(forces - run["rub.F"][1::9]).max() <= 1e-9 * np.abs(run["rub.F"]).max()


def loaded(path):
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def creep():
    """How far the machine's body moves from 0.5 s to 1 s under a push of 2 N that a load of 20 N lets it hold."""
    constant = {"on": "a", "kind": "signal", "signal": {"kind": "points", "t": [0.0, 1.0], "value": [20.0, 20.0]}}
    push = {"on": "a", "kind": "signal", "signal": {"kind": "points", "t": [0.0, 1.0], "value": [-18.0, -18.0]}}
    changes = {"loads.press": constant, "loads.push": push, "solve.t_end": 1.0, "output.step": 0.5}
    y = stribeck.simulate(PRESSED.with_changes(changes))["a.y"]
    assert 0 < y[1] < 1e-3
    return float(y[2] - y[1])


def test_mujoco(run, tmp_path):
    """The callback's equations are the machine's; a body that is pressed holds, and creeps no more than in the machine."""
    mujoco = pytest.importorskip("mujoco", reason="mujoco is not installed")
    model, callback = stribeck.export(RIG, "mujoco", tmp_path, part="law")
    module = loaded(callback)
    compiled = mujoco.MjModel.from_xml_path(str(model))
    p = compiled.actuator_biasprm[0][: len(RIG.law.p.numbers)]
    forces = [
        module.equations(p, np.float64(v), z, row)[1]
        for v, z, row in zip(run["rub.w"], run["rub.z"], given(run), strict=True)
    ]
    assert np.abs(forces - run["rub.F"]).max() <= 1e-9 * np.abs(run["rub.F"]).max()
    model, callback = stribeck.export(PRESSED, "mujoco", tmp_path / "pressed", part="law")
    module, moved = loaded(callback), {}
    for load, push in ((0.0, 3.0), (20.0, 2.0), (20.0, 7.0)):  # it breaks away at 1.4 + 0.2 load
        compiled = mujoco.MjModel.from_xml_path(str(model))
        data = mujoco.MjData(compiled)
        module.install(compiled, lambda m, d, i, load=load: (load,))
        data.qfrc_applied[0] = push
        try:
            mujoco.mj_step(compiled, data, 500)
            half = float(data.qpos[0])
            mujoco.mj_step(compiled, data, 500)
        finally:
            module.remove()
        moved[load, push] = half, float(data.qpos[0])
    assert moved[0.0, 3.0][0] > 0.1
    assert moved[20.0, 7.0][0] > 0.1
    first, then = moved[20.0, 2.0]
    assert 0 < first < 1e-3
    assert then - first == pytest.approx(creep(), rel=1e-2)


def steps(chosen, load, v, effort):
    """An implicit step of each joint by SciPy: the state after it and the friction."""
    from scipy.optimize import brentq

    results = []
    for row, v0, u in zip(load, v, effort, strict=True):
        here = chosen.replace(**dict(zip(chosen.inputs, row, strict=True)))

        def z_at(w, here=here):
            return brentq(lambda z: z - 1e-3 * float(here.rate(w, z)), -1e-2, 1e-2, xtol=1e-18, rtol=1e-15)

        def excess(w, here=here, v0=v0, u=u):
            return 0.5 / 1e-3 * (w - v0) + float(here.force(w, z_at(w))) - u

        w = brentq(excess, -1.0, 1.0, xtol=1e-18, rtol=1e-15)
        results.append((z_at(w), float(here.force(w, z_at(w)))))
    return np.array(results).T


LOAD = np.array([[4.0, -3.0, 1.0, 2e-3], [0.0, 2.0, 1.5, 0.0], [-2.0, 1.0, 1.0, -1e-3]])
V, EFFORT = np.array([0.02, -0.01, 0.0]), np.array([1.0, -2.0, 0.5])


@pytest.mark.parametrize("library", ["torch", "jax"])
def test_the_step_of_array_libraries(library):
    """Backward Euler of joint and bristles at each joint's own load; the gradient by the load is a difference's."""
    pytest.importorskip(library, reason=f"{library} is not installed")
    chosen = contact_law(RIG)
    z, F = steps(chosen, LOAD, V, EFFORT)
    result, slope = globals()[f"by_{library}"](chosen, LOAD)
    assert np.abs(result[0] - z).max() <= 1e-9 * np.abs(z).max()
    assert np.abs(result[1] - F).max() <= 1e-9 * np.abs(F).max()
    h = 1e-5
    differences = []
    for j in range(LOAD.shape[1]):
        up, down = (steps(chosen, LOAD + s * h * (np.arange(LOAD.shape[1]) == j), V, EFFORT)[1] for s in (1, -1))
        differences.append((up - down) / (2 * h))
    assert slope == pytest.approx(np.array(differences).T, rel=1e-4, abs=1e-6)


def by_torch(chosen, load):
    import torch

    v, effort = torch.tensor(V), torch.tensor(EFFORT)
    load = torch.tensor(load, requires_grad=True)
    z, F = to_torch(chosen).step(0 * v, v, effort, 0.5, 1e-3, load)
    F.sum().backward()
    with pytest.raises(InputError, match="load: missing: must be an array whose last axis has load_press"):
        to_torch(chosen).step(0 * v, v, effort, 0.5, 1e-3)
    return (z.detach().numpy(), F.detach().numpy()), load.grad.numpy()


def by_jax(chosen, load):
    import jax
    import jax.numpy as jnp

    jax.config.update("jax_enable_x64", True)
    step, load = to_jax(chosen).step, jnp.asarray(load)
    z, F = step(jnp.zeros(3), jnp.asarray(V), jnp.asarray(EFFORT), 0.5, 1e-3, load)
    slope = jax.grad(lambda x: step(jnp.zeros(3), jnp.asarray(V), jnp.asarray(EFFORT), 0.5, 1e-3, x)[1].sum())(load)
    return (np.asarray(z), np.asarray(F)), np.asarray(slope)


def test_isaaclab_holds_what_the_machine_holds(tmp_path):
    torch = pytest.importorskip("torch", reason="torch is not installed")
    (file,) = stribeck.export(PRESSED, "isaaclab", tmp_path / "pressed.py", part="law")
    joints = loaded(file).JointFriction(torch.full((2, 1), 0.5, dtype=torch.float64), 1e-3)
    load, push = torch.tensor([[0.0], [20.0]], dtype=torch.float64), torch.full((2, 1), 2.0, dtype=torch.float64)
    v, y = torch.zeros_like(load), torch.zeros_like(load)
    rows = []
    for _ in range(1000):
        v = v + 1e-3 * (push - joints(v, push, load)) / 0.5
        y = y + 1e-3 * v
        rows.append(y[:, 0].tolist())
    assert rows[499][0] > 0.1
    assert 0 < rows[499][1] < 1e-3
    assert rows[999][1] - rows[499][1] == pytest.approx(creep(), rel=1e-2)


@pytest.mark.parametrize("target", ["newton", "mjwarp"])
def test_engines_on_warp_take_the_load(target, tmp_path):
    """Two joints of one model, of which one is pressed: it holds, the other runs."""
    pytest.importorskip({"newton": "newton", "mjwarp": "mujoco_warp"}[target])
    (file,) = stribeck.export(PRESSED, target, tmp_path / f"{target}_pressed.py", part="law")
    free, held = globals()[f"in_{target}"](loaded(file))
    assert free > 0.1
    assert 0 <= held < 1e-3


def in_mjwarp(module):
    import mujoco
    import mujoco_warp

    geom = '<geom size=".1" mass=".5" contype="0" conaffinity="0"/>'
    bodies = "".join(f'<body><joint name="{n}" type="slide" axis="1 0 0"/>{geom}</body>' for n in "ab")
    text = f'<mujoco><option timestep="1e-3" gravity="0 0 0"/><worldbody>{bodies}</worldbody></mujoco>'
    mjm = mujoco.MjModel.from_xml_string(text)
    m, d = mujoco_warp.put_model(mjm), mujoco_warp.make_data(mjm, nworld=1)
    friction = module.JointFriction(mjm, m, d, joints=["a", "b"])
    with pytest.raises(ValueError, match="load must be an array of load_press"):
        mujoco_warp.step(m, d)
    friction.load = np.array([[0.0], [20.0]])
    d.qfrc_applied.fill_(3.0)
    for _ in range(500):
        mujoco_warp.step(m, d)
    return d.qpos.numpy()[0]


def in_newton(module):
    import newton
    import warp as wp

    builder = newton.ModelBuilder()  # gravity is along z
    for _ in range(2):
        link = builder.add_link(mass=0.5, inertia=wp.mat33(np.eye(3) * 1e-2))
        builder.add_articulation([builder.add_joint_prismatic(parent=-1, child=link, axis=newton.Axis.X, friction=0.0)])
    model = builder.finalize(device="cpu")
    friction, solver = module.JointFriction(model, dofs=[0, 1]), newton.solvers.SolverFeatherstone(model)
    state, after, control = model.state(), model.state(), model.control()
    for _ in range(500):
        control.joint_f.fill_(3.0)
        friction.step(state, control, 1e-3, np.array([[0.0], [20.0]]))
        state.clear_forces()
        solver.step(state, after, control, None, 1e-3)
        state, after = after, state
    return state.joint_q.numpy()


OWN = """from stribeck.constants import Constant
from stribeck.laws.lugre import LuGre

class Own(LuGre):
    "A law whose constants have the names of inputs and gains."

    name = "own"
    position = Constant("1", "a number", default=2.0)
    load_press = Constant("1", "a number", default=3.0)
    factor_sigma_2 = Constant("1", "a number", default=5.0)
    gain_0_F_c = Constant("1", "a number", default=7.0)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + (p.position + p.load_press + p.factor_sigma_2 + p.gain_0_F_c) * p.sigma_2 * v
"""


def test_a_law_of_a_file_keeps_its_constants_beside_inputs_of_their_names(tmp_path, capsys):
    (tmp_path / "own.py").write_text(OWN)
    parameters = {n: x for n, x in law()["parameters"].items() if n != "v_d"}
    data = rig(law={"name": f"{tmp_path / 'own.py'}:Own", "parameters": parameters})
    run = stribeck.simulate(data)
    chosen = contact_law(data)
    assert set(chosen.inputs) == {"load_press_", "load_push", "position_", "factor_sigma_2_"}
    columns = {"load_press_": run["press.f"], "load_push": run["push.f"], "position_": run["a.y"],
               "factor_sigma_2_": 1 + np.asarray(run.t) / 0.7}  # fmt: skip
    rows = np.array([columns[n] for n in chosen.inputs]).T
    forces = [
        chosen.replace(**dict(zip(chosen.inputs, row, strict=True))).force(v, z)
        for row, v, z in zip(rows, run["rub.w"], run["rub.z"], strict=True)
    ]
    assert np.abs(np.array(forces) - run["rub.F"]).max() <= 1e-14 * np.abs(run["rub.F"]).max()
    (tmp_path / "rig.toml").write_text(tomli_w.dumps(data.data))
    words = ["export", str(tmp_path / "rig.toml"), "--contact", "rub", "--target", "c", "--out", str(tmp_path / "out")]
    assert _status(words) == 0, capsys.readouterr().err
    assert "load_press_;" in (tmp_path / "out" / "own.h").read_text()
