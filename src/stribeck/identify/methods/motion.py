"""Simulation-error fit the other way round: measured force or command in, motion out, closed loop included."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace

import numpy as np
from threadpoolctl import threadpool_limits

from stribeck.arrays import Array
from stribeck.errors import InputError, StribeckError, arg
from stribeck.identify.details import FitDetails
from stribeck.identify.log import Log
from stribeck.identify.methods.dynamic import fit_of, judged_of
from stribeck.identify.methods.horizons import first_values, follow
from stribeck.identify.methods.optimise import Optimum, multistart, starting_points
from stribeck.identify.models.dynamic_problem import Given, VelocityProblem, first_deflection, velocity_problem
from stribeck.identify.models.motion_problem import SLIDES, MotionProblem, output_noise, raw, white_noise
from stribeck.identify.models.problem import Coordinate, Problem, Tie
from stribeck.identify.models.terms import column
from stribeck.identify.result import Fit
from stribeck.identify.statistics.verdicts import Noise
from stribeck.identify.work import Work
from stribeck.scenario import Scenario
from stribeck.signals import PointsSignal
from stribeck.simulation import simulate

_RTOL = 1e-6
_STARTS_THERE = 8
_MISSED = 0.02  # of the output's changes: a fit that leaves more, and more than noise, has missed it
_OUTPUTS = {"position": "y", "velocity": "v"}


_BESIDE = {"delay", "offset", "gravity_sin", "gravity_cos", "stiffness", "area", "sigma_2_by_direction", "drag"}


class RigProblem(Problem):
    """Measured force or command in, motion out: the rig as a scenario, from the first row of each run to its last.

    Args:
        inverse: the problem the other way round, which names the coordinates.
        drive: ``[drive]`` of a scenario without its signal: ``{"kind": "force"}`` takes the log's force, any other kind
            its command.
        output: "position" or "velocity".
    """

    step = 1e-3  # each simulation takes steps of its own: smaller differences drown in their errors

    def __init__(self, inverse: VelocityProblem, drive: Mapping[str, object], output: str) -> None:
        self.inverse, self.log, self.kind, self.column = inverse, inverse.log, drive["kind"], _OUTPUTS[output]
        self.runs, whole = inverse.within, raw(self.log, output)
        self.rows = np.concatenate([np.arange(len(self.log))[run] for run in self.runs])
        measured = whole[self.rows]
        scale = float(np.sqrt(np.mean((measured - measured.mean()) ** 2)))
        super().__init__(inverse.law, self._own_coordinates(), inverse.fixed, inverse.tied, measured, scale)
        assert inverse.home is not None
        self.home = self.begun(inverse.home)
        signal = self.log.force if self.kind == "force" else self.log.command
        assert signal is not None
        self.signal, self.coarse = signal, False
        self.scenarios = {
            i: self._scenario(rows, drive, self.values(self.home))
            for i, rows in enumerate(self.runs)
            if rows.stop > rows.start
        }

    def _scenario(self, rows: slice, drive: Mapping[str, object], values: Given) -> Scenario:
        log, known = self.log, self.law.constants()
        inside = {n: values[n] for n in self.law.uses}
        own = {n: values[n] for n in known if n not in inside and n in values}
        return Scenario(
            law={"name": self.law.name, **own, "parameters": inside},
            plant={"mass": values["mass"], "initial": {"y": float(log.position[rows][0]), "v": float(log.velocity[rows][0])}},
            drive={**drive, "signal": {"kind": "points", "t": [0.0], "value": [0.0]}},
            solve={"t_end": (rows.stop - rows.start - 1) * log.step, "rtol": _RTOL},
            output={"step": log.step},
        )  # fmt: skip

    def _own_coordinates(self) -> list[Coordinate]:
        """Those of the problem the other way round, each run's own at the rows that count."""
        start = np.cumsum([0, *(run.stop - run.start for run in self.runs)]).tolist()
        parts = {first_deflection(i): slice(start[i], start[i + 1]) for i in range(len(self.runs))}
        own = [replace(c, rows=parts.get(c.name)) for c in self.inverse.coordinates]
        for number, run in enumerate(self.runs):
            part = parts[first_deflection(number)]
            for name in _OUTPUTS if run.stop > run.start else ():  # the measured ones have their noise
                x = getattr(self.log, name)
                size, first = max(float(np.ptp(x)), 1e-300), float(x[run.start])
                ends = first - size, first + size
                own.append(Coordinate(f"{name}_{number}", "", *ends, log=False, scale=size, nuisance=True, rows=part))
        return own

    def begun(self, u: Array) -> Array:
        """The point of the problem the other way round with each run's start as it was measured."""
        starts = [(c.low + c.high) / 2 / c.scale for c in self.coordinates[len(u) :]]
        return np.concatenate([u, starts])

    def outputs(self, points: Array) -> Array | None:
        """The motion at the rows that count."""
        out = np.empty((len(points), len(self.log)))
        for lane, u in enumerate(points):
            values = self.values(u)
            for number in self.scenarios:
                rows = self.runs[number]
                part = self._simulated(number, rows, values)
                if part is None:
                    return None
                out[lane, rows] = part
        return out[:, self.rows]

    def between_samples(self, u: Array) -> Array:
        """How the output may be off as the signal goes straight from sample to sample: a third of what every second one alone
        does to it, as that error is of the second order."""
        other = copy(self)
        other.coarse = True
        usual, coarse = self.outputs(u[None, :]), other.outputs(u[None, :])
        if usual is None or coarse is None:
            return np.zeros(len(self.measured))
        return np.asarray((coarse[0] - usual[0]) / 3)

    def _beside(self, rows: slice, values: Given) -> Array:
        """What of the measured force neither moves the body nor is the law's: at the measured position and speed."""
        part = self.log.rows(rows)
        return np.asarray(
            sum((values[n] * column(n, part, values) for n in self.inverse.body if n != "mass"), np.zeros(len(part)))
        )

    def _simulated(self, number: int, rows: slice, values: Given) -> Array | None:
        try:
            law = self.law({n: values[n] for n in self.law.constants() if n in values})
        except InputError:
            return None
        z = values.get(first_deflection(number), 0.0) * self.length(values)
        state = {"y": values[f"position_{number}"], "v": values[f"velocity_{number}"]}
        initial = {**self.scenarios[number].initial, **state, **({"z": z} if self.law.has_z else {})}
        time = self.log.time[rows] - self.log.time[rows][0]
        driving = self.inverse.driving(self.signal, values)[rows]
        push = driving - (self._beside(rows, values) if self.kind == "force" else 0.0)
        some = np.append(np.arange(0, len(time) - 1, 2), len(time) - 1) if self.coarse else slice(None)
        signal = PointsSignal(time[some], push[some])
        numbers = {("contacts.law", n): x for n, x in law.p.numbers.items()} | {("bodies", "mass"): values["mass"]}
        solution = simulate(self.scenarios[number].with_values(numbers, initial=initial, signal=signal))
        found = solution[self.column]
        return found if solution.status == "done" and np.isfinite(found).all() else None


