"""Oscillations that floating point cannot follow to the end of a run.

Rounding changes a frequency w by a share eps, so that the phase is off by eps w t. Beyond some 1e9 radians this is more than
the promised accuracy. The solver's method damps what it steps over. A motion that excites an undamped mode so fast would be
wrong by the whole oscillation, and no estimated error would tell.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.scenario import Scenario
from stribeck.simulation.promise import MOTION, promised
from stribeck.simulation.rates import RateFunctions
from stribeck.simulation.variations import Variations
from stribeck.waveforms.pieces import SMOOTH, Pieces

_EPS = float(np.finfo(float).eps)
_STEP = 1e-5  # of a tenth of a state's natural magnitude: a difference that finds how fast a system is, not how damped


def beyond_floats(scenario: Scenario, states: Array) -> list[str]:
    """A remark on the columns that miss the promise since they hold an oscillation too fast for floating point, if any.

    Args:
        scenario: the scenario.
        states: the rows of its states.
    """
    functions, pieces, atol = RateFunctions.of(scenario), scenario.pieces(), scenario.atol()
    functions.piece = pieces.rows[0]
    each = np.array([atol[state.name] for state in scenario.system.states], float)
    if not _too_fast(scenario, _at_most(functions, states[0], each, scenario.solve.rtol)):
        return []
    for wrong, eigenvalue in _wrong(scenario, functions, pieces, states):
        names = ", ".join(s.name for s, x in zip(scenario.system.states, wrong, strict=True) if x)
        cause = f"it oscillates at {abs(eigenvalue.imag) / (2 * np.pi):.3g} Hz, hardly damped"
        allowed = MOTION * scenario.solve.rtol
        return [f"accuracy not reached: {names} to {allowed:g} of the peak; {cause}: rounding decides its phase"]
    return []


def lanes_beyond_floats(lanes: Variations, states: Array) -> NDArray[np.bool_]:
    """Whether each lane misses the promise for this reason; ``states`` in shape (lanes, rows, states)."""
    scenario, values, tables = lanes.scenario, lanes.parameters(), lanes.pieces()
    functions = RateFunctions(scenario.system, values)
    functions.piece = tables.whole.rows[tables.first]
    beyond = _too_fast(scenario, _at_most(functions, states[:, 0], lanes.atol(), scenario.solve.rtol))
    for lane in np.flatnonzero(beyond):
        part = slice(int(tables.first[lane]), int(tables.end[lane]))
        pieces = Pieces(tables.whole.start[part], tables.whole.rows[part], tables.whole.restart[part])
        found = _wrong(scenario, RateFunctions(scenario.system, values[lane]), pieces, states[lane])
        beyond[lane] = next(found, None) is not None
    return beyond


def _too_fast(scenario: Scenario, magnitudes: Array) -> NDArray[np.bool_]:
    """Whether modes of these magnitudes may lose more of their phase than the promise allows."""
    return np.asarray(magnitudes * _EPS * scenario.end > MOTION * scenario.solve.rtol)


def _wrong(
    scenario: Scenario, functions: RateFunctions, pieces: Pieces, states: Array
) -> Iterator[tuple[NDArray[np.bool_], complex]]:
    """The states that an oscillation makes wrong, and its eigenvalue, for each that does."""
    allowed, peaks = MOTION * scenario.solve.rtol, np.max(abs(states), axis=0)
    with np.errstate(all="ignore"):
        for t, swings, eigenvalue in _excited(scenario, functions, pieces, states):
            left = min(scenario.end - t, 1 / abs(eigenvalue.real) if eigenvalue.real else np.inf)
            off = min(_EPS * abs(eigenvalue.imag) * left, 1.0)
            wrong = promised(scenario) & (off * swings > allowed * np.maximum(peaks, swings))
            if wrong.any():
                yield wrong, eigenvalue


def _at_most(functions: RateFunctions, x: Array, atol: Array, rtol: float) -> Array:
    """A bound on the magnitude of every mode at the start: the largest row sum of the scaled Jacobian, by differences.

    Args:
        functions: the system's functions.
        x: the states; any leading axes.
        atol: the absolute tolerance of each state, in the shape of ``x``.
        rtol: the relative tolerance; of it, and of a tenth of a state's natural magnitude, atol is the product.
    """
    with np.errstate(all="ignore"):
        sizes = np.maximum(atol / rtol, abs(x))
        steps, before, sums = _STEP * sizes, functions.rates(0.0, x), np.zeros(x.shape)
        for i in range(x.shape[-1]):
            moved = x.copy()
            moved[..., i] += steps[..., i]
            sums += abs(functions.rates(0.0, moved) - before) / _STEP / sizes
    return np.asarray(np.max(np.nan_to_num(sums, nan=np.inf, posinf=np.inf), axis=-1, initial=0.0))


def _excited(
    scenario: Scenario, functions: RateFunctions, pieces: Pieces, states: Array
) -> Iterator[tuple[float, Array, complex]]:
    """Each oscillation that begins at a start or a break of the signals: the time, its amplitude in each state, and its
    eigenvalue."""

    def of_piece(which: int, t: float, x: Array) -> tuple[Array, Array, Array]:
        functions.piece = pieces.rows[which]
        return (functions.rates(t, x), *functions.slopes(t, x))

    for i, t in enumerate(pieces.start):
        if t >= scenario.end or (i and pieces.restart[i] == SMOOTH):
            continue
        t = max(t, 0.0)  # a first piece may begin before the run
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
