"""A system's equations as Python functions of numbers, for eigenvalues."""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import derivative, symbol
from stribeck.scenario import Scenario


class RateFunctions:
    """The system's functions of (t, x), within one piece of the signals.

    Args:
        scenario: the scenario with the constants.

    Attributes:
        states: names of the states.
        piece: the numbers of the signals' present pieces, set by the caller.
        held: the outputs of sampled controllers, set by the caller.
    """

    def __init__(self, scenario: Scenario) -> None:
        system, values = scenario.system, scenario.elements.values
        self.states = [state.name for state in system.states]
        inputs = [f"{owner}.{name}" for owner, name in system.parameters]
        inputs += [f"segment.{name}" for name in (*system.piece_fields, *system.held)] + ["t", *self.states]
        rates = system.rates()
        jacobian = [derivative(rate, symbol(name)) for rate in rates for name in self.states]
        self._rates, self._jacobian = python_function(inputs, rates), python_function(inputs, jacobian)
        self._values = [np.float64(values[key]) for key in system.parameters]
        self.piece: Array = np.zeros(len(system.piece_fields))
        self.held = np.zeros(len(system.held))

    def arguments(self, t: float, x: Array) -> tuple[object, ...]:
        """The arguments of the functions: parameters, pieces, held outputs, the time, the states."""
        return (*self._values, *self.piece, *self.held, t, *x)

    def rates(self, t: float, x: Array) -> Array:
        """The time derivatives of the states."""
        return np.array(self._rates(*self.arguments(t, x)), float)

    def jacobian(self, t: float, x: Array) -> Array:
        """The derivatives of the rates by the states."""
        return np.array(self._jacobian(*self.arguments(t, x)), float).reshape(len(x), len(x))