def fit_motion(
    log: Log,
    law: str,
    drive: Mapping[str, object] | None = None,
    *,
    output: str = "velocity",
    fixed: Given | None = None,
    free: Sequence[str] | None = None,
    tied: Mapping[str, Tie] | None = None,
    start: Given | None = None,
    mass: float | None = None,
    body: Sequence[str] = (),
    starts: int = 8,
    seed: int = 0,
    profiles: bool = True,
    work: Work | None = None,
) -> Fit:
    """Fit a law's constants so that the motion simulated for the measured force or command meets the measured one.

    Args:
        drive: what moves the body, as ``[drive]`` of a scenario without its signal: ``{"kind": "force"}``, the default,
            takes the log's force; ``{"kind": "pid", "K_p": ..., ...}`` and ``{"kind": "spring", ...}`` its command.
        output: the motion that is met, "velocity" or "position".
        body: beside mass, for measured forces: "offset", "gravity_sin", "gravity_cos", "stiffness", "area",
            "sigma_2_by_direction", "drag", all taken at the measured position and speed; and "delay", by which that motion lags
            the force.

    The other arguments, what is returned and raised: as in :func:`stribeck.identify.methods.dynamic.fit_dynamic`;
    ``details["output_error"]`` is norm(residual)/norm(output).
    """
    drive = dict(drive or {"kind": "force"})
    _check(log, drive, output, body)
    made = velocity_problem(log, law, fixed=fixed, free=free, tied=tied, start=start, mass=mass, body=body)
    search = _Search(log, made, output, starts, seed, work or Work())
    with threadpool_limits(1):
        met = search.in_windows(bool(start)) if search.has_windows(drive) else search.of_rig(drive)
        return search.fit(met, profiles)


