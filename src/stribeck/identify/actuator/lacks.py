"""Effects that the model may lack: one table of forms, each as derivatives of all plain residuals.

A friction term of size 0 does not change the machine's own derivatives. To first order, it acts as an external force along
the simulated motion. So all terms, of any law, are simulated in parallel as loads on the same machine.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import NEUTRAL, MachineCoordinate, paths
from stribeck.identify.actuator.drawn import change_by
from stribeck.identify.actuator.inputs import STILL, RecordedInput, number_at
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Channel
from stribeck.identify.actuator.runs import RecordedRun, rms
from stribeck.identify.core.library import UNNOTICED
from stribeck.identify.models.forms import WIDTHS, in_words
from stribeck.identify.models.over_position import direction_within, travel
from stribeck.scenario.changes import unused_prefix

BENDS = (0.02, 0.05, 0.12, 0.3, 0.6)  # Stribeck velocities that are tried, of the fastest speed, by factors of 2.5
CLOCK = 1e-3  # s/s: the drift of a computer's clock is smaller
_ON = "lacks"  # name of the loads that apply the terms
_STEP = 1e-3  # of the contact's friction: the size of a tried term, linear and far above the solver's error
_FORCES = (".f", ".torque")  # the columns of forces
_TURNED = 0.3  # rad: over a smaller range, a weight acts as a constant
_SMOOTHING = (".k_v", ".z_ba")  # parameters of the model, not of the machine
_FAINT = 1e-9  # relative square of what a column adds to others: below it lies the rounding of an interpolated motion
_HALF = 0.5  # of a fixed number, to either side: bounds of its coordinate
_BY = "level by "  # begins the name of friction that grows with another force of the machine
_IN_WORDS = {  # what only the forward fit has
    "offset": "a constant force", "level by direction": "a friction level that differs by direction",
    "level by turn": "a friction level that changes with the angle",
}  # fmt: skip
AtSpeed = Callable[[Array, Array], Array]  # a term's contribution to the steady level, from level and speed


@dataclass(frozen=True)
class MissingForm:
    """An effect that the model may lack.

    Attributes:
        name: forms of one name are used together, such as sine and cosine; ``label``: what it is called in the result.
        slopes: of all plain residuals, by one unit.
        largest: the largest coefficient that may go unnoticed in a record.
        tell: a function that describes a coefficient in words.
        contact, at: for a friction term: its contact, and its contribution to the steady level there.
    """

    name: str
    slopes: Array
    largest: float
    tell: Callable[[float], str] = field(repr=False)
    label: str
    contact: str = ""
    at: AtSpeed | None = None


@dataclass(frozen=True)
class RunMotion:
    """The simulated columns of each run on its grid, the times, and the speeds in each contact."""

    runs: list[dict[str, Array]]

    @classmethod
    def of(cls, problem: MachineProblem, u: Array) -> RunMotion:
        """The motion at the point ``u``."""
        columns = [c.name for c in problem.runs[0].scenario.system.columns]
        columns = [name for name in columns if name.endswith((".y", ".v", ".w", ".F", *_FORCES))]
        motions = []
        for k, run in enumerate(problem.runs):
            grid = run.grid
            whole = replace(run, targets=[Channel(name, grid, grid) for name in columns])
            predicted = problem.predicted(whole, k, u[None])
            motions.append({name: x[0] for name, x in zip(columns, predicted, strict=True)} | {"t": grid})
        return cls(motions)

    def each(self, name: str) -> list[Array]:
        """A column of each run."""
        return [x[name] for x in self.runs]

    def column(self, name: str) -> Array:
        """A column over all runs."""
        return np.concatenate(self.each(name))


def missing_forms(problem: MachineProblem, u: Array, motion: RunMotion, words: Mapping[str, str]) -> list[MissingForm]:
    """All possibly missing forms that move the plain residuals; ``words``: for paths and contacts in their labels."""
    problem = problem.without_whitening()
    r = problem.residuals(u[None])[0]
    every = [
        *_friction(problem, u, motion, words),
        *_fixed(problem, u, words),
        *_sensors(problem, u, r, words),
        *_inputs(problem, u, r),
    ]
    return [x for x in every if np.isfinite(x.slopes).all() and x.slopes @ x.slopes > 0]


def forms_in_words(chosen: Mapping[str, float], every: Sequence[MissingForm]) -> str:
    """Forms with their coefficients, in words."""
    return ", ".join(form.tell(chosen[form.name]) for form in every if form.name in chosen)


# -- friction --------------------------------------------------------------------------------------------------------------


def _friction(problem: MachineProblem, u: Array, motion: RunMotion, words: Mapping[str, str]) -> Iterator[MissingForm]:
    """The friction terms that a machine's contacts may lack. A unit has the rms of the contact's friction.

    A term on a body that can move is simulated as a load. In a contact of prescribed motion it adds to the measured friction.
    """
    contacts = problem.runs[0].scenario.data.get("contacts", {})
    terms: list[tuple[str, str, list[Array], AtSpeed | None]] = []
    added: list[MachineCoordinate] = []
    for contact in contacts:
        friction = rms(motion.each(f"{contact}.F"))
        for term, forces, at in _terms(problem, u, motion, contact):
            if not (friction > 0 and (size := rms(forces)) > 0):
                continue
            name, size = f"{_ON}.{contact}.{term}", friction / size
            if _loads(problem.runs[0], contact):
                terms.append((contact, term, forces, at))
                added.append(MachineCoordinate(name, -size, size, 0.0, None, {name: 1.0}))
            elif (slopes := _of_force(problem, motion, contact, forces)) is not None:
                yield _form(contact, term, size * slopes, at and _times(at, size), words)
    if not terms:
        return
    runs = []
    for k, run in enumerate(problem.runs):
        loads = {contact: _loads(run, contact) for contact in contacts}
        tables: dict[str, object] = {
            path: {"on": body, "kind": "signal", "signal": STILL}
            for paths in loads.values() for path, (body, _) in paths.items()
        }  # fmt: skip
        played = {
            c.name: {f"{path}.signal": share * forces[k] for path, (_, share) in loads[contact].items()}
            for c, (contact, _, forces, _) in zip(added, terms, strict=True)
        }
        runs.append(replace(run, scenario=run.scenario.with_changes(tables), played=played))
    whole = replace(problem, runs=runs, sought=[*problem.sought, *added])
    points = np.repeat(np.append(u, [c.inner(0.0) for c in added])[None], len(added) + 1, axis=0)
    for i, c in enumerate(added):
        points[i + 1, len(u) + i] = c.inner(_STEP * c.high)
    r = whole.residuals(points)
    for c, (contact, term, _, at), slopes in zip(added, terms, (r[1:] - r[0]) / _STEP, strict=True):
        yield _form(contact, term, slopes, at and _times(at, c.high), words)


def _form(contact: str, term: str, slopes: Array, at: AtSpeed | None, words: Mapping[str, str]) -> MissingForm:
    """A friction term as a form."""
    kind = term.removesuffix(" sin").removesuffix(" cos")
    text = _IN_WORDS.get(kind) or in_words(kind)
    if text == kind and kind.startswith(_BY):
        text = f"friction that grows with {kind.removeprefix(_BY)}"
    of = "the friction" if contact in words else f"{contact}.F"
    label = words.get(contact, f"{contact}: ") + text
    return MissingForm(f"{contact}: {kind}", slopes, UNNOTICED, _of_friction(text, of), label, contact, at)


def _of_force(problem: MachineProblem, motion: RunMotion, contact: str, forces: Sequence[Array]) -> Array | None:
    """The change of the residuals by a force in the measured friction of a contact, given by run; None without a change.

    A force that the fitted errors of this column and its further terms contain, such as its offset, is no form of its own.
    """
    column = f"{contact}.F"
    fitted = [c.output[1] for c in problem.sought if c.output is not None and c.output[0] == column]
    direct, known = np.zeros(problem.size), np.zeros((problem.size, len(fitted)))
    for k, target, rows in problem.pieces:
        if target.column == column:
            noise = problem.noise[column]
            direct[rows] = np.interp(target.t, motion.runs[k]["t"], forces[k]) / noise
            for i, name in enumerate(fitted):
                known[rows, i] = target.beside.get(name, 1.0 if name == "offset" else 0.0)
    left = direct - known @ np.linalg.lstsq(known, direct, rcond=None)[0]
    return direct if left @ left > _FAINT * (direct @ direct) else None


def _times(at: AtSpeed, size: float) -> AtSpeed:
    return lambda level, v: size * at(level, v)


def _of_friction(text: str, of: str) -> Callable[[float], str]:
    return lambda x: f"{text} ({100 * abs(x):.2g} % of {of})"


def _loads(run: RecordedRun, contact: str) -> dict[str, tuple[str, float]]:
    """The loads that apply a contact's terms: the body, which a force can move, and its share of the friction.

    There are none on a body of prescribed motion.
    """
    table, data = run.scenario.data["contacts"][contact], run.scenario.data["bodies"]
    prefix = unused_prefix(run.scenario.data, f"{_ON}_")
    bodies = {"from": (table["from"], -table.get("ratio", 1.0)), "to": (table.get("to", "ground"), 1.0)}
    return {
        f"loads.{prefix}{contact}_{end}": (body, share)
        for end, (body, share) in bodies.items() if body != "ground" and "velocity" not in data[body]
    }  # fmt: skip


def _bend(speed: float) -> AtSpeed:
    return lambda level, v: level * np.exp(-((v / speed) ** 2))


def _terms(
    problem: MachineProblem, u: Array, motion: RunMotion, contact: str
) -> Iterator[tuple[str, list[Array], AtSpeed | None]]:
    """The terms of a contact by name: the force of one unit in every run, and the contribution to the steady level."""
    scenario = problem.runs[0].scenario
    table = scenario.data["contacts"][contact]
    start, end, ratio = table["from"], table.get("to", "ground"), table.get("ratio", 1.0)
    w, y = motion.each(f"{contact}.w"), motion.each(f"{start}.y")
    other = motion.each(f"{end}.y") if end != "ground" else [0.0 * x for x in y]
    d = [ratio * x - z for x, z in zip(y, other, strict=True)]
    path = f"contacts.{contact}.law"
    given = scenario.elements.values.get((path, "sigma_2"), 0.0)
    viscous = problem.numbers(u).get(f"{path}.parameters.sigma_2", given) or 0.0
    level = [x - viscous * v for x, v in zip(motion.each(f"{contact}.F"), w, strict=True)]
    fastest = max(float(np.max(abs(x))) for x in w)
    if not (np.isfinite(fastest) and fastest > 0 and all(np.isfinite(x).all() for x in level)):
        return
    steady: dict[str, AtSpeed] = {f"bend {share} square": _bend(share * fastest) for share in BENDS}
    steady |= {"growth 2.0": lambda _, v: v * abs(v), "growth 3.0": lambda _, v: v**3}
    if not viscous:
        steady["viscous friction"] = lambda _, v: v
    for name, at in steady.items():
        yield name, [at(x, v) for x, v in zip(level, w, strict=True)], at

    def grown(by: Sequence[Array]) -> list[Array]:
        return [x * z for x, z in zip(level, by, strict=True)]

    further = {
        "offset": [np.ones_like(x) for x in w], "level by direction": [abs(x) for x in level],
        "uneven slope": [abs(x) for x in w], "spring": d, "level by position": grown(d),
        "level by time": grown(motion.each("t")),
    }  # fmt: skip
    if not scenario.elements.laws[path].has_z:  # presliding, which other laws have
        way = max(travel(x, v) for x, v in zip(d, w, strict=True))
        for width in WIDTHS if way > 0 else ():
            further[f"play {np.format_float_positional(width)}"] = [
                abs(x) * direction_within(z, v[0], (v[1] - v[0]) / (t[1] - t[0]), width * way) - x
                for x, z, v, t in zip(level, d, w, motion.each("t"), strict=True)
            ]
    if scenario.system.elements.bodies[start].turns and max(float(np.ptp(x)) for x in d) > _TURNED:
        for name, wave in (("sin", np.sin), ("cos", np.cos)):
            further[f"weight {name}"] = [wave(x) for x in d]
            further[f"level by turn {name}"] = grown(further[f"weight {name}"])
    for name in motion.runs[0] if not table.get("loads") else ():  # otherwise the machine declares its growth
        if name.endswith(_FORCES) and not problem.of_guide(name) and np.ptp(abs(motion.runs[0][name])) > 0:
            further[_BY + name] = grown([abs(x) for x in motion.each(name)])
    for name, rows in further.items():
        yield name, rows, None


# -- fixed numbers, sensors, inputs ----------------------------------------------------------------------------------------


def _fixed(problem: MachineProblem, u: Array, words: Mapping[str, str]) -> Iterator[MissingForm]:
    """The machine's fixed numbers that are equal in all recordings. A unit is a factor of e."""
    sought, fixed = paths(problem.sought), dict[str, float]()
    for path in problem.runs[0].scenario.places:
        if (
            path in sought
            or ".initial." in path
            or ".signal." in path
            or path.endswith(_SMOOTHING)
            or problem.of_guide(path)
        ):
            continue
        values = {number_at(run.scenario, path) for run in problem.runs}
        x = values.pop()
        if x and not values:
            fixed[path] = x
    if not fixed:
        return
    added = []
    for path, x in fixed.items():
        low, high = sorted((x * (1 - _HALF), x * (1 + _HALF)))
        added.append(MachineCoordinate(path, low, high, x, None, {path: 1.0}))
    whole = replace(problem, sought=[*problem.sought, *added])
    there = np.append(u, [c.inner(fixed[c.name]) for c in added])
    J = whole.slopes(there[None], by=range(len(u), len(there)))[1][0]
    for c, slopes in zip(added, J.T, strict=True):
        x, label = fixed[c.name], words.get(c.name, c.name)
        yield MissingForm(c.name, slopes / c.slope(c.inner(x)) * x, UNNOTICED, _of_number(label, x), label)


