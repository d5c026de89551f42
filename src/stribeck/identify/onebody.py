"""Fits a log of one body by simulation, as a machine of one body and one contact.

If the fitted output is the force, the measured motion moves the body. The contact's friction is then compared with the
measured force less the rig's other forces. If the output is the motion, the measured force drives the body.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.identify.actuator.api import Fitting
from stribeck.identify.actuator.estimate import BestPoint, Estimation
from stribeck.identify.actuator.lacks import RunMotion, missing_forms
from stribeck.identify.actuator.recordings import Channel, Logs, Recording, Sought
from stribeck.identify.actuator.regression import regressed
from stribeck.identify.beyond import seen
from stribeck.identify.data.quality import LARGEST
from stribeck.identify.features.filtering import other_motions
from stribeck.identify.features.guess import Guess, ranges, sizes_of, steady_curve
from stribeck.identify.features.what_to_measure import with_units
from stribeck.identify.force import Values, farthest, law_table, parts, runs, with_constants
from stribeck.identify.log import ENOUGH_ROWS, Log, Trace, size_ratio
from stribeck.identify.models import terms
from stribeck.identify.models.record import shortened
from stribeck.identify.models.terms import TERMS, WEIGHT
from stribeck.identify.options import FitOptions
from stribeck.identify.result import LogFit, MachineFit
from stribeck.identify.result_parts import FrictionRows
from stribeck.identify.work import Progress
from stribeck.laws.base import PARAMETERS, Law
from stribeck.scenario import Scenario

OUTPUTS = {"force": "contact.F", "position": "body.y", "velocity": "body.v"}  # the machine's column that is fitted
_ROOM = 3.0  # search range of a coefficient: in initial values, plus in friction levels in its unit
_HELD = {"kind": "points", "t": [0.0, 1.0], "value": [-1.0, -1.0]}  # the signal of a constant force against the motion
BESIDE = ("offset", "stiffness", *WEIGHT, "area", "delay")  # terms available in a fit of the motion
_LAW = "contacts.contact.law"


@dataclass(frozen=True)
class OneBody:
    """The model of one body: given and fitted parameters.

    Attributes:
        law: its class; ``name``: as given.
        free: constants to fit; ``fixed``: given constants, words too.
        given: given terms; ``wanted``: terms to fit.
        output: the fitted output: "force", "position" or "velocity"; ``rotary``: whether the body turns.
        first: initial values and ranges, by name.
    """

    law: type[Law]
    name: str
    free: tuple[str, ...]
    fixed: Values
    given: Mapping[str, float]
    wanted: tuple[str, ...]
    output: str
    rotary: bool
    first: dict[str, Guess] = field(default_factory=dict)

    def first_law(self) -> Law:
        """The law with initial values."""
        return with_constants(self.law, {**self.fixed, **{n: g.value for n, g in self.first.items()}})

    @property
    def mass(self) -> str:
        """The key of the body's mass in the machine."""
        return "inertia" if self.rotary else "mass"

    def sign(self, name: str) -> float:
        """The factor from a parameter to the machine's: a force leads by what the motion lags."""
        return -1.0 if name == "delay" and self.output == "force" else 1.0

    def path(self, name: str) -> str:
        """The path of a parameter in the machine, or beside its output."""
        if name in self.law.constants():
            return f"{_LAW}.parameters.{name}" if name in PARAMETERS else f"{_LAW}.{name}"
        if self.output == "force" or name == "delay":
            return f"outputs.{OUTPUTS[self.output]}.{name}"
        places = {"mass": f"bodies.body.{self.mass}", "stiffness": "links.stiffness.stiffness"}
        places |= {n: f"loads.{n}.amplitude" for n in WEIGHT}
        return places.get(name, f"loads.{name}.gain")


