"""Simulation-error fit: the law's constants with which the simulated output meets the measured one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from stribeck import laws
from stribeck.errors import InputError, StribeckError, nearest
from stribeck.identify import uncertainty
from stribeck.identify.estimate import Fit, Prediction
from stribeck.identify.guess import Range, ranges, scales
from stribeck.identify.log import Log
from stribeck.identify.optimise import Optimum, multistart, starting_points
from stribeck.identify.problem import Coordinate, Problem, Tie
from stribeck.laws.base import Law
from stribeck.simulation.response import Response

Array = NDArray[np.float64]
Given = Mapping[str, float]

_TOLERANCE = 1e-6  # of the deflection, as a share of its natural scale: far below any sensor
_STARTS = 20
_MANY_RUNS = 200
BODY_UNITS = {"mass": "kg", "stiffness": "N/m", "offset": "N"}


class VelocityProblem(Problem):
    """Measured velocity in, force out: mass * acceleration + friction + stiffness * position + offset.

    Args:
        log: the record.
        law: the friction law.
        coordinates: what is free: constants of the law, of the body, shifts, first deflections.
        fixed: what is given; together with the free and tied ones all constants of law and body.
        tied: what follows another constant.
        shifts: constant -> the name of its coefficient: constant + coefficient * level.
        level: what shifts them, at every row.
        rows: the rows that count; all unless given.
    """

    def __init__(
        self,
        log: Log,
        law: type[Law],
        coordinates: Sequence[Coordinate],
        fixed: Given,
        tied: Mapping[str, Tie],
        shifts: Mapping[str, str] | None = None,
        level: Array | None = None,
        rows: NDArray[np.bool_] | None = None,
    ) -> None:
        self.log, self.shifts, self.level = log, dict(shifts or {}), level
        self.rows = np.ones(len(log), bool) if rows is None else rows
        measured = log.force[self.rows]
        super().__init__(law, coordinates, fixed, tied, measured, float(np.sqrt(np.mean(log.force**2))))
        structure = tuple(n for n, c in law.constants().items() if c.optional and n in fixed)
        self.response = Response(law, structure)
        self.runs = list(log.runs())
        body = set(BODY_UNITS)
        self.frictional = [i for i, c in enumerate(self.coordinates) if c.name not in body]

    def outputs(self, points: Array) -> Array | None:
        """The force at the rows that count."""
        total = self.force(points)
        return None if total is None else total[:, self.rows]

    def force(self, points: Array) -> Array | None:
        """The force at every row for each point; None where the simulation fails."""
        sets = [self.values(u) for u in points]
        own = points[:, self.frictional]
        lanes, place = _distinct(own)  # the body's constants need no simulation of their own
        friction = self._friction([sets[i] for i in lanes])
        if friction is None:
            return None
        body = np.array([[each[name] for name in BODY_UNITS] for each in sets])
        rest = np.vstack([self.log.acceleration, self.log.position, np.ones(len(self.log))])
        return np.asarray(friction[place] + body @ rest)

    def _friction(self, sets: Sequence[Given]) -> Array | None:
        constants = self.response.lanes(sets)
        with np.errstate(all="ignore"):
            length = [self.law.scales(_Values(each)).length for each in sets]
        if not np.isfinite(length[0]) or length[0] <= 0:
            return None
        gains = None
        if self.shifts:
            by_name = [{self.shifts[n]: each[self.shifts[n]] for n in self.shifts} for each in sets]
            gains = np.array([[each.get(self.shifts.get(n, ""), 0.0) for n in self.response.names] for each in by_name])
        out = np.empty((len(sets), len(self.log)))
        for number, rows in enumerate(self.runs):
            z = [each.get(first_deflection(number), 0.0) * size for each, size in zip(sets, length, strict=True)]
            part = self.response.force(
                self.log.time[rows], self.log.velocity[rows], constants, np.array(z), _TOLERANCE * length[0],
                None if self.level is None else self.level[rows], gains,
            )  # fmt: skip
            if part is None:
                return None
            out[:, rows] = part
        return out


class _Values:
    """A mapping's values as attributes."""

    def __init__(self, values: Given) -> None:
        self.__dict__.update(values)


def first_deflection(run: int) -> str:
    """The name of the deflection at the first sample of a run, in units of the law's natural length."""
    return f"z_{run}"


def _distinct(rows: Array) -> tuple[list[int], list[int]]:
    """The first of each kind of row, and for every row the place of its kind among them."""
    known: dict[bytes, int] = {}
    lanes: list[int] = []
    place = []
    for i, row in enumerate(rows):
        key = row.tobytes()
        if key not in known:
            known[key] = len(lanes)
            lanes.append(i)
        place.append(known[key])
    return lanes, place


