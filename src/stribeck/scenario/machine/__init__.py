"""Reading a machine file (``schema = 2``)."""

from __future__ import annotations

from stribeck.scenario.machine.reader import TOP, MachineReader

__all__ = ["TOP", "MachineReader"]
