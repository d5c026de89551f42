"""The page of a machine: charts by unit, friction of each contact, and the data of its numbers."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import groupby

from stribeck.constants import Column
from stribeck.errors import printable, unbroken
from stribeck.explorer.appendix import machine_relations
from stribeck.explorer.figures import Chart, Series
from stribeck.explorer.measured import Measured
from stribeck.machine.elements.contacts import Contact
from stribeck.machine.system import MachineSystem
from stribeck.scenario import Scenario

# Charts in order, from top to bottom: the label by the last word of a column's name, otherwise by its unit.
_LABELS = {
    "y": "position", "r": "position", "e": "error", "v": "velocity", "w": "sliding speed", "s": "sliding variable s",
    "F": "friction", "F_hat": "friction", "f": "force", "torque": "force", "z": "deflection", "z_hat": "deflection",
    "i": "current", "": "force", "p_err": "pressure error",
}  # fmt: skip
_BY_UNIT = {"Pa": "pressure", "V": "voltage", "A": "current", "J": "energy"}
_ENERGIES = {"in": "put in", "dissipated": "dissipated", "stored": "stored"}
_ROTARY = {"position": "angle", "force": "torque", "friction": "friction torque", "velocity": "angular velocity"}


def machine_panels(scenario: Scenario) -> dict[str, Chart]:
    """The charts by name: all columns over time by kind and unit, each contact's friction, and the energies."""
    machine = scenario.system
    order = list(dict.fromkeys([*_LABELS.values(), *_BY_UNIT.values()]))
    contacts = [_contact(machine, contact) for contact in machine.contacts]
    sliding = {speed.name for speed, _ in contacts}
    shown = sorted(
        (c for c in machine.columns if not c.name.startswith("E_")), key=lambda c: (order.index(_label(c)), c.unit)
    )
    charts: dict[str, Chart] = {}
    for i, ((label, unit), each) in enumerate(groupby(shown, key=lambda c: (_label(c), c.unit))):
        names = [c.name for c in each]
        words = _ROTARY.get(label, label) if unit.startswith(("rad", "N m")) else label
        marks = tuple(n for n in names if n in sliding)
        lines = tuple(Series(n, n) for n in names)
        words = names[0] if len(names) == 1 else words  # a single line has no legend
        charts[f"time-{i}"] = Chart("t", "t", "s", lines, words, unit, height=190, marks=marks)
    for i, ((speed, force), contact) in enumerate(zip(contacts, machine.contacts, strict=True)):
        friction = (Series(force.name, force.name),)
        label = f"friction in {contact.name}" if contact.name else "friction"
        charts[f"loop-{i}"] = Chart(speed.name, "sliding speed", speed.unit, friction, label, force.unit, height=280)
    if machine.energy:
        energies = tuple(Series(f"E_{n}", words) for n, words in _ENERGIES.items())
        charts["energy"] = Chart("t", "t", "s", energies, "energy", "J", height=280)
    return charts


def machine_sections(scenario: Scenario) -> list[tuple[str, str]]:
    """Name and heading of each chart that is not over time."""
    machine = scenario.system
    sections = [
        (f"loop-{i}", f"Friction{f' in {contact.name}' if contact.name else ''} against its sliding speed")
        for i, contact in enumerate(machine.contacts)
    ]
    return [*sections, ("energy", "Energy balance")] if machine.energy else sections


def _label(column: Column) -> str:
    last = column.name.rpartition(".")[2]
    return _LABELS.get(last) or _BY_UNIT.get(column.unit, "force")


def _contact(machine: MachineSystem, contact: Contact) -> tuple[Column, Column]:
    """The columns of a contact's sliding speed (of a single body, its velocity) and friction."""
    by_name, dot = {column.name: column for column in machine.columns}, f"{contact.name}." if contact.name else ""
    return by_name[f"{dot}w" if dot else "v"], by_name[f"{dot}F"]


def machine_law(scenario: Scenario) -> dict[str, object]:
    """The page's data in the place of a law: parameters, states, columns and conditions."""
    machine = scenario.system
    conditions = []
    for contact, each in machine_relations(machine):
        path = path_of_constant(scenario, contact.law_path, each.key)
        conditions.append({"key": path, "allowed": each.allowed, "path": path})
    return {
        "name": "machine", "about": f"{scenario.subject}.", "table": None, "numbers": [],
        **structure(machine, machine.columns), "relations": conditions, "conditions": {}, "equations": [],
    }  # fmt: skip


def structure(system: MachineSystem, columns: Iterable[Column]) -> dict[str, object]:
    """Names of parameters, states and columns, in the order of the module's."""
    return {
        "parameters": [".".join(each) for each in system.parameters],
        "states": [state.name for state in system.states],
        "columns": [{"name": c.name, "unit": printable(c.unit), "meaning": unbroken(c.meaning)} for c in columns],
    }


def path_of_constant(scenario: Scenario, law: str, key: str) -> str:
    """The file's path of a law's constant."""
    inside = ".parameters" if key in scenario.elements.laws[law].machine else ""
    return f"{scenario.called.to_file(law)}{inside}.{key}"


def machine_data(measured: Measured) -> dict[str, object]:
    """The solver's input at the file's numbers, and the numbers without a slider."""
    machine, arrays = measured.scenario.system, measured.arrays
    held = len(machine.held)
    return {
        "arrays": {name: array.tolist() for name, array in arrays.items() if name not in ("restart", "queue_room")},
        "restart": [int(x) for x in arrays["restart"]],
        "rooms": {
            "held": held, "shown": len(machine.shown), "queue_room": int(arrays["queue_room"][0]),
            "noise_room": arrays["noise"].size // held if held else 0,
        },
        "fixed": [{"path": path, "value": value} for path, value in measured.fixed.items()],
    }  # fmt: skip
