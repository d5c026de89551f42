"""Simulation of scenarios: one, or many at once with other numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stribeck.codegen import source
from stribeck.scenario import Scenario
from stribeck.simulation.single import simulate
from stribeck.simulation.solution import Solution

if TYPE_CHECKING:
    from stribeck.simulation.ensemble import Ensemble, simulate_ensemble

__all__ = ["Ensemble", "Solution", "c_source", "simulate", "simulate_ensemble"]


def c_source(scenario: Scenario) -> str:
    """The generated C of a scenario's system: equations, Jacobian and solver; constants are run-time arguments."""
    return source(scenario.system)


def __getattr__(name: str) -> object:
    """Ensembles are read at first use: one run needs none of them."""
    if name not in ("Ensemble", "simulate_ensemble"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from stribeck.simulation import ensemble

    return getattr(ensemble, name)