def _of_number(label: str, now: float) -> Callable[[float], str]:
    return lambda x: f"{label} = {now * float(np.exp(np.clip(x, -3, 3))):.4g} in place of {now:.4g}"


def errors_of_sensor(t: Array, x: Array) -> dict[str, Array]:
    """By how much a sensor of the column ``x`` errs for each unit of its clock (s/s), delay (s), gain and offset."""
    rate = np.gradient(x, t) if len(t) > 1 else np.zeros(len(t))
    return {"clock": -rate * t, "delay": -rate, "gain": x, "offset": np.ones(len(t))}


def _sensors(problem: MachineProblem, u: Array, r: Array, words: Mapping[str, str]) -> Iterator[MissingForm]:
    """Delay (s), clock (s/s), gain and offset of each column, of all recordings and of each."""
    every: dict[tuple[str, str], dict[int, Array]] = {}
    step, span = dict.fromkeys(problem.noise, 0.0), dict.fromkeys(problem.noise, 0.0)
    columns = [x[0] for k, run in enumerate(problem.runs) for x in problem.predicted(run, k, u[None])]
    for (k, target, _), x in zip(problem.pieces, columns, strict=True):
        if len(target.t) > 2:
            name = target.column
            for what, error in errors_of_sensor(target.t, x).items():
                every.setdefault((name, what), {})[k] = error
            step[name] = max(step[name], float(np.median(np.diff(target.t))))
            span[name] = max(span[name], float(np.ptp(target.x)))
    slopes = {key: _of_errors(problem, u, r, key[0], errors) for key, errors in every.items()}
    names, units = _files(problem), {c.name: c.unit for c in problem.runs[0].scenario.system.columns}
    sought = {(c.output, c.log) for c in problem.sought}
    for (name, what), x in slopes.items():
        largest = {"clock": CLOCK, "delay": step[name], "gain": UNNOTICED, "offset": UNNOTICED * span[name]}[what]
        unit = {"clock": "s/s", "delay": "s", "gain": ""}.get(what, units.get(name, ""))
        if ((name, what), None) in sought or not largest > 0:
            continue
        for log, file in names.items():
            if ((name, what), log) not in sought:
                path = f"outputs.{name}.{what}" if log is None else f"log.{log}.outputs.{name}.{what}"
                label, neutral = words.get(path, path), NEUTRAL[what]
                tell = _of_sensor(label, neutral, file, unit)
                yield MissingForm(path, np.where(rows_of(problem, log), x, 0.0), largest, tell, label)


