"""Models each joint of a MuJoCo model as a machine of one body.

The rigid-body torque comes from MuJoCo's inverse dynamics along the recorded motion. The rest of the measured torque is the
joint's friction.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.interpolate import make_interp_spline

from stribeck.constants import show
from stribeck.errors import InputError, arg, needed
from stribeck.files import open_file, write_text
from stribeck.identify.actuator.api import fit_machine
from stribeck.identify.actuator.inputs import STILL
from stribeck.identify.actuator.recordings import Channel, Logs, Recording, Sought
from stribeck.identify.data.filters import HIGHEST, low_pass
from stribeck.identify.data.quality import EVEN
from stribeck.identify.result import MachineFit
from stribeck.recorded import is_table, no_column, opened
from stribeck.scenario import Scenario

MuJoCo = Any  # MuJoCo's modules, models and data have no types

_STEEP = 500.0  # k_v in units of 1/speed: the smooth sign is complete at a few thousandths of the speed
_ROOM = 1e-4  # of the largest torque: lower bound of the friction
_CUTOFF = 0.1  # of the sampling rate: above it, differences show more noise than motion


@dataclass(frozen=True)
class Joint:
    """A joint as a machine with recordings for :func:`fit_machine`; its contact is called ``friction``."""

    name: str
    machine: Scenario
    logs: Logs

    def fit(self, **options: Any) -> MachineFit:
        """Fit the joint's friction; ``options`` are those of :func:`fit_machine`, such as ``laws={"friction": [...]}``."""
        return fit_machine(self.machine, self.logs, **options)

    def write(self, folder: str | Path) -> tuple[Path, Path]:
        """Write JOINT.toml and JOINT_logs.toml for ``stribeck fit``, with a CSV file for each recording.

        The folder is created if it does not exist.
        """
        import tomli_w

        folder, entries = Path(folder), list[dict[str, object]]()
        folder.mkdir(parents=True, exist_ok=True)
        for i, r in enumerate(self.logs.recordings):
            outputs, inputs = ({n: c.column for n, c in group.items()} for group in (r.outputs, r.inputs))
            columns = {"t": r.t, **{c.column: c.x for c in (*r.outputs.values(), *r.inputs.values())}}
            rows = [",".join(columns), *(",".join(map(repr, row)) for row in np.stack([*columns.values()], 1).tolist())]
            write_text(folder / f"{self.name}_{i}.csv", "\n".join(rows) + "\n")
            file = f"{self.name}_{i}.csv"
            entries.append({"file": file, "hold_out": r.hold_out, "outputs": outputs, "inputs": inputs})
        sought = {s.path: {"low": s.low, "high": s.high} for s in self.logs.sought}
        machine, logs = folder / f"{self.name}.toml", folder / f"{self.name}_logs.toml"
        write_text(machine, tomli_w.dumps(self.machine.data))
        write_text(logs, tomli_w.dumps({"log": entries, "unknown": sought}))
        return machine, logs


