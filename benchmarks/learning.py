"""Joint friction in learning simulators: what each engine does with the same numbers, and steps a second.

With ``--device cuda`` all but MuJoCo run on the GPU, and steps are counted by the clock: Warp's engines are advanced by a
CUDA graph as their users do, JAX and PyTorch are waited for once at the end.
"""

from __future__ import annotations

import importlib.util
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
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
# loads: held at 0.9 N m; a ramp to break-away; a sine of 3 N m at 0.5 Hz
HELD, RAMP, SINE = (lambda t: 0.9 * min(t, 1.0)), (lambda t: 2.0 * t), (lambda t: 3.0 * np.sin(np.pi * t))
STEPS = (2e-3, 5e-3, 1e-2, 2e-2)


@dataclass(frozen=True)
class Engine:
    """A world, or many.

    Attributes:
        push: a step under a load.
        read: position and velocity of the first world.
        graphs: whether pushes can be captured in a CUDA graph.
    """

    push: Callable[[float], object]
    read: Callable[[], tuple[float, float]]
    graphs: bool = False

    def __call__(self, load: float) -> tuple[float, float]:
        """Position and velocity after a step under the load."""
        self.push(load)
        return self.read()


def joint_model(step: float, own: bool = False) -> mujoco.MjModel:
    """The joint for MuJoCo; of our ``own`` friction, its own is 0."""
    return mujoco.MjModel.from_xml_string(
        MODEL.format(step=step, loss=0.0 if own else 1.0, damping=0.0 if own else 0.4)
    )


def mujoco_cpu(step: float, worlds: int = 1) -> Engine:
    """MuJoCo's frictionloss on the CPU, of one world."""
    model = joint_model(step)
    data = mujoco.MjData(model)

    def push(load: float) -> None:
        data.qfrc_applied[0] = load
        mujoco.mj_step(model, data)

    return Engine(push, lambda: (float(data.qpos[0]), float(data.qvel[0])))


def mjwarp(own: bool, step: float, worlds: int = 1) -> Engine:
    """MuJoCo Warp with its frictionloss, or our own friction by the exported callback."""
    model = joint_model(step, own)
    m = mujoco_warp.put_model(model)
    d = mujoco_warp.put_data(model, mujoco.MjData(model), nworld=worlds)
    if own:
        exported("mjwarp").JointFriction(model, m, d, ["j"])

    def push(load: float) -> None:
        d.qfrc_applied.fill_(load)
        mujoco_warp.step(m, d)

    return Engine(push, lambda: (float(d.qpos.numpy()[0, 0]), float(d.qvel.numpy()[0, 0])), graphs=True)


def mjx(step: float, worlds: int = 1) -> Engine:
    """MuJoCo's equations in JAX, compiled."""
    from mujoco import mjx

    model = mjx.put_model(joint_model(step))
    data = jax.vmap(lambda _: mjx.make_data(model))(np.arange(worlds))
    advance = jax.jit(
        jax.vmap(lambda d, load: mjx.step(model, d.replace(qfrc_applied=load + 0 * d.qfrc_applied)), (0, None))
    )

    def push(load: float) -> None:
        nonlocal data
        data = advance(data, load)

    return Engine(push, lambda: (float(data.qpos[0, 0]), float(data.qvel[0, 0])))


def newton(own: bool, step: float, worlds: int = 1) -> Engine:
    """Newton with its MuJoCo solver, and its joint friction or our own."""
    import newton

    world = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    link = world.add_link(mass=1.0, inertia=wp.mat33(1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0))
    joint = world.add_joint_prismatic(-1, link, axis=(1, 0, 0), armature=0.0, friction=0.0 if own else 1.0)
    world.add_articulation([joint])
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    builder.replicate(world, worlds)  # else all links are one system of as many coupled joints
    model = builder.finalize(device=wp.get_device())
    solver = newton.solvers.SolverMuJoCo(model)
    state, other, control = model.state(), model.state(), model.control()
    newton.eval_fk(model, model.joint_q, model.joint_qd, state)
    friction = exported("newton").JointFriction(model, range(worlds)) if own else None

    def push(load: float) -> None:
        nonlocal state, other
        control.joint_f.fill_(load)
        if friction:
            friction.step(state, control, step)
        solver.step(state, other, control, None, step)
        state, other = other, state

    return Engine(push, lambda: (float(state.joint_q.numpy()[0]), float(state.joint_qd.numpy()[0])), graphs=True)


