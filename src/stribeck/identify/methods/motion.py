"""Simulation-error fit the other way round: measured force or command in, motion out, closed loop included."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from stribeck.arrays import Array
from stribeck.errors import InputError, StribeckError, arg
from stribeck.identify.log import Log
from stribeck.identify.methods.dynamic import fit_of, judged_of
from stribeck.identify.methods.horizons import first_values, follow
from stribeck.identify.methods.optimise import multistart, starting_points
from stribeck.identify.models.columns import column
from stribeck.identify.models.dynamic_problem import Given, VelocityProblem, first_deflection, velocity_problem
from stribeck.identify.models.motion_problem import MotionProblem, raw, white_noise
from stribeck.identify.models.problem import Problem, Tie
from stribeck.identify.result import Fit
from stribeck.identify.statistics.verdicts import Noise
from stribeck.identify.work import Work
from stribeck.scenario import Scenario
from stribeck.signals import Points
from stribeck.simulation import simulate

_RTOL = 1e-6
_STARTS_THERE = 8
_MISSED = 0.02  # of the output's changes: a fit that leaves more, and more than noise, has missed it
_OUTPUTS = {"position": "y", "velocity": "v"}


_BESIDE = {"offset", "gravity_sin", "gravity_cos", "stiffness", "area", "sigma_2_by_direction"}


class RigProblem(Problem):
    """Measured force or command in, motion out: the rig as a scenario, from the first row of each run to its last.

    Args:
        inverse: the problem the other way round, which names the coordinates.
        drive: ``[drive]`` of a scenario without its signal: ``{"kind": "force"}`` takes the log's force, any other kind
            its command.
        output: "position" or "velocity".
    """

    step = 1e-3  # each simulation takes steps of its own: smaller differences drown in their errors

    def __init__(self, inverse: VelocityProblem, drive: Mapping[str, Any], output: str) -> None:
        self.inverse, self.log, self.kind, self.column = inverse, inverse.log, drive["kind"], _OUTPUTS[output]
        measured = self.log.position if output == "position" else self.log.velocity
        scale = float(np.sqrt(np.mean((measured - measured.mean()) ** 2)))
        super().__init__(inverse.law, inverse.coordinates, inverse.fixed, inverse.tied, measured, scale)
        self.home, self.runs = inverse.home, list(self.log.runs())
        assert self.home is not None
        signal = self.log.force if self.kind == "force" else self.log.command
        assert signal is not None
        self.signal = signal
        self.scenarios = [self._scenario(rows, drive, self.values(self.home)) for rows in self.runs]

    def _scenario(self, rows: slice, drive: Mapping[str, Any], values: Given) -> Scenario:
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

    def outputs(self, points: Array) -> Array | None:
        """The motion at every row."""
        out = np.empty((len(points), len(self.log)))
        for lane, u in enumerate(points):
            values = self.values(u)
            for number, rows in enumerate(self.runs):
                part = self._simulated(number, rows, values)
                if part is None:
                    return None
                out[lane, rows] = part
        return out

    def _beside(self, rows: slice, values: Given) -> Array:
        """What of the measured force neither moves the body nor is the law's: at the measured position and speed."""
        part = self.log.rows(rows)
        return np.asarray(
            sum((values[n] * column(n, part) for n in self.inverse.body if n != "mass"), np.zeros(len(part)))
        )

    def _simulated(self, number: int, rows: slice, values: Given) -> Array | None:
        try:
            law = self.law({n: values[n] for n in self.law.constants() if n in values})
        except InputError:
            return None
        z = values.get(first_deflection(number), 0.0) * self.length(values)
        initial = {**self.scenarios[number].initial, **({"z": z} if self.law.has_z else {})}
        time = self.log.time[rows] - self.log.time[rows][0]
        signal = Points(time, self.signal[rows] - (self._beside(rows, values) if self.kind == "force" else 0.0))
        solution = simulate(
            self.scenarios[number].with_values(law=law, mass=values["mass"], initial=initial, signal=signal)
        )
        found = solution[self.column]
        return found if solution.status == "done" and np.isfinite(found).all() else None


