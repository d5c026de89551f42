"""A system's equations as Python functions of numbers, for eigenvalues."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from stribeck.arrays import Array
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import derivative, symbol
from stribeck.expressions.ops import Value
from stribeck.machine.system import MachineSystem
from stribeck.scenario import Scenario


class RateFunctions:
    """The functions of (t, x) of a scenario's system, with its constants, within one piece of the signals.

    Args:
        scenario: the scenario; outputs of sampled controllers are 0.
        piece: the numbers of the signals' piece.
    """

    def __init__(self, scenario: Scenario, piece: Array) -> None:
        system, values = scenario.system, scenario.elements.values
        self._rates, self._slopes = _functions(system)
        constants = np.array([values[key] for key in system.parameters], float)
        self._given = (*constants, *piece, *np.zeros(len(system.held)))

    def rates(self, t: float, x: Array) -> Array:
        """The time derivatives of the states."""
        return np.array(self._rates(*self._given, np.float64(t), *x), float)

    def jacobian(self, t: float, x: Array) -> Array:
        """The derivatives of the rates by the states."""
        return np.array(self._slopes(*self._given, np.float64(t), *x), float).reshape(len(x), len(x))


@lru_cache(maxsize=64)
def _functions(system: MachineSystem) -> tuple[Callable[..., tuple[Value, ...]], Callable[..., tuple[Value, ...]]]:
    """The rates, and the derivatives by each state of one rate after the other, of the same inputs."""
    states, rates = [state.name for state in system.states], system.rates()
    inputs = [f"{owner}.{name}" for owner, name in system.parameters]
    inputs += [f"segment.{name}" for name in (*system.piece_fields, *system.held)] + ["t", *states]
    slopes = [derivative(rate, symbol(name)) for rate in rates for name in states]
    return python_function(inputs, rates), python_function(inputs, slopes)
