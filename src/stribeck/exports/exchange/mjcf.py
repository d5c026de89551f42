"""The friction of a MuJoCo model's joints as machines of one body each."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from stribeck.constants import Constant, show
from stribeck.errors import InputError, needed, note
from stribeck.exports.exchange.bam import STEEPNESS
from stribeck.files import open_file

Tables = dict[str, Any]
Model = Any  # MuJoCo has no types

_SINGLE = ("slide", "hinge")
_STILL = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}


def from_mujoco_file(path: str | Path) -> Tables:
    """The tables of a machine from a MuJoCo model.

    Each slide or hinge becomes a body, a contact with ``frictionloss`` and ``damping``, and a link to the ground with
    ``stiffness``. The body's inertia is what the joint moves at the model's initial position, with armature. Joints do not
    act on each other. A note reports everything else in the model, which is left out.

    Raises:
        InputError: if MuJoCo cannot read the model, or it has no such joint.
        MissingExtra: if MuJoCo is not installed.
    """
    with needed("import mujoco"):
        import mujoco
    model = _read(mujoco, path)
    machine: Tables = {
        "schema": 2,
        "name": Path(path).stem,
        "bodies": {},
        "links": {},
        "contacts": {},
        "loads": {},
        "motors": {},
    }
    names: dict[int, str] = {}
    for j in range(model.njnt):
        kind, d = int(model.jnt_type[j]), int(model.jnt_dofadr[j])
        hinge = kind == int(mujoco.mjtJoint.mjJNT_HINGE)
        if not hinge and kind != int(mujoco.mjtJoint.mjJNT_SLIDE):
            continue
        names[j] = name = _unused_name(machine, model.joint(j).name or f"joint{j}")
        machine["bodies"][name] = {"inertia" if hinge else "mass": float(model.dof_M0[d])}
        loss, damping = float(model.dof_frictionloss[d]), float(model.dof_damping.reshape(model.nv, -1)[d, 0])
        if loss > 0 or damping > 0:
            numbers = {"F_c": max(loss, 1e-9), "sigma_2": damping}
            law = {"name": "coulomb_viscous", "k_v": STEEPNESS, "parameters": numbers}
            machine["contacts"][_unused_name(machine, f"{name}_friction")] = {"from": name, "law": law}
        _add_spring(machine, model, j, name)
    if not names:
        raise InputError(f"{path}: has no joint that is a {' or a '.join(_SINGLE)}")
    for a in range(model.nu):
        if int(model.actuator_gaintype[a]) == int(mujoco.mjtGain.mjGAIN_DCMOTOR):
            _add_dcmotor(machine, model, a, names.get(int(model.actuator_trnid[a, 0]), ""))
    if omitted := _omitted(mujoco, model, names):
        note(f"{path}: {', '.join(omitted)}: left out")
    return {**{n: x for n, x in machine.items() if x != {}}, "solve": {"t_end": 1.0}, "output": {"step": 0.005}}


def _add_spring(machine: Tables, model: Model, j: int, name: str) -> None:
    """Add a joint's spring to the world. A body's coordinate is 0 at the model's initial position; the spring's rest
    position may differ, which adds a constant load."""
    stiffness, coordinate = _stiffness(model, j), int(model.jnt_qposadr[j])
    if stiffness <= 0:
        return
    machine["links"][_unused_name(machine, f"{name}_spring")] = {"from": name, "to": "ground", "stiffness": stiffness}
    if rest := float(model.qpos_spring[coordinate] - model.qpos0[coordinate]):
        push = {"kind": "points", "t": [0.0, 1.0], "value": [stiffness * rest] * 2}
        machine["loads"][_unused_name(machine, f"{name}_spring_rest")] = {"on": name, "kind": "signal", "signal": push}


def _stiffness(model: Model, j: int) -> float:
    return float(np.ravel(model.jnt_stiffness[j])[0])


def _omitted(mujoco: ModuleType, model: Model, names: Mapping[int, str]) -> list[str]:
    """Parts of the model that act on the bodies and are not in the machine, in words."""
    omitted = (
        ["gravity"]
        if np.any(model.opt.gravity) and not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
        else []
    )
    for j in range(model.njnt):
        d, name = int(model.jnt_dofadr[j]), model.joint(j).name or f"joint{j}"
        if j not in names:
            omitted.append(f"joint {show(name)} (neither slide nor hinge)")
            continue
        for word, table, row in (("damping", "dof_dampingpoly", d), ("stiffness", "jnt_stiffnesspoly", j)):
            if hasattr(model, table) and np.any(getattr(model, table)[row]):  # since MuJoCo 4
                omitted.append(f"joint {show(name)}: {word} beyond its linear part")
        omitted += [f"joint {show(name)}: its range"] if model.jnt_limited[j] else []
        stiffness = _stiffness(model, j)
        omitted += [f"joint {show(name)}: stiffness {stiffness:g} < 0"] if stiffness < 0 else []
    others = [a for a in range(model.nu) if int(model.actuator_gaintype[a]) != int(mujoco.mjtGain.mjGAIN_DCMOTOR)]
    omitted += [f"actuator {show(model.actuator(a).name or f'actuator{a}')}" for a in others]
    counts = {"tendons": model.ntendon, "equality constraints": model.neq}
    return omitted + [f"{n} {what}" for what, n in counts.items() if n]


def _read(mujoco: ModuleType, path: str | Path) -> Model:
    """The model, with joints whose numbers are valid in a machine; MuJoCo's warnings become errors or notes."""
    warnings: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(warnings.append)
    try:
        open_file(Path(path)).close()  # raises an error for a pipe, for which MuJoCo would wait
        model = mujoco.MjModel.from_xml_path(str(path))
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    except ValueError as error:
        raise InputError(f"{path}: MuJoCo cannot read it: {str(error).splitlines()[0]}") from None
    finally:
        mujoco.set_mju_user_warning(before)
    problems = []
    for j in range(model.njnt):
        d, name = int(model.jnt_dofadr[j]), model.joint(j).name or f"joint{j}"
        numbers = {
            "frictionloss": (model.dof_frictionloss[d], 0.0), "damping": (model.dof_damping[d], 0.0),
            "armature": (model.dof_armature[d], None), "stiffness": (model.jnt_stiffness[j], None),
        }  # fmt: skip
        for word, (given, least) in numbers.items():
            number = float(np.ravel(given)[0])  # only the first coefficient of damping is linear
            if text := Constant("", "", at_least=least).problem(number):
                problems.append(f"{path}: joint {show(name)}: {word}: {number:g}: {text}")
    if not problems:
        problems = [f"{path}: MuJoCo: {text}" for text in warnings if "nan" in text.lower()]
    if problems:
        raise InputError(problems)
    for text in warnings:
        note(f"{path}: MuJoCo: {text}")
    return model


