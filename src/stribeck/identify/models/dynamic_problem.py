"""The problem of a simulation-error fit: measured velocity in, force out, through the compiled law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError, arg, nearest
from stribeck.identify.features.guess import Guess, ranges, sizes_of
from stribeck.identify.log import Log
from stribeck.identify.models import delay, terms
from stribeck.identify.models.problem import Coordinate, Problem, Tie
from stribeck.identify.models.terms import TERMS
from stribeck.laws.base import Law
from stribeck.laws.form import Form
from stribeck.simulation.response import Response

Given = Mapping[str, float]

_TOLERANCE = 1e-6  # of the deflection, as a share of its natural scale: far below any sensor
_MANY_RUNS = 200
_MOST_ROWS = 2_000_000  # beyond, the lanes of a derivative fill the memory
_SIGN = 0.01  # of the largest speed: what a smooth sign takes to change, for first values
_LEVELS = ("F_c", "F_s")  # what a varying friction level shifts


class VelocityProblem(Problem):
    """Measured velocity in, force out: friction and the body's terms.

    Args:
        log: the record.
        law: the friction law.
        coordinates: what is free: constants of the law, terms of the body, first deflections.
        fixed: what is given; together with the free and tied ones all constants and terms.
        tied: what follows another constant.
        body: the terms beside friction (:data:`stribeck.identify.models.terms.TERMS`). Those that vary the friction level
            shift F_c and F_s alike.
        rows: the rows that count; all unless given.
    """

    def __init__(
        self,
        log: Log,
        law: type[Law],
        coordinates: Sequence[Coordinate],
        fixed: Given,
        tied: Mapping[str, Tie],
        body: Sequence[str],
        rows: NDArray[np.bool_] | None = None,
    ) -> None:
        self.log = log
        self.rows = np.ones(len(log), bool) if rows is None else rows
        size = float(np.sqrt(np.mean(log.force**2)))
        super().__init__(law, coordinates, fixed, tied, log.force[self.rows], size)
        self.response = Response(law, form_of(law, fixed))
        self.runs = list(log.runs())
        self.levels = [name for name in body if TERMS[name].level]
        self.body = [name for name in body if not TERMS[name].level and TERMS[name].column is not None]
        self.late = "delay" in body
        longest = abs(fixed["delay"]) if "delay" in fixed else delay.longest_of(log) if self.late else 0.0
        self.within = delay.within(log, longest)  # of each run, what the motion has its force for
        self.frictional = [i for i, c in enumerate(self.coordinates) if c.name not in (*self.body, "delay")]
        self.level_columns = _columns(log, self.levels, fixed)
        self.body_columns = _columns(log, self.body, fixed)

    def with_rows(self, rows: NDArray[np.bool_]) -> VelocityProblem:
        """The same problem where other rows count."""
        before = np.concatenate([[0], np.cumsum(rows)]).tolist()
        coordinates = [
            c if c.rows is None else replace(c, rows=slice(before[run.start], before[run.stop]))
            for c, run in zip(self.coordinates, self._runs_of_coordinates(), strict=True)
        ]
        return self._with(self.log, coordinates, rows)

    def moving(self, velocity: Array) -> VelocityProblem:
        """The same problem for another velocity."""
        return self._with(self.log.with_columns(velocity=velocity), self.coordinates, self.rows)

    def _with(
        self, log: Log, coordinates: Sequence[Coordinate], rows: NDArray[np.bool_], late: bool = False
    ) -> VelocityProblem:
        body = (*self.body, *self.levels, *(["delay"] if self.late or late else []))
        other = VelocityProblem(log, self.law, coordinates, self.fixed, self.tied, body, rows)
        other.home = self.home if self.home is None or not late else np.append(self.home, 0.0)
        return other

    def with_delay(self) -> tuple[VelocityProblem, float] | None:
        """The same problem, at the rows whose force is known, with a delay that is free, and a likely one, s; None where too
        few rows are left."""
        held = {n: self.fixed[n] for n in self.fixed if n in TERMS}
        first = _first_delay(self.log, (*self.body, "delay"), held)
        coordinate, *_ = _body_coordinate("delay", self.log, 1.0, 0.0, held, first)
        other = self._with(self.log, [*self.coordinates, coordinate], self.rows, late=True)
        known = np.zeros(len(self.log), bool)
        for run in other.within:
            known[run] = True
        some = self.rows & known
        return (other.with_rows(some), first) if np.sum(some) > 0.5 * np.sum(self.rows) else None

    def _runs_of_coordinates(self) -> list[slice]:
        numbers = {first_deflection(i): run for i, run in enumerate(self.runs)}
        return [numbers.get(c.name, slice(0, 0)) for c in self.coordinates]

    def without_unseen_starts(self, u: Array) -> Array:
        """The point with no deflection at the start of the runs whose first row does not count: it is soon forgotten."""
        unseen = [run.stop > run.start and not self.rows[run.start] for run in self._runs_of_coordinates()]
        return np.where(unseen, 0.0, u)

    def outputs(self, points: Array) -> Array | None:
        """The force at the rows that count."""
        total = self.force(points)
        return None if total is None else total[:, self.rows]

    def force(self, points: Array) -> Array | None:
        """The force at every row for each point; None where the simulation fails."""
        sets = [self.values(u) for u in points]
        lanes, place = _distinct(points[:, self.frictional])  # the body's terms need no simulation of their own
        friction = self._friction([sets[i] for i in lanes])
        if friction is None:
            return None
        total = friction[place] + self.of_body(sets)
        return self._at_the_force(total, sets) if self.late else total

    def _at_the_force(self, total: Array, sets: Sequence[Given]) -> Array:
        """The force along the motion, at the rows of the force that it belongs to: the motion there is measured later. The
        measured force is not moved, as half a sample between two would take a quarter of its noise away."""
        return np.array([delay.later(self.log, x, each["delay"]) for x, each in zip(total, sets, strict=True)])

    def driving(self, force: Array, values: Given) -> Array:
        """The force, given at each row, that belongs to the motion there: that of a delay before."""
        return delay.force_of_motion(self.log, force, values["delay"]) if self.late else force

    def of_body(self, sets: Sequence[Given]) -> Array:
        """The force beside friction at every row, for each set of values."""
        return np.array([[each[name] for name in self.body] for each in sets]) @ self.body_columns

    def _friction(self, sets: Sequence[Given]) -> Array | None:
        constants = self.response.lanes(sets)
        with np.errstate(all="ignore"):
            length = [self.length(each) for each in sets]
        if not (np.isfinite(length[0]) and length[0] > 0):
            return None
        shift = None
        if self.levels:
            shift = np.array([[each[name] for name in self.levels] for each in sets]) @ self.level_columns
        out = np.empty((len(sets), len(self.log)))
        for number, rows in enumerate(self.runs):
            z = [each.get(first_deflection(number), 0.0) * size for each, size in zip(sets, length, strict=True)]
            part = self.response.force(
                self.log.time[rows], self.log.velocity[rows], constants, np.array(z), _TOLERANCE * length[0],
                None if shift is None else shift[:, rows], _LEVELS,
            )  # fmt: skip
            if part is None:
                return None
            out[:, rows] = part
        return out


def form_of(law: type[Law], given: Given) -> Form:
    """The form of the law's equations: optional constants that are given, and words."""
    constants = law.constants()
    on = tuple(n for n, c in constants.items() if c.optional and n in given)
    given_words = ((n, str(given[n])) for n, c in constants.items() if c.choices and n in given)
    return Form(on, tuple((n, word) for n, word in given_words if word != constants[n].choices[0]))


