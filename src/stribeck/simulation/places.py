"""The paths of a file that name a number, and the constant that each stands for."""

from __future__ import annotations

from typing import Any

from stribeck.laws.base import PARAMETERS
from stribeck.scenario import Scenario
from stribeck.scenario.rig import Rig

Place = tuple[str, str]  # owner and name of a constant; the owner "initial" has the states at t = 0

_IN_PIECES = ("ramp", "step")  # signals whose constants make pieces


def machine_places(scenario: Scenario) -> dict[str, Place]:
    """Every path that can be varied in lanes, and the constant it stands for."""
    rig = scenario.rig
    if rig.single:
        return _of_single(scenario)
    found: dict[str, Place] = {}
    for path, name in rig.values:
        found[_written(scenario, rig, path, name)] = (path, name)
    for body in rig.machine.bodies:
        if body.leader is None:
            found[f"{body.path}.initial.y"] = ("initial", f"{body.name}.y")
            if body.driven is None:
                found[f"{body.path}.initial.v"] = ("initial", f"{body.name}.v")
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


def _written(scenario: Scenario, rig: Rig, path: str, name: str) -> str:
    """How the file names a constant: parameters of a law stand in a table of their own, numbers of a list have a number."""
    if path in rig.laws:
        table: Any = scenario.data
        for word in path.split("."):
            table = table[word]
        inside = table.get("parameters")
        listed = name in PARAMETERS or (isinstance(inside, dict) and name in inside)
        return f"{path}.parameters.{name}" if listed else f"{path}.{name}"
    if name.startswith("weight_"):
        return f"{path}.force.{name.removeprefix('weight_')}"
    stem, _, number = name.rpartition("_")
    if number.isdigit() and stem in ("amplitude", "waves", "phase"):
        return f"{path}.{stem}.{number}"
    return f"{path}.{name}"
