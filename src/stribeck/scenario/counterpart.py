"""A law on a single body (``schema = 1``) as a machine (``schema = 2``), and a machine's pressure cascade as the former."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy

from stribeck.constants import show, which_controller
from stribeck.control.cascade import PressureCascade
from stribeck.errors import InputError, arg
from stribeck.plants import Mass
from stribeck.plants.cylinder import Cylinder
from stribeck.scenario import Scenario

BODY, CONTACT, CONTROLLER = "body", "contact", "controller"
_Tables = dict[str, dict[str, object]]
# Where the numbers of a single body stand in its machine.
_PLACES = {
    "law.": f"contacts.{CONTACT}.law.",
    "drive.": f"controllers.{CONTROLLER}.",
    "plant.mass": f"bodies.{BODY}.mass",
}


def as_machine(scenario: Scenario) -> Scenario:
    """The same as a file of schema 2: one body, one contact, and what moves the body; a machine stays as it is.

    Raises:
        InputError: its plant is a class of the user's own, which a machine's tables cannot name.
    """
    if not scenario.rig.single:
        return scenario
    data = deepcopy(scenario.data)
    drive = {n: x for n, x in data["drive"].items() if x is not None}
    plant = {n: x for n, x in data.get("plant", {}).items() if x is not None}
    tables = _moved(drive, _body(scenario, plant), scenario.initial, {"rotary": True} if scenario.rotary else {})
    start = {"initial": {"z": z}} if (z := scenario.initial.get("z")) else {}
    contact = {"from": BODY, "law": data["law"], **start}
    given = {
        "schema": 2, "name": scenario.name, **tables, "contacts": {CONTACT: contact},
        "solve": {"t_end": scenario.solve.t_end}, "output": {"step": scenario.output.step},
    }  # fmt: skip
    return Scenario(given, folder=scenario.folder, trust=True)


def as_servo(scenario: Scenario, controller: str | None = None) -> Scenario:
    """A pressure cascade of a machine with its piston and its friction as a file of schema 1, as which it is read.

    Args:
        scenario: the machine; a file of schema 1 stays as it is.
        controller: which pressure cascade; the only one unless given.

    Raises:
        InputError: the machine has no such controller, or several and none was named.
    """
    if scenario.rig.single:
        return scenario
    machine = scenario.rig.machine
    known = [drive.name for drive in machine.drives]
    if not known:
        raise InputError(
            f"{arg('scenario')}: {scenario.name!r}: part 'cascade' needs a controller of kind 'pressure_cascade'"
        )
    name = which_controller(controller, known, "pressure cascade")
    drive = next(each for each in machine.drives if each.name == name)
    data = deepcopy(scenario.data)
    table = {n: x for n, x in data["controllers"][drive.name].items() if n != "on"}
    contact = next(x for x in machine.contacts if x.ends == (drive.on,))
    given = {
        "schema": 1, "name": scenario.name, "law": data["contacts"][contact.name]["law"],
        "plant": data["bodies"][drive.on], "drive": {**table, "kind": PressureCascade.kind},
        "solve": {"t_end": scenario.solve.t_end}, "output": {"step": scenario.output.step},
    }  # fmt: skip
    return Scenario(given, folder=scenario.folder, trust=True)


def machine_path(path: str) -> str:
    """A path in a file of schema 1 as it is in that machine; others stay as they are."""
    for old, new in _PLACES.items():
        if path.startswith(old):
            return new + path.removeprefix(old)
    return path


def _body(scenario: Scenario, plant: Mapping[str, object]) -> dict[str, object]:
    """The table of the body."""
    if scenario.plant is Mass:
        start = {n: x for n, x in scenario.initial.items() if n in ("y", "v")}
        inertia = "inertia" if scenario.rotary else "mass"
        return {inertia: scenario.mass, **({"initial": start} if start else {})}
    if scenario.plant is not Cylinder:
        raise InputError(f"plant.kind: {show(plant['kind'])}: must be {Mass.kind!r} or {Cylinder.kind!r} in a machine")
    start_of = plant.get("initial")
    if isinstance(start_of, Mapping):
        return {**plant, "initial": {n: x for n, x in start_of.items() if n != "z"}}
    return dict(plant)


def _moved(
    drive: dict[str, object], body: dict[str, object], initial: Mapping[str, float], turns: dict[str, object]
) -> dict[str, _Tables]:
    """The tables of the body and of what moves it; ``turns``: what says that a body turns whose velocity is given."""
    kind, signal = drive.pop("kind"), drive.pop("signal")
    bodies: _Tables = {BODY: body}
    if kind == "force":
        return {"bodies": bodies, "loads": {"force": {"on": BODY, "kind": "signal", "signal": signal}}}
    if kind == "spring":
        return {"bodies": bodies, "links": {"spring": {"from": {"signal": signal}, "to": BODY, **drive}}}
    if kind == "velocity":
        start = {"initial": {"y": y}} if (y := initial.get("y")) else {}
        return {"bodies": {BODY: {"velocity": {"signal": signal}, **start, **turns}}}
    if kind == "pid":
        own = {"kind": "pid", "on": BODY, "measures": BODY, "signal": signal, **drive}
        return {"bodies": bodies, "controllers": {CONTROLLER: own}}
    own = {"kind": "pressure_cascade", "on": BODY, "signal": signal, **drive}
    return {"bodies": bodies, "controllers": {CONTROLLER: own}}