def _columns(log: Log, names: Sequence[str], given: Given) -> Array:
    held = {n: float(x) for n, x in given.items() if n in TERMS}
    return np.array([terms.column(n, log, held) for n in names]).reshape(len(names), len(log))


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
    body: Sequence[str] = ("offset",),
) -> tuple[VelocityProblem, Array, Array, Array]:
    """The problem of a simulation-error fit with its first start and the box of the others.

    Arguments as in :func:`stribeck.identify.methods.dynamic.fit_dynamic`.
    """
    if len(log) > _MOST_ROWS:
        raise InputError(
            f"{arg('data')}: {len(log)} rows: a simulation takes at most {_MOST_ROWS}; cut the log, or use "
            f"{arg('method')} static"
        )
    law, fixed, tied = laws.find(law_name), dict(fixed or {}), dict(tied or {})
    held = {name: fixed.pop(name) for name in list(fixed) if name in TERMS}
    free = free_constants(law, fixed, tied, free)
    body = terms.complete(["mass", *body, *held], held)
    terms.check(tuple(body), log)
    if unknown := [n for n in dict.fromkeys(TERMS[name].of for name in body) if n and n not in held]:
        raise InputError([f"{arg('terms')}: {n}: a static fit looks for it; must be given here" for n in unknown])
    if mass is not None:
        held["mass"] = mass
    if (most := delay.longest_of(log)) < abs(held.get("delay", 0.0)):
        raise InputError(f"{arg('constants.delay')}: {held['delay']:g}: must be from {-most:.3g} to {most:.3g} s here")
    if any(TERMS[name].level for name in body) and "F_c" not in law.constants():
        raise InputError(f"{arg('terms')}: law '{law.name}' has no friction level F_c that could vary")
    late = _first_delay(log, body, held)
    moved = log.with_columns(force=delay.force_of_motion(log, log.force, late))
    beside = _first_of_beside(moved, body, held)
    sizes = sizes_of(_less(moved, {**beside, **{n: held[n] for n in body if n in held and n != "mass"}}), mass or 0.0)
    found: list[tuple[Coordinate, float, float, float]] = []
    for name in free:
        here = ranges(law, sizes)[name]
        if start and start.get(name, 0.0) > 0:
            given = float(start[name])
            here = Guess(given, min(here.low, given), max(here.high, given), here.reach)
        unit = law.constants()[name].unit
        found.append((Coordinate(name, unit, *here.bounds), here.value, here.low, here.high))
    for name in body:
        if name not in held:
            coordinate, value, lowest, highest = _body_coordinate(name, log, sizes.force, sizes.offset, held, late)
            value = beside.get(name, value)
            found.append((coordinate, value, min(lowest, value), max(highest, value)))
    for number, rows in enumerate(_with_own_start(log, law)):
        z = Coordinate(first_deflection(number), "", -1.0, 1.0, log=False, nuisance=True, rows=rows)
        found.append((z, 0.0, -0.5, 0.5))
    problem = VelocityProblem(log, law, [c for c, *_ in found], {**fixed, **held}, tied, body)
    points = np.array([[c.inner(x) for x in values] for c, *values in found])
    problem.home = _allowed_start(problem, points[:, 0])
    return problem, problem.home, points[:, 1], points[:, 2]


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


