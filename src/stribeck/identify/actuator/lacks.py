"""Effects that the model may lack: one table of forms, each as derivatives of all residuals.

A friction term of size 0 does not change the machine's own derivatives. To first order, it acts as an external force along
the simulated motion. So all terms, of any law, are simulated in parallel as loads on the same machine.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate, paths
from stribeck.identify.actuator.problem import MachineProblem, number_at
from stribeck.identify.actuator.runs import Compared, RecordedRun
from stribeck.identify.core.library import LARGEST
from stribeck.scenario.changes import unused_prefix

BENDS = (0.02, 0.05, 0.12, 0.3, 0.6)  # Stribeck velocities that are tried, of the fastest speed, by factors of 2.5
CLOCK = 1e-3  # s/s: the drift of a computer's clock is smaller
_ON = "lacks"  # name of the loads that apply the terms
_STEP = 1e-3  # of the contact's friction: the size of a tried term
_FORCES = (".f", ".torque")  # the columns of forces
_TURNED = 0.3  # rad: over a smaller range, a weight acts as a constant
_SMOOTHING = (".k_v", ".z_ba")  # parameters of the model, not of the machine
_HALF = 0.5  # of a fixed number, to either side: bounds of its coordinate
AtSpeed = Callable[[Array, Array], Array]  # a term's contribution to the steady level, from level and speed


@dataclass(frozen=True)
class MissingForm:
    """An effect that the model may lack.

    Attributes:
        name: forms of one name are used together, such as sine and cosine.
        slopes: of all residuals, by one unit.
        largest: the largest coefficient that may go unnoticed in a record.
        tell: a function that describes a coefficient in words.
        contact, at: for a friction term: its contact, and its contribution to the steady level there.
    """

    name: str
    slopes: Array
    largest: float
    tell: Callable[[float], str] = field(repr=False)
    contact: str = ""
    at: AtSpeed | None = None


@dataclass(frozen=True)
class RunMotion:
    """The simulated columns of each run on its grid, the times, and the speeds in each contact."""

    ways: list[dict[str, Array]]

    @classmethod
    def of(cls, problem: MachineProblem, u: Array) -> RunMotion:
        """The motion at the point ``u``."""
        return cls([_way(problem, run, k, u) for k, run in enumerate(problem.runs)])

    def column(self, name: str) -> Array:
        """A column over all runs."""
        return np.concatenate([x[name] for x in self.ways])


def missing_forms(problem: MachineProblem, u: Array, motion: RunMotion) -> list[MissingForm]:
    """All possibly missing forms that move the residuals."""
    r = problem.residuals(u[None])[0]
    every = [
        *_friction(problem, u, motion),
        *_fixed(problem, u),
        *_sensors(problem, u),
        *_inputs(problem, u, r),
        *_begun(problem, u, r),
    ]
    return [x for x in every if np.isfinite(x.slopes).all() and x.slopes @ x.slopes > 0]


def _way(problem: MachineProblem, run: RecordedRun, k: int, u: Array) -> dict[str, Array]:
    """The columns of a run from which terms are computed, on its grid, and the times."""
    grid: Array = np.arange(run.scenario.rows, dtype=float) * run.scenario.output.step
    columns = [c.name for c in run.scenario.system.columns if c.name.endswith((".y", ".v", ".w", ".F", *_FORCES))]
    wanted = replace(run, targets=[Compared(name, grid, grid) for name in columns])
    found = {name: x[0] for name, x in zip(columns, problem.predicted(wanted, k, u[None]), strict=True)}
    return {**found, "t": grid + float(run.piece or 0.0)}


def _friction(problem: MachineProblem, u: Array, motion: RunMotion) -> Iterator[MissingForm]:
    """The friction terms that a machine's contacts may lack. A unit has the rms of the contact's friction."""
    terms: dict[str, tuple[str, str, list[Array], AtSpeed | None]] = {}
    sizes: dict[str, float] = {}
    for contact in problem.runs[0].scenario.data.get("contacts", {}):
        friction = _mean([x[f"{contact}.F"] for x in motion.ways])
        for term, rows, at in _terms(problem, u, motion.ways, contact) if _ends(problem.runs[0], contact) else ():
            if friction > 0 and (size := _mean(rows)) > 0:
                name = f"{_ON}.{contact}.{term}"
                terms[name], sizes[name] = (contact, term, rows, at), friction / size
    if not terms:
        return
    runs = []
    for k, run in enumerate(problem.runs):
        whole = run.scenario.with_changes(_loads(run))
        played = {name: _played(run, contact, rows[k]) for name, (contact, _, rows, _) in terms.items()}
        runs.append(replace(run, scenario=whole, played=played, otherwise=()))
    added = [MachineCoordinate(name, -x, x, 0.0, None, {name: 1.0}) for name, x in sizes.items()]
    own = replace(problem, runs=runs, sought=[*problem.sought, *added], noise=dict(problem.noise))
    points = np.repeat(np.append(u, [c.inner(0.0) for c in added])[None], len(added) + 1, axis=0)
    for i, c in enumerate(added):
        points[i + 1, len(u) + i] = c.inner(_STEP * c.high)
    r = own.residuals(points)
    for (name, (contact, term, _, at)), slopes in zip(terms.items(), (r[1:] - r[0]) / _STEP, strict=True):
        group = f"{contact}: {term.removesuffix(' sin').removesuffix(' cos')}"
        adds = None if at is None else _times(at, sizes[name])
        yield MissingForm(group, slopes, LARGEST, _of_friction(contact, term), contact, adds)


def _times(at: AtSpeed, size: float) -> AtSpeed:
    return lambda level, v: size * at(level, v)


def _of_friction(contact: str, term: str) -> Callable[[float], str]:
    return lambda x: f"{term} of {100 * abs(x):.2g} % of the friction of {contact}"


def _mean(rows: Sequence[Array]) -> float:
    """The root mean square."""
    return float(np.sqrt(np.mean(np.concatenate(rows) ** 2)))


def _ends(run: RecordedRun, contact: str) -> dict[str, tuple[str, float]]:
    """The bodies at a contact that a force can move, and the share of the friction on each; none for a prescribed motion."""
    table, data = run.scenario.data["contacts"][contact], run.scenario.data["bodies"]
    found = {"from": (table["from"], -table.get("ratio", 1.0)), "to": (table.get("to", "ground"), 1.0)}
    return {end: x for end, x in found.items() if x[0] != "ground" and "velocity" not in data[x[0]]}


def _on(run: RecordedRun) -> str:
    """The prefix of the loads' names."""
    return unused_prefix(run.scenario.data, f"{_ON}_")