def _of_errors(problem: MachineProblem, u: Array, r: Array, column: str, errors: Mapping[int, Array]) -> Array:
    """The change of the residuals if a sensor reads more by some errors, given by run; a guide follows the corrected values."""
    direct = np.zeros(problem.size)
    for k, target, rows in problem.pieces:
        if target.column == column and k in errors:
            direct[rows] = errors[k] / problem.noise[column]
    body = column.rpartition(".")[0]
    pull = f"loads.{problem.guide}pull_{body}.signal"
    if not problem.guide or all(pull not in run.inputs for run in problem.runs):
        return direct
    ranges = [float(np.ptp(t.x)) for k, t, _ in problem.pieces if t.column == column and k in errors]
    size = _STEP * max(ranges) / max(float(np.max(abs(x))) for x in errors.values())
    runs = list(problem.runs)
    for k, target, _ in problem.pieces:
        if target.column == column and k in errors:
            link, drive = runs[k].scenario.data["links"][f"{problem.guide}spring_{body}"], runs[k].inputs[pull]
            error = np.interp(drive.t, target.t, size * errors[k])
            force = link["damping"] * error
            if column.endswith(".y"):
                force = link["stiffness"] * error + link["damping"] * np.gradient(error, drive.t)
            runs[k] = runs[k].driven({**runs[k].inputs, pull: replace(drive, x=drive.x - force)})
    return direct + change_by(problem, u, r, runs) / size


