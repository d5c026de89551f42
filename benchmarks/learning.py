"""Joint friction in learning simulators: what each engine does with the same numbers, and steps a second.

With ``--device cuda`` all but MuJoCo run on the GPU, and steps are counted by the clock: Warp's engines are advanced by a
CUDA graph as their users do, JAX and PyTorch are waited for once at the end.
"""

from __future__ import annotations

import importlib.util
import tempfile
from importlib import metadata
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import jax
import mujoco
import mujoco_warp
import numpy as np
import torch
import warp as wp
from measure import finish, options, say

import stribeck
from stribeck.exports import export
from stribeck.exports.python import to_jax, to_torch

jax.config.update("jax_enable_x64", True)

# A joint of 1 kg m^2 alone: 1.5 N m static, 1 N m kinetic friction; elastic up to 0.95 N m.
CONSTANTS = {
    "sigma_0": 1e5, "sigma_1": 316.0, "sigma_2": 0.4, "F_c": 1.0, "F_s": 1.5, "v_s": 1e-3, "k_v": 1e7, "z_ba": 9.5e-6,
}  # fmt: skip
LAW = stribeck.law("elastoplastic_majorant", CONSTANTS)
MODEL = """<mujoco><option timestep="{step}" gravity="0 0 0" integrator="implicitfast"/><worldbody><body>
<joint name="j" type="slide" axis="1 0 0" frictionloss="{loss}" damping="{damping}"/>
<geom type="box" size=".05 .05 .05" mass="1" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""
WORLDS = 4096
ON_A_GPU = (4096, 65_536)
STEPS = (2e-3, 5e-3, 1e-2, 2e-2)


def drive(kind: str, t: float) -> float:
    """The load: held at 0.9 N m; a ramp to break-away; a sine of 3 N m at 0.5 Hz."""
    if kind == "hold":
        return 0.9 * min(t, 1.0)
    return 2.0 * t if kind == "ramp" else 3.0 * np.sin(np.pi * t)


class Engine:
    """A world, or many."""

    graphs = False  # whether its pushes can be captured in a CUDA graph

    def push(self, load: float) -> None:
        """A step under the load."""
        raise NotImplementedError

    def read(self) -> tuple[float, float]:
        """Position and velocity of the first world."""
        raise NotImplementedError

    def __call__(self, load: float) -> tuple[float, float]:
        """Position and velocity after a step under the load."""
        self.push(load)
        return self.read()


class MuJoCo(Engine):
    """MuJoCo's frictionloss on the CPU."""

    def __init__(self, step: float, loss: float = 1.0) -> None:
        self.model = mujoco.MjModel.from_xml_string(MODEL.format(step=step, loss=loss, damping=0.4 if loss else 0.0))
        self.data = mujoco.MjData(self.model)

    def push(self, load: float) -> None:
        """A step under the load."""
        self.data.qfrc_applied[0] = load
        mujoco.mj_step(self.model, self.data)

    def read(self) -> tuple[float, float]:
        """Position and velocity of the first world."""
        return float(self.data.qpos[0]), float(self.data.qvel[0])


class MuJoCoWarp(Engine):
    """MuJoCo Warp; loss 0 and a friction of ours by the exported callback."""

    graphs = True

    def __init__(self, step: float, own: bool, worlds: int = 1) -> None:
        loss = 0.0 if own else 1.0
        model = mujoco.MjModel.from_xml_string(MODEL.format(step=step, loss=loss, damping=0.0 if own else 0.4))
        self.m = mujoco_warp.put_model(model)
        self.d = mujoco_warp.put_data(model, mujoco.MjData(model), nworld=worlds)
        if own:
            self.friction = exported("mjwarp").JointFriction(model, self.m, self.d, ["j"])

    def push(self, load: float) -> None:
        """A step under the load."""
        self.d.qfrc_applied.fill_(load)
        mujoco_warp.step(self.m, self.d)

    def read(self) -> tuple[float, float]:
        """Position and velocity of the first world."""
        return float(self.d.qpos.numpy()[0, 0]), float(self.d.qvel.numpy()[0, 0])