def _loads(run: RecordedRun) -> dict[str, object]:
    """The loads that apply the terms, one for each body at a contact."""
    still = {"kind": "points", "t": [0.0, 1.0], "value": [0.0, 0.0]}
    return {
        f"loads.{_on(run)}{contact}_{end}": {"on": body, "kind": "signal", "signal": still}
        for contact in run.scenario.data["contacts"]
        for end, (body, _) in _ends(run, contact).items()
    }


def _played(run: RecordedRun, contact: str, force: Array) -> dict[str, Array]:
    """A friction force as signals of the loads on the bodies at a contact."""
    return {f"loads.{_on(run)}{contact}_{end}.signal": share * force for end, (_, share) in _ends(run, contact).items()}


def _bend(speed: float) -> Callable[[Array, Array], Array]:
    return lambda level, v: level * np.exp(-((v / speed) ** 2))


def _terms(
    problem: MachineProblem, u: Array, ways: list[dict[str, Array]], contact: str
) -> Iterator[tuple[str, list[Array], AtSpeed | None]]:
    """The terms of a contact by name: the force of one unit in every run, and the contribution to the steady level."""
    scenario = problem.runs[0].scenario
    table = scenario.data["contacts"][contact]
    start, end, ratio = table["from"], table.get("to", "ground"), table.get("ratio", 1.0)
    w = [x[f"{contact}.w"] for x in ways]
    d = [ratio * x[f"{start}.y"] - (x[f"{end}.y"] if end != "ground" else 0.0) for x in ways]
    path = f"contacts.{contact}.law"
    viscous = (
        problem.values(u).get(f"{path}.parameters.sigma_2", scenario.elements.values.get((path, "sigma_2"), 0.0)) or 0.0
    )
    level = [x[f"{contact}.F"] - viscous * x[f"{contact}.w"] for x in ways]
    fastest = max(float(np.max(abs(x))) for x in w)
    if not (np.isfinite(fastest) and fastest > 0 and all(np.isfinite(x).all() for x in level)):
        return
    steady: dict[str, AtSpeed] = {f"bend below {share * fastest:.2g}": _bend(share * fastest) for share in BENDS}
    steady |= {"drag": lambda _, v: v * abs(v), "cubic drag": lambda _, v: v**3}
    if not viscous:
        steady["viscous friction"] = lambda _, v: v
    for name, at in steady.items():
        yield name, [at(x, v) for x, v in zip(level, w, strict=True)], at
    further = {
        "offset": [np.ones_like(x) for x in w], "level by direction": [abs(x) for x in level],
        "viscous by direction": [abs(x) for x in w], "spring": d,
        "level by position": [x * y for x, y in zip(level, d, strict=True)],
        "level by time": [x * y["t"] for x, y in zip(level, ways, strict=True)],
    }  # fmt: skip
    if scenario.system.elements.bodies[start].turns and max(float(np.ptp(x)) for x in d) > _TURNED:
        for name, wave in (("sin", np.sin), ("cos", np.cos)):
            further[f"weight {name}"] = [wave(y) for y in d]
            further[f"level by turn {name}"] = [x * wave(y) for x, y in zip(level, d, strict=True)]
    for name in ways[0] if not table.get("loads") else ():  # otherwise the machine declares how its friction grows
        if name.endswith(_FORCES) and np.ptp(abs(ways[0][name])) > 0:
            further[f"level by {name}"] = [x * abs(y[name]) for x, y in zip(level, ways, strict=True)]
    for name, rows in further.items():
        yield name, rows, None