def _files(problem: MachineProblem) -> dict[int | None, str]:
    """All recordings together, without a name, and each of several by its file."""
    names: dict[int | None, str] = {run.log: run.name for run in problem.runs}
    return {None: ""} | (names if len(names) > 1 else {})


def _of_sensor(label: str, neutral: float, file: str, unit: str) -> Callable[[float], str]:
    return lambda x: f"{label}{f' ({file})' if file else ''} = {x + neutral:.3g} {unit}".rstrip()


def rows_of(problem: MachineProblem, log: int | None) -> Array:
    """A mask of the residuals of one recording, or of all."""
    mask = np.zeros(problem.size, bool)
    for k, run in enumerate(problem.runs):
        mask[problem.first[k] : problem.first[k + 1]] = log in (None, run.log)
    return mask


def _inputs(problem: MachineProblem, u: Array, r: Array) -> Iterator[MissingForm]:
    """Other interpolations of the inputs between samples. A unit is the complete change."""

    def instead(other: Callable[[RecordedInput], RecordedInput]) -> Array:
        drives = [{path: other(x) for path, x in run.inputs.items()} for run in problem.runs]
        return change_by(problem, u, r, [run.driven(x) for run, x in zip(problem.runs, drives, strict=True)])

    every = [x for run in problem.runs for x in run.inputs.values()]
    if any(not x.spline for x in every):
        held = not all(x.held for x in every if not x.spline)
        words = f"inputs {'held' if held else 'linear'} between samples (held = {str(held).lower()})"
        off = instead(lambda x: replace(x, held=held and not x.spline))
        yield MissingForm("inputs", off, 1.0, lambda x: f"{words}, {100 * x:.3g} % of this change", words)
    if any(x.smooth() is not x for x in every):
        bend, off = "inputs smooth between samples", instead(RecordedInput.smooth)
        yield MissingForm("inputs smooth", off, 1.0, lambda x: f"{bend}, {100 * x:.3g} % of this change", bend)
