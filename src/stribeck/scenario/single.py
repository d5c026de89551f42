"""A law on a plant under a drive (``schema = 1``) as the smallest machine: one body, one contact, one drive."""

from __future__ import annotations

from stribeck.drives import Drive
from stribeck.laws.base import Law
from stribeck.laws.form import Form
from stribeck.machine.parts import BodyPart, ContactPart, DrivePart, SignalUse, Span
from stribeck.machine.system import MachineSystem
from stribeck.plants import Mass, Plant
from stribeck.scenario.parts import Parts, Settings
from stribeck.scenario.rig import Rig
from stribeck.signals import Signal


def one_body(
    law: type[Law], form: Form, drive: Drive, signal: type[Signal] | None, energy: bool = False,
    plant: type[Plant] = Mass,
) -> MachineSystem:  # fmt: skip
    """The structure: which law, plant, drive and kind of signal (None: straight pieces), without any values."""
    use = SignalUse("", "signal", signal)
    moved = drive.sets_velocity
    body = BodyPart("", False, not moved, driven=use if moved else None, plant=Mass if moved else plant)
    contact = ContactPart("", law, form, Span("", None))
    return MachineSystem((body,), (), (contact,), (), (), (), (use,), energy, (DrivePart("", drive, "", use),))


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
