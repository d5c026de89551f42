"""A law on a single body (``schema = 1``) as a machine (``schema = 2``), and a machine's pressure cascade as the former."""

from __future__ import annotations

from copy import deepcopy

from stribeck.constants import which_controller
from stribeck.control.cascade import PressureCascade
from stribeck.errors import InputError, arg
from stribeck.scenario import Scenario
from stribeck.scenario.schema1 import ElementNames, translated

_MOVERS = {"force": "force", "spring": "spring"}  # by the kind of drive; others are controllers


def as_machine(scenario: Scenario) -> Scenario:
    """The same as a file of schema 2: ``body``, its friction ``contact``, and what moves the body; a machine stays as it is."""
    if not scenario.rig.single:
        return scenario
    sections, _, _ = translated(deepcopy(scenario.data), scenario.rotary, _names(scenario))
    given = {
        "schema": 2, "name": scenario.name, **sections,
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


def machine_path(scenario: Scenario, path: str) -> str:
    """A path in a file of schema 1 as it is in that machine; others stay as they are."""
    if not scenario.rig.single:
        return path
    return translated(scenario.data, scenario.rotary, _names(scenario))[1].to_machine(path)


def _names(scenario: Scenario) -> ElementNames:
    return ElementNames("body", "contact", _MOVERS.get(scenario.called.drive, "controller"))