def _fixed(problem: MachineProblem, u: Array) -> Iterator[MissingForm]:
    """The machine's fixed numbers that are equal in all recordings. A unit is a factor of e."""
    sought, numbers = paths(problem.sought), list[tuple[MachineCoordinate, float]]()
    for path in problem.runs[0].scenario.places:
        if path in sought or ".initial." in path or ".signal." in path or path.endswith(_SMOOTHING):
            continue
        values = {number_at(run, path) for run in problem.runs}
        x = values.pop()
        if x and not values:
            low, high = sorted((x * (1 - _HALF), x * (1 + _HALF)))
            numbers.append((MachineCoordinate(path, low, high, x, None, {path: 1.0}), x))
    if not numbers:
        return
    own = replace(problem, sought=[*problem.sought, *(c for c, _ in numbers)], noise=dict(problem.noise))
    there = np.append(u, [c.inner(x) for c, x in numbers])
    J = own.slopes(there[None], np.full(len(there), own.step))[1][0]
    for i, (c, x) in enumerate(numbers):
        slopes = J[:, len(u) + i] / c.slope(c.inner(x)) * x
        yield MissingForm(c.name, slopes, LARGEST, _of_number(c.name, x))


def _of_number(path: str, now: float) -> Callable[[float], str]:
    return lambda x: f"{path} fixed at {now:.4g} and rather {now * float(np.exp(np.clip(x, -3, 3))):.4g}"


def _sensors(problem: MachineProblem, u: Array) -> Iterator[MissingForm]:
    """Delay (s), clock (s/s), gain and offset of each column, of all recordings and of each."""
    sought = {(c.output, c.log) for c in problem.sought}
    logs = list(dict.fromkeys(run.log for run in problem.runs))
    names = {run.log: run.name for run in problem.runs}
    for (column, what), (slopes, largest, unit) in _of_columns(problem, u).items():
        if ((column, what), None) in sought:
            continue
        for log in [None, *logs] if len(logs) > 1 else [None]:
            if ((column, what), log) not in sought and largest > 0:
                of = f"outputs.{column}.{what}" if log is None else f"log.{log}.outputs.{column}.{what}"
                x = np.where(rows_of(problem, log), slopes, 0.0)
                yield MissingForm(of, x, largest, _of_sensor(of, "" if log is None else names[log], unit))


def _of_sensor(path: str, file: str, unit: str) -> Callable[[float], str]:
    what = path.rpartition(".")[2]
    of = f" ({file})" if file else ""
    return lambda x: f"{path}{of} {x + (what == 'gain'):.3g} {unit}".rstrip()


