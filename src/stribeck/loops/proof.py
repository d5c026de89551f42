"""What passivity proves of a loop: contacts by ``check``, the controller by its kind and gains."""

from __future__ import annotations

from typing import Any

from stribeck.loops.loop import Loop
from stribeck.machine.controllers import Cascade, Pid
from stribeck.machine.parts import ControllerPart
from stribeck.scenario.machine import Rig

NO_HUNTING = (
    "with the signals at rest the stored energy with the controller's K_p (r - y)^2/2 never rises, so no limit cycle can "
    "draw energy from it (theory.md; the machine's contacts are passive by 'check')"
)


def proof(loop: Loop) -> dict[str, Any]:
    """Whether passivity excludes that the loop hunts: ``holds`` true with the reasons, or null with what stands against it;
    ``contacts`` says which contacts are passive whatever the file lets their constants do.

    Simulation alone says everything else.
    """
    from stribeck.properties.ports import check_machine

    rig = loop.scenario.rig
    assert rig is not None
    found = check_machine(loop.scenario)
    against = [text for each in rig.machine.controllers for text in active(rig, each)]
    if found.passive is not True:
        against.append(found.why)
    holds = True if not against else None
    return {
        "holds": holds,
        "why": NO_HUNTING if holds else "; ".join(against),
        "machine_passive": found.passive,
        "contacts": {name: verdicts["passive"].holds for name, verdicts in found.contacts.items()},
    }


def active(rig: Rig, each: ControllerPart) -> list[str]:
    """Why a controller may supply energy while its signal rests; nothing where it is a spring and a damper."""
    name, against = each.name, []
    if each.sampling is not None:
        against.append(f"{name} is sampled: its output lags the motion")
    if each.kind is Pid and rig.values[each.path, "K_i"]:
        against.append(f"{name} has an integral (K_i)")
    elif each.kind is Cascade and "T_i" in each.form:
        against.append(f"{name} has an integral (T_i)")
    elif each.kind not in (Pid, Cascade):
        against.append(f"{name} is a controller of one's own")
    if "limit" in each.form:
        against.append(f"{name} has a limit, and its spring is not one beyond it")
    if each.compensation is not None and each.compensation.speed == "measured":
        against.append(f"{name} makes up for friction at the measured speed: it supplies what friction takes")
    motor = next((m for m in rig.machine.motors if m.name == each.on), None)
    acts_on = motor.on if motor is not None else each.on
    if motor is not None and (motor.has_inductance or "voltage" in motor.form):
        against.append(f"{motor.name} follows with its inductance and voltage")
    if acts_on != each.measures:
        against.append(f"{name} measures {each.measures} and acts on {acts_on}")
    gains = {"K_p": rig.values[each.path, "K_p"]} if each.kind in (Pid, Cascade) else {}
    damping = "K_d" if each.kind is Pid else "K_v"
    if each.kind in (Pid, Cascade):
        gains[damping] = rig.values[each.path, damping]
    against += [f"{name}: {gain} = {x:g} is negative" for gain, x in gains.items() if x < 0]
    return against