def from_mujoco(
    model: MuJoCo, log: Any, *, positions: Mapping[str, str] | None = None, torques: Mapping[str, str] | None = None,
    time: str = "t", cutoff: float | None = None, hold_out: Sequence[int] = (),
) -> dict[str, Joint]:  # fmt: skip
    """Each joint of a MuJoCo model whose torque was recorded, as a machine of one body with its recordings.

    The model's own friction (``frictionloss``, ``damping``) is ignored, because it is fitted. Armature and springs are
    those of the model. Contacts and joint limits do not act.

    Args:
        model: a ``mujoco.MjModel``, or the path of an XML model.
        log: a recording or several, each a file (CSV, Parquet, MAT, NPZ), a data frame or a mapping of columns.
        positions: the column of each joint's position (rad, m); ``JOINT.position`` unless given. Every slide and hinge
            must have one.
        torques: the column of each joint's torque or force (N m, N); ``JOINT.torque``, if it exists, unless given.
        time: the column of times, s, evenly sampled.
        cutoff: cut-off frequency, Hz, of the zero-phase low-pass (Butterworth, order 4) before derivatives; a tenth of
            the sampling rate unless given.
        hold_out: indices of recordings, from 0, that are predicted and not fitted.

    Raises:
        InputError: the model or a recording cannot be read, or a column is missing; a line for each problem.
        MissingExtra: MuJoCo is not installed.
    """
    with needed("identify.from_mujoco"):
        import mujoco
    frictionless = _model(mujoco, model)
    logs = log if isinstance(log, list | tuple) else [log]
    motions = [
        _Motion(mujoco, frictionless, x, i, time, positions or {}, torques or {}, cutoff) for i, x in enumerate(logs)
    ]
    driven = [name for name in motions[0].joints if all(name in motion.torque for motion in motions)]
    if not driven:
        wanted = ", ".join(f"{name}.torque" for name in motions[0].joints)
        raise InputError(f"{arg('torques')}: no joint has a torque in every recording (looked for {wanted})")
    return {name: _joint(name, motions, hold_out) for name in driven}


def _model(mujoco: MuJoCo, model: MuJoCo) -> MuJoCo:
    """The model without friction, contacts and limits: a copy."""
    import copy

    if isinstance(model, str | Path):
        try:
            open_file(Path(model)).close()  # raises for a pipe, on which MuJoCo would block
            copied = mujoco.MjModel.from_xml_path(str(model))
        except OSError as error:
            raise InputError(f"{model}: cannot be read: {error.strerror}") from None
        except ValueError as error:
            raise InputError(f"{model}: MuJoCo cannot read it: {str(error).splitlines()[0]}") from None
    else:
        copied = copy.deepcopy(model)
    for name in ("dof_frictionloss", "dof_damping", "dof_dampingpoly", "actuator_damping", "actuator_dampingpoly"):
        if hasattr(copied, name):
            getattr(copied, name)[:] = 0.0
    flags = mujoco.mjtDisableBit
    copied.opt.disableflags |= int(flags.mjDSBL_CONTACT) | int(flags.mjDSBL_LIMIT) | int(flags.mjDSBL_FRICTIONLOSS)
    return copied


