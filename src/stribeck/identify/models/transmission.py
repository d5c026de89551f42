"""What a record tells of what lies between force and sliding: a filter of the force, an elastic coupling, presliding."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.signal import bilinear, lfilter, lfilter_zi

from stribeck.arrays import Array
from stribeck.identify.data.filters import HIGHEST
from stribeck.identify.log import parted
from stribeck.identify.models.curves import SteadyCurve
from stribeck.identify.models.over_position import direction_along
from stribeck.identify.models.record import Record, body_columns, kept_rows

_TRIED = 25  # frequencies, or times: frequencies a seventh apart, the width of a lightly damped resonance
_BAND = 30.0  # largest over smallest frequency: slower swings are those of a spring
_TIMES = 0.25, 25.0  # samples: a shorter time is a delay, a longer one leaves no friction to fit
_SHORTEST = 1e-3  # of the longest way: microns of a stroke of decimeters
_DAMPINGS = (0.03, 0.1, 0.3)  # of steel shafts, of belts, of rubber
Filter = tuple[Array, Array]  # numerator and denominator in z


def filtered(time: float, step: float) -> Filter:
    """A filter of first order."""
    return bilinear([1.0], [time, 1.0], 1 / step)


def lag(time: float, step: float) -> Filter:
    """A filter of first order whose input is constant within a step, as a sign is."""
    keep = float(np.exp(-step / time))
    return np.array([1 - keep]), np.array([1.0, -keep])


def coupling(hertz: float, damping: float, step: float) -> Filter:
    """The acceleration of a mass behind that of the drive which carries it along.

    Args:
        hertz: the resonance of the mass on the coupling; ``damping``: its ratio.
    """
    w = 2 / step * np.tan(np.pi * min(hertz * step, HIGHEST))  # prewarped for the bilinear transform
    return bilinear([2 * damping * w, w * w], [1.0, 2 * damping * w, w * w], 1 / step)


def behind(x: Array, runs: Iterable[slice], of_filter: Filter) -> Array:
    """What a filter adds to a series (rows first); each run begins in the steady state of its first row."""
    out, still = np.empty(x.shape), lfilter_zi(*of_filter)
    for run in runs:
        out[run] = lfilter(*of_filter, x[run], axis=0, zi=np.multiply.outer(still, x[run][0]))[0]
    return out - x


class Transmission:
    """A record's rows behind the thinning filter, as a series in which a filter can run.

    Args:
        shape: of the law, at which its columns are taken.
    """

    def __init__(self, record: Record, curve: SteadyCurve, shape: Mapping[str, float]) -> None:
        log = record.log
        of_law, of_body = curve.columns(log.velocity, shape), body_columns(log, list(record.body))
        columns = [*(of_law[n] for n in curve.names), *(of_body[n] for n in record.body)]
        self.record, self.step = record, record.q * log.step
        self.columns = np.column_stack([*map(record.reduce, columns)])
        self.acceleration = record.reduce(log.acceleration)
        self.runs = parted(np.diff(log.run[kept_rows(log, record.q)]) != 0)

    def behind_filter(self, time: float) -> Array:
        """The columns at the compared rows behind a filter of the force; 0 for none."""
        columns = self.columns
        if time:
            columns = columns + behind(columns, self.runs, filtered(time, self.step))
        return np.asarray(columns[self.record.counted])

    def force_filter(self) -> float:
        """The time constant, s, of the filter of the force that explains most of the record; 0 if none does."""

        def left(log_time: float) -> float:
            a = self.behind_filter(float(np.exp(log_time)))
            a = a / np.maximum(np.max(abs(a), axis=0), 1e-300)
            b = a.T @ self.record.force
            return -float(b @ np.linalg.lstsq(a.T @ a, b, rcond=1e-12)[0])

        x, at_end = _least(left, *(n * self.step for n in _TIMES))
        return 0.0 if at_end else float(np.exp(x))

    def swing(self, basis: Array, residual: Array) -> tuple[float, float]:
        """The frequency, Hz, and the damping ratio of the coupling that explains most of a residual.

        Args:
            basis: of the columns that left the residual.
        """

        def left(log_hertz: float, damping: float) -> float:
            of_filter = coupling(float(np.exp(log_hertz)), damping, self.step)
            column = behind(self.acceleration, self.runs, of_filter)[self.record.counted]
            return -_explained(column, basis, residual)

        high = min(HIGHEST / self.step, self.record.log.bandwidth or np.inf)
        x, _ = _least(partial(left, damping=_DAMPINGS[1]), high / _BAND, high)
        return float(np.exp(x)), min(_DAMPINGS, key=partial(left, x))

    def play(self, basis: Array, residual: Array, high: float) -> float:
        """The way, m, up to ``high``, that explains most of a residual if friction reverses over it."""
        log = self.record.log

        def left(log_way: float) -> float:
            column = self.record.column(direction_along(log, float(np.exp(log_way))) - np.sign(log.velocity))
            return -_explained(column, basis, residual)

        x, _ = _least(left, _SHORTEST * high, high)
        return float(np.exp(x))


def _explained(column: Array, basis: Array, residual: Array) -> float:
    """The part of a residual's squares that a column explains beside a basis."""
    column = column - basis @ (basis.T @ column)
    return float(column @ residual) ** 2 / max(float(column @ column), 1e-300)


def _least(cost: Callable[[float], float], low: float, high: float) -> tuple[float, bool]:
    """The logarithm of the value between two at which a cost is least, and whether this is the lower one."""
    grid = np.log(np.geomspace(low, high, _TRIED))
    at = int(np.argmin([cost(x) for x in grid.tolist()]))
    around = float(grid[max(at - 1, 0)]), float(grid[min(at + 1, _TRIED - 1)])
    return float(minimize_scalar(cost, bounds=around, method="bounded").x), at == 0
