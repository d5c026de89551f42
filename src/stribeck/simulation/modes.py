"""Oscillations that floating point cannot follow to the end of a run.

Rounding changes a frequency w by a share eps, so that the phase is off by eps w t. Beyond some 1e9 radians this is more than
the promised accuracy. The solver's method damps what it steps over. A motion that excites an undamped mode so fast would be
wrong by the whole oscillation, and no estimated error would tell.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stribeck.arrays import Array
from stribeck.scenario import Scenario
from stribeck.simulation.promise import MOTION, promised
from stribeck.simulation.rates import RateFunctions
from stribeck.waveforms.pieces import SMOOTH

_EPS = float(np.finfo(float).eps)
_STEP = 1e-6  # of a state's natural magnitude: a difference that finds how fast a system is, not how damped


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


def _fast(scenario: Scenario, x: Array) -> float:
    """The magnitude of the fastest mode at the start, by differences."""
    functions = RateFunctions(scenario)
    functions.piece = scenario.pieces().rows[0]
    sizes = [float(scenario.elements.natural[state.name]) for state in scenario.system.states]
    steps, before = _STEP * np.maximum(sizes, abs(x)), functions.rates(0.0, x)
    matrix = np.array([(functions.rates(0.0, x + row) - before) / row.sum() for row in np.diag(steps)]).T
    return float(np.max(abs(np.linalg.eigvals(matrix)), initial=0.0)) if np.all(np.isfinite(matrix)) else np.inf


def _excited(scenario: Scenario, states: Array) -> Iterator[tuple[float, Array, complex]]:
    """Each oscillation that begins at a start or a break of the signals: the time, its amplitude in each state, and its
    eigenvalue."""
    pieces, functions = scenario.pieces(), RateFunctions(scenario)

    def of_piece(which: int, t: float, x: Array) -> tuple[Array, Array, Array]:
        functions.piece = pieces.rows[which]
        return (functions.rates(t, x), *functions.slopes(t, x))

    for i, t in enumerate(pieces.start):
        if t >= scenario.end or (i and pieces.restart[i] == SMOOTH):
            continue
        x = states[min(int(t / scenario.output.step), len(states) - 1)]
        f, f_t, matrix = of_piece(i, t, x)
        if i:
            f_before, f_t_before, _ = of_piece(i - 1, t, x)
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
