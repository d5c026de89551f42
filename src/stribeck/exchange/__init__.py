"""Machines from other programs' files, and back."""

from __future__ import annotations

from copy import deepcopy

from stribeck.errors import InputError
from stribeck.exchange.bam import from_bam, to_bam
from stribeck.exchange.mjcf import Tables, from_mujoco_file, to_mujoco
from stribeck.scenario import Scenario

__all__ = ["from_bam", "from_mujoco_file", "tables", "to_bam", "to_mujoco"]


def tables(scenario: Scenario) -> Tables:
    """The tables of a machine with its laws' parameters written out, as :func:`to_bam` and :func:`to_mujoco` take them.

    Raises:
        InputError: the scenario is no machine.
    """
    if "bodies" not in scenario.data:
        raise InputError(f"schema: {scenario.data['schema']}: must be 2, a machine")
    found = deepcopy(scenario.data)
    for contact in scenario.rig.machine.contacts:
        found["contacts"][contact.name]["law"]["parameters"] = dict(scenario.rig.laws[contact.law_path].machine)
    return found
