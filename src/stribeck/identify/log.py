"""A measured log in SI units, ready to be fitted."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from hashlib import sha256
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.constants import rotary_unit

MOTION = ("position", "velocity", "acceleration")
_COLUMNS = ("time", *MOTION, "force", "load", "pressure", "command", "unfiltered", "run")
INTEGRAL = "the integral of the velocity"  # the source of a position that nobody measured
MANY_ROWS = 500_000  # taken at once: some 4 MB a column, whatever the record's length; so many tell the sizes of a log
ENOUGH_ROWS = 100_000  # of a record: behind a filter, neighboring rows are alike, and more tell nothing new
STILL = 0.01  # of the fastest speed: the body hardly moves
# Of a run to be simulated: an initial state takes half, a parabola and one more, and as many show the fit.
FEWEST_SAMPLES = 8
# Samples from which an initial state is estimated: few enough for a parabola, and a slope's noise is a twelfth.
FIRST_SAMPLES = 12
BEGIN = 2 * FIRST_SAMPLES  # samples to which the initial state of a predicted run is fitted


@dataclass(frozen=True)
class Log:
    """Motion and force against time, SI units (rotary machines: rad, N m), every array of the same length.

    Within a run the time rises by ``step``, the first of them unless given; runs follow each other. ``force`` is what drives
    the body, positive in the direction of positive motion: mass * acceleration + friction + spring, gravity and offset.

    Attributes:
        unfiltered: the measured position, or the velocity where that was measured, before any filter.
        sources: where each column is from: "measured", "from position, cut-off 20 Hz", ...
        quality: what was found in the raw data and what was done about it, a line each.
        bandwidth: the cut-off of the filter that was applied, Hz; None for data taken as they are. ``order``: the filter's.
        files: the name of the file that each run is from.
        hashes: SHA-256 of each file that it was read from.
        rotary: whether the machine turns: rad, N m and kg m^2 in the place of m, N and kg.
        noise: spectral density of the noise of the measured motion; None if it is unknown.
    """

    time: Array
    position: Array
    velocity: Array
    acceleration: Array
    force: Array
    run: NDArray[np.int32]
    load: Array | None = None
    pressure: Array | None = None
    command: Array | None = None
    unfiltered: Array | None = None
    step: float = 0.0
    sources: dict[str, str] = field(default_factory=dict)
    quality: tuple[str, ...] = ()
    bandwidth: float | None = None
    order: int = 4
    files: tuple[str, ...] = ()
    hashes: tuple[str, ...] = ()
    noise: float | None = None
    rotary: bool = False

    def __post_init__(self) -> None:
        if not self.step:
            object.__setattr__(self, "step", float(np.sum(self.time[1:2] - self.time[:1])))

    def __len__(self) -> int:
        return len(self.time)

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the file; of several, of their sums in order; of the columns where there is no file."""
        if self.hashes:
            return self.hashes[0] if len(self.hashes) == 1 else sha256("".join(self.hashes).encode()).hexdigest()
        digest = sha256()
        for name, column in self.columns().items():
            digest.update(name.encode())
            digest.update(np.ascontiguousarray(column).view(np.uint8).data)
        return digest.hexdigest()

    def unit(self, of_line: str) -> str:
        """The unit of a quantity of this machine, from that of one that moves on a line."""
        return rotary_unit(of_line) if self.rotary else of_line

    def columns(self) -> dict[str, Array | NDArray[np.int32]]:
        """The columns that are there, by name."""
        return {name: getattr(self, name) for name in _COLUMNS if getattr(self, name) is not None}

    def rows(self, which: slice | NDArray[np.bool_] | NDArray[np.intp]) -> Log:
        """The log with the rows that ``which`` (a slice, mask or index array) picks."""
        return self.with_columns(**{name: column[which] for name, column in self.columns().items()})

    def runs(self) -> list[slice]:
        """The rows of each run, in order."""
        return parted(np.diff(self.run) != 0) if len(self) else []

    @property
    def file_of_rows(self) -> NDArray[np.intp]:
        """The number of the file that each row is from."""
        names = list(dict.fromkeys(self.files))
        numbers = [names.index(n) for n in self.files] or [0] * (int(self.run.max()) + 1)
        return np.array(numbers, np.intp)[self.run]

    def with_columns(self, **columns: Any) -> Log:
        """The log with some columns or notes replaced."""
        return replace(self, **columns)


def parted(breaks: NDArray[np.bool_]) -> list[slice]:
    """The rows between breaks; ``breaks[i]``: whether there is one between rows i and i + 1."""
    return [slice(a, b) for a, b in pairwise([0, *(np.flatnonzero(breaks) + 1).tolist(), len(breaks) + 1])]


def stretches(there: NDArray[np.bool_]) -> NDArray[np.intp]:
    """The first row of each stretch of true values, and the row after its last one; (stretches, 2)."""
    return np.flatnonzero(np.diff(there, prepend=False, append=False)).reshape(-1, 2)


def size_ratio(left: Array, of: Array) -> float:
    """norm(left)/norm(of): a residual as a share of what it is left of."""
    return float(np.linalg.norm(left)) / max(float(np.linalg.norm(of)), 1e-300)


def thinned(log: Log) -> Log:
    """A long log with fewer rows, for sizes that do not need all of them."""
    every = len(log) // MANY_ROWS
    return log if every < 2 else log.rows(slice(None, None, every))


@dataclass
class Trace:
    """A measured column and its simulation."""

    column: str
    unit: str
    t: Array
    measured: Array
    predicted: Array

    @property
    def rms(self) -> float:
        """The rms error."""
        return float(np.sqrt(np.mean((self.predicted - self.measured) ** 2)))

    @property
    def relative(self) -> float:
        """The error relative to the changes of the measured column."""
        size = float(np.std(self.measured))
        return self.rms / size if size > 0 else float("inf")