def _check(log: Log, drive: Mapping[str, object], output: str, body: Sequence[str]) -> None:
    """Refuse what cannot be asked of a fit of the motion.

    Raises:
        InputError: what is wrong, one line for each problem.
    """
    problems: list[str] = []
    if drive.get("kind") == "velocity" or "kind" not in drive:
        problems.append(f"drive.kind: {drive.get('kind')!r}: must be 'force', 'pid' or 'spring'")
    elif drive["kind"] != "force" and log.command is None:
        problems.append(f"drive.kind: {drive['kind']!r}: the log has no column 'command'")
    if output not in _OUTPUTS:
        problems.append(f"{arg('output')}: {output!r}: must be 'position' or 'velocity'")
    allowed = _BESIDE if drive.get("kind") == "force" else set()
    problems += [
        f"{arg('terms')}: {name!r}: has no place in a fit of the motion" for name in body if name not in allowed
    ]
    if problems:
        raise InputError(problems)


@dataclass(frozen=True)
class _Met:
    """A problem at its optimum, the residual that noise explains, in how many windows of what length it was met, and the
    share of the output that it leaves in longer ones."""

    problem: MotionProblem | RigProblem
    optimum: Optimum
    expected: float
    windows: str = ""
    farther: float = 0.0


class _Search:
    """The ways to the optimum, and the fit there.

    Args:
        log: the record.
        made: the problem the other way round, its first start, and the box of the others.
        output, starts, seed, work: as for :func:`fit_motion`.
    """

    def __init__(
        self, log: Log, made: tuple[VelocityProblem, Array, Array, Array], output: str, starts: int, seed: int, work: Work
    ) -> None:  # fmt: skip
        self.log, self.output, self.starts, self.seed, self.work = log, output, starts, seed, work
        self.inverse, self.first, self.low, self.high = made
        self.noise = output_noise(log, output)

    def has_windows(self, drive: Mapping[str, object]) -> bool:
        """Whether the body can be simulated in short windows: under the measured force."""
        law_and_mass = self.inverse.law.has_z and self.inverse.values(self.first)["mass"] > 0
        return drive == {"kind": "force"} and law_and_mass

    def the_other_way(self) -> Array:
        """The optimum of the problem the other way round, which costs a tenth."""
        starts = starting_points(self.inverse, self.first, self.low, self.high, _STARTS_THERE, self.seed)
        return multistart(self.inverse, starts, self.work).point

    def in_windows(self, started: bool) -> _Met:
        """Met in windows that grow; ``started``: from a start that was given."""
        given = first_values(self.inverse, self.starts, self.seed)
        given = [self.inverse.values(self.first), *given] if started else given
        force_noise = white_noise(self.log.force, list(self.log.runs()))
        followed = follow(
            self.inverse, self.output, given[: self.starts], self.noise, force_noise, self.work,
            lambda: self.inverse.values(self.the_other_way()),
        )  # fmt: skip
        problem = followed.problem
        expected = float(np.hypot(self.noise, problem.input_noise(followed.optimum.point, force_noise)))
        told = f"; {len(problem.windows)} windows of some {followed.seconds:.3g} s, each with a start of its own"
        return _Met(problem, followed.optimum, expected, told, followed.farther)

    def of_rig(self, drive: Mapping[str, object]) -> _Met:
        """Met over whole runs of the rig, closed loop included, from the optimum of the other way round."""
        self.work.section(0.4)
        there = self.the_other_way()
        self.work.section(0.7)
        problem = RigProblem(self.inverse, drive, self.output)
        starts = starting_points(self.inverse, there, self.low, self.high, self.starts, self.seed)
        points = [problem.begun(each) for each in starts]
        return _Met(problem, multistart(problem, points, self.work), self.noise)

    def fit(self, met: _Met, profiles: bool) -> Fit:
        """The fit with intervals, and what of the output it misses."""
        problem, optimum, inverse, log = met.problem, met.optimum, self.inverse, self.log
        if problem.misfit(optimum.point) is None:
            raise StribeckError(f"law '{problem.law.name}': no start led to a simulation that works")
        self.work.section(1.0)
        alone = optimum.agreeing < 2 and not optimum.exhausted
        noise = Noise(self.noise, met.expected, _MISSED, alone, met.farther)
        judged = judged_of(problem, optimum, log, profiles, noise, self.work)
        values = {**inverse.values(self.first), **problem.values(judged.point)}
        if isinstance(problem, MotionProblem):
            values |= _begun_in_motion(inverse, values)
        found = fit_of(inverse, inverse.point(values), judged, optimum, log, self.work)
        self.work.done(1.0)
        misfit = problem.misfit(judged.point)
        assert misfit is not None
        unit = "m" if self.output == "position" else "m/s"
        missed = f"the {self.output} is missed by {np.sqrt(np.mean(misfit**2)):.3g} {unit} rms"
        details: FitDetails = {
            **found.details,
            "output": self.output,
            "output_error": float(np.linalg.norm(misfit) / np.linalg.norm(problem.measured)),
            "output_trace": _trace(problem, judged.point, self.output),
        }
        note = f"{missed}, its noise is {self.noise:.3g} {unit}{met.windows}"
        return replace(found, details=details, notes=(note, *found.notes))