def fit_motion(
    log: Log,
    law: str,
    drive: Mapping[str, Any] | None = None,
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
            "sigma_2_by_direction", all taken at the measured position and speed.

    The other arguments, what is returned and raised: as in :func:`stribeck.identify.methods.dynamic.fit_dynamic`;
    ``details["output_error"]`` is norm(residual)/norm(output).
    """
    drive = dict(drive or {"kind": "force"})
    problems: list[str] = []
    if drive.get("kind") == "velocity" or "kind" not in drive:
        problems.append(f"drive.kind: {drive.get('kind')!r}: must be 'force', 'pid' or 'spring'")
    elif drive["kind"] != "force" and log.command is None:
        problems.append(f"drive.kind: {drive['kind']!r}: the log has no column 'command'")
    if output not in _OUTPUTS:
        problems.append(f"output: {output!r}: must be 'position' or 'velocity'")
    allowed = _BESIDE if drive.get("kind") == "force" else set()
    problems += [
        f"{arg('terms')}: {name!r}: has no place in a fit of the motion" for name in body if name not in allowed
    ]
    if problems:
        raise InputError(problems)
    inverse, first, low, high = velocity_problem(
        log, law, fixed=fixed, free=free, tied=tied, start=start, mass=mass, body=body
    )
    work, runs = work or Work(), list(log.runs())
    noise, force_noise = white_noise(raw(log, output), runs), white_noise(log.force, runs)

    def the_other_way() -> Array:
        return multistart(inverse, starting_points(inverse, first, low, high, _STARTS_THERE, seed), work).point

    with threadpool_limits(1):
        problem: MotionProblem | RigProblem
        plain = set(inverse.body) <= {"mass", "offset"}
        if drive == {"kind": "force"} and plain and inverse.law.has_z and inverse.values(first)["mass"] > 0:
            given = (
                first_values(inverse, starts, seed)
                if not start
                else [inverse.values(first), *first_values(inverse, starts, seed)]
            )
            followed = follow(
                inverse, output, given[:starts], noise, force_noise, work, lambda: inverse.values(the_other_way())
            )
            problem, optimum = followed.problem, followed.optimum
            expected = float(np.hypot(noise, problem.input_noise(optimum.point, force_noise)))
            farther = followed.farther
        else:
            # a start in the right place comes from the other way round, which costs a tenth
            work.section(0.4)
            there = the_other_way()
            work.section(0.7)
            problem = RigProblem(inverse, drive, output)
            optimum = multistart(problem, starting_points(problem, there, low, high, starts, seed), work)
            expected, farther = noise, 0.0
        if problem.misfit(optimum.point) is None:
            raise StribeckError(f"law '{problem.law.name}': no start led to a simulation that works")
        work.section(1.0)
        alone = optimum.agreeing < 2 and not optimum.exhausted
        judged = judged_of(problem, optimum, log, profiles, Noise(noise, expected, _MISSED, alone, farther), work)
        values = {**inverse.values(first), **problem.values(judged.point)}
        found = fit_of(inverse, inverse.point(values), judged, optimum, log, work)
        work.done(1.0)
    misfit = problem.misfit(judged.point)
    assert misfit is not None
    unit = "m" if output == "position" else "m/s"
    error = float(np.linalg.norm(misfit) / np.linalg.norm(problem.measured))
    left = f"the {output} is missed by {np.sqrt(np.mean(misfit**2)):.3g} {unit} rms, its noise is {noise:.3g} {unit}"
    if isinstance(problem, MotionProblem):
        left += f"; {len(problem.windows)} windows of some {followed.seconds:.3g} s, each with a start of its own"
    details = {
        **found.details,
        "output": output,
        "output_error": error,
        "output_trace": _trace(problem, judged.point, output),
    }
    return replace(found, details=details, notes=(left, *found.notes))


def _trace(problem: MotionProblem | RigProblem, u: Array, output: str) -> dict[str, Any]:
    """The measured and the simulated output, row by row."""
    log = problem.log
    measured = raw(log, output)
    if isinstance(problem, RigProblem):
        fitted = problem.outputs(u[None, :])
        rows = np.arange(len(log))
    else:
        fitted, rows = problem.outputs(u[None, :]), problem.rows
        if fitted is not None and output == "position":
            for part in problem.parts:
                fitted[0, part] += measured[rows[part]].mean()
    assert fitted is not None
    return {"time": log.time[rows], "velocity": log.velocity[rows], "measured": measured[rows], "fitted": fitted[0]}