# -- from a log and a law's name to a problem ------------------------------------------------------------------------


def velocity_problem(
    log: Log,
    law_name: str,
    *,
    fixed: Given | None = None,
    free: Sequence[str] | None = None,
    tied: Mapping[str, Tie] | None = None,
    start: Given | None = None,
    mass: float | None = None,
    stiffness: float | None = 0.0,
    offset: float | None = None,
    shifts: Sequence[str] = (),
    level: Array | None = None,
) -> tuple[VelocityProblem, Array, Array, Array]:
    """The problem of a simulation-error fit with its first start and the box of the others.

    Arguments as in :func:`fit_dynamic`.
    """
    law, fixed, tied = laws.find(law_name), dict(fixed or {}), dict(tied or {})
    free = free_constants(law, fixed, tied, free)
    body = {"mass": mass, "stiffness": stiffness, "offset": offset}
    sizes = scales(log, mass or 0.0)
    rough = ranges(law, sizes)
    given = {n: float(v) for n, v in (start or {}).items()}
    coordinates, first, box = [], [], []

    def add(coordinate: Coordinate, value: float, low: float, high: float) -> None:
        coordinates.append(coordinate)
        first.append(coordinate.inner(value))
        box.append((coordinate.inner(low), coordinate.inner(high)))

    for name in free:
        here = rough[name]
        if name in given and given[name] > 0:
            here = Range(given[name], min(here.low, given[name]), max(here.high, given[name]))
        add(Coordinate(name, law.constants()[name].unit, *here.bounds), here.value, here.low, here.high)
    for name in shifts:
        size = 0.3 * rough[name].value / float(np.max(abs(level))) if level is not None else 1.0
        unit = law.constants()[name].unit
        add(Coordinate(shift_name(name), unit, -1e3 * size, 1e3 * size, log=False, scale=size), 0.0, -size, size)
    for name, value in body.items():
        if value is None:
            add(*_body_coordinate(name, log, sizes.force, sizes.offset))
    for number, rows in enumerate(_with_own_start(log, law)):
        z = Coordinate(first_deflection(number), "", -1.0, 1.0, log=False, nuisance=True, rows=rows)
        add(z, 0.0, -0.5, 0.5)
    known = {**fixed, **{n: v for n, v in body.items() if v is not None}}
    problem = VelocityProblem(
        log, law, coordinates, known, tied, {n: shift_name(n) for n in shifts}, level if shifts else None
    )
    u, edges = np.array(first), np.array(box).reshape(-1, 2)
    problem.home = _allowed_start(problem, u)
    return problem, problem.home, edges[:, 0], edges[:, 1]


def shift_name(constant: str) -> str:
    """The name of the coefficient by which a level shifts a constant."""
    return f"{constant}_shift"


def free_constants(law: type[Law], fixed: Given, tied: Mapping[str, Tie], free: Sequence[str] | None) -> list[str]:
    """The constants to fit: those of the machine unless others are named; all are accounted for, or an error says."""
    known = law.constants()
    wanted = list(free) if free is not None else list(law.uses or law.own_constants())
    problems = [
        f"{name}: law '{law.name}' has no such constant{nearest(name, known)}"
        for name in (*wanted, *fixed, *tied)
        if name not in known
    ]
    wanted = [name for name in wanted if name not in fixed and name not in tied and name in known]
    for name, constant in known.items():
        if constant.required and name not in (*wanted, *fixed, *tied):
            problems.append(f"{name}: missing: give its value ({constant.meaning}, {constant.allowed}), or fit it")
    if problems:
        raise InputError(problems)
    if not wanted:
        raise InputError(f"law '{law.name}': every constant is given: there is nothing to fit")
    for name, constant in known.items():
        if constant.default is not None and name not in (*wanted, *fixed, *tied) and isinstance(fixed, dict):
            fixed[name] = constant.default
    return wanted


def _body_coordinate(name: str, log: Log, force: float, offset: float) -> tuple[Coordinate, float, float, float]:
    """The body's mass, spring or offset: the size that makes the friction level."""
    if name == "offset":
        return Coordinate(name, "N", -1e3 * force, 1e3 * force, log=False, scale=force), offset, -force, force
    column = log.acceleration if name == "mass" else log.position - log.position.mean()
    size = 0.1 * force / max(float(np.quantile(abs(column), 0.99)), 1e-12)
    if name == "mass":
        return Coordinate(name, "kg", 1e-6 * size, 1e6 * size), size, 0.1 * size, 10 * size
    return Coordinate(name, "N/m", -1e6 * size, 1e6 * size, log=False, scale=size), 0.0, -size, size


