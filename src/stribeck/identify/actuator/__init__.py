"""Estimates a machine's unknown parameters: the simulation is compared with all measured columns of its recordings."""

from __future__ import annotations

from stribeck.identify.actuator.api import fit_machine
from stribeck.identify.actuator.recordings import Logs, read_logs
from stribeck.identify.result import MachineFit

__all__ = ["Logs", "MachineFit", "fit_machine", "read_logs"]