@dataclass(frozen=True)
class Simulated:
    """A law fitted to a log by simulation. Its uncertainties are only computed by :meth:`judged`.

    Attributes:
        log: the fitted record; ``model``: given and fitted parameters.
        fitting, estimation, best: the fit as that of a machine, and its best point so far.
    """

    log: Log
    model: OneBody
    fitting: Fitting
    estimation: Estimation
    best: BestPoint

    @property
    def stopped(self) -> bool:
        """Whether Ctrl-C ended it."""
        return self.best.stopped

    @cached_property
    def residual(self) -> Array:
        """The force of the fitted record less that of the law, N."""
        values = self.best.values()
        fitted = {n: self.model.sign(n) * values[n] for n in self.model.first}
        used = {**self.model.fixed, **self.model.given, **fitted}
        friction, beside = parts(self.model.name, used, self.log, _deflections(values, self.log))
        return self.log.force - friction - beside

    @property
    def error(self) -> float:
        """The residual as a share of the force."""
        return size_ratio(self.residual, self.log.force)

    @property
    def late(self) -> bool:
        """Whether a delay is among the effects that explain the residual best, and neither fitted nor given.

        Bristles with a damping below 0 would explain a late force as well: it stays at its bound.
        """
        if "delay" in self.model.given:
            return False
        problem, u = self.best.problem.without_whitening(), self.best.u
        motion = RunMotion.of(problem, u)
        choice = regressed(problem, u, motion, missing_forms(problem, u, motion, {}), at_bound=False)
        _, k, *_ = choice.choose(np.ones(len(choice.library.gram)), alone=False)
        return self.model.path("delay") in choice.library.models[k][1]

    def converged(self) -> Simulated:
        """The fit at its optimum."""
        with threadpool_limits(1):
            return replace(self, best=self.estimation.best())

    def judged(self) -> LogFit:
        """The fit with intervals, ranges and states."""
        with threadpool_limits(1):
            machine_fit = self.fitting.reported(self.best, [])
        self.fitting.work.section(1.0)
        return _finished(self.log, self.model, machine_fit)


def simulated(log: Log, name: str, options: FitOptions, progress: Progress | None = None) -> Simulated:
    """The best point of a law's constants, and of further terms, by simulation; arguments as of :func:`approached`."""
    return approached(log, name, options, progress).converged()


def approached(log: Log, name: str, options: FitOptions, progress: Progress | None = None) -> Simulated:
    """The end of the search for a law's constants, and for further terms, whose error is to be compared.

    Args:
        log: the record, SI units.
        name: the law's name, or FILE.py:NAME.
        options: given values, parameters to fit and the output.
        progress: called with the share done, 0 to 1.

    Raises:
        InputError: constants are unknown, missing or not allowed; nothing moves.
        StribeckError: the law cannot be simulated along the motion.
    """
    log = shortened(log, ENOUGH_ROWS)
    model = _model(log, name, options)
    recordings = [_recording(log, rows, model, i) for i, rows in enumerate(runs(log))]
    logs = Logs(tuple(_doubted(recordings, log, model)), _sought(model, log, options), words=_words(model))
    scenario = Scenario(_tables(model), folder=Path(), trust=True)
    fitting = Fitting(scenario, logs, options.starts, options.seed, progress, advised=False)
    with threadpool_limits(1):
        estimation = fitting.searched()
        return Simulated(log, model, fitting, estimation, estimation.free)


# -- given and fitted parameters ---------------------------------------------------------------------------------------


def _model(log: Log, name: str, options: FitOptions) -> OneBody:
    """The given and fitted parameters of a law on a record, with initial values.

    Raises:
        InputError: constants or terms are unknown, missing, or not allowed here; a line for each problem.
    """
    law, output = laws.find(name), options.output
    given = {n: x for n, x in options.numbers.items() if n in TERMS}
    fixed = {n: x for n, x in options.set.items() if n not in TERMS}
    free = _free(law, name, fixed, options.free)
    wanted = [n for n in dict.fromkeys(("mass", "offset", *options.term)) if n not in given]
    terms.check((*wanted, *given), log)
    problems = []
    for n in (*wanted, *given):
        if output == "force" and TERMS[n].level:
            problems.append(
                f"{arg('term')}: {n}: a static fit looks for it; has no place in a fit of the force by simulation"
            )
        elif output != "force" and n not in ("mass", *BESIDE):
            problems.append(f"{arg('term')}: {n}: has no place in a fit of the motion (it has {', '.join(BESIDE)})")
    if problems:
        raise InputError(problems)
    usual = {n: c.default for n, c in law.constants().items() if c.default is not None and n not in free}
    model = OneBody(law, name, tuple(free), {**usual, **fixed}, given, tuple(wanted), output, log.rotary)
    _first(model, log)
    with np.errstate(all="ignore"):
        force = model.first_law().steady_force(v := log.velocity)
    if not np.all(abs(force) <= LARGEST):
        text = (
            f"gives no force within {LARGEST:g} N in size at the speeds of this record ({v.min():.3g} to {v.max():.3g})"
        )
        raise InputError(f"law '{law.name}': {text}")
    return model


def _free(law: type[Law], name: str, fixed: Mapping[str, object], more: Sequence[str]) -> list[str]:
    """The constants to fit: the machine's, or the law's own if it uses none of these, and those freed by the user."""
    known = law.constants()
    wanted = [n for n in dict.fromkeys((*(law.uses or law.own_constants()), *more)) if n in known and n not in fixed]
    problems = [
        f"{n}: missing: give its value ({c.meaning}, {c.allowed}), or fit it"
        for n, c in known.items() if c.required and n not in (*wanted, *fixed)
    ]  # fmt: skip
    if problems:
        raise InputError(problems)
    if not wanted:
        raise InputError(f"law '{name}': every constant is given: there is nothing to fit")
    return wanted


