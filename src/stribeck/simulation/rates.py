"""A system's equations as Python functions of numbers, for eigenvalues."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, lru_cache

import numpy as np

from stribeck.arrays import Array
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import derivative, symbol
from stribeck.expressions.ops import Value
from stribeck.machine.system import MachineSystem
from stribeck.scenario import Scenario


class _Functions:
    """A system's rates, and their derivatives by time and by the states, as functions of one list of inputs."""

    def __init__(self, system: MachineSystem) -> None:
        self._states = [state.name for state in system.states]
        self._inputs = [f"{owner}.{name}" for owner, name in system.parameters]
        self._inputs += [f"segment.{name}" for name in (*system.piece_fields, *system.held)] + ["t", *self._states]
        self._rates = system.rates()
        self.rates = python_function(self._inputs, self._rates)

    @cached_property
    def slopes(self) -> Callable[..., tuple[Value, ...]]:
        """The derivatives by time and by each state, of one rate after the other."""
        by = [symbol(name) for name in ("t", *self._states)]
        return python_function(self._inputs, [derivative(rate, x) for rate in self._rates for x in by])


_functions = lru_cache(maxsize=64)(_Functions)


class RateFunctions:
    """The system's functions of (t, x), within one piece of the signals.

    Args:
        scenario: the scenario with the constants.

    Attributes:
        piece: the numbers of the signals' present pieces, set by the caller.
        held: the outputs of sampled controllers, set by the caller.
    """

    def __init__(self, scenario: Scenario) -> None:
        system, values = scenario.system, scenario.elements.values
        self._functions = _functions(system)
        self._values = [np.float64(values[key]) for key in system.parameters]
        self.piece: Array = np.zeros(len(system.piece_fields))
        self.held = np.zeros(len(system.held))

    def rates(self, t: float, x: Array) -> Array:
        """The time derivatives of the states."""
        return np.array(self._functions.rates(*self._arguments(t, x)), float)

    def slopes(self, t: float, x: Array) -> tuple[Array, Array]:
        """The derivatives of the rates by the time, and by the states."""
        rows = np.array(self._functions.slopes(*self._arguments(t, x)), float).reshape(len(x), len(x) + 1)
        return rows[:, 0], rows[:, 1:]

    def _arguments(self, t: float, x: Array) -> tuple[object, ...]:
        """Parameters, pieces, held outputs, the time, the states."""
        return (*self._values, *self.piece, *self.held, np.float64(t), *x)
