"""The law in PyTorch and JAX against NumPy's step, with gradients; and the files for learning simulators, run."""

import importlib.util
import subprocess
import sys

import numpy as np
import pytest

import stribeck
from stribeck.exports import export
from stribeck.exports.python import to_jax, to_torch
from tests.exports.stepped import Stepped, law, problems

SAMPLE = ("lugre_majorant", "elastoplastic", "stribeck")


def both(name):
    """A step with gradients of friction + z, from NumPy."""
    step = Stepped(law(name))
    p, given, (x, force, w, jump) = step.solve(*problems(step.law, 40, 3, wide=False))
    slopes = step.slopes(p, given, (x, w, jump))
    first, each = [np.add(*slopes[i]) for i in range(5)], {n: np.add(*slopes[n]) for n in step.constants}
    return step, given, (x, force), first, each


@pytest.mark.parametrize("name", SAMPLE)
def test_torch(name):
    torch = pytest.importorskip("torch")
    step, given, results, first, each = both(name)
    inputs = [torch.tensor(x, requires_grad=True) for x in given]
    constants = {n: torch.tensor(x, dtype=torch.float64, requires_grad=True) for n, x in step.constants.items()}
    z, force = to_torch(step.law).step(*inputs, **constants)
    (z + force).sum().backward()
    assert np.allclose(z.detach(), results[0], rtol=1e-12, atol=1e-20)
    assert np.allclose(force.detach(), results[1], rtol=1e-10, atol=1e-13)
    for x, wanted in zip(inputs, first, strict=True):
        assert np.allclose(x.grad, wanted, rtol=1e-8, atol=1e-10 * np.max(abs(wanted)))
    for n, x in constants.items():  # one constant for all worlds: its gradient is their sum
        assert float(x.grad) == pytest.approx(np.sum(each[n]), rel=1e-8, abs=1e-10 * np.sum(abs(each[n])))
    assert to_torch(step.law).step(*(x.detach() for x in inputs[:-1]), inputs[-1])[1].requires_grad
    with pytest.raises(stribeck.InputError, match="no such constant"):
        to_torch(step.law).step(*inputs, Fs=1.0)


@pytest.mark.parametrize("name", SAMPLE)
def test_jax(name):
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    step, given, results, first, _ = both(name)
    tool = to_jax(step.law)
    z, force = jax.jit(tool.step)(*given)
    assert np.allclose(z, results[0], rtol=1e-9, atol=1e-18)
    assert np.allclose(force, results[1], rtol=1e-8, atol=1e-12)
    slopes = jax.grad(lambda *x: sum(y.sum() for y in tool.step(*x)), range(5))(*map(jax.numpy.asarray, given))
    for slope, wanted in zip(slopes, first, strict=True):
        assert np.allclose(slope, wanted, rtol=1e-6, atol=1e-8 * np.max(abs(wanted)))


@pytest.mark.parametrize("name", SAMPLE)
def test_kernels(name, tmp_path):
    """Each machine has one joint, so that the coupled step is the step of a joint; in single precision."""
    pytest.importorskip("mujoco_warp")
    import warp as wp

    wp.config.quiet = True
    step, (z, v, effort, inertia, dt), wanted, _, _ = both(name)
    kernels = module("mjwarp", tmp_path, step.law)
    one = [wp.array(x[:, None], dtype=wp.float32) for x in (v, effort, 0 * v, 0 * v)]
    matrix, slot = wp.array(inertia[:, None, None], dtype=wp.float32), wp.array(np.arange(40)[:, None], dtype=int)
    state, fresh = wp.array(z, dtype=wp.float32), wp.full(40, True, dtype=wp.bool)
    constants, steps = wp.array(kernels._table(None, 40), dtype=wp.float32), wp.array(dt, dtype=wp.float32)
    given = [constants, slot, matrix, steps, *one[:2], state, fresh, *one[2:]]
    wp.launch(kernels.coupled, 40, inputs=given)
    rounding = 1e-5 * (abs(effort) + inertia / dt * abs(v) + step.law.scales(step.law.p).force)
    assert np.all(abs(one[3].numpy()[:, 0] - wanted[1]) <= rounding)


ELASTIC = {
    "sigma_0": 2e4, "sigma_1": 20.0, "sigma_2": 0.02, "F_c": 1.0, "F_s": 1.5, "v_s": 0.01, "k_v": 1e6, "z_ba": 4e-5,
}  # fmt: skip


def module(target, folder, of=None):
    """The exported file, imported."""
    path = folder / f"friction_{target}.py"
    export(of or stribeck.law("elastoplastic_majorant", ELASTIC), target, path)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    result = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(result)
    return result