def by_torch(own: bool, step: float, worlds: int = 1) -> Engine:
    """A joint in PyTorch (double precision): the tanh friction of most hand-written tasks, or the law's step."""
    law = to_torch(LAW) if own else None
    q, v, z = (torch.zeros(worlds, dtype=torch.float64) for _ in range(3))

    def push(load: float) -> None:
        nonlocal q, v, z
        if law:
            z, friction = law.step(z, v, load, 1.0, step)
        else:
            friction = torch.tanh(v / 0.01) + 0.4 * v  # steeper is unstable at 20 ms
        v = v + step * (load - friction)
        q = q + step * v

    return Engine(push, lambda: (float(q[0]), float(v[0])))


def by_jax(step: float, worlds: int = 1) -> Engine:
    """A joint in JAX (double precision), compiled: the law's step."""
    law, state = to_jax(LAW), (jax.numpy.zeros(worlds),) * 3

    @jax.jit
    def advance(state: Any, load: float) -> Any:
        z, v, q = state
        z, friction = law.step(z, v, load + 0 * v, 1.0 + 0 * v, step + 0 * v)
        v = v + step * (load - friction)
        return z, v, q + step * v

    def push(load: float) -> None:
        nonlocal state
        state = advance(state, load)

    return Engine(push, lambda: (float(state[2][0]), float(state[1][0])))


def exported(target: str) -> Any:
    """The exported file as a module."""
    path = Path(tempfile.mkdtemp()) / f"friction_{target}.py"
    export(LAW, target, path)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


ENGINES: dict[str, Callable[..., Engine]] = {
    "MuJoCo, frictionloss": mujoco_cpu,
    "MuJoCo Warp, frictionloss": partial(mjwarp, False),
    "MuJoCo Warp, this law": partial(mjwarp, True),
    "MJX, frictionloss": mjx,
    "Newton, joint friction": partial(newton, False),
    "Newton, this law": partial(newton, True),
    "PyTorch, tanh(v/0.01)": partial(by_torch, False),
    "PyTorch, this law": partial(by_torch, True),
    "JAX, this law": by_jax,
}


def behavior(make: Any, step: float, seconds: float) -> dict[str, float]:
    """Creep under 0.9 N m, m/s; the load at which it moves by 0.1 mm on a ramp, N; energy drawn in 4 s of the sine, J."""
    rig = make(step)
    q = [rig(HELD(k * step))[0] for k in range(round((2 + seconds) / step))]
    creep = (q[-1] - q[round(2 / step)]) / seconds
    rig, load, k = make(step), 0.0, 0
    while load < 4.0:
        load = RAMP(k * step)
        k += 1
        if rig(load)[0] > 1e-4:
            break
    rig, energy, before = make(step), 0.0, 0.0
    for k in range(round(4.0 / step)):
        push = SINE(k * step)
        now, _ = rig(push)
        energy, before = energy + push * (now - before), now
    return {"creep": creep, "break_away": load, "energy": energy}


def speeds(makers: dict[str, Callable[..., Engine]], count: int, worlds: int, on_gpu: bool) -> dict[str, float]:
    """Steps of all worlds together in a second: medians of rounds in which each has its turn.

    Of processor time of all threads; on a GPU by the clock, and captured in a graph where that can be.
    """
    clock, rounds = (perf_counter, 5) if on_gpu else (process_time, 3)
    pushes: dict[str, tuple[Engine, Callable[[], object]]] = {}
    for name, make in makers.items():
        rig = make(2e-3, worlds)
        for _ in range(2):
            rig(0.9)
        pushes[name] = (rig, lambda rig=rig: (rig.push(0.9), rig.push(0.9)))
        if on_gpu and rig.graphs:
            with wp.ScopedCapture() as capture:  # two steps: Newton's states are then where they were
                pushes[name][1]()
            pushes[name] = (rig, lambda graph=capture.graph: wp.capture_launch(graph))
    outcome: dict[str, list[float]] = {name: [] for name in pushes}
    for _ in range(rounds):
        for name, (rig, push) in pushes.items():
            started = clock()
            for _ in range(count // 2):
                push()
            position, _ = rig.read()
            outcome[name].append(worlds * count / (clock() - started))
            assert np.isfinite(position), name
    return {name: float(np.median(x)) for name, x in outcome.items()}


def main() -> None:
    """Behavior and speed on the CPU, or with ``--device cuda`` on a GPU."""
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
        speed = {str(n): speeds(many, 100, n, on_gpu) for n in ON_A_GPU}
        finish(given, {**result, "gpu": torch.cuda.get_device_name(), "steps_a_second": speed}, stem="learning_gpu")
    else:
        finish(given, {**result, "worlds": WORLDS, "steps_a_processor_second": speeds(many, 20, WORLDS, on_gpu)})


if __name__ == "__main__":
    main()
