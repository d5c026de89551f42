"""What a number of the file is, by its path: the declaration of it that an element, a law or a signal makes."""

from __future__ import annotations

from dataclasses import replace

from stribeck.constants import Constant
from stribeck.scenario import Scenario


def declared(scenario: Scenario, path: str) -> Constant | None:
    """The declaration of the number at a path, with the unit that it has there; None where no table declares it."""
    rig = scenario.rig
    machine, words = rig.machine, path.split(".")
    cut = max((i for i, word in enumerate(words) if not word.isdigit()), default=0)
    group, name = ".".join(words[:cut]), ".".join(words[cut:])
    owner, key = group.removesuffix(".parameters"), name.replace(".", "_")
    if owner in machine.tables and key in machine.tables[owner][0]:
        return machine.constant(owner, key)
    for use, signal in rig.signals.items():
        if name in signal.constants and group == (f"drive.{use.path}" if rig.single else use.path):
            own = signal.constants[name]
            unit = scenario.drive.signal.of_motion(scenario.rotary).unit if rig.single else ""
            return replace(
                own, unit=own.unit.replace("signal", unit) if unit else "" if "signal" in own.unit else own.unit
            )
    return None