def _first(model: OneBody, log: Log) -> None:
    """Set initial values and ranges.

    Terms follow from least squares together with a Stribeck curve, which is the first one of the law.
    """
    columns = {n: terms.column(n, log) for n in (*model.wanted, *model.given) if TERMS[n].column is not None}
    force = log.force - sum((x * columns[n] for n, x in model.given.items() if n in columns), np.zeros(len(log)))
    wanted = [n for n in model.wanted if n in columns]
    of_wanted, curve, _ = steady_curve(log.velocity, [columns[n] for n in wanted], force)
    least = dict(zip(wanted, of_wanted.tolist(), strict=True))
    least = {n: x for n, x in least.items() if x > 0 or not TERMS[n].positive}
    beside = sum((x * columns[n] for n, x in least.items()), np.zeros(len(log)))
    sizes = sizes_of(log.with_columns(force=force - beside))
    known = ranges(model.law, sizes, curve)
    model.first.update({n: known[n] for n in model.free})
    for n, other, nearer in (("F_c", "F_s", min), ("F_s", "F_c", max)):  # no law has F_c above F_s
        if n in model.free and other in model.fixed:
            model.first[n] = replace(known[n], value=nearer(known[n].value, float(model.fixed[other])))
    for n in model.wanted:
        if n == "delay":
            most = 50 * log.step
            model.first[n] = Guess(0.0, -most, most)
            continue
        room = _ROOM * sizes.force / max(float(np.sqrt(np.mean(columns[n] ** 2))), 1e-300)
        value = least.get(n, 0.1 * room if TERMS[n].positive else 0.0)
        far = room + _ROOM * abs(value)
        model.first[n] = Guess(value, 1e-6 * far if TERMS[n].positive else value - far, value + far)


# -- the machine and its recordings --------------------------------------------------------------------------------------


def _tables(model: OneBody) -> dict[str, object]:
    """The machine's tables, with initial values."""
    values = {**model.fixed, **{n: g.value for n, g in model.first.items()}, **model.given}
    turns = {"rotary": True} if model.rotary else {}
    body: dict[str, object] = {"velocity": {"signal": _HELD}, **turns}
    loads: dict[str, object] = {}
    links: dict[str, object] = {}
    if model.output != "force":
        if not values["mass"]:
            raise InputError(f"{arg('mass')}: 0: a body that a force drives has a mass; must be above 0")
        body = {model.mass: values["mass"]}
        loads = {"force": {"on": "body", "kind": "signal", "signal": _HELD}}
        for n in (*model.wanted, *model.given):
            if n in ("offset", "area"):
                loads[n] = {"on": "body", "kind": "signal", "gain": values[n], "signal": _HELD}
            elif n in WEIGHT:
                loads[n] = {"on": "body", "kind": "pendulum", "amplitude": values[n], "phase": WEIGHT[n]}
            elif n == "stiffness":
                links[n] = {"from": "body", "to": "ground", "stiffness": values[n], "damping": 0.0}
    return {
        "schema": 2, "bodies": {"body": body}, "contacts": {"contact": {"from": "body", "law": law_table(model.name, values)}},
        **({"loads": loads} if loads else {}), **({"links": links} if links else {}),
        "solve": {"t_end": 1.0}, "output": {"step": 1e-3},
    }  # fmt: skip


def _recording(log: Log, rows: slice, model: OneBody, number: int) -> Recording:
    """One run of the log as a recording of the machine."""
    part, t = log.rows(rows), log.step * np.arange(rows.stop - rows.start)
    name = log.files[log.run[rows.start]] if log.files else f"run {number}"
    inputs = {"loads.force.signal": Channel("force", t, part.force, smooth=True)}
    at = t - model.sign("delay") * model.given.get("delay", 0.0)  # of the output, by the clock of the drive
    output = Channel(model.output, at, raw(part, model.output))
    if model.output == "force":
        columns = {n: np.interp(at, t, terms.column(n, part)) for n in (*model.given, *model.wanted) if TERMS[n].column}
        known = sum((x * columns[n] for n, x in model.given.items() if n in columns), np.zeros(len(t)))
        beside = {n: columns[n] for n in model.wanted if n in columns and n != "offset"}
        output = Channel("force", at, part.force - known, beside=beside)
        inputs = {"bodies.body.velocity.signal": Channel("velocity", t, part.velocity, smooth=True)}
    elif "area" in (*model.wanted, *model.given) and part.pressure is not None:
        inputs["loads.area.signal"] = Channel("pressure", t, -part.pressure, smooth=True)
    return Recording(name, t, {OUTPUTS[model.output]: output}, inputs)


