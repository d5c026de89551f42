"""The friction of a MuJoCo model's joints as machines of one body each, and back as a model of such joints."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np

from stribeck.constants import Constant, show
from stribeck.errors import InputError, needed, note
from stribeck.exports.exchange.bam import STEEPNESS
from stribeck.files import open_file

Tables = dict[str, Any]
Read = Mapping[str, Any]
Model = Any  # MuJoCo has no types

_SINGLE = ("slide", "hinge")
_STILL = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}


def from_mujoco_file(path: str | Path) -> Tables:
    """The tables of a machine: for each slide or hinge a body with the inertia that it moves at the model's first
    position (armature with it), a contact with ``frictionloss`` and ``damping``, and a link to the ground with ``stiffness``;
    joints do not act on each other. What else acts in the model is left out, and told.

    Raises:
        InputError: MuJoCo cannot read the model, or it has no such joint.
        MissingExtra: MuJoCo is not installed.
    """
    with needed("import mujoco"):
        import mujoco
    model = _read(mujoco, path)
    made: Tables = {
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
        names[j] = name = _free(made, model.joint(j).name or f"joint{j}")
        made["bodies"][name] = {"inertia" if hinge else "mass": float(model.dof_M0[d])}
        loss, damping = float(model.dof_frictionloss[d]), float(model.dof_damping.reshape(model.nv, -1)[d, 0])
        if loss > 0 or damping > 0:
            numbers = {"F_c": max(loss, 1e-9), "sigma_2": damping}
            law = {"name": "coulomb_viscous", "k_v": STEEPNESS, "parameters": numbers}
            made["contacts"][_free(made, f"{name}_friction")] = {"from": name, "law": law}
        _spring(made, model, j, name)
    if not names:
        raise InputError(f"{path}: has no joint that is a {' or a '.join(_SINGLE)}")
    for a in range(model.nu):
        if int(model.actuator_gaintype[a]) == int(mujoco.mjtGain.mjGAIN_DCMOTOR):
            _dcmotor(made, model, a, names.get(int(model.actuator_trnid[a, 0]), ""))
    if left := _left_out(mujoco, model, names):
        note(f"{path}: {', '.join(left)}: left out")
    return {**{n: x for n, x in made.items() if x != {}}, "solve": {"t_end": 1.0}, "output": {"step": 0.005}}


def _spring(made: Tables, model: Model, j: int, name: str) -> None:
    """A joint's spring to the world; a body's coordinate is 0 where the model begins, the spring's rest may be elsewhere."""
    stiffness, at = _stiffness(model, j), int(model.jnt_qposadr[j])
    if stiffness <= 0:
        return
    made["links"][_free(made, f"{name}_spring")] = {"from": name, "to": "ground", "stiffness": stiffness}
    if rest := float(model.qpos_spring[at] - model.qpos0[at]):
        push = {"kind": "points", "t": [0.0, 1.0], "value": [stiffness * rest] * 2}
        made["loads"][_free(made, f"{name}_spring_rest")] = {"on": name, "kind": "signal", "signal": push}


def _stiffness(model: Model, j: int) -> float:
    return float(np.ravel(model.jnt_stiffness[j])[0])


def _left_out(mujoco: ModuleType, model: Model, names: Mapping[int, str]) -> list[str]:
    """What acts on the bodies in MuJoCo and not in a machine of the joints' own friction and springs."""
    left = (
        ["gravity"]
        if np.any(model.opt.gravity) and not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY
        else []
    )
    for j in range(model.njnt):
        d, name = int(model.jnt_dofadr[j]), model.joint(j).name or f"joint{j}"
        if j not in names:
            left.append(f"joint {show(name)} (neither slide nor hinge)")
            continue
        for word, table, row in (("damping", "dof_dampingpoly", d), ("stiffness", "jnt_stiffnesspoly", j)):
            if hasattr(model, table) and np.any(getattr(model, table)[row]):  # MuJoCo 4 has them
                left.append(f"joint {show(name)}: {word} beyond its linear part")
        left += [f"joint {show(name)}: its range"] if model.jnt_limited[j] else []
        stiffness = _stiffness(model, j)
        left += [f"joint {show(name)}: stiffness {stiffness:g} < 0"] if stiffness < 0 else []
    others = [a for a in range(model.nu) if int(model.actuator_gaintype[a]) != int(mujoco.mjtGain.mjGAIN_DCMOTOR)]
    left += [f"actuator {show(model.actuator(a).name or f'actuator{a}')}" for a in others]
    counts = {"tendons": model.ntendon, "equality constraints": model.neq}
    return left + [f"{n} {what}" for what, n in counts.items() if n]


