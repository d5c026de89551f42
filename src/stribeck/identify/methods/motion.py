"""Simulation-error fit the other way round: measured force or command in, motion out, closed loop included."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from stribeck.errors import InputError, StribeckError, arg
from stribeck.identify.log import Log
from stribeck.identify.methods.dynamic import fit_of
from stribeck.identify.methods.optimise import multistart, starting_points
from stribeck.identify.models.dynamic_problem import Given, VelocityProblem, first_deflection, velocity_problem
from stribeck.identify.models.problem import Problem, Tie
from stribeck.identify.result import Fit
from stribeck.identify.statistics import uncertainty
from stribeck.scenario import Scenario
from stribeck.signals import Points
from stribeck.simulation import simulate

Array = NDArray[np.float64]
_RTOL = 1e-6
_OUTPUTS = {"position": "y", "velocity": "v"}


class MotionProblem(Problem):
    """Measured force or command in, motion out: the rig as a scenario.

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

    def _simulated(self, number: int, rows: slice, values: Given) -> Array | None:
        scenario = copy.copy(self.scenarios[number])  # its numbers change, its structure does not
        scenario.__dict__.pop("threshold", None)
        try:
            scenario.law = self.law({n: values[n] for n in self.law.constants() if n in values})
        except InputError:
            return None
        scenario.mass = values["mass"]
        z = values.get(first_deflection(number), 0.0) * self.length(values)
        scenario.initial = {**scenario.initial, **({"z": z} if self.law.has_z else {})}
        time = self.log.time[rows] - self.log.time[rows][0]
        scenario.signal = Points(time, self.signal[rows] - (values.get("offset", 0.0) if self.kind == "force" else 0.0))
        solution = simulate(scenario)
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
) -> Fit:
    """Fit a law's constants so that the motion simulated for the measured force or command meets the measured one.

    Args:
        drive: what moves the body, as ``[drive]`` of a scenario without its signal: ``{"kind": "force"}``, the default,
            takes the log's force; ``{"kind": "pid", "K_p": ..., ...}`` and ``{"kind": "spring", ...}`` its command.
        output: the motion that is met, "velocity" or "position".
        body: "offset" beside mass, for measured forces.

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
    allowed = {"offset"} if drive.get("kind") == "force" else set()
    problems += [
        f"{arg('terms')}: {name!r}: has no place in a fit of the motion" for name in body if name not in allowed
    ]
    if problems:
        raise InputError(problems)
    inverse, first, low, high = velocity_problem(
        log, law, fixed=fixed, free=free, tied=tied, start=start, mass=mass, body=body
    )
    with threadpool_limits(1):
        # a start in the right place comes from the other way round, which costs a tenth
        there = multistart(inverse, starting_points(inverse, first, low, high, 8, seed))
        problem = MotionProblem(inverse, drive, output)
        points = starting_points(problem, there.point, low, high, starts, seed)
        optimum = multistart(problem, points)
        misfit = problem.misfit(optimum.point)
        if misfit is None:
            raise StribeckError(f"law '{problem.law.name}': no start led to a simulation that works")
        judged = uncertainty.judge(problem, optimum.point, log, profiles)
        found = fit_of(inverse, judged, optimum, log)
    misfit = problem.misfit(judged.point)
    assert misfit is not None
    error = float(np.linalg.norm(misfit) / np.linalg.norm(problem.measured))
    return replace(found, details={**found.details, "output": output, "output_error": error})
