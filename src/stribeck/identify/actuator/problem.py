"""The least-squares problem over all recordings: residuals of the measured outputs, and their Jacobian."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, pairwise

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import NEUTRAL, MachineCoordinate
from stribeck.identify.actuator.related import Relations
from stribeck.identify.actuator.runs import RecordedRun
from stribeck.identify.work import Work
from stribeck.simulation.lanes import threads_of_this_machine
from stribeck.waveforms import Signal

STEP = 2e-4  # of a coordinate, for differences
_SPEED = float(np.sqrt(12 / 12**3))  # deviation of a slope over twelve samples, by their deviation and distance
_MOST = 4e6  # numbers in memory at once
_REMEMBERED = 4e6  # cached numbers of simulated points


@dataclass(frozen=True)
class Seam:
    """The end of a stretch and the start of the next: the run, its column, and the coordinate of that start.

    ``share`` is the allowed difference, in units of the noise of the position ``of``.
    """

    run: int
    column: str
    coordinate: int
    of: str
    share: float


def chains(runs: Sequence[RecordedRun]) -> list[list[int]]:
    """The indices of the runs: consecutive stretches of a recording form one list, in their order."""
    found: list[list[int]] = []
    end = np.nan
    for k in sorted(range(len(runs)), key=lambda k: (runs[k].log, float(runs[k].piece or 0))):
        run = runs[k]
        begin = float(run.piece or 0)
        follows = found and runs[found[-1][-1]].log == run.log and abs(begin - end) < run.scenario.output.step
        found = [*found[:-1], [*found[-1], k]] if follows else [*found, [k]]
        end = begin + run.scenario.end
    return found


def ties(runs: Sequence[RecordedRun], sought: Sequence[MachineCoordinate]) -> list[Seam]:
    """The ties between consecutive stretches."""
    before = {(runs[b].log, runs[b].piece): a for ks in chains(runs) for a, b in pairwise(ks)}
    found = []
    for i, c in enumerate(sought):
        k = before.get((c.log or 0, c.piece)) if c.nuisance else None
        if k is None:
            continue
        body, what = c.name.rsplit(".", 2)[1:]
        position = next((t for t in runs[k].targets if t.column == f"{body}.y"), None)
        if position is None or len(position.t) < 2:
            continue
        share = 1.0 if what == "y" else _SPEED / float(np.median(np.diff(position.t)))
        found.append(Seam(k, f"{body}.{what}", i, position.column, share))
    return found


@dataclass
class MachineProblem:
    """Runs, coordinates to fit, and the noise of each column.

    ``residuals(U)`` maps points (lanes, coordinates) to (lanes, residuals); nan where a simulation failed. First are
    (simulated - measured)/noise of every target of every run, then priors. If stretches are ``tied``, the difference
    between each end and the next start follows, by the start's deviation from the samples. Unmeasured states of a start
    (bristles, currents, unmeasured bodies) then continue the stretch before, at the same point.
    """

    runs: list[RecordedRun]
    sought: list[MachineCoordinate]
    noise: dict[str, float]
    threads: int = field(default_factory=threads_of_this_machine)
    work: Work = field(default_factory=Work)
    step: float = STEP
    tied: bool = False

    def __post_init__(self) -> None:
        self.low, self.high = (np.array([c.bounds[i] for c in self.sought]) for i in (0, 1))
        self.concerns = [np.array([_belongs(c, run) for c in self.sought], bool) for run in self.runs]
        self._seen: list[dict[bytes, Array]] = [{} for _ in self.runs]
        sizes = [run.size for run in self.runs]
        self.first = np.concatenate([[0], np.cumsum(sizes)]).astype(int)
        self.priors = [i for i, c in enumerate(self.sought) if c.prior is not None]
        self.ties = ties(self.runs, self.sought) if self.tied else []
        self.size = int(self.first[-1]) + len(self.priors) + len(self.ties)
        self._states = [state.name for state in self.runs[0].scenario.system.states]
        self._chains = chains(self.runs) if self.tied else [[k] for k in range(len(self.runs))]
        self._chains.sort(key=lambda ks: -sum(self.runs[k].scenario.rows for k in ks))
        self._starts = [c for c in self.sought if c.nuisance]
        self._relations = Relations(self.sought, lambda path: number_at(self.runs[0], path))

    def repaired(self, U: Array) -> Array:
        """The points moved into the bounds, and to where relations hold (F_s >= F_c)."""
        return self._relations.repaired(np.clip(U, self.low, self.high))

    def residuals(self, U: Array) -> Array:
        """The residuals at the points U, by the noise. The runs are simulated in parallel."""
        U = np.atleast_2d(U)
        found = np.full((len(U), self.size), np.nan)
        simulated = self.work.each(lambda ks: list(self._followed(ks, U)), self._chains)
        self.work.check()
        for k, rows, _ in chain.from_iterable(filter(None, simulated)):
            run, at = self.runs[k], int(self.first[k])
            begin = 0
            for target in run.targets:
                size = len(target.t)
                found[:, at : at + size] = (rows[:, begin : begin + size] - target.x) / self.noise[target.column]
                at, begin = at + size, begin + size
            for at, tie in enumerate(self.ties, int(self.first[-1]) + len(self.priors)):
                if tie.run == k:
                    there = np.array([self.sought[tie.coordinate].outer(u) for u in U[:, tie.coordinate]])
                    end = rows[:, begin + self._states.index(tie.column)]
                    found[:, at] = (end - there) / (tie.share * self.noise[tie.of])
        for n, i in enumerate(self.priors):
            c = self.sought[i]
            assert c.prior is not None
            found[:, self.first[-1] + n] = [(c.outer(u) - c.prior[0]) / c.prior[1] for u in U[:, i]]
        self.work.tick()
        return found

    def _followed(self, ks: Sequence[int], U: Array) -> Iterator[tuple[int, Array, Mapping[str, Array]]]:
        """The runs of a chain at the points U: the result of :meth:`_simulated`, and shifts of initial states.

        The shifts let states that no coordinate sets continue the run before.
        """
        ends = np.empty((len(U), 0))
        for i, k in enumerate(ks):
            begins = self._unset(k) if i else {}
            shift = {n: ends[:, self._states.index(n)] - x for n, x in begins.items()}
            rows = self._simulated(k, U, shift)
            ends = rows[:, self.runs[k].size :]
            yield k, rows, shift

    def _unset(self, k: int) -> dict[str, float]:
        """The initial states of a stretch that no coordinate of its own sets, with the machine's initial values."""
        run = self.runs[k]
        own = {".".join(c.name.rsplit(".", 2)[1:]) for c in self._starts if (c.log, c.piece) == (run.log, run.piece)}
        begins = {**run.scenario.initial}
        for path, x in run.start.items():
            _, body, _, what = path.split(".")
            begins[f"{body}.{what}"] = x
        return {n: begins.get(n, 0.0) for n in self._states if n not in own}

    def handed_on(self, u: Array) -> list[RecordedRun]:
        """The runs at the point u. States that no coordinate sets continue the run before."""
        found = list(self.runs)
        for k, _, shift in chain.from_iterable(self._followed(ks, u[None]) for ks in self._chains):
            known = {n: float(x[0]) for n, x in shift.items() if np.isfinite(x[0])}
            found[k] = replace(self.runs[k], shift=known or self.runs[k].shift)
        return found

    def predicted(
        self, run: RecordedRun, k: int, U: Array, ends: Sequence[str] = (), threads: int | None = None,
        shift: Mapping[str, Array] | None = None, signals: Mapping[str, Sequence[Signal]] | None = None,
    ) -> list[Array]:  # fmt: skip
        """The simulated columns of a run with its sensors' gains and offsets, and the columns ``ends`` at its end.

        ``signals``: by path, inputs of each lane instead of the recorded ones.
        """
        values: dict[str, Array] = {}
        sensors: dict[tuple[str, str], Array] = {}
        for i in np.flatnonzero(self.concerns[k]):
            c = self.sought[i]
            x = np.array([c.outer(u) for u in U[:, i]])
            for path, scale in c.targets.items():
                values[path] = scale * x
            if c.output is not None:
                sensors[c.output] = x
        if not values:  # parallel simulation needs at least one number by lane: an unchanged one
            name = next(x.name for x in run.scenario.system.bodies if x.free)
            path, now = f"bodies.{name}.initial.y", run.scenario.elements.initial.get(f"{name}.y", 0.0)
            values = {path: np.full(len(U), run.start.get(path, now))}
        delays = {
            column: (sensors.get((column, "delay")), sensors.get((column, "clock")))
            for column, what in sensors if what in ("delay", "clock")
        }  # fmt: skip
        found = run.predict(values, delays, threads or self.threads, ends, shift, signals)
        for target, x in zip(run.targets, found, strict=False):
            gain, offset = (sensors.get((target.column, what)) for what in ("gain", "offset"))
            if gain is not None:
                x *= gain[:, None]
            if offset is not None:
                x += offset[:, None]
            for name, column in target.beside.items():
                if (factor := sensors.get((target.column, name))) is not None:
                    x += factor[:, None] * column
        return found

    def _simulated(self, k: int, U: Array, shift: Mapping[str, Array]) -> Array:
        """The compared columns of a run at the points U, one after the other, and its final states if stretches are tied.

        Equal points are simulated once, and recent points are cached.
        """
        run, seen = self.runs[k], self._seen[k]
        given = np.column_stack([U[:, self.concerns[k]], *shift.values()])
        keys = [row.tobytes() for row in given]
        new = [i for key, i in {key: i for i, key in enumerate(keys)}.items() if key not in seen]
        most = max(8, int(_MOST / max(run.scenario.rows, 1)))
        threads = -(-self.threads // min(len(self._chains), self.threads))
        here: dict[bytes, Array] = {key: seen[key] for key in keys if key in seen}
        for first in range(0, len(new), most):
            some = new[first : first + most]
            begun = {name: x[some] for name, x in shift.items()}
            columns = self.predicted(run, k, U[some], self._states if self.tied else (), threads, begun or None)
            here |= zip((keys[i] for i in some), np.concatenate(columns, axis=1), strict=True)
        room = int(_REMEMBERED / (len(self.runs) * max(run.size, 1)))
        self._seen[k] = dict(list({**seen, **here}.items())[-room:]) if room else {}
        return np.array([here[key] for key in keys])

    def slopes(self, U: Array, step: Array) -> tuple[Array, Array]:
        """Residuals (points, residuals) and Jacobians (points, residuals, coordinates), by differences within the bounds."""
        U = np.atleast_2d(U)
        n = len(self.sought)
        side = np.where(U + step <= self.high, 1.0, -1.0)
        side[:, self._relations.lower()] = -1.0
        side = np.where((side < 0) & (U - step < self.low), 1.0, side)
        all_ = np.repeat(U, n + 1, axis=0).reshape(len(U), n + 1, n)
        for i in range(n):
            all_[:, i + 1, i] += side[:, i] * step[i]
        found = self.residuals(all_.reshape(len(U) * (n + 1), n)).reshape(len(U), n + 1, -1)
        J = np.empty((len(U), self.size, n))
        for i in range(n):
            J[:, :, i] = (found[:, i + 1] - found[:, 0]) / (side[:, i] * step[i])[:, None]
        if np.isnan(J).any():
            self._other_side(U, step, side, found, J)
        return found[:, 0], J

    def _other_side(self, U: Array, step: Array, side: Array, found: Array, J: Array) -> None:
        """Replace derivatives that failed to one side by differences to the other side."""
        for p in range(len(U)):
            bad = [i for i in range(U.shape[1]) if np.isnan(J[p, :, i]).any()]
            if not bad or np.isnan(found[p, 0]).any():
                continue
            tried = np.repeat(U[p : p + 1], len(bad), axis=0)
            for row, i in enumerate(bad):
                tried[row, i] -= side[p, i] * step[i]
            r = self.residuals(tried)
            for row, i in enumerate(bad):
                slope = (r[row] - found[p, 0]) / (-side[p, i] * step[i])
                J[p, :, i] = np.where(np.isfinite(slope), slope, 0.0)

    def central(self, u: Array, step: Array) -> Array:
        """The Jacobian at one point by central differences, one-sided at bounds and failed simulations."""
        n = len(u)
        up, down = np.minimum(u + step, self.high), np.maximum(u - step, self.low)
        points = np.repeat(u[None], 2 * n, axis=0)
        points[np.arange(n), np.arange(n)] = up
        points[n + np.arange(n), np.arange(n)] = down
        r = self.residuals(np.concatenate([u[None], points]))
        J = np.empty((self.size, n))
        for i in range(n):
            a, b = r[1 + i], r[1 + n + i]
            if np.isfinite(a).all() and np.isfinite(b).all():
                J[:, i] = (a - b) / max(up[i] - down[i], 1e-300)
            elif np.isfinite(a).all():
                J[:, i] = (a - r[0]) / max(up[i] - u[i], 1e-300)
            elif np.isfinite(b).all():
                J[:, i] = (r[0] - b) / max(u[i] - down[i], 1e-300)
            else:
                J[:, i] = 0.0
        return J

    def start(self) -> Array:
        """The user's or the machine's initial values; without one, the middle of the bounds."""
        found = []
        for c in self.sought:
            x = c.start if c.start is not None else None if c.prior is None else c.prior[0]
            if x is None and c.output is not None:
                x = NEUTRAL.get(c.output[1], 0.0)
            if x is None:
                x = number_at(self.runs[0], next(iter(c.targets), ""))
            inside = x is not None and c.low <= x <= c.high
            found.append(c.inner(x) if inside and x is not None else float(np.mean(c.bounds)))
        return np.asarray(self.repaired(np.array([found]))[0])

    def point(self, values: Mapping[str, float]) -> Array:
        """A point from values by name; other coordinates have their initial values."""
        u = self.start()
        for i, c in enumerate(self.sought):
            if c.name in values:
                u[i] = c.inner(values[c.name])
        return np.asarray(self.repaired(u[None])[0])

    def values(self, u: Array) -> dict[str, float]:
        """The values at a point, by name."""
        return {c.name: c.outer(x) for c, x in zip(self.sought, u, strict=True)}


def number_at(run: RecordedRun, path: str) -> float | None:
    """The machine's number at a path, if there is one."""
    value: object = run.scenario.data
    for word in path.split("."):
        if isinstance(value, dict):
            value = value.get(word)
        elif isinstance(value, list) and word.isdigit() and int(word) < len(value):
            value = value[int(word)]
        else:
            return None
    return float(value) if isinstance(value, int | float) else None


def _belongs(c: MachineCoordinate, run: RecordedRun) -> bool:
    """Whether a coordinate concerns a run."""
    if c.output is not None and all(t.column != c.output[0] for t in run.targets):
        return False
    if not c.nuisance and run.piece not in (None, "0") and any(".initial." in path for path in c.targets):
        return False  # an initial state of the recording does not concern its later stretches
    return c.log in (None, run.log) and (not c.nuisance or c.piece == run.piece)
