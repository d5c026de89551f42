"""The friction of a MuJoCo model's joints as machines of one body each, and back as attributes of joints."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stribeck.constants import show
from stribeck.errors import InputError, needed, note
from stribeck.exchange.bam import STEEPNESS

Tables = dict[str, Any]
Read = Mapping[str, Any]

_SINGLE = ("slide", "hinge")
_STILL = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}


def from_mujoco_file(path: str | Path) -> Tables:
    """The tables of a machine: for each slide or hinge a body with the inertia that it moves at the model's first
    position (armature with it), and a contact with ``frictionloss`` and ``damping``; joints do not act on each other.

    Raises:
        InputError: MuJoCo cannot read the model, or it has no such joint.
        MissingExtra: MuJoCo is not installed.
    """
    with needed("import mujoco"):
        import mujoco
    try:
        model = mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise InputError(f"{path}: MuJoCo cannot read it: {str(error).splitlines()[0]}") from None
    made: Tables = {
        "schema": 2,
        "name": Path(path).stem,
        "bodies": {},
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
        names[j] = name = _plain(model.joint(j).name or f"joint{j}")
        made["bodies"][name] = {"inertia" if hinge else "mass": float(model.dof_M0[d])}
        loss, damping = float(model.dof_frictionloss[d]), float(model.dof_damping.reshape(model.nv, -1)[d, 0])
        if loss > 0 or damping > 0:
            numbers = {"F_c": max(loss, 1e-9), "sigma_2": damping}
            law = {"name": "coulomb_viscous", "k_v": STEEPNESS, "parameters": numbers}
            made["contacts"][f"{name}_friction"] = {"from": name, "law": law}
    if not names:
        raise InputError(f"{path}: has no joint that is a {' or a '.join(_SINGLE)}")
    for a in range(model.nu):
        if int(model.actuator_gaintype[a]) == int(mujoco.mjtGain.mjGAIN_DCMOTOR):
            _dcmotor(made, model, a, names.get(int(model.actuator_trnid[a, 0]), ""))
    return {**{n: x for n, x in made.items() if x != {}}, "solve": {"t_end": 1.0}, "output": {"step": 0.005}}


def _plain(name: str) -> str:
    return "".join(c if c.isalnum() else "_" for c in name)


def _dcmotor(made: Tables, model: Any, a: int, joint: str) -> None:
    """Motor, cogging and LuGre friction of a dcmotor on a joint, whose gear is the ratio; MuJoCo keeps R and K in gainprm,
    the cogging, F_c, F_s and v_s in biasprm, L/R, sigma_0 and sigma_1 in dynprm."""
    name, gear = _plain(model.actuator(a).name or f"motor{a}"), float(model.actuator_gear[a, 0])
    if not joint:
        note(f"actuator {name}: its transmission is no slide or hinge: left out")
        return
    gain, bias, dyn = (getattr(model, f"actuator_{part}prm")[a] for part in ("gain", "bias", "dyn"))
    R, K = float(gain[0]), float(gain[1])
    lost = [f"dynprm[{i}] = {dyn[i]:g}" for i in (1, 2, 3, 4, 7, 8, 9) if dyn[i]]
    lost += [f"gainprm[{i}] = {gain[i]:g}" for i in range(2, 10) if gain[i]]
    lost += [f"{word}range" for word in ("force", "ctrl") if getattr(model, f"actuator_{word}limited").ravel()[a]]
    if lost:
        note(f"actuator {name}: {', '.join(lost)} (limits, heat or a controller of its own): left out")
    if K:
        motor = {"on": joint, "K": gear * K, "R": R, "signal": dict(_STILL)}
        made["motors"][name] = motor | ({"L": float(dyn[0]) * R} if dyn[0] else {})
    if bias[0]:
        ripple = {"amplitude": [gear * float(bias[0])], "waves": [gear * float(bias[1])], "phase": [float(bias[2])]}
        made["loads"][f"{name}_cogging"] = {"on": joint, "kind": "ripple", **ripple}
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
        made["contacts"][f"{name}_lugre"] = {"from": joint, "law": law} | ({"ratio": gear} if gear != 1 else {})


def to_mujoco(machine: Read) -> str:
    """The elements ``joint`` with ``frictionloss`` and ``damping``, and ``dcmotor`` with ``lugre``, for a model's own joints.

    Raises:
        InputError: a contact has a law that these cannot hold.
    """
    lines, problems, motors = [], [], dict(machine.get("motors", {}))
    for name, contact in machine.get("contacts", {}).items():
        law, body = contact["law"], contact["from"]
        plain = not contact.get("loads") and not contact.get("factors") and contact.get("to", "ground") == "ground"
        if plain and law["name"] == "lugre":
            driving = next((n for n, m in motors.items() if m["on"] == body), None)
            own = motors.pop(driving) if driving is not None else None
            lines.append(_element(machine, driving or name, contact, own))
        elif plain and law["name"] == "coulomb_viscous" and contact.get("ratio", 1.0) == 1.0:
            p, kind = law["parameters"], "hinge" if "inertia" in machine["bodies"][body] else "slide"
            words = f'frictionloss="{p["F_c"]:.9g}" damping="{p["sigma_2"]:.9g}"'
            lines.append(f'<joint name="{body}" type="{kind}" {words}/>')
        else:
            text = "a joint holds coulomb_viscous and a dcmotor lugre, without loads ('stribeck export --to mujoco' has laws)"
            problems.append(f"contacts.{name}.law.name: {show(law['name'])}: {text}")
    if problems:
        raise InputError(problems)
    lines += [_element(machine, n, {"from": m["on"]}, m) for n, m in motors.items()]
    return "\n".join(lines) + "\n"


def _element(machine: Read, name: str, contact: Read, motor: Read | None) -> str:
    """A dcmotor, in the coordinate of the motor's side."""
    body, gear = contact["from"], contact.get("ratio", 1.0)
    ripple = next((x for x in machine.get("loads", {}).values() if x["on"] == body and x["kind"] == "ripple"), None)
    words = [f'<dcmotor name="{name}" joint="{body}"'] + ([f'gear="{gear:.9g}"'] if gear != 1 else [])
    if motor is None:
        words.append('input="none" motorconst="0" resistance="1"')
    else:
        words.append(f'motorconst="{motor["K"] / gear:.9g}" resistance="{motor["R"]:.9g}"')
        words += [f'inductance="{motor["L"]:.9g}"'] if motor.get("L") else []
    if ripple is not None and len(ripple["waves"]) == 1:
        phase = ripple.get("phase") or [0.0]
        words.append(f'cogging="{ripple["amplitude"][0] / gear:.9g} {ripple["waves"][0] / gear:.9g} {phase[0]:.9g}"')
    if "law" in contact:
        p = contact["law"]["parameters"]
        five = " ".join(f"{p[n]:.9g}" for n in ("sigma_0", "sigma_1", "F_c", "F_s", "v_s"))
        words.append(f'lugre="{five}"' + (f' damping="{p["sigma_2"]:.9g}"' if p["sigma_2"] else ""))
    return " ".join(words) + "/>"
