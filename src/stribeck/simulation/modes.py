"""Oscillations that floating point cannot follow to the end of a run.

Rounding changes a frequency w by a share eps, so that the phase is off by eps w t. Beyond some 1e9 radians this is more than
the promised accuracy. The solver's method damps what it steps over. A motion that excites an undamped mode so fast would be
wrong by the whole oscillation, and no estimated error would tell.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property, lru_cache

import numpy as np

from stribeck.arrays import Array
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import derivative, symbol
from stribeck.expressions.ops import Value
from stribeck.machine.system import MachineSystem
from stribeck.scenario import Scenario
from stribeck.simulation.promise import MOTION, promised
from stribeck.waveforms.pieces import SMOOTH

_EPS = float(np.finfo(float).eps)
_STEP = 1e-6  # of a state's natural magnitude: a difference that finds how fast a system is, not how damped


class _Functions:
    """A system's rates, and their derivatives by the states and by time, as Python functions of one list of inputs."""

    def __init__(self, system: MachineSystem) -> None:
        self._names = [state.name for state in system.states]
        self._inputs = [f"{owner}.{name}" for owner, name in system.parameters]
        self._inputs += [f"segment.{name}" for name in (*system.piece_fields, *system.held)] + ["t", *self._names]
        self._rates = system.rates()
        self.rates = python_function(self._inputs, self._rates)

    @cached_property
    def derivatives(self) -> Callable[..., tuple[Value, ...]]:
        """The derivatives: by time and by each state, of one rate after the other."""
        by = [symbol(name) for name in ("t", *self._names)]
        return python_function(self._inputs, [derivative(rate, x) for rate in self._rates for x in by])


_functions = lru_cache(maxsize=64)(_Functions)


def beyond_floats(scenario: Scenario, states: Array) -> list[str]:
    """A remark on the columns that miss the promise since they hold an oscillation too fast for floating point, if any.

    Args:
        scenario: the scenario.
        states: the rows of its states.
    """
    allowed = MOTION * scenario.solve.rtol
    with np.errstate(all="ignore"):
        if not _fast(scenario, states[0]) * _EPS * scenario.end > allowed:
            return []
        peaks = np.max(abs(states), axis=0)
        for t, swings, eigenvalue in _excited(scenario, states):
            left = min(scenario.end - t, 1 / abs(eigenvalue.real) if eigenvalue.real else np.inf)
            off = min(_EPS * abs(eigenvalue.imag) * left, 1.0)
            wrong = promised(scenario) & (off * swings > allowed * np.maximum(peaks, swings))
            if wrong.any():
                names = ", ".join(s.name for s, x in zip(scenario.system.states, wrong, strict=True) if x)
                cause = f"it oscillates at {abs(eigenvalue.imag) / (2 * np.pi):.3g} Hz, hardly damped"
                return [
                    f"accuracy not reached: {names} to {allowed:g} of the peak; {cause}: rounding decides its phase"
                ]
    return []


def _arguments(scenario: Scenario, piece: Array, t: float, x: Array) -> list[np.float64]:
    values, system = scenario.elements.values, scenario.system
    constants = (np.float64(values[key]) for key in system.parameters)
    return [*constants, *piece, *np.zeros(len(system.held)), np.float64(t), *x]


def _fast(scenario: Scenario, x: Array) -> float:
    """The magnitude of the fastest mode at the start, by differences."""
    functions, piece = _functions(scenario.system), scenario.pieces().rows[0]
    sizes = [float(scenario.elements.natural[state.name]) for state in scenario.system.states]

    def rates(at: Array) -> Array:
        return np.array(functions.rates(*_arguments(scenario, piece, 0.0, at)), float)

    steps, before = _STEP * np.maximum(sizes, abs(x)), rates(x)
    matrix = np.array([(rates(x + row) - before) / row.sum() for row in np.diag(steps)]).T
    return float(np.max(abs(np.linalg.eigvals(matrix)), initial=0.0)) if np.all(np.isfinite(matrix)) else np.inf


def _excited(scenario: Scenario, states: Array) -> Iterator[tuple[float, Array, complex]]:
    """Each oscillation that begins at a start or a break of the signals: the time, its amplitude in each state, and its
    eigenvalue."""
    pieces, count = scenario.pieces(), states.shape[1]
    functions = _functions(scenario.system)
    for i, t in enumerate(pieces.start):
        if t >= scenario.end or (i and pieces.restart[i] == SMOOTH):
            continue
        x = states[min(int(t / scenario.output.step), len(states) - 1)]

        def of_piece(which: int, t: float = float(t), x: Array = x) -> tuple[Array, Array, Array]:
            at = _arguments(scenario, pieces.rows[which], t, x)
            slopes = np.array(functions.derivatives(*at), float).reshape(count, count + 1)
            return np.array(functions.rates(*at), float), slopes[:, 0], slopes[:, 1:]

        f, f_t, matrix = of_piece(i)
        if i:
            f_before, f_t_before, _ = of_piece(i - 1)
            f, f_t = f - f_before, f_t - f_t_before
        if not np.all(np.isfinite(matrix)):
            continue
        eigenvalues, right = np.linalg.eig(matrix)
        same, left = np.linalg.eig(matrix.T)
        for k in np.flatnonzero(eigenvalues.imag > 0):
            row = left[:, np.argmin(abs(same - eigenvalues[k]))]
            # the motion begins apart from the one that follows the signals slowly: by J^-1 f + J^-2 df/dt
            size = row @ (f / eigenvalues[k] + f_t / eigenvalues[k] ** 2) / (row @ right[:, k])
            yield float(t), 2 * abs(size * right[:, k]), complex(eigenvalues[k])
