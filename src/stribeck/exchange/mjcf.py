"""The friction of a MuJoCo model's joints as machines of one body each, and back as attributes of joints."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from stribeck.constants import show
from stribeck.errors import InputError, needed
from stribeck.exchange.bam import STEEPNESS

_SINGLE = ("slide", "hinge")


def from_mujoco_file(path: str | Path) -> dict[str, Any]:
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
    bodies: dict[str, Any] = {}
    contacts: dict[str, Any] = {}
    for j in range(model.njnt):
        kind, d = int(model.jnt_type[j]), int(model.jnt_dofadr[j])
        hinge = kind == int(mujoco.mjtJoint.mjJNT_HINGE)
        if not hinge and kind != int(mujoco.mjtJoint.mjJNT_SLIDE):
            continue
        name = "".join(c if c.isalnum() else "_" for c in model.joint(j).name or f"joint{j}")
        bodies[name] = {"inertia" if hinge else "mass": float(model.dof_M0[d])}
        loss, damping = float(model.dof_frictionloss[d]), float(model.dof_damping.reshape(model.nv, -1)[d, 0])
        if loss > 0 or damping > 0:
            law = {
                "name": "coulomb_viscous",
                "k_v": STEEPNESS,
                "parameters": {"F_c": max(loss, 1e-9), "sigma_2": damping},
            }
            contacts[f"{name}_friction"] = {"from": name, "law": law}
    if not bodies:
        raise InputError(f"{path}: has no joint that is a {' or a '.join(_SINGLE)}")
    made = {"schema": 2, "name": Path(path).stem, "bodies": bodies}
    made |= {"contacts": contacts} if contacts else {}
    return {**made, "solve": {"t_end": 1.0}, "output": {"step": 0.005}}


def to_mujoco(machine: Mapping[str, Any]) -> str:
    """The elements ``joint`` with ``frictionloss`` and ``damping`` for a model's own joints.

    Raises:
        InputError: a contact has a law that ``frictionloss`` and ``damping`` cannot hold.
    """
    lines, problems = [], []
    for name, contact in machine.get("contacts", {}).items():
        law = contact["law"]
        if law["name"] != "coulomb_viscous" or contact.get("loads") or contact.get("factors"):
            text = (
                "frictionloss and damping hold coulomb_viscous without loads ('stribeck export --to mujoco' has laws)"
            )
            problems.append(f"contacts.{name}.law.name: {show(law['name'])}: {text}")
            continue
        p, turns = law["parameters"], "inertia" in machine["bodies"][contact["from"]]
        kind = "hinge" if turns else "slide"
        lines.append(
            f'<joint name="{contact["from"]}" type="{kind}" frictionloss="{p["F_c"]:.9g}" damping="{p["sigma_2"]:.9g}"/>'
        )
    if problems:
        raise InputError(problems)
    return "\n".join(lines) + "\n"
