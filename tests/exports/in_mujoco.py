"""The exported models in MuJoCo."""

import mujoco
import numpy as np

from stribeck.exports import export


def load(law, folder, step=1e-3, own=False, change=lambda text: text):
    """A model as a user loads it, and what its callback's file defines."""
    mujoco.set_mjcb_act_dyn(None)
    mujoco.set_mjcb_act_bias(None)
    export(law, "mujoco", folder, step=step)
    path = folder / f"{law.name}{'_dcmotor' if own else ''}.xml"
    path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")
    model = mujoco.MjModel.from_xml_path(str(path))
    scope = {}
    if not own:
        source = (folder / f"{law.name}_mujoco.py").read_text(encoding="utf-8")
        exec(compile(source, "callback", "exec"), scope)
        scope["install"](model)
    return model, mujoco.MjData(model), scope


def run(model, data, push, t_end):
    """Times, positions, velocities and the friction that the body felt in each step."""
    step, mass = model.opt.timestep, model.body("body").mass[0]
    count = round(t_end / step)
    y, v, u = (np.zeros(count + 1) for _ in range(3))
    for k in range(count):
        u[k] = data.qfrc_applied[0] = push(data.time, data.qpos[0])
        mujoco.mj_step(model, data)
        y[k + 1], v[k + 1] = data.qpos[0], data.qvel[0]
    return np.arange(count + 1) * step, y, v, u[:-1] - mass * np.diff(v) / step
