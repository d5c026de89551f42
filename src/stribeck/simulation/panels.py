"""The panels of a figure: what each shows, and which ones a machine wants."""

from __future__ import annotations

from dataclasses import dataclass

from stribeck.machine.system import MachineSystem


@dataclass(frozen=True)
class Panel:
    """One panel: a quantity against another, under a title of words.

    Attributes:
        y: the quantity drawn, for every solution.
        title: what it is, in words; ``axis``: what it and ``beside`` are, for the label; ``also``: and what ``beside`` is.
        x: what it is drawn against.
        beside: quantities of the same unit drawn with it: a setpoint, a driving force.
        alone: draw ``beside`` only where there is one solution, as it differs from one to the other.
        near_rest: stretch the horizontal axis around 0, where it reaches far.
        log: a logarithmic vertical axis.
        settled: the vertical axis shows the second half of the time; a transient may leave it.
    """

    y: str
    title: str
    x: str = "t"
    also: str = ""
    axis: str = ""
    beside: tuple[str, ...] = ()
    alone: bool = False
    near_rest: bool = False
    log: bool = False
    settled: bool = False


ENERGY = Panel(
    "E_in", "energy put in", also=", dissipated, stored", axis="energy", beside=("E_dissipated", "E_stored"), alone=True
)


def choose_panels(machine: MachineSystem) -> tuple[Panel, ...]:
    """The panels of a machine in the order of reading.

    There are two for each body, contact, motor and controller, and one for each link and load.
    """
    panels: list[Panel] = []
    controllers = {each.name for each in machine.controllers}
    valves = [each for each in machine.elements.controllers.values() if each.moves_valve]
    followed = {each.measures: each.name for each in machine.controllers} | {x.on: x.name for x in valves}
    for body in machine.bodies:
        if body.tied_to is None:  # what is tied moves in proportion
            tied = [
                other.name
                for other in machine.bodies
                if machine.elements.leader(other.name) is body and other is not body
            ]
            title = f"{body.name} (tied to it: {', '.join(tied)})" if tied else body.name
            controller = followed.get(body.name)
            beside = (f"{controller}.r",) if controller else ()
            also = f" and reference of {controller}" if controller else ""
            panels.append(Panel(f"{body.name}.y", f"{title}: position", also=also, axis="position", beside=beside))
            if controller in controllers:
                panels.append(Panel(f"{controller}.e", f"{controller}: tracking error"))
            panels.append(Panel(f"{body.name}.v", f"{body.name}: velocity"))
            panels += [Panel(f"{body.name}.{s.name}", f"{body.name}: {s.meaning}") for s in body.states]
    for contact in machine.contacts:
        force, slip = f"{contact.name}.F", f"{contact.name}.w"
        panels.append(Panel(force, f"{contact.name}: friction, {contact.friction.kind.name}"))
        panels.append(Panel(force, f"{contact.name}: friction against sliding speed", x=slip, near_rest=True))
    panels += [Panel(f"{link.name}.f", f"{link.name}: force") for link in machine.links]
    for load in machine.loads:
        if load.by_position_alone:  # against time its waves would be a block
            panels.append(
                Panel(f"{load.name}.curve", f"{load.name}: force against position", x=f"{load.name}.position")
            )
        else:
            panels.append(Panel(f"{load.name}.f", f"{load.name}: force"))
    for motor in machine.motors:
        panels += [
            Panel(f"{motor.name}.i", f"{motor.name}: current"),
            Panel(f"{motor.name}.V", f"{motor.name}: voltage"),
        ]
    panels += [Panel(f"{each.name}.u", f"{each.name}: output") for each in machine.controllers]
    panels += [Panel(f"{each.name}.u", f"{each.name}: valve voltage") for each in valves]
    return (*panels, *((ENERGY,) if machine.energy else ()))