def _read(mujoco: ModuleType, path: str | Path) -> Model:
    """The model, whose joints' numbers can be a machine's; what MuJoCo warns of is refused or told, not left in a file."""
    told: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(told.append)
    try:
        open_file(Path(path)).close()  # a pipe would be waited for
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
            number = float(np.ravel(given)[0])  # of the damping the first alone is linear
            if text := Constant("", "", at_least=least).problem(number):
                problems.append(f"{path}: joint {show(name)}: {word}: {number:g}: {text}")
    if not problems:
        problems = [f"{path}: MuJoCo: {text}" for text in told if "nan" in text.lower()]
    if problems:
        raise InputError(problems)
    for text in told:
        note(f"{path}: MuJoCo: {text}")
    return model


def _free(made: Tables, name: str) -> str:
    """A name as a machine has it, of letters, digits and underscores, that nothing else has there."""
    wanted = re.sub(r"\W", "_", name, flags=re.ASCII)
    taken = {"ground"}.union(*(table for table in made.values() if isinstance(table, dict)))
    names = (wanted, *(f"{wanted}_{i}" for i in range(2, len(taken) + 3)))
    return next(each for each in names if each not in taken)


def _dcmotor(made: Tables, model: Model, a: int, joint: str) -> None:
    """Motor, cogging and LuGre friction of a dcmotor on a joint, whose gear is the ratio; MuJoCo keeps R and K in gainprm,
    the cogging, F_c, F_s and v_s in biasprm, L/R, sigma_0 and sigma_1 in dynprm."""
    name, gear = _free(made, model.actuator(a).name or f"motor{a}"), float(model.actuator_gear[a, 0])
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
        made["loads"][_free(made, f"{name}_cogging")] = {"on": joint, "kind": "ripple", **ripple}
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
        made["contacts"][_free(made, f"{name}_lugre")] = {"from": joint, "law": law} | (
            {"ratio": gear} if gear != 1 else {}
        )


def to_mujoco(machine: Read) -> str:
    """A model that MuJoCo loads: each body with its inertia on a joint of its own with ``frictionloss`` and ``damping``,
    bodies tied to it as ``armature``, and ``dcmotor`` with ``lugre``. What such a model cannot hold is left out, and told.

    Raises:
        InputError: a contact has a law that these cannot hold.
    """
    motors, used = dict(machine.get("motors", {})), set[str]()
    problems = [
f"bodies.{n}: neither inertia nor mass: a joint of MuJoCo moves a body with one of them"
        for n, b in machine["bodies"].items() if not {"inertia", "mass", "tied_to"} & set(b)
    ]  # fmt: skip
    text = "a joint of MuJoCo has one mass for all times"
    problems += [f"bodies.{n}.added: {text}" for n, b in machine["bodies"].items() if "added" in b]
    joints: dict[str, dict[str, float]] = {n: {} for n, b in machine["bodies"].items() if "tied_to" not in b}
    actuators = []
    for name, contact in machine.get("contacts", {}).items():
        law = contact["law"]
        leader, ratio = _led(machine, contact["from"])
        gear = ratio * contact.get("ratio", 1.0)
        plain = not contact.get("loads") and not contact.get("factors") and contact.get("to", "ground") == "ground"
        if plain and law["name"] == "lugre":
            driving = next((n for n, m in motors.items() if _led(machine, m["on"])[0] == leader), None)
            own = motors.pop(driving) if driving is not None else None
            actuators.append(_element(machine, driving or name, leader, gear, law, own, used))
        elif plain and law["name"] == "coulomb_viscous":
            p, words = law["parameters"], joints[leader]
            words["frictionloss"] = words.get("frictionloss", 0.0) + p["F_c"] * abs(gear)
            words["damping"] = words.get("damping", 0.0) + p["sigma_2"] * gear**2
        else:
            text = "a joint holds coulomb_viscous and a dcmotor lugre, without loads ('stribeck export --target mujoco' has laws)"
            problems.append(f"contacts.{name}.law.name: {show(law['name'])}: {text}")
    if problems:
        raise InputError(problems)
    springs = _grounded(machine, joints)
    actuators += [_element(machine, n, *_led(machine, m["on"]), None, m, used) for n, m in motors.items()]
    lost = [f"loads.{n}" for n in machine.get("loads", {}) if n not in used]
    lost += [
        f"{kind}.{n}" for kind in ("links", "controllers", "sensors") for n in machine.get(kind, {}) if n not in springs
    ]
    if lost:
        note(f"{', '.join(lost)}: left out: MuJoCo's model has its bodies, friction and motors")
    return _model(str(machine.get("name", "machine")), machine["bodies"], joints, actuators)


