"""The declaration of a number in a file, by its path: from an element, a law or a signal."""

from __future__ import annotations

from dataclasses import replace

from stribeck.constants import Constant
from stribeck.scenario import Scenario
from stribeck.waveforms.piecewise import OfSignal


def declared(scenario: Scenario, path: str) -> Constant | None:
    """The declaration of the number at a path, with the unit that it has there; None where no table declares it."""
    machine, words = scenario.system, scenario.called.to_machine(path).split(".")
    cut = max((i for i, word in enumerate(words) if not word.isdigit()), default=0)
    group, name = ".".join(words[:cut]), ".".join(words[cut:])
    owner, key = group.removesuffix(".parameters"), name.replace(".", "_")
    if owner in machine.tables and key in machine.tables[owner][0]:
        return machine.constant(owner, key)
    for use, signal in scenario.elements.signals.items():
        if name in signal.constants and group == use.path:
            declaration = signal.constants[name]
            return replace(declaration, unit="") if isinstance(declaration, OfSignal) else declaration
    return None