class _Motion:
    """One recording: the joints' positions, their torques, and the inverse dynamics of each."""

    def __init__(
        self, mujoco: MuJoCo, model: MuJoCo, data: MuJoCo, number: int, time: str, positions: Mapping[str, str],
        torques: Mapping[str, str], cutoff: float | None,
    ) -> None:  # fmt: skip
        self.file = f"log {number}" if is_table(data) else Path(data).name
        single = (int(mujoco.mjtJoint.mjJNT_SLIDE), int(mujoco.mjtJoint.mjJNT_HINGE))
        self.joints = {model.joint(j).name: j for j in range(model.njnt) if int(model.jnt_type[j]) in single}
        self.hinges = {n for n, j in self.joints.items() if int(model.jnt_type[j]) == single[1]}
        source = opened(data)
        wrong = [f"{arg('positions')}: {n!r}: no such joint" for n in (*positions, *torques) if n not in self.joints]
        wanted = {"time": time, **{f"position of {n}": positions.get(n, f"{n}.position") for n in self.joints}}
        wrong += [no_column(role, name, source) for role, name in wanted.items() if name not in source.names]
        drives = {n: torques.get(n, f"{n}.torque") for n in self.joints}
        wrong += [
            no_column("torques", drives[n], source) for n in torques if n in drives and drives[n] not in source.names
        ]
        if wrong or not self.joints:
            raise InputError(wrong or ["model: has no slide and no hinge"])
        wanted |= {f"torque of {n}": name for n, name in drives.items() if name in source.names}
        columns = source.columns(wanted)
        self.t = columns["time"] - columns["time"][0]
        self.position = {n: columns[f"position of {n}"] for n in self.joints}
        self.torque = {n: columns[f"torque of {n}"] for n in self.joints if f"torque of {n}" in columns}
        self.place = {n: int(model.jnt_dofadr[j]) for n, j in self.joints.items()}
        self._invert(mujoco, model, cutoff)

    def _invert(self, mujoco: MuJoCo, model: MuJoCo, cutoff: float | None) -> None:
        """Compute speeds, accelerations, rigid-body torques and inertias, (times, places of the joints)."""
        step = float(np.median(np.diff(self.t)))
        rows = np.stack([self.t, *self.position.values(), *self.torque.values()])
        if not np.isfinite(rows).all() or abs(np.diff(self.t) - step).max() > EVEN * step or len(self.t) < 32:
            text = "must be evenly sampled and complete, of at least 32 rows, for MuJoCo's inverse dynamics"
            raise InputError(f"{arg('time')}: {show(self.file)}: {text}")
        rate, data = 1 / step, mujoco.MjData(model)
        qpos = np.tile(model.qpos0, (len(self.t), 1))
        self.speed, self.acceleration, self.rigid, self.inertia = np.zeros((4, len(self.t), model.nv))
        for name, place in self.place.items():
            q = low_pass(self.position[name], min(cutoff or _CUTOFF * rate, HIGHEST * rate), step)
            spline = make_interp_spline(self.t, q, 5)
            qpos[:, int(model.jnt_qposadr[self.joints[name]])] = q
            self.speed[:, place], self.acceleration[:, place] = (spline.derivative(n)(self.t) for n in (1, 2))
        full = np.empty((model.nv, model.nv))
        for i in range(len(self.t)):
            data.qpos[:], data.qvel[:], data.qacc[:] = qpos[i], self.speed[i], self.acceleration[i]
            mujoco.mj_inverse(model, data)
            self.rigid[i] = data.qfrc_inverse
            mujoco.mj_fullM(model, data, full)
            self.inertia[i] = np.diag(full)


def _joint(name: str, motions: Sequence[_Motion], hold_out: Sequence[int]) -> Joint:
    """The machine of a joint. Its body has the mean inertia; the rest of the rigid-body torque is a recorded load."""
    place = motions[0].place[name]
    inertia = float(np.mean(np.concatenate([m.inertia[:, place] for m in motions])))
    speed = max(float(np.sqrt(np.mean(np.concatenate([m.speed[:, place] for m in motions]) ** 2))), 1e-6)
    size = max(float(np.max(abs(np.concatenate([m.torque[name] for m in motions])))), 1e-9)
    body = "".join(c if c.isalnum() else "_" for c in name)
    law = {"name": "coulomb_viscous", "k_v": _STEEP / speed,
           "parameters": {"F_c": 0.03 * size, "sigma_2": 0.03 * size / speed}}  # fmt: skip
    machine = Scenario({
        "schema": 2, "name": body,
        "bodies": {body: {"inertia" if name in motions[0].hinges else "mass": inertia}},
        "contacts": {"friction": {"from": body, "law": law}},
        "loads": {n: {"on": body, "kind": "signal", "signal": STILL} for n in ("drive", "rigid")},
        "solve": {"t_end": float(motions[0].t[-1])}, "output": {"step": float(np.median(np.diff(motions[0].t)))},
    })  # fmt: skip
    recordings = []
    for i, m in enumerate(motions):
        rest = inertia * m.acceleration[:, place] - m.rigid[:, place]
        inputs = {"loads.drive.signal": Channel("torque", m.t, m.torque[name])}
        inputs["loads.rigid.signal"] = Channel("rigid_bodies", m.t, rest)
        outputs = {f"{body}.y": Channel("position", m.t, m.position[name])}
        recordings.append(Recording(m.file, m.t, outputs, inputs, hold_out=i in hold_out))
    bounds = {"F_c": size, "sigma_2": size / speed}
    sought = tuple(Sought(f"contacts.friction.law.parameters.{n}", _ROOM * x, x) for n, x in bounds.items())
    return Joint(body, machine, Logs(tuple(recordings), sought))
