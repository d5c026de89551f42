"""What passivity proves of a loop: contacts by ``check``, the controller by its kind and gains."""

from __future__ import annotations

from stribeck.loops.loop import Loop
from stribeck.machine.controllers import Cascade, PidController
from stribeck.machine.links import LinkElement
from stribeck.machine.loads import Follower, Pendulum, Ripple
from stribeck.machine.parts import ControllerPart
from stribeck.scenario.rig import Rig

NO_HUNTING = (
    "with the signals at rest the stored energy with the controller's K_p (r - y)^2/2 falls at least by what its damping takes, "
    "and rests only where every body does: no motion repeats (the machine's contacts are passive by 'check')"
)


FILE = "certificate.json"  # beside the page: the certificates of the contacts, as 'stribeck check --certificate' writes them


def proof(loop: Loop) -> dict[str, object]:
    """:func:`proof_and_certificates` without the certificates."""
    return proof_and_certificates(loop)[0]


def proof_and_certificates(loop: Loop) -> tuple[dict[str, object], dict[str, object] | None]:
    """Whether passivity excludes that the loop hunts: ``holds`` true with the reasons, or null with what stands against it;
    ``contacts`` says which contacts are passive whatever the file lets their constants do; and
    where all are, ``check``'s certificates, which its independent checker has read.

    Simulation alone says everything else.
    """
    from stribeck.properties.ports import check_machine

    rig = loop.scenario.rig
    found = check_machine(loop.scenario)
    against = [text for each in rig.machine.controllers for text in active(rig, each)] + supplied(rig) + undamped(rig)
    if found.passive is not True:
        against.append(found.why)
    holds = True if not against else None
    theorems = {
        name: verdicts["passive"].certificate["theorem"]
        for name, verdicts in found.contacts.items() if verdicts["passive"].certificate
    }  # fmt: skip
    told: dict[str, object] = {
        "holds": holds,
        "why": NO_HUNTING if holds else "; ".join(against),
        "machine_passive": found.passive,
        "contacts": {name: verdicts["passive"].holds for name, verdicts in found.contacts.items()},
        "theorems": theorems,
    }
    certificates: dict[str, object] = {**found.certificates()}
    return told, (certificates if holds and theorems else None)


def supplied(rig: Rig) -> list[str]:
    """What else may supply energy while all signals rest: a load whose signal is held, gravity and cogging have a potential."""
    machine = rig.machine
    driven = {each.on for each in machine.controllers}
    against = [
        f"{body.name}'s velocity is given: it supplies energy" for body in machine.bodies if body.driven is not None
    ]
    against += [f"{motor.name} has a voltage and no controller" for motor in machine.motors if motor.name not in driven]
    against += [
        f"{load.name} is a load of one's own" for load in machine.loads if load.kind not in (Follower, Pendulum, Ripple)
    ]
    against += [f"{link.name} is a link of one's own" for link in machine.links if link.kind is not LinkElement]
    return against


def undamped(rig: Rig) -> list[str]:
    """Bodies that could swing for ever while the measured ones rest: those that no damped link without play ties to them."""
    machine = rig.machine
    still = {machine.leader(each.measures).name for each in machine.controllers}
    for _ in machine.bodies:
        for link in machine.links:
            ends = [link.span.start, link.span.end]
            if any(not isinstance(end, str) for end in ends) or "gap" in link.form:
                continue
            names = {machine.leader(str(end)).name for end in ends}
            damped = rig.values.get((link.path, "damping"), 0.0) > 0 and rig.values[link.path, "stiffness"] > 0
            if damped and names & still:
                still |= names
    free = [
        body.name for body in machine.bodies if body.leader is None and body.driven is None and body.name not in still
    ]
    return [f"{name} is not tied to a measured body by damped links without play" for name in free]


def active(rig: Rig, each: ControllerPart) -> list[str]:
    """Why a controller may supply energy while its signal rests; nothing where it is a spring and a damper."""
    name, against = each.name, []
    if each.sampling is not None:
        against.append(f"{name} is sampled: its output lags the motion")
    if each.kind is PidController and rig.values[each.path, "K_i"]:
        against.append(f"{name} has an integral (K_i)")
    elif each.kind is Cascade and "T_i" in each.form:
        against.append(f"{name} has an integral (T_i)")
    elif each.kind not in (PidController, Cascade):
        against.append(f"{name} is a controller of one's own")
    if "limit" in each.form:
        against.append(f"{name} has a limit, and its spring is not one beyond it")
    if each.compensation is not None and each.compensation.speed == "measured":
        against.append(f"{name} makes up for friction at the measured speed: it supplies what friction takes")
    if each.dither is not None:
        against.append(f"{name} has a dither: it supplies energy")
    motor = next((m for m in rig.machine.motors if m.name == each.on), None)
    acts_on = motor.on if motor is not None else each.on
    if motor is not None and (motor.has_inductance or "voltage" in motor.form):
        against.append(f"{motor.name} follows with its inductance and voltage")
    if acts_on != each.measures:
        against.append(f"{name} measures {each.measures} and acts on {acts_on}")
    gains = {"K_p": rig.values[each.path, "K_p"]} if each.kind in (PidController, Cascade) else {}
    damping = "K_d" if each.kind is PidController else "K_v"
    if each.kind in (PidController, Cascade):
        gains[damping] = rig.values[each.path, damping]
    against += [f"{name}: {gain} = {x:g} is not above 0" for gain, x in gains.items() if not x > 0]
    return against
