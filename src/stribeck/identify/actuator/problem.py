"""The least-squares problem over all recordings: residuals of the measured outputs, and their Jacobian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.signal import lfilter

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import NEUTRAL, MachineCoordinate, Relations
from stribeck.identify.actuator.inputs import number_at
from stribeck.identify.actuator.recordings import Channel
from stribeck.identify.actuator.runs import RecordedRun, delayed
from stribeck.identify.actuator.whitening import WHITE
from stribeck.identify.work import Work
from stribeck.simulation.lanes import threads_of_this_machine
from stribeck.waveforms import Signal

STEP = 2e-4  # of a coordinate, for differences: far above the solver's error, far below the next minimum
_MEMORY = 4e6  # numbers that one batch of lanes, or the cache, may hold: some 30 MB


@dataclass
class MachineProblem:
    """Runs, coordinates to fit, and the noise of each column.

    ``plain(U)`` maps points (lanes, coordinates) to (lanes, residuals); nan where a simulation failed. First are
    (simulated - measured)/noise of every target of every run, then priors. ``residuals(U)`` are the prediction errors of
    these.

    Attributes:
        known_noise: columns whose noise is given.
        whitening: by column, the filter of its prediction errors.
        guide: the prefix of the elements of a guide, if there is one.
        pieces: the run, the target and the rows of the residuals of every compared column.
    """

    runs: list[RecordedRun]
    sought: list[MachineCoordinate]
    noise: dict[str, float]
    threads: int = field(default_factory=threads_of_this_machine)
    work: Work = field(default_factory=Work)
    step: float = STEP
    guide: str = ""
    known_noise: frozenset[str] = frozenset()
    whitening: dict[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.low, self.high = (np.array([c.bounds[i] for c in self.sought]) for i in (0, 1))
        self.concerns = [np.array([_belongs(c, run) for c in self.sought], bool) for run in self.runs]
        self._cache: list[dict[bytes, Array]] = [{} for _ in self.runs]
        self.first = np.concatenate([[0], np.cumsum([run.size for run in self.runs])]).astype(int)
        self.priors = [(i, c.prior) for i, c in enumerate(self.sought) if c.prior is not None]
        self.size = int(self.first[-1]) + len(self.priors)
        self.pieces: list[tuple[int, Channel, slice]] = []
        end = 0
        for k, target in ((k, target) for k, run in enumerate(self.runs) for target in run.targets):
            self.pieces.append((k, target, slice(end, end := end + len(target.t))))
        self._longest_first = sorted(range(len(self.runs)), key=lambda k: -self.runs[k].scenario.rows)
        self._relations = Relations(self.sought, lambda path: number_at(self.runs[0].scenario, path))

    def repaired(self, U: Array) -> Array:
        """The points moved into the bounds, and to where relations hold (F_s >= F_c)."""
        return self._relations.repaired(np.clip(U, self.low, self.high))

    def residuals(self, U: Array) -> Array:
        """The residuals at the points U: prediction errors by their deviation."""
        return self.whitened(self.plain(U))

    def whitened(self, r: Array) -> Array:
        """Plain residuals as prediction errors. The first samples of a run, which have no past, stay as they are."""
        if not self.colored:
            return r
        r = r.copy()
        for _, target, rows in self.pieces:
            coefficients = self.whitening.get(target.column, WHITE)
            past = len(coefficients) - 1
            if past:
                r[..., rows.start + past : rows.stop] = lfilter(coefficients, [1.0], r[..., rows])[..., past:]
        return r

    @property
    def colored(self) -> bool:
        """Whether past residuals predict some of the next."""
        return any(len(x) > 1 for x in self.whitening.values())

    def of_guide(self, path: str) -> bool:
        """Whether a path, or a column, belongs to a guide."""
        return bool(self.guide) and self.guide in path

    def without_whitening(self) -> MachineProblem:
        """The problem whose residuals are plain."""
        plain = replace(self, whitening={})
        plain._cache = self._cache
        return plain

    def deviations(self) -> dict[str, float]:
        """The deviation of each column's prediction errors, in its unit."""
        return {c: noise / float(self.whitening.get(c, WHITE)[0]) for c, noise in self.noise.items()}

    def plain(self, U: Array) -> Array:
        """The residuals at the points U, by the noise. The runs are simulated in parallel."""
        U = np.atleast_2d(U)
        r = np.full((len(U), self.size), np.nan)
        simulated = self.work.each(lambda k: self._simulated(k, U), self._longest_first)
        columns = dict(zip(self._longest_first, simulated, strict=True))
        for k, target, rows in self.pieces:
            x = columns[k][:, rows.start - self.first[k] : rows.stop - self.first[k]]
            r[:, rows] = (x - target.x) / self.noise[target.column]
        compared = int(self.first[-1])
        for row, (i, (mean, deviation)) in enumerate(self.priors, compared):
            r[:, row] = [(self.sought[i].outer(u) - mean) / deviation for u in U[:, i]]
        self.work.tick()
        return r

    def predicted(
        self, run: RecordedRun, k: int, U: Array, threads: int | None = None, shift: Mapping[str, Array] | None = None,
        signals: Mapping[str, Sequence[Signal]] | None = None,
    ) -> list[Array]:  # fmt: skip
        """The simulated columns of a run with its sensors' gains and offsets.

        Args:
            shift: added to initial states of each lane.
            signals: by path, inputs of each lane instead of the recorded ones.
        """
        values: dict[str, Array] = {}
        sensors: dict[tuple[str, str], Array] = {}
        for i in np.flatnonzero(self.concerns[k]):
            c = self.sought[i]
            x = np.array([c.outer(u) for u in U[:, i]])
            values |= {path: scale * x for path, scale in c.targets.items()}
            sensors |= {c.output: x} if c.output is not None else {}
        if not values:  # parallel simulation needs at least one number by lane: an unchanged one
            elements = run.scenario.elements
            path, place = next(x for x in run.scenario.places.items() if x[1] in elements.values)
            values = {path: np.full(len(U), elements.values[place])}
        none = np.zeros(len(U))
        delays = {
            column: (sensors.get((column, "delay"), none), sensors.get((column, "clock"), none))
            for column, what in sensors if what in ("delay", "clock")
        }  # fmt: skip
        columns = run.predict(values, delays, threads or self.threads, shift, signals)
        for target, x in zip(run.targets, columns, strict=True):
            of_sensor = {what: each[:, None] for (column, what), each in sensors.items() if column == target.column}
            x *= of_sensor.get("gain", 1.0)
            x += of_sensor.get("offset", 0.0)
            late = delays.get(target.column)
            for name, term in target.beside.items():
                if name in of_sensor:
                    x += of_sensor[name] * (term if late is None else delayed(target.t, term, late))
        return columns

    def _simulated(self, k: int, U: Array) -> Array:
        """The compared columns of a run at the points U, one after the other.

        Equal points are simulated once, and recent points are cached.
        """
        run, cached = self.runs[k], self._cache[k]
        keys = [row.tobytes() for row in U[:, self.concerns[k]]]
        new = [i for key, i in {key: i for i, key in enumerate(keys)}.items() if key not in cached]
        most = max(8, int(_MEMORY / max(run.scenario.rows, 1)))
        threads = -(-self.threads // min(len(self.runs), self.threads))
        here: dict[bytes, Array] = {key: cached[key] for key in keys if key in cached}
        for first in range(0, len(new), most):
            some = new[first : first + most]
            columns = self.predicted(run, k, U[some], threads)
            here |= zip((keys[i] for i in some), np.concatenate(columns, axis=1), strict=True)
        room = int(_MEMORY / (len(self.runs) * max(run.size, 1)))
        self._cache[k] = dict(list({**cached, **here}.items())[-room:]) if room else {}
        return np.array([here[key] for key in keys])

    def slopes(self, U: Array, step: Array | float | None = None, by: Sequence[int] = ()) -> tuple[Array, Array]:
        """Residuals (points, residuals) and Jacobians (points, residuals, coordinates), by differences within the bounds.

        Where the simulation to one side fails, the difference is taken to the other.

        Args:
            step: of the differences; the problem's unless given. ``by``: the coordinates of the Jacobian; all unless given.
        """
        U, step = np.atleast_2d(U), self.step if step is None else step
        columns = np.asarray(by or range(U.shape[1]))
        count, n = len(U), len(columns)
        side = np.where(U + step <= self.high, 1.0, -1.0)
        side[:, self._relations.lower()] = -1.0
        moves = (np.where((side < 0) & (U - step < self.low), 1.0, side) * step)[:, columns]
        points = np.repeat(U, n + 1, axis=0).reshape(count, n + 1, -1)
        points[:, np.arange(1, n + 1), columns] += moves
        r = self.residuals(points.reshape(count * (n + 1), -1)).reshape(count, n + 1, -1)
        base, J = r[:, 0], np.empty((count, self.size, n))
        J[:] = np.swapaxes((r[:, 1:] - r[:, :1]) / moves[:, :, None], 1, 2)
        for p in np.flatnonzero(np.isnan(J).any(axis=(1, 2)) & ~np.isnan(base).any(axis=1)):
            bad = np.flatnonzero(np.isnan(J[p]).any(axis=0))
            other = np.repeat(U[p : p + 1], len(bad), axis=0)
            other[np.arange(len(bad)), columns[bad]] -= moves[p, bad]
            slope = (self.residuals(other) - base[p]) / -moves[p, bad, None]
            J[p][:, bad] = np.where(np.isfinite(slope), slope, 0.0).T
        return base, J

    def central(self, u: Array, step: Array) -> Array:
        """The Jacobian at one point by central differences, one-sided at bounds and failed simulations."""
        n = len(u)
        sides = np.minimum(u + step, self.high), np.maximum(u - step, self.low)
        points = np.repeat(u[None], 2 * n, axis=0)
        points[np.arange(2 * n), np.tile(np.arange(n), 2)] = np.concatenate(sides)
        r = self.residuals(np.concatenate([u[None], points]))
        ends = []
        for at, moved in zip(sides, (r[1 : 1 + n], r[1 + n :]), strict=True):
            whole = np.all(np.isfinite(moved), axis=1, keepdims=True)
            ends.append((np.where(whole[:, 0], at, u), np.where(whole, moved, r[0])))
        (up, above), (down, below) = ends
        J = np.empty((self.size, n))
        J[:] = ((above - below) / np.maximum(up - down, 1e-300)[:, None]).T
        return J

    def start(self) -> Array:
        """The user's or the machine's initial values; without one, the middle of the bounds."""
        u = []
        for c in self.sought:
            x = c.start if c.start is not None else None if c.prior is None else c.prior[0]
            if x is None and c.output is not None:
                x = NEUTRAL.get(c.output[1], 0.0)
            if x is None:
                x = number_at(self.runs[0].scenario, next(iter(c.targets), ""))
            u.append(c.inner(x) if x is not None and c.low <= x <= c.high else float(np.mean(c.bounds)))
        return np.asarray(self.repaired(np.array([u]))[0])

    def point(self, values: Mapping[str, float]) -> Array:
        """A point from values by name; other coordinates have their initial values."""
        u = self.start()
        for i, c in enumerate(self.sought):
            if c.name in values:
                u[i] = c.inner(values[c.name])
        return np.asarray(self.repaired(u[None])[0])

    def numbers(self, u: Array) -> dict[str, float]:
        """The machine's fitted numbers at a point, by path."""
        return {p: s * c.outer(x) for c, x in zip(self.sought, u, strict=True) for p, s in c.targets.items()}

    def values(self, u: Array) -> dict[str, float]:
        """The values at a point, by name."""
        return {c.name: c.outer(x) for c, x in zip(self.sought, u, strict=True)}


def _belongs(c: MachineCoordinate, run: RecordedRun) -> bool:
    """Whether a coordinate concerns a run."""
    if c.output is not None and all(t.column != c.output[0] for t in run.targets):
        return False
    return c.log in (None, run.log)
