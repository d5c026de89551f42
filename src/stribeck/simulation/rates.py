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
    """The system's functions of (t, x), within one piece of the signals, for one run or for all lanes at once.

    Args:
        system: the system.
        values: the run-time constants in the order of ``system.parameters``, along the last axis.

    Attributes:
        piece: the numbers of the signals' present pieces along the last axis, set by the caller.
        held: the outputs of sampled controllers, set by the caller.
    """

    def __init__(self, system: MachineSystem, values: Array) -> None:
        self._functions = _functions(system)
        self._values = values
        self.piece: Array = np.zeros(len(system.piece_fields))
        self.held = np.zeros(len(system.held))

    @classmethod
    def of(cls, scenario: Scenario) -> RateFunctions:
        """The functions of a scenario's system, with its constants."""
        values = scenario.elements.values
        return cls(scenario.system, np.array([values[key] for key in scenario.system.parameters], float))

    def rates(self, t: float, x: Array) -> Array:
        """The time derivatives of the states, along the last axis as the states in ``x``."""
        rows = self._functions.rates(*self._arguments(t, x))
        return np.stack([np.broadcast_to(np.asarray(row, float), x.shape[:-1]) for row in rows], axis=-1)

    def slopes(self, t: float, x: Array) -> tuple[Array, Array]:
        """The derivatives of the rates by the time, and by the states, of one run."""
        rows = np.array(self._functions.slopes(*self._arguments(t, x)), float).reshape(len(x), len(x) + 1)
        return rows[:, 0], rows[:, 1:]

    def _arguments(self, t: float, x: Array) -> tuple[object, ...]:
        """Parameters, pieces, held outputs, the time, the states."""
        columns = (c for table in (self._values, self.piece, self.held) for c in np.moveaxis(table, -1, 0))
        return (*columns, np.float64(t), *np.moveaxis(x, -1, 0))
