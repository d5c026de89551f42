"""A law on a single body (``schema = 1``) as a machine (``schema = 2``)."""

from __future__ import annotations

from copy import deepcopy

from stribeck.scenario import Scenario
from stribeck.scenario.schema1 import ElementNames, translated

_MOVERS = {"force": "force", "spring": "spring"}  # by the kind of drive; others are controllers


def as_machine(scenario: Scenario) -> Scenario:
    """The same as a file of schema 2: ``body``, its friction ``contact``, and what moves the body; a machine stays as it is."""
    if not scenario.elements.unnamed:
        return scenario
    sections, _, _ = translated(deepcopy(scenario.data), scenario.rotary, _names(scenario))
    given = {
        "schema": 2, "name": scenario.name, **sections,
        "solve": {"t_end": scenario.solve.t_end}, "output": {"step": scenario.output.step},
    }  # fmt: skip
    return Scenario(given, folder=scenario.folder, trust=True)


def machine_path(scenario: Scenario, path: str) -> str:
    """A path in a file of schema 1 as it is in that machine; others stay as they are."""
    if not scenario.elements.unnamed:
        return path
    return translated(scenario.data, scenario.rotary, _names(scenario))[1].to_machine(path)


def _names(scenario: Scenario) -> ElementNames:
    return ElementNames("body", "contact", _MOVERS.get(scenario.called.drive, "controller"))
