"""Reading a machine file (``schema = 2``)."""

from __future__ import annotations

from stribeck.scenario.machine.reader import TOP, MachineReader
from stribeck.scenario.machine.rig import Rig

__all__ = ["TOP", "MachineReader", "Rig"]