class MJX(Engine):
    """MuJoCo's equations in JAX, compiled."""

    def __init__(self, step: float, worlds: int = 1) -> None:
        from mujoco import mjx

        model = mjx.put_model(mujoco.MjModel.from_xml_string(MODEL.format(step=step, loss=1.0, damping=0.4)))
        self.data = jax.vmap(lambda _: mjx.make_data(model))(np.arange(worlds))
        self.step = jax.jit(
            jax.vmap(lambda d, load: mjx.step(model, d.replace(qfrc_applied=load + 0 * d.qfrc_applied)), (0, None))
        )

    def push(self, load: float) -> None:
        """A step under the load."""
        self.data = self.step(self.data, load)

    def read(self) -> tuple[float, float]:
        """Position and velocity of the first world."""
        return float(self.data.qpos[0, 0]), float(self.data.qvel[0, 0])


class Newton(Engine):
    """Newton with its MuJoCo solver."""

    graphs = True

    def __init__(self, step: float, own: bool, worlds: int = 1) -> None:
        import newton

        world = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
        link = world.add_link(mass=1.0, inertia=wp.mat33(1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0))
        joint = world.add_joint_prismatic(-1, link, axis=(1, 0, 0), armature=0.0, friction=0.0 if own else 1.0)
        world.add_articulation([joint])
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
        builder.replicate(world, worlds)  # else all links are one system of as many coupled joints
        model = builder.finalize(device=wp.get_device())
        self.solver = newton.solvers.SolverMuJoCo(model)
        self.state, self.other, self.control, self.step = model.state(), model.state(), model.control(), step
        newton.eval_fk(model, model.joint_q, model.joint_qd, self.state)
        self.friction = exported("newton").JointFriction(model, range(worlds)) if own else None

    def push(self, load: float) -> None:
        """A step under the load."""
        self.control.joint_f.fill_(load)
        if self.friction:
            self.friction.step(self.state, self.control, self.step)
        self.solver.step(self.state, self.other, self.control, None, self.step)
        self.state, self.other = self.other, self.state

    def read(self) -> tuple[float, float]:
        """Position and velocity of the first world."""
        return float(self.state.joint_q.numpy()[0]), float(self.state.joint_qd.numpy()[0])


class Torch(Engine):
    """A joint in PyTorch (double precision): the tanh friction of most hand-written tasks, or the law's step."""

    def __init__(self, step: float, own: bool, worlds: int = 1) -> None:
        self.dt, self.law = step, to_torch(LAW) if own else None
        self.q, self.v, self.z = (torch.zeros(worlds, dtype=torch.float64) for _ in range(3))

    def push(self, load: float) -> None:
        """A step under the load."""
        if self.law:
            self.z, friction = self.law.step(self.z, self.v, load, 1.0, self.dt)
        else:
            friction = torch.tanh(self.v / 0.01) + 0.4 * self.v  # steeper is unstable at 20 ms
        self.v = self.v + self.dt * (load - friction)
        self.q = self.q + self.dt * self.v

    def read(self) -> tuple[float, float]:
        """Position and velocity of the first world."""
        return float(self.q[0]), float(self.v[0])


class Jax(Engine):
    """A joint in JAX (double precision), compiled: the law's step."""

    def __init__(self, step: float, worlds: int = 1) -> None:
        law = to_jax(LAW)
        self.state = (jax.numpy.zeros(worlds),) * 3

        def advance(state: Any, load: float) -> Any:
            z, v, q = state
            z, friction = law.step(z, v, load + 0 * v, 1.0 + 0 * v, step + 0 * v)
            v = v + step * (load - friction)
            return z, v, q + step * v

        self.step = jax.jit(advance)

    def push(self, load: float) -> None:
        """A step under the load."""
        self.state = self.step(self.state, load)

    def read(self) -> tuple[float, float]:
        """Position and velocity of the first world."""
        return float(self.state[2][0]), float(self.state[1][0])


def exported(target: str) -> Any:
    """The exported file as a module."""
    path = Path(tempfile.mkdtemp()) / f"friction_{target}.py"
    export(LAW, target, path)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


ENGINES: dict[str, Any] = {
    "MuJoCo, frictionloss": lambda step, worlds=1: MuJoCo(step),
    "MuJoCo Warp, frictionloss": lambda step, worlds=1: MuJoCoWarp(step, False, worlds),
    "MuJoCo Warp, this law": lambda step, worlds=1: MuJoCoWarp(step, True, worlds),
    "MJX, frictionloss": lambda step, worlds=1: MJX(step, worlds),
    "Newton, joint friction": lambda step, worlds=1: Newton(step, False, worlds),
    "Newton, this law": lambda step, worlds=1: Newton(step, True, worlds),
    "PyTorch, tanh(v/0.01)": lambda step, worlds=1: Torch(step, False, worlds),
    "PyTorch, this law": lambda step, worlds=1: Torch(step, True, worlds),
    "JAX, this law": lambda step, worlds=1: Jax(step, worlds),
}


