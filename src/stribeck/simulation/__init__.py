"""Simulation of scenarios: one, or many at once with other numbers."""

from __future__ import annotations

from stribeck.codegen import source
from stribeck.scenario import Scenario
from stribeck.simulation.ensemble import Ensemble, simulate_ensemble
from stribeck.simulation.single import simulate
from stribeck.simulation.solution import Solution

__all__ = ["Ensemble", "Solution", "c_source", "simulate", "simulate_ensemble"]


def c_source(scenario: Scenario) -> str:
    """The generated C of a scenario's system: equations, Jacobian and solver; constants are run-time arguments."""
    return source(scenario.system)