def _with_own_start(log: Log, law: type[Law]) -> list[slice]:
    """The runs whose first deflection is fitted; none where there are so many that starts matter little."""
    found = list(log.runs()) if law.has_z else []
    return found if len(found) <= _MANY_RUNS else []


def _allowed_start(problem: Problem, u: Array) -> Array:
    """The start, or an allowed point near it."""
    if problem.allowed(u):
        return u
    draw = np.random.default_rng(0)
    for spread in np.repeat([0.3, 1.0, 3.0], 300):
        trial = np.clip(u + spread * draw.standard_normal(len(u)), *problem.bounds)
        if problem.allowed(trial):
            return np.asarray(trial)
    told = ", ".join(f"{n} = {v:g}" for n, v in problem.fixed.items())
    raise InputError(f"law '{problem.law.name}': no values near the data's are allowed together with {told}")


# -- the fit ---------------------------------------------------------------------------------------------------------


def fit_dynamic(
    log: Log,
    law: str,
    *,
    fixed: Given | None = None,
    free: Sequence[str] | None = None,
    tied: Mapping[str, Tie] | None = None,
    start: Given | None = None,
    mass: float | None = None,
    stiffness: float | None = 0.0,
    offset: float | None = None,
    shifts: Sequence[str] = (),
    level: Array | None = None,
    starts: int = _STARTS,
    seed: int = 0,
    profiles: bool = True,
) -> Fit:
    """Fit a law's constants so that the force simulated for the measured velocity meets the measured force.

    Args:
        log: the record, SI units.
        law: the law's name, or FILE.py:NAME.
        fixed: constants that are given, such as the law's own (k_v, z_ba).
        free: constants to fit; by default those of the machine that are not given.
        tied: constants that follow another one: ``{"F_s": Tie("F_c", 1.4)}``.
        start: values to start from; the other starts fill a range around what the data suggest.
        mass: kg; None fits it.
        stiffness: of a spring to ground, N/m; None fits it.
        offset: a constant force such as gravity, N; None fits it.
        shifts: constants that ``level`` shifts: constant + coefficient * level, the coefficient being fitted.
        level: what shifts them at each row: a load, a pressure, or the direction of motion (-1 and 1).
        starts: how many starting points; the seed makes them the same each time.
        seed: of the starting points.
        profiles: find intervals from profiles of the likelihood; else from the covariance alone.

    Returns:
        The fit; its ``details["search"]`` says how the starts ended.

    Raises:
        InputError: constants are unknown, missing or not allowed; nothing moves.
        BuildError: there is no C compiler.
        StribeckError: no start led to a simulation that works.
    """
    problem, first, low, high = velocity_problem(
        log, law, fixed=fixed, free=free, tied=tied, start=start, mass=mass, stiffness=stiffness, offset=offset,
        shifts=shifts, level=level,
    )  # fmt: skip
    optimum = multistart(problem, starting_points(problem, first, low, high, starts, seed))
    return finish(problem, optimum, log, "dynamic", profiles)


def finish(problem: VelocityProblem, optimum: Optimum, log: Log, method: str, profiles: bool = True) -> Fit:
    """The fit with intervals and verdicts from an optimum.

    Raises:
        StribeckError: the optimum is no simulation that works.
    """
    if problem.misfit(optimum.point) is None:
        raise StribeckError(f"law '{problem.law.name}': no start led to a simulation that works")
    judged = uncertainty.judge(problem, optimum.point, log, profiles)
    force = problem.force(judged.point[None, :])
    assert force is not None
    values, misfit = problem.values(judged.point), log.force - force[0]
    rig = np.vstack([log.acceleration, log.position, np.ones(len(log))])
    body = np.array([values[name] for name in BODY_UNITS]) @ rig
    own = set(BODY_UNITS) | set(problem.shifts.values())
    used = problem.describe(judged.point)
    notes = [] if optimum.converged and (optimum.starts == 1 or optimum.agreeing > 1) else [optimum.verdict]
    return Fit(
        law=problem.law.name,
        method=method,
        estimates={n: e for n, e in judged.estimates.items() if n not in own},
        body={n: e for n, e in judged.estimates.items() if n in own},
        fixed=problem.fixed,
        used=used,
        names=judged.names,
        covariance=judged.covariance,
        relative_force_error=float(np.linalg.norm(misfit) / np.linalg.norm(log.force)),
        data_hash=log.hash,
        profiles=judged.profiles,
        prediction=Prediction(log.time, log.position, log.velocity, log.force - body, force[0] - body),
        notes=(*notes, *judged.notes),
        details={"search": optimum.verdict, "noise": judged.noise},
    )