def behavior(make: Any, step: float, seconds: float) -> dict[str, float]:
    """Creep under 0.9 N m, m/s; the load at which it moves by 0.1 mm on a ramp, N; energy drawn in 4 s of the sine, J."""
    rig = make(step)
    q = [rig(drive("hold", k * step))[0] for k in range(round((2 + seconds) / step))]
    creep = (q[-1] - q[round(2 / step)]) / seconds
    rig, load, k = make(step), 0.0, 0
    while load < 4.0:
        load = drive("ramp", k * step)
        k += 1
        if rig(load)[0] > 1e-4:
            break
    rig, energy, before = make(step), 0.0, 0.0
    for k in range(round(4.0 / step)):
        push = drive("sine", k * step)
        now, _ = rig(push)
        energy, before = energy + push * (now - before), now
    return {"creep": creep, "break_away": load, "energy": energy}


def speeds(makers: dict[str, Any], count: int, rounds: int = 3) -> dict[str, float]:
    """Steps of all worlds together in a second of processor time (all threads): medians of rounds in which each has its turn."""
    rigs = {name: make(2e-3, WORLDS) for name, make in makers.items()}
    for rig in rigs.values():
        rig(0.9)
    outcome: dict[str, list[float]] = {name: [] for name in rigs}
    for _ in range(rounds):
        for name, rig in rigs.items():
            started = process_time()
            for _ in range(count):
                rig(0.9)
            outcome[name].append(WORLDS * count / (process_time() - started))
    return {name: float(np.median(x)) for name, x in outcome.items()}


def speeds_on_a_gpu(makers: dict[str, Any], count: int, worlds: int, rounds: int = 5) -> dict[str, float]:
    """Steps of all worlds together in a second by the clock: medians of rounds in which each has its turn."""
    pushes: dict[str, tuple[Engine, Any]] = {}
    for name, make in makers.items():
        rig = make(2e-3, worlds)
        for _ in range(2):
            rig(0.9)
        pushes[name] = (rig, lambda rig=rig: (rig.push(0.9), rig.push(0.9)))
        if rig.graphs:
            with wp.ScopedCapture() as capture:  # two steps: Newton's states are then where they were
                pushes[name][1]()
            pushes[name] = (rig, lambda graph=capture.graph: wp.capture_launch(graph))
    outcome: dict[str, list[float]] = {name: [] for name in pushes}
    for _ in range(rounds):
        for name, (rig, push) in pushes.items():
            started = perf_counter()
            for _ in range(count // 2):
                push()
            position, _ = rig.read()
            outcome[name].append(worlds * count / (perf_counter() - started))
            assert np.isfinite(position), name
    return {name: float(np.median(x)) for name, x in outcome.items()}


def main() -> None:
    """Print a table, and write the results."""
    given = options(__doc__, "learning", seconds=(100.0, 4.0), device="cpu")  # held; cuda
    wp.config.quiet = True
    on_gpu = given.device == "cuda"
    if on_gpu:
        torch.set_default_device("cuda")
    wp.set_device("cuda:0" if on_gpu else "cpu")
    jax.config.update("jax_default_device", jax.devices("gpu" if on_gpu else "cpu")[0])
    torch.set_num_threads(1)  # its threads wait by turning: on a busy machine that is most of their time
    rows = []
    for name, make in ENGINES.items():
        row: dict[str, Any] = {"engine": name}
        for step in STEPS:
            seconds = given.seconds if "this law" in name else min(10.0, given.seconds)  # theirs creep evenly
            row[f"{step:g}"] = {**behavior(make, step, seconds), "held": seconds}
        rows.append(row)
        say(str(row))
    many = {name: make for name, make in ENGINES.items() if name != "MuJoCo, frictionloss"}
    packages = ("mujoco", "mujoco-warp", "mujoco-mjx", "newton", "warp-lang", "torch", "jax")
    result = {"versions": {n: metadata.version(n) for n in packages}, "constants": CONSTANTS, "rows": rows}
    if on_gpu:
        speed = {str(n): speeds_on_a_gpu(many, 100, n) for n in ON_A_GPU}
        finish(given, {**result, "gpu": torch.cuda.get_device_name(), "steps_a_second": speed}, stem="learning_gpu")
    else:
        finish(given, {**result, "worlds": WORLDS, "steps_a_processor_second": speeds(many, 20)})


if __name__ == "__main__":
    main()