def test_newton_holds_a_double_pendulum(tmp_path):
    """Two coupled links let go near the bottom come to rest, and stay."""
    pytest.importorskip("newton")
    import newton
    import warp as wp

    builder, parent, joints = newton.ModelBuilder(), -1, []
    for k in range(2):
        link = builder.add_link(
            mass=0.5, inertia=wp.mat33(5e-3, 0, 0, 0, 5e-3, 0, 0, 0, 5e-3), com=wp.vec3(0, 0, -0.15)
        )
        where = wp.transform((0, 0, -0.3 * k), wp.quat_identity())
        joints.append(builder.add_joint_revolute(parent, link, axis=(0, 1, 0), parent_xform=where))
        parent = link
    builder.add_articulation(joints)
    model = builder.finalize(device="cpu")
    model.joint_q.assign([0.3, 0.0])
    solver, state, other, control = (
        newton.solvers.SolverFeatherstone(model),
        model.state(),
        model.state(),
        model.control(),
    )
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    friction, past = module("newton", tmp_path).JointFriction(model, [0, 1]), []
    for _ in range(300):
        control.joint_f.zero_()
        friction.step(state, control, 0.01)
        solver.step(state, other, control, None, 0.01)
        state, other = other, state
        past.append(state.joint_q.numpy().copy())
    assert np.max(abs(past[-1] - past[200])) < 1e-6
    assert 0.05 < past[-1][0] < 0.3


def test_mjwarp_holds_and_slides(tmp_path):
    mujoco_warp = pytest.importorskip("mujoco_warp")
    import mujoco
    import warp as wp

    wp.config.quiet = True
    text = (
        '<mujoco><option timestep="0.01" gravity="0 0 0" integrator="implicitfast"/><worldbody><body><joint name="j" '
        'type="slide" axis="1 0 0"/><geom size=".1" mass="1"/></body></worldbody></mujoco>'
    )
    model = mujoco.MjModel.from_xml_string(text)
    m, d = mujoco_warp.put_model(model), mujoco_warp.put_data(model, mujoco.MjData(model), nworld=2)
    friction = module("mjwarp", tmp_path).JointFriction(model, m, d, ["j"])
    d.qfrc_applied.assign(np.array([[0.6], [3.0]], np.float32))
    for _ in range(100):
        mujoco_warp.step(m, d)
    assert d.qpos.numpy()[0, 0] == pytest.approx(0.6 / 2e4, rel=1e-5)
    assert abs(d.qvel.numpy()[0, 0]) < 1e-8
    v = d.qvel.numpy()[1, 0]
    assert friction.friction.numpy()[1, 0] == pytest.approx(1 + 0.02 * v, rel=1e-3)
    assert v == pytest.approx(2.0, rel=0.02)
    with pytest.raises(ValueError, match="no joint called k"):
        type(friction)(model, m, d, ["k"])


def test_isaaclab_holds_against_a_load_that_it_does_not_see(tmp_path):
    """The PyTorch part: a joint under gravity the actuator knows nothing of; randomised constants; a reset."""
    torch = pytest.importorskip("torch")
    built = module("isaaclab", tmp_path)
    inertia, dt = torch.full((2, 1), 0.05), 5e-3
    friction = built.JointFriction(inertia, dt, F_c=torch.tensor([[1.0], [0.9]]))
    q, v, motor = torch.zeros(2, 1), torch.zeros(2, 1), torch.tensor([[0.2], [0.2]])
    for k in range(600):
        outside = torch.tensor([[0.5], [1.5]]) * min(k * dt, 1.0)
        v = v + dt * (motor + outside - friction(v, motor)) / inertia
        q = q + dt * v
    assert float(q[0, 0]) == pytest.approx(0.7 / 2e4, rel=1e-3)
    assert abs(float(v[0, 0])) < 1e-7
    assert float(friction.friction[1, 0]) == pytest.approx(0.9 + 0.02 * float(v[1, 0]), rel=1e-2)
    friction.reset(torch.tensor([1]))
    assert friction.z[1, 0] == 0
    assert friction.z[0, 0] > 0


@pytest.mark.parametrize("target", ["newton", "mjwarp", "isaaclab"])
def test_every_law_is_written(target, tmp_path):
    for name in ("dahl", "stribeck", "elastoplastic"):
        (file,) = export(law(name), target, tmp_path / f"{name}.py")
        text = file.read_text(encoding="utf-8")
        compile(text, str(file), "exec")
        assert repr(law(name).values["F_c"]) in text
        assert "stribeck." not in text.split('"""', 2)[2]  # it stands alone
        judge = [sys.executable, "-m", "ruff", "check", "--isolated", "--select", "F", str(file)]
        judged = subprocess.run(judge, capture_output=True, text=True)  # every name that it uses is defined in it
        assert judged.returncode == 0, judged.stdout + judged.stderr