def _body_coordinate(
    name: str, log: Log, force: float, offset: float, held: Given, late: float
) -> tuple[Coordinate, float, float, float]:
    """A term of the body with a first value and the range of the starts: what makes a tenth of the friction level."""
    term = TERMS[name]
    if name == "delay":
        step, most = log.step, delay.longest_of(log)
        low, high = max(late - 3 * step, -most), min(late + 3 * step, most)
        return Coordinate(name, term.unit, -most, most, log=False, scale=step), late, low, high
    if name == "offset":
        return Coordinate(name, term.unit, -1e3 * force, 1e3 * force, log=False, scale=force), offset, -force, force
    column = _columns(log, [name], held)[0]
    varies = column - column.mean() if name == "stiffness" else column
    size = 0.1 * force / max(float(np.quantile(abs(varies), 0.99)), 1e-12)
    if term.positive:
        return Coordinate(name, term.unit, 1e-6 * size, 1e6 * size), size, 0.1 * size, 10 * size
    return Coordinate(name, term.unit, -1e6 * size, 1e6 * size, log=False, scale=size), 0.0, -size, size


def _first_of_beside(log: Log, body: Sequence[str], held: Given) -> dict[str, float]:
    """First values of what the force holds beside inertia, friction and offset, such as an arm's weight: by least squares
    beside these, as else they would be taken for friction."""
    wanted = [n for n in body if n not in (*held, "mass", "offset", "delay") and not TERMS[n].level]
    if not wanted:
        return {}
    matrix = np.array(_plain(log, [*wanted, *(n for n in ("mass", "offset") if n not in held)], held)).T
    size = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
    rest = _less(log, {n: x for n, x in held.items() if TERMS[n].column is not None and not TERMS[n].level}).force
    values = (np.linalg.lstsq(matrix / size, rest, rcond=1e-9)[0] / size).tolist()
    return {n: x for n, x in zip(wanted, values, strict=False) if x > 0 or not TERMS[n].positive}


def _first_delay(log: Log, body: Sequence[str], held: Given) -> float:
    """The delay that is given, or else likely beside plain friction, s; 0 where it is no term."""
    if "delay" not in body or "delay" in held:
        return float(held.get("delay", 0.0))
    beside = [n for n in body if TERMS[n].column is not None and not TERMS[n].level]
    return delay.likely(log, _plain(log, beside, held), delay.longest_of(log))


def _plain(log: Log, names: Sequence[str], held: Given) -> list[Array]:
    """Columns of plain friction behind those of the terms."""
    slow = _SIGN * float(np.max(abs(log.velocity)))
    return [*_columns(log, names, held), np.tanh(log.velocity / max(slow, 1e-300)), log.velocity]


def _less(log: Log, values: Given) -> Log:
    """The record without the force of these terms."""
    known = {n: x for n, x in values.items() if TERMS[n].column is not None and not TERMS[n].level}
    if not known:
        return log
    return log.with_columns(force=log.force - np.array(list(known.values())) @ _columns(log, list(known), values))


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
