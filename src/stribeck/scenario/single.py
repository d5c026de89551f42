"""A law on a plant under a drive (``schema = 1``) as the smallest machine: one body, one contact, one drive."""

from __future__ import annotations

from functools import lru_cache

from stribeck.drives import Drive
from stribeck.expressions.graph import symbol
from stribeck.laws.base import Law
from stribeck.laws.form import Form
from stribeck.machine.driving import DrivePart
from stribeck.machine.element import GROUND
from stribeck.machine.elements.bodies import Body, Velocity
from stribeck.machine.elements.contacts import Contact
from stribeck.machine.elements.plants import Numbers, SingleBody
from stribeck.machine.law import Friction
from stribeck.machine.machine import Elements
from stribeck.machine.signal import SignalUse
from stribeck.machine.system import MachineSystem
from stribeck.machine.table import Frozen
from stribeck.plants import Mass, Plant
from stribeck.scenario.parts import Parts, Settings
from stribeck.scenario.rig import Rig
from stribeck.signals import Signal


@lru_cache(maxsize=64)
def same(machine: MachineSystem) -> MachineSystem:
    """The first of equal structures: what it finds out about itself, it finds once."""
    return machine


def one_body(
    law: type[Law], form: Form, drive: Drive, signal: type[Signal] | None, energy: bool = False,
    plant: type[Plant] = Mass,
) -> MachineSystem:  # fmt: skip
    """The structure: which law, plant, drive and kind of signal (None: straight pieces), without any values."""
    use = SignalUse("", "signal", signal)
    body = Body.model_construct(name="", velocity=Velocity.model_construct(signal=use))
    if not drive.sets_velocity:
        numbers = {name: symbol(f"plant.{name}") for name in plant.constants}
        body = SingleBody.model_construct(name="", acts=plant, numbers=Numbers.of(plant.constants, numbers))
    friction = Friction(law, form, law.symbolic(lambda name: symbol(f"law.{name}"), form))
    contact = Contact.model_construct(name="", start="", end=GROUND, law=friction, loads=(), factors=Frozen())
    elements = Elements(bodies=Frozen({"": body}), contacts=Frozen({"": contact}), energy=energy)
    return same(MachineSystem(elements, (use,), (DrivePart("", drive, "", use),)))


def structure(parts: Parts) -> MachineSystem:
    """The structure of a law on a single body, as far as its parts are known."""
    assert parts.law is not None
    assert parts.drive is not None
    drive = (parts.settings or Settings()).drive(parts.drive, parts.drive_values or {})
    smooth = type(parts.signal) if parts.signal is not None and parts.signal.smooth else None
    energy = parts.output is not None and parts.output.energy
    return one_body(type(parts.law), parts.law.form, drive, smooth, energy, parts.plant or Mass)


def rig_of(parts: Parts) -> Rig:
    """The machine with its values."""
    machine, law, signal = structure(parts), parts.law, parts.signal
    assert law is not None
    assert signal is not None
    settings = parts.settings or Settings()
    values = {("law", n): x for n, x in law.p.numbers.items()}
    values |= {("drive", n): x for n, x in (parts.drive_values or {}).items()}
    values |= {("signal", n): x for n, x in signal.values.items()} if signal.smooth else {}
    values |= {("plant", n): x for n, x in (parts.plant_values or {}).items()}
    values |= settings.values()
    return Rig(machine, values, {machine.drive.signal: signal}, {"law": law}, parts.initial or {}, {}, {"": settings})
