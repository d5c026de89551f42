"""The paths of a file that name a number, and the constant that each stands for."""

from __future__ import annotations

from stribeck.laws.base import PARAMETERS
from stribeck.scenario import Scenario

Place = tuple[str, str]  # owner and name of a constant; the owner "initial" has the states at t = 0

_IN_PIECES = ("ramp", "step")  # signals whose constants make pieces


def machine_places(scenario: Scenario) -> dict[str, Place]:
    """Every path that can be varied in lanes, and the constant it stands for."""
    rig = scenario.rig
    if rig.single:
        return _of_single(scenario)
    found: dict[str, Place] = {leaf.path: leaf.key for leaf, _ in scenario.elements.leaves}
    for body in scenario.elements.bodies.values():
        if body.tied_to is None:
            found[f"{body.path}.initial.y"] = ("initial", body.of("y"))
            if body.free:
                found[f"{body.path}.initial.v"] = ("initial", body.of("v"))
    for contact in scenario.elements.contacts.values():
        if contact.has_z:
            found[f"{contact.path}.initial.z"] = ("initial", contact.of("z"))
    for use, signal in rig.signals.items():
        if signal.kind in _IN_PIECES:
            found |= {f"{use.path}.{name}": (use.path, name) for name in signal.constants}
    return found


def _of_single(scenario: Scenario) -> dict[str, Place]:
    """The same of a law on a body under a drive, whose signal stands in [drive]."""
    s, table = scenario, scenario.data["law"].get("parameters")
    inside = {*PARAMETERS, *(table if isinstance(table, dict) else ())}
    names = [*s.law.values, *(name for name in s.law.machine if name not in s.law.values)]
    places: dict[str, Place] = {f"law.{'parameters.' if n in inside else ''}{n}": ("law", n) for n in names}
    places |= {f"plant.{name}": ("plant", name) for name in s.plant_values}
    allowed = [
        state.name for state in s.system.states if state.name in ("y", "v", "z", *(x.name for x in s.plant.states))
    ]
    places |= {f"plant.initial.{name}": ("initial", name) for name in allowed}
    places |= {f"drive.{name}": ("drive", name) for name in s.drive.constants}
    return places | {f"drive.signal.{name}": ("signal", name) for name in s.signal.constants}