def rows_of(problem: MachineProblem, log: int | None) -> Array:
    """A mask of the residuals of one recording, or of all."""
    found = np.zeros(problem.size, bool)
    for k, run in enumerate(problem.runs):
        found[problem.first[k] : problem.first[k + 1]] = log in (None, run.log)
    return found


def _of_columns(problem: MachineProblem, u: Array) -> dict[tuple[str, str], tuple[Array, float, str]]:
    """For each sensor parameter: derivatives of the residuals, the largest value that may go unnoticed, and the unit."""
    found: dict[tuple[str, str], Array] = {}
    late, span = dict.fromkeys(problem.noise, 0.0), dict.fromkeys(problem.noise, 0.0)
    for k, run in enumerate(problem.runs):
        at, begin = int(problem.first[k]), float(run.piece) if run.piece else 0.0
        for target, x in zip(run.targets, problem.predicted(run, k, u[None]), strict=True):
            n, noise = len(target.t), problem.noise[target.column]
            if n > 2:
                rate = np.gradient(x[0], target.t)
                of = {"clock": -rate * (target.t + begin), "delay": -rate, "gain": x[0], "offset": np.ones(n)}
                for what, slopes in of.items():
                    found.setdefault((target.column, what), np.zeros(problem.size))[at : at + n] = slopes / noise
                late[target.column] = max(late[target.column], float(np.median(np.diff(target.t))))
                span[target.column] = max(span[target.column], float(np.ptp(target.x)))
            at += n
    units = {c.name: c.unit for c in problem.runs[0].scenario.system.columns}
    told = dict[tuple[str, str], tuple[Array, float, str]]()
    for (name, what), x in found.items():
        largest = {"clock": CLOCK, "delay": late[name], "gain": LARGEST, "offset": LARGEST * span[name]}[what]
        told[name, what] = x, largest, {"clock": "s/s", "delay": "s", "gain": ""}.get(what, units.get(name, ""))
    return told


def _inputs(problem: MachineProblem, u: Array, r: Array) -> Iterator[MissingForm]:
    """Other interpolations of the inputs between samples. A unit is the complete change."""
    compared = int(problem.first[-1])  # priors and ties are unchanged

    def instead(runs: list[RecordedRun]) -> Array:
        own = replace(problem, runs=runs, noise=dict(problem.noise), tied=False)
        off = np.zeros(len(r))
        off[:compared] = own.residuals(u[None])[0][:compared] - r[:compared]
        return off

    drives = [x for run in problem.runs for x in run.inputs.values() if not x.spline]
    if drives:
        held = not all(x.held for x in drives)
        other = [{p: replace(x, held=held and not x.spline) for p, x in run.inputs.items()} for run in problem.runs]
        words = "held from sample to sample (held = true)" if held else "straight from sample to sample (held = false)"
        off = instead([run.driven(x) for run, x in zip(problem.runs, other, strict=True)])
        yield MissingForm("inputs", off, 1.0, lambda x: f"inputs {words}, {x:.2g} of the way")
    smooth = [{p: x.smooth() for p, x in run.inputs.items()} for run in problem.runs]
    if any(x is not run.inputs[p] for run, each in zip(problem.runs, smooth, strict=True) for p, x in each.items()):
        off = instead([run.driven(x) for run, x in zip(problem.runs, smooth, strict=True)])
        yield MissingForm(
            "inputs smooth", off, 1.0, lambda x: f"inputs that bend between their samples, {x:.2g} of the way"
        )


def _begun(problem: MachineProblem, u: Array, r: Array) -> Iterator[MissingForm]:
    """Stretches whose unmeasured states (bodies, bristles, currents) continue those of the stretch before."""
    if problem.tied or len(problem.runs) == len({run.log for run in problem.runs}):
        return
    handed = replace(problem, tied=True).handed_on(u)
    own = replace(problem, runs=handed, noise=dict(problem.noise))
    yield MissingForm(
        "stretches",
        own.residuals(u[None])[0] - r,
        1.0,
        lambda x: f"stretches that begin as those before end, {x:.2g} of the way",
    )


def forms_in_words(chosen: Mapping[str, float], every: Sequence[MissingForm]) -> str:
    """Forms with their coefficients, in words."""
    return " and ".join(form.tell(chosen[form.name]) for form in every if form.name in chosen)