def _begun_in_motion(inverse: VelocityProblem, values: Given) -> dict[str, float]:
    """The deflections, in natural lengths, at the start of the runs that begin in motion, for the force along the measured
    motion: with none its first row would be all damping."""
    v = inverse.log.velocity
    firsts = {first_deflection(i): v[run.start] for i, run in enumerate(inverse.runs)}
    fast = {n: x for n, x in firsts.items() if n in values and abs(x) > SLIDES * float(np.max(abs(v)))}
    if not fast:
        return {}
    law = inverse.law({n: values[n] for n in inverse.law.constants() if n in values})
    bent = law.steady_deflection(np.array(list(fast.values()))) / inverse.length(values)
    return dict(zip(fast, np.clip(bent, -1.0, 1.0).tolist(), strict=True))


def _trace(problem: MotionProblem | RigProblem, u: Array, output: str) -> dict[str, Array]:
    """The measured and the simulated output, row by row."""
    log = problem.log
    measured = raw(log, output)
    fitted, rows = problem.outputs(u[None, :]), problem.rows
    if fitted is not None and output == "position" and isinstance(problem, MotionProblem):
        for part in problem.parts:
            fitted[0, part] += measured[rows[part]].mean()
    assert fitted is not None
    return {"time": log.time[rows], "velocity": log.velocity[rows], "measured": measured[rows], "fitted": fitted[0]}
