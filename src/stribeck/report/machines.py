"""The panels of a machine: two for each body, contact, motor and controller, one for each link and load."""

from __future__ import annotations

from stribeck.machine.system import MachineSystem
from stribeck.report.panels import ENERGY, Panel


def panels(machine: MachineSystem) -> tuple[Panel, ...]:
    """What is worth seeing of a machine, in the order of reading."""
    found: list[Panel] = []
    followed = {each.measures: each.name for each in machine.controllers} | {x.on: x.name for x in machine.drives}
    for body in machine.bodies:
        if body.tied_to is None:  # what is tied moves in proportion
            tied = [other.name for other in machine.bodies if machine.leader(other.name) is body and other is not body]
            title = f"{body.name} (tied to it: {', '.join(tied)})" if tied else body.name
            beside = (f"{followed[body.name]}.r",) if body.name in followed else ()
            also = f", and what {followed[body.name]} is to follow" if beside else ""
            found.append(Panel(f"{body.name}.y", f"{title}: position", also=also, beside=beside))
            found.append(Panel(f"{body.name}.v", f"{body.name}: velocity"))
            found += [Panel(f"{body.name}.{s.name}", f"{body.name}: {s.meaning}") for s in body.plant.states]
    for contact in machine.contacts:
        force, slip = f"{contact.name}.F", f"{contact.name}.w"
        found.append(Panel(force, f"{contact.name}: friction, {contact.friction.kind.name}"))
        found.append(Panel(force, f"{contact.name}: friction against sliding speed", x=slip, near_rest=True))
    forces = [*(link.name for link in machine.links), *(load.name for load in machine.loads)]
    found += [Panel(f"{name}.f", f"{name}: force") for name in forces]
    for motor in machine.motors:
        found += [
            Panel(f"{motor.name}.i", f"{motor.name}: current"),
            Panel(f"{motor.name}.V", f"{motor.name}: voltage"),
        ]
    found += [Panel(f"{each.name}.u", f"{each.name}: output") for each in machine.controllers]
    found += [Panel(f"{drive.name}.u", f"{drive.name}: {drive.drive.gives.meaning}") for drive in machine.drives]
    return (*found, *((ENERGY,) if machine.energy else ()))