def _unused_name(machine: Tables, name: str) -> str:
    """A valid name, of letters, digits and underscores, that is not yet used in the machine."""
    wanted = re.sub(r"\W", "_", name, flags=re.ASCII)
    taken = {"ground"}.union(*(table for table in machine.values() if isinstance(table, dict)))
    names = (wanted, *(f"{wanted}_{i}" for i in range(2, len(taken) + 3)))
    return next(each for each in names if each not in taken)


def _add_dcmotor(machine: Tables, model: Model, a: int, joint: str) -> None:
    """Add motor, cogging and LuGre friction of a dcmotor on a joint, with its gear as the ratio.

    MuJoCo stores R and K in gainprm, the cogging, F_c, F_s and v_s in biasprm, and L/R, sigma_0 and sigma_1 in dynprm.
    """
    name, gear = _unused_name(machine, model.actuator(a).name or f"motor{a}"), float(model.actuator_gear[a, 0])
    if not joint:
        note(f"actuator {name}: its transmission is no slide or hinge: left out")
        return
    gain, bias, dyn = (getattr(model, f"actuator_{part}prm")[a] for part in ("gain", "bias", "dyn"))
    R, K = float(gain[0]), float(gain[1])
    omitted = [f"dynprm[{i}] = {dyn[i]:g}" for i in (1, 2, 3, 4, 7, 8, 9) if dyn[i]]
    omitted += [f"gainprm[{i}] = {gain[i]:g}" for i in range(2, 10) if gain[i]]
    omitted += [f"{word}range" for word in ("force", "ctrl") if getattr(model, f"actuator_{word}limited").ravel()[a]]
    if omitted:
        note(f"actuator {name}: {', '.join(omitted)} (limits, heat or a controller of its own): left out")
    if K:
        motor = {"on": joint, "K": gear * K, "R": R, "signal": dict(_STILL)}
        machine["motors"][name] = motor | ({"L": float(dyn[0]) * R} if dyn[0] else {})
    if bias[0]:
        ripple = {"amplitude": [gear * float(bias[0])], "waves": [gear * float(bias[1])], "phase": [float(bias[2])]}
        machine["loads"][_unused_name(machine, f"{name}_cogging")] = {"on": joint, "kind": "ripple", **ripple}
    viscous = float(model.actuator_damping[a].ravel()[0])
    if dyn[5]:
        numbers = {
            "sigma_0": dyn[5],
            "sigma_1": dyn[6],
            "sigma_2": viscous,
            "F_c": bias[3],
            "F_s": bias[4],
            "v_s": bias[5],
        }
        law = {"name": "lugre", "parameters": {n: float(x) for n, x in numbers.items()}}
        machine["contacts"][_unused_name(machine, f"{name}_lugre")] = {"from": joint, "law": law} | (
            {"ratio": gear} if gear != 1 else {}
        )