def _grounded(machine: Read, joints: Mapping[str, dict[str, float]]) -> list[str]:
    """The links that are springs from a body to the ground, which go into its joint."""
    found = []
    for name, link in machine.get("links", {}).items():
        if link.get("to") == "ground" and isinstance(link["from"], str) and link.get("kind", "link") == "link":
            if link.get("gap"):
                continue
            leader, ratio = _led(machine, link["from"])
            words, side = joints[leader], (ratio * link.get("ratio", 1.0)) ** 2
            for word, x in (("stiffness", link["stiffness"]), ("damping", link.get("damping") or 0.0)):
                if x:
                    words[word] = words.get(word, 0.0) + x * side
            found.append(name)
    return found


def _led(machine: Read, body: str) -> tuple[str, float]:
    """The body that one is tied to, and how far it moves when that moves by one."""
    ratio, own = 1.0, machine["bodies"][body]
    while "tied_to" in own:
        ratio, body = ratio * own.get("ratio", 1.0), own["tied_to"]
        own = machine["bodies"][body]
    return body, ratio


def _model(name: str, bodies: Read, joints: Mapping[str, dict[str, float]], actuators: list[str]) -> str:
    """The model's text."""
    lines = [
        f"<mujoco model={quoteattr(name)}>",
        '  <compiler angle="radian"/>',
        '  <option gravity="0 0 0"/>',
        "  <worldbody>",
    ]
    for body, words in joints.items():
        tied = [(bodies[n], _led({"bodies": bodies}, n)) for n in bodies if n != body]
        armature = sum(b.get("inertia", b.get("mass", 0.0)) * ratio**2 for b, (led, ratio) in tied if led == body)
        told = ({"armature": armature} if armature else {}) | words
        text = "".join(f' {n}="{x:.9g}"' for n, x in told.items())
        own = bodies[body]
        moment, mass = own.get("inertia", own.get("mass")), own.get("mass", 1.0)  # of a hinge, its mass moves nothing
        lines += [
            f'    <body name="{body}">',
            f'      <inertial pos="0 0 0" mass="{mass:.9g}" diaginertia="{moment:.9g} {moment:.9g} {moment:.9g}"/>',
            f'      <joint name="{body}" type="{"hinge" if "inertia" in own else "slide"}" axis="0 0 1"{text}/>',
            "    </body>",
        ]
    lines.append("  </worldbody>")
    if actuators:
        lines += ["  <actuator>", *(f"    {each}" for each in actuators), "  </actuator>"]
    return "\n".join([*lines, "</mujoco>"]) + "\n"


def _element(
    machine: Read, name: str, joint: str, gear: float, law: Read | None, motor: Read | None, used: set[str]
) -> str:
    """A dcmotor, in the coordinate of the motor's side; the ripple that it takes is ``used``."""
    words = [f'<dcmotor name="{name}" joint="{joint}"'] + ([f'gear="{gear:.9g}"'] if gear != 1 else [])
    if motor is None:
        words.append('input="none" motorconst="0" resistance="1"')
    else:
        K = motor["K"] * _led(machine, motor["on"])[1] / gear
        words.append(f'motorconst="{K:.9g}" resistance="{motor["R"]:.9g}"')
        words += [f'inductance="{motor["L"]:.9g}"'] if motor.get("L") else []
    for n, x in machine.get("loads", {}).items():
        if n not in used and x["kind"] == "ripple" and len(x["waves"]) == 1 and _led(machine, x["on"])[0] == joint:
            side, phase = _led(machine, x["on"])[1] / gear, x.get("phase") or [0.0]
            words.append(f'cogging="{x["amplitude"][0] * side:.9g} {x["waves"][0] * side:.9g} {phase[0]:.9g}"')
            used.add(n)
            break
    if law is not None:
        p = law["parameters"]
        five = " ".join(f"{p[n]:.9g}" for n in ("sigma_0", "sigma_1", "F_c", "F_s", "v_s"))
        words.append(f'lugre="{five}"' + (f' damping="{p["sigma_2"]:.9g}"' if p["sigma_2"] else ""))
    return " ".join(words) + "/>"