def raw(log: Log, output: str) -> Array:
    """The fitted output as measured, before any filter, if the log has it."""
    kept = log.unfiltered if log.sources.get("unfiltered") == output else None
    return np.asarray(getattr(log, output) if kept is None else kept)


def _sought(model: OneBody, log: Log, options: FitOptions) -> tuple[Sought, ...]:
    """The parameters of the machine fit, each with its name as label."""
    sought = list[Sought]()
    for n, guess in model.first.items():
        path = model.path(n)
        given = options.sought.get(n)
        if given is None:
            sought.append(Sought(path, guess.low, guess.high, guess.value, label=n))
        else:
            begin = min(max(guess.value, given.low), given.high)
            start = begin if given.start is None and given.prior is None else given.start
            wanted = replace(given, path=path, start=start, label=n)
            sought.append(wanted if model.sign(n) > 0 else wanted.mirrored())
    if model.law.has_z:
        law = model.first_law()
        way = farthest(law)
        for i, rows in enumerate(runs(log)):
            slid = float(law.steady_deflection(float(log.velocity[rows.start])))
            path = f"log.{i}.contacts.contact.initial.z"
            sought.append(Sought(path, -way, way, min(max(slid, -way), way), nuisance=True))
    return tuple(sought)


# -- the fit -------------------------------------------------------------------------------------------------------------


def _finished(log: Log, model: OneBody, machine_fit: MachineFit) -> LogFit:
    """The machine's fit as a fit of the log."""
    fitted = {n: e if model.sign(n) > 0 else e.mirrored() for n, e in machine_fit.estimates.items()}
    used = {**model.fixed, **model.given, **{n: e.value for n, e in fitted.items()}}
    estimates = with_units(fitted, model.name, model.fixed, log)
    friction, beside = parts(model.name, used, log, _deflections(machine_fit.nuisance, log))
    left = log.force - friction - beside
    missed = float(np.std(left)) / max(float(np.std(log.force)), 1e-300)
    notes = *([machine_fit.reason] if machine_fit.reason else []), *machine_fit.notes
    return LogFit(
        law_name=model.name, method="dynamic", estimates=estimates,
        levels={n.removeprefix("contact "): e for n, e in machine_fit.levels.items()},
        speeds={n.removeprefix("contact "): v for n, v in machine_fit.speeds.items()},
        values=used, given=(*model.fixed, *model.given), relation=machine_fit.relation,
        relative_force_error=size_ratio(left, log.force), missed=missed,
        friction=FrictionRows(log.time, log.velocity, log.force - beside, friction), data_hash=log.hash,
        output=_output(model.output, [result.traces[0] for result in machine_fit.logs]), seen=seen(log, np.ones(len(log), bool)),
        notes=notes, status="stopped" if machine_fit.status == "stopped" else "done", log=log,
    )  # fmt: skip


def _output(name: str, runs: Sequence[Trace]) -> Trace | None:
    """The fitted motion of all runs; None if the force was fitted."""
    if name == "force":
        return None
    t, measured, predicted = (np.concatenate([getattr(x, n) for x in runs]) for n in ("t", "measured", "predicted"))
    return Trace(name, runs[0].unit, t, measured, predicted)


def _deflections(values: Mapping[str, float], log: Log) -> list[float | None]:
    """The fitted deflection of the bristles at the start of each run, m; None of a law without bristles."""
    return [values.get(f"log.{i}.contacts.contact.initial.z") for i in range(len(runs(log)))]


def _doubted(recordings: Sequence[Recording], log: Log, model: OneBody) -> Iterator[Recording]:
    """The runs, each with alternatives that measurement errors allow.

    The drive between two samples is not measured, so a straight line is one alternative.
    """
    filtered = model.output == "force" or log.sources.get("unfiltered") != model.output
    as_well = other_motions(log) if filtered else {}
    for i, (recording, rows) in enumerate(zip(recordings, runs(log), strict=True)):
        same = {cause: [_recording(x, rows, model, i) for x in logs] for cause, logs in as_well.items()}
        if model.output != "force":
            straight = {path: replace(each, smooth=False) for path, each in recording.inputs.items()}
            same["drive between samples"] = [replace(recording, inputs=straight)]
        yield replace(recording, as_well=same)


def _words(model: OneBody) -> dict[str, str]:
    """Names of numbers and of errors of the output's sensor in the fit of a log. The only contact has no name."""
    errors = {"clock": "clock drift", "delay": "delay", "gain": "gain", "offset": "offset"}
    of_output = {f"outputs.{OUTPUTS[model.output]}.{n}": f"{text} of the {model.output}" for n, text in errors.items()}
    return {**of_output, **{model.path(n): n for n in (*model.law.constants(), "mass")}, "contact": ""}
