"""The calls whose results are kept, beside the commands: one function a case, which yields lines."""

import contextlib
import copy
import functools
import hashlib
import itertools
import json
import operator
import random
import shlex
import tomllib
import warnings
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
import tomli_w
import typer.main
from jsonschema import Draft202012Validator
from scipy.io import savemat

import stribeck
import stribeck.errors
from stribeck import InputError, Scenario, examples
from stribeck.cli.app import app
from stribeck.codegen import source
from stribeck.constants import show
from stribeck.exports import contact_law
from stribeck.exports.exchange import from_bam
from stribeck.exports.optional import Operations
from stribeck.exports.python import stepping
from stribeck.exports.python.arrays import ArrayLaw
from stribeck.expressions import emit, ops, pretty
from stribeck.expressions.graph import constant, derivative, symbol, symbols
from stribeck.expressions.intervals import Box
from stribeck.identify.actuator import read_logs
from stribeck.identify.actuator.coordinates import coordinates
from stribeck.identify.data.read import ColumnNames, read
from stribeck.identify.formula import model_lines
from stribeck.laws import builtin, overflow, trouble
from stribeck.loops.boundary import Turned
from stribeck.mouth import cells
from stribeck.mouth.document import Ends, Uncertain
from stribeck.properties.prover.ring import Ring
from stribeck.properties.prover.search import Budget, Prover
from stribeck.recorded import opened
from stribeck.scenario import parse_assignment, schema
from stribeck.simulation import wasm
from stribeck.sweeps.ranges import Range
from stribeck.waveforms.pieces import pieces
from tests.kept import shown
from tests.kept.runner import EXACT, INPUTS, PLACES, Case, call, inputs
from tests.proofs.coq import script
from tests.properties.nasty import PROPERTIES
from tests.properties.nasty import cases as nasty_cases

CALLS: list[Case] = []
MACHINES = sorted((PLACES[2]).glob("*.toml"))
CANUDAS = dict(stribeck.library().sets["canudas1995"].values)
coq = script("coq")
OWN = {"k_v": 1e5, "z_ba": 7e-6, "g1": 0.25, "g2": 100.0, "g3": 10.0, "g4": 0.1, "g5": 100.0, "g6": 0.01}


def kept(name, tolerance=EXACT, backend="", thorough=False):
    """A case of a function that yields lines."""

    def register(function):
        CALLS.append(Case(name, lambda: list(function()), tolerance, thorough, backend))
        return function

    return register


def numbers(values):
    """Numbers in a line, to twelve digits."""
    return ", ".join(f"{x:.12g}" for x in np.ravel(values))


def laws():
    """Every built-in law with constants of the literature, and some with options."""
    for name, cls in builtin().items():
        known = cls.constants()
        yield name, stribeck.law(name, {n: x for n, x in {**CANUDAS, **OWN}.items() if n in known})
    for name, more in {
        "lugre": {"v_d": 2e-3}, "lugre_sobczyk": {"k_v": 1e6, "delta": 1.3}, "stribeck": {"k_v": None, "delta": 1.0},
        "lugre_majorant": {"k_v": 1e4, "smooth_abs": "sqrt", "v_d": 1e-2},
        "elastoplastic_majorant": {"k_v": 1e4, "z_ba": 5e-6, "smooth_abs": "compact"},
    }.items():  # fmt: skip
        known = builtin()[name].constants()
        given = {n: x for n, x in {**CANUDAS, **more}.items() if n in known and x is not None}
        yield f"{name} {more}", stribeck.law(name, given)


@kept("laws/values")
def _():
    v = np.array([0.0, 1e-6, -3e-5, 4e-4, -1e-3, 0.02, 1.0])
    z = np.array([0.0, 2e-6, -8e-6, 9e-6, 1.2e-5, -1.4e-5, 5e-6])
    for name, law in laws():
        yield f"== {name}"
        yield f"{law.to_dict()} linear {law.linear}, differentiable {law.differentiable}, jumps {law.jumps_at_rest}"
        yield f"{law.guarantees()} {law.scales(law.p)}"
        for what, values in {
            "rate": law.rate(v, z), "force": law.force(v, z), "jacobian": law.jacobian(v, z)[0],
            "jacobian of F": law.jacobian(v, z)[1], "steady": law.steady_force(v), "steady z": law.steady_deflection(v),
        }.items():  # fmt: skip
            yield f"{what}: {numbers(values)}"
        with contextlib.suppress(InputError, stribeck.StribeckError):
            yield f"force rate: {numbers(law.force_rate(v, z, 3.0 - v))}"


@kept("laws/told")
def _():
    for name, law in laws():
        yield f"== {name}"
        yield repr(law)
        yield from shown.page(law._repr_html_(), 12)
        for other in (
            {"k": 1},
            {"F_c": 0.0},
            {"F_c": "a"},
            {"F_s": 0.1},
            {"k_v": -1},
            {"sigma_1": np.nan},
            {"delta": 0.2},
        ):
            with warnings.catch_warnings(record=True) as notes, contextlib.suppress(InputError):
                warnings.simplefilter("always")
                try:
                    law.replace(**other)
                    yield f"{other}: taken"
                except InputError as error:
                    yield from (f"{other}: {problem}" for problem in error.problems)
            yield from (f"note: {each.message}" for each in notes)


SIGNALS = {
    "ramp": {"rate": 0.3},
    "step": {"time": 0.4, "value": -2.0},
    "sine": {"amplitude": 0.5, "frequency": 1.5, "offset": 0.2, "phase": 0.4},
    "points": {"t": [0.1, 0.4, 0.4, 0.9], "value": [0, 1, -1, 2]},
    "point_to_point": {"t": [0.1, 0.5, 0.8], "value": [0.0, 1.0, -0.5]},
    "spline": {"t": [0.0, 0.3, 0.7, 1.0], "value": [0.0, 0.4, -0.2, 0.1]},
    "square": {"amplitude": 1.0, "frequency": 2.0},
    "staircase": {"levels": [0.1, 0.5, -0.4], "hold": 0.3, "ramp": 0.05},
    "sum": {"of": [
        {"kind": "sine", "amplitude": 1.0, "frequency": 1.0},
        {"kind": "points", "t": [0.1, 0.4, 0.4, 0.9], "value": [0, 1, -1, 2]},
    ]},
}  # fmt: skip


POINTS = {  # what may stand in a signal's points
    "before the start": ([-2, -1, 1], [5, 0, 2]), "a jump at the start": ([0, 0, 1], [1, 2, 2]),
    "a jump there before": ([-1, 0, 0], [7, 7, 2]), "three at once": ([0, 0.5, 0.5, 0.5, 1], [0, 1, 9, 5, 5]),
    "one": ([3], [0.5]), "jumps up and down": ([0.1, 0.2, 0.2, 0.3], [0, 4, -1, 1]), "to and fro": ([0, 0.4, 0.8], [-2, 2, -2]),
    "touched from below": ([0, 0.1, 0.2], [0, 0.1, 0]), "touched from above": ([0, 0.1, 0.2], [2, 0.1, 2]),
    "past a point": ([0, 0.1, 0.2], [0, 0.1, 2]), "from far": ([-1, 3], [0, 4]),
}  # fmt: skip
VARIED = SIGNALS | {
    **{f"points, {name}": {"kind": "points", "t": t, "value": x} for name, (t, x) in POINTS.items()},
    "step before": {"kind": "step", "time": -1.0, "value": 2.0}, "slow ramp": {"kind": "ramp", "rate": -0.1},
    "one side": {"kind": "sine", "amplitude": 0.5, "frequency": 1.0, "offset": 2.0},
    "touching": {"kind": "sine", "amplitude": 0.1, "frequency": 1.0, "phase": 0.3},
    "still": {"kind": "sine", "amplitude": 0.0, "frequency": 1.0, "offset": 0.1},
}  # fmt: skip


@kept("signals/values")
def _():
    t = np.linspace(0, 1.2, 13)
    for kind, constants in VARIED.items():
        tables = {**RIG, "drive": {"kind": "force", "signal": {"kind": kind, **constants}}}
        yield f"== {kind} {constants}"
        try:
            signal = Scenario(tables).signal
        except InputError as error:
            yield from error.problems
            continue
        yield f"at: {numbers(signal.at(t))}"
        yield from (f"{name} there: {numbers(x)}" for name, x in signal.values_at(t[::3]).items())
        yield f"smooth {signal.smooth}, longest step {signal.longest_step:g}, {len(signal.pieces)} pieces"
        table = pieces(signal, True, 1.2)
        yield from (
            f"{name}: {numbers(np.asarray(x, float))}"
            for name, x in vars(table).items()
            if np.size(x) and _is_number(x)
        )
        for missing in (n for n in constants if n != "kind"):
            yield from _refusal(f"without {missing}", _edited(tables, ("drive", "signal", missing), GONE))


def _is_number(x):
    return np.asarray(x).dtype.kind in "ifb"


RIG = {
    "schema": 1, "law": {"name": "lugre", "parameters": "canudas1995"}, "plant": {"mass": 1.0},
    "drive": {"kind": "force", "signal": {"kind": "ramp", "rate": 1.0}}, "solve": {"t_end": 1.2}, "output": {"step": 0.1},
}  # fmt: skip
GONE, SCHEMA = object(), Draft202012Validator(schema.json_schema())
WRONG = (GONE, True, -1.5, 0, "?", {"?": 1}, [])


def _edited(tables, path, value):
    tables = copy.deepcopy(tables)
    *parents, last = path
    table = tables
    for name in parents:
        table = table[name]
    if value is GONE:
        del table[last]
    else:
        table[last] = value
    return tables


def _places(table, path=()):
    for name, value in table.items():
        yield *path, name
        if isinstance(value, dict):
            yield from _places(value, (*path, name))


def _refusal(what, tables):
    """The lines of a refusal, with what was wrong; a line with what is taken."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            Scenario(tables)
    except InputError as error:
        for problem in error.problems:
            yield f"{what}: {problem}"
    else:
        yield f"{what}: taken"


def _said(path, wrong):
    return f"{'.'.join(path)} = {'nothing' if wrong is GONE else repr(wrong)}"


def _every_mistake(tables, within=(), besides=None):
    for path in (p for p in _places(tables) if p[: len(within)] == within and p[1:2] != (besides,)):
        for wrong in WRONG:
            yield from _refusal(_said(path, wrong), _edited(tables, path, wrong))
        name = path[-1] + path[-1][-1]
        yield from _refusal(name, _edited(_edited(tables, path, GONE), (*path[:-1], name), 1.0))


def _mistakes_of_a_scenario(*given):
    """And which of the lines differ from what the schema, by which an editor underlines, says of some mistakes."""
    yield from (lines := list(_every_mistake(*given)))
    taken = {line.rpartition(": ")[0] for line in lines if line.endswith(": taken")}
    for path in _places(given[0]):
        for wrong in (GONE, -1.5, "?"):
            message = _said(path, wrong)
            if any(line.startswith(f"{message}: ") for line in lines):
                valid = SCHEMA.is_valid(_edited(given[0], path, wrong))
                if valid != (message in taken):
                    yield f"{message}: {'taken' if valid else 'refused'} by the schema"


@kept("refused/machine")
def _():
    yield from _every_mistake(tomllib.loads((PLACES[2] / "everything.toml").read_text()))


@kept("refused/servo")
def _():
    servo = tomllib.loads(examples.path("servo").read_text())
    real = {"sample_time": 1e-3, "delay": 5e-4, "noise": 1e-5, "seed": 1, "quantization": 2.44e-4, "bandwidth": 200.0,
            "supply_droop": 2e7, "adaptive": True, "adaptation": {}, "model": {"mass": 3.5}}  # fmt: skip
    yield from _every_mistake({**servo, "drive": {**servo["drive"], **real}})


@kept("refused/scenario")
def _():
    for drive in (
        {"kind": "spring", "stiffness": 2.0},
        {"kind": "pid", "K_p": 1.0, "K_i": 2.0, "K_d": 3.0},
        {"kind": "velocity"},
    ):
        signal = {"kind": "sine", "amplitude": 0.5, "frequency": 1.0}
        yield from _mistakes_of_a_scenario({**RIG, "drive": {**drive, "signal": signal}}, ("drive",))
    drawn = {"kind": "file", "path": _file("record.csv", "t,v\n0,0\n1,1\n"), "time": "t", "value": "v"}
    for signal in (drawn, *({"kind": kind, **constants} for kind, constants in SIGNALS.items())):
        yield from _mistakes_of_a_scenario({**RIG, "drive": {"kind": "force", "signal": signal}}, ("drive", "signal"))
    yield from _mistakes_of_a_scenario({**RIG, "plant": {"mass": 1.0, "initial": {"y": 0.1, "v": 0.2, "z": 1e-6}}})
    for name, law in laws():
        yield f"== {name}"
        yield from _mistakes_of_a_scenario(
            {**RIG, "law": law.to_dict()}, ("law",), None if name == "lugre" else "parameters"
        )


SETS = (  # what may stand beside a number, and what not
    "F_c = 1.0", "F_c = {value = 1.0, determined = 0}", "F_c = {value = 1.0, determined = 'false'}",
    "F_c = {value = 1.0, unit = 3}", "F_c = {value = 1.0, unit = 'kN'}", "F_c = {value = 1.0, low = 'x'}",
    "F_c = {value = 1.0, high = true}", "F_c = {low = 1.0}", "F_c = {value = 1.0, low = 2.0, high = 0.5}",
    "F_c = {value = 3.0, low = 0.5, high = 2.0}", "F_c = {value = 3.0, high = 2.0}",
    "F_c = {value = 1.0, unit = 'N m'}\nF_s = {value = 2.0, unit = 'N'}", "F_c = 1.0\nsmooth_ab = 'sqrt'",
    "F_c = 1.0\nkv = 1e6", "F_c = 1.0\nmu = 0.3", "F_c = '1.5'", "F_c = nan", "F_c = 2.0\nF_s = 1.0\nv_s = 0.1",
    "sigma_0 = 1.0", "F_c = 1.0\nk_v = 1e6", "F_c = 1.0\n[other]\n[more]", "F_c = ",
)  # fmt: skip


@kept("refused/sets")
def _():
    """Sets of parameters in files, of a law and of a scenario's law."""
    heads = ("[parameters]\n", "", "motion = 'rotating'\n", "motion = 'rotary'\nmaker = 'x'\n")
    for text in (*("[parameters]\n" + x for x in SETS), *(head + SETS[0] for head in heads), "parameters = 1"):
        Path("x.toml").write_text(text)
        what = text.removeprefix("[parameters]\n").replace("\n", "; ")
        try:
            result = stribeck.law("coulomb_viscous", "x.toml", sigma_2=0.0)
            yield f"{what}: {result.p.F_c:g}, {'rotary' if result.rotary else 'linear'}"
        except InputError as error:
            yield from (f"{what}: {problem}" for problem in error.problems)
        law = {"name": "stribeck", "k_v": 1e7, "parameters": "x.toml"}
        yield from _refusal(f"{what} in a scenario", {**RIG, "law": law})


@kept("refused/logs")
def _():
    inputs("axis.toml axis.logs.toml")
    Path("few.csv").write_text("t,y,u\n0,0,0\n0.1,0,0\n")
    Path("words.csv").write_text("t,y,u\n" + "0.1,much,0\n" * 9)
    machine, tables = Scenario.load("axis.toml"), tomllib.loads(Path("axis.logs.toml").read_text())
    first, second = tables["log"]
    read = {"a.y": {"column": "y", "unit": "mm", "gain": 1e3, "noise": 1e-5, "held": False}}
    driven = {"loads.push.signal": {"column": "u", "held": True}}
    reported = {"outputs": read, "inputs": driven, "known": {"bodies.a.initial.y": 0.0}, "hold_out": False}
    sought = {"low": 0.2, "high": 5.0, "start": 1.0, "prior": {"mean": 1.0, "deviation": 0.1}}
    shape = {"log": {**first, **reported}, "unknown": {**tables["unknown"], "bodies.a.mass": sought}}
    wide = {"prior": {"mean": 1.0, "deviation": 0.25}}
    files = [(("log", "file"), x) for x in ("none.csv", "few.csv", "words.csv", "x" * 300 + ".csv")]
    names = ("log.3.bodies.a.mass", "initial.a.y", "outputs.b.y.offset", "outputs.a.y.wobble", "bodies.a.mas")
    others = [(("unknown",), {n: {"low": 0.2, "high": 5.0}}) for n in names]
    others += [
        (("unknown",), {"bodies.a.mass": x}) for x in (wide, {"low": -1.0, "high": 5.0}, {"low": 2.0, "high": 1.0})
    ]
    others += [(("log", "hold_out"), True), (("log", "outputs"), {"a.q": "y"})]
    tried = [(path, wrong) for path in _places(shape) for wrong in (*WRONG, 1e308, -1e308, 1e-320)]
    for path, wrong in tried + files + others:
        edited = _edited(shape, path, wrong)
        if isinstance(edited.get("log"), dict):
            edited["log"] = [edited["log"], second]
        Path("l.toml").write_text(tomli_w.dumps(edited))
        message = _said(path, wrong)[:120]  # a file's name may be too long
        try:
            coordinates(machine, read_logs("l.toml"))
            yield f"{message}: taken"
        except InputError as error:
            yield from (f"{message}: {x}" for x in error.problems)


@kept("refused/bam")
def _():
    tables = json.loads((PLACES[0] / "m6.json").read_text())
    for more in ({}, {"unknown": 1.0}, {"command_delay": 0.01}, {"load_friction_stribeck": 0.1}, {"kt": 10**400}):
        yield from _refused_file(f"with {list(more)}", {**tables, **more})
    for path in _places(tables):
        for wrong in WRONG:
            yield from _refused_file(_said(path, wrong), _edited(tables, path, wrong))


def _refused_file(what, tables):
    """The lines of a refusal of BAM's numbers, and notes; a line with what is taken."""
    with warnings.catch_warnings(record=True) as notes:
        warnings.simplefilter("always")
        try:
            from_bam(tables)
            yield f"{what}: taken"
        except InputError as error:
            yield from (f"{what}: {problem}" for problem in error.problems)
    yield from (f"{what}: note: {each.message}" for each in notes)


@kept("codegen/c")
def _():
    yield from _codes(lambda scenario: source(scenario.system))


@kept("codegen/lanes")
def _():
    yield from _codes(lambda scenario: source(scenario.system, lanes=True))


def _codes(code):
    seen = set()  # the runtime is the same in all
    for path in MACHINES:
        yield f"== {path.stem}"
        blocks = shown.digest(code(Scenario.load(path)))
        yield from (block for block in blocks if block not in seen)
        seen.update(blocks)


@kept("codegen/wasm")
def _():
    for path in MACHINES:
        built = wasm.system_module(Scenario.load(path).system)
        yield f"{path.stem}: {len(built.module)} bytes, {built.shape}, {built.end}"


SHOWN = {"x": "x", "y": "y", "k_v": "k_v"}
X, Y, K = symbol("x"), symbol("y"), symbol("k_v")
EXPRESSIONS = {
    "polynomial": 3 * X**2 - X * Y / 7 + 0.5,
    "powers": X**-2 + Y**1.5 - (X + 1) ** 3,
    "reach": -(X - Y) / (K * X + 2),
    "smooth sign": 2 / np.pi * ops.atan(K * X),
    "exponential": ops.exp(-((X / 0.1) ** 2)) * ops.tanh(Y),
    "waves": ops.sin(3 * X) * ops.cos(Y) - ops.log(2 + X * X),
    "cases": ops.where(X < 0, -Y, Y * Y),
    "both": ops.where(ops.both(X > 0, Y <= 1), ops.sqrt(1 + X * X), abs(X)),
    "either": ops.where(ops.either(X >= Y, K < 1), X, -X),
    "clip": ops.clip(X * Y, -0.5, 0.25) + ops.sign(X),
    "larger": ops.larger(X, Y) - ops.smaller(X * X, 2 * Y),
    "nested": ops.where(X < 0, ops.where(Y < 0, X, K), ops.where(Y < 1, K - X, X * K)),
    "fraction": (X - Y) / (X * X + 0.1) / (1 + abs(Y)),
}
BOXES = [((-1, 2), (0.5, 1.5)), ((0.1, 0.2), (-0.3, 0.1)), ((-3, -1), (-2, 5)), ((0, 0), (1, 1)), ((-1, 1), (-1, 1))]


@kept("expressions/written")
def _():
    names = {"x": "x", "y": "y", "k_v": "p->k_v"}
    for name, e in EXPRESSIONS.items():
        yield f"== {name}"
        yield from emit.Writer(emit.C, names).write([("out", e)])
        yield from emit.Writer(emit.PYTHON, {n: n for n in names}).write([("out", e)])
        yield pretty.write(e, SHOWN, latex=True)
        yield pretty.write(e, SHOWN, latex=False)
        with contextlib.suppress(Exception):
            yield coq.write(e)
        for by in (X, Y, K):
            yield f"by {by}: {pretty.write(derivative(e, by), SHOWN, latex=False)}"


@kept("expressions/ranges")
def _():
    for name, e in EXPRESSIONS.items():
        yield f"== {name}"
        for what in (e, derivative(e, X), derivative(e, Y)):
            for x, y in BOXES:
                with contextlib.suppress(Exception):
                    yield numbers(Box({"x": x, "y": y, "k_v": (2.0, 3.0)})(what))


def _verdicts(cases):
    for case in cases:
        verdicts = stribeck.check(case.law())
        yield f"== {case.kind}.{case.name}"
        for name in PROPERTIES:
            verdict = verdicts[name].to_dict()
            yield f"{name}: {verdict['holds']}, {verdict['method']}"
            yield from ("  " + line for line in shown.tree(verdict["evidence"], 9))


NASTY = list(nasty_cases())


@kept("check_nasty/some", 1e-6, "wasm")
def _():
    yield from _verdicts(NASTY[::8])


@kept("check_nasty/rest", 1e-6, "wasm", thorough=True)
def _():
    yield from _verdicts(case for i, case in enumerate(NASTY) if i % 8)


@kept("scenario/schema")
def _():
    yield from shown.tree(schema.json_schema(), 12)


@kept("scenario/read")
def _():
    for path in MACHINES:
        scenario = Scenario.load(path)
        elements = scenario.elements
        yield f"== {path.stem}: {scenario.name}, {scenario.label}, {scenario.subject}, rotary {scenario.rotary}"
        yield f"{scenario.rows} rows to {scenario.end:g}, longest step {elements.longest_step:g}"
        yield from (f"atol {n}: {float(x):.6g}" for n, x in scenario.atol().items())
        yield from (f"{name}: {scales}" for name, scales in elements.scales.items())
        yield f"natural {shown.rounded({n: float(x) for n, x in elements.natural.items()}, 9)}"
        yield f"thresholds {[float(x) for x in elements.thresholds()]}"
        yield from (
            f"sampling {shown.rounded({n: float(x) for n, x in each.items()}, 9)}" for each in elements.sampling()
        )
        yield f"states {[s.name for s in scenario.system.states]}, parameters {scenario.system.parameters}"


@kept("solution/api", 1e-5)
def _():
    solution = stribeck.simulate(examples.path("stick_slip"), t_end=2.0)
    yield from [repr(solution), str(solution), *shown.page(solution._repr_html_(), 7)]
    yield from shown.tree(solution.summary(), 7)
    for column in solution.columns:
        yield f"{column}"
    several = stribeck.simulate(
        examples.path("stick_slip"), vary={"law.k_v": [1e6, 1e7], "plant.mass": [1.0, 2.0]}, t_end=1.0
    )
    yield from [
        repr(several),
        *shown.page(several._repr_html_(), 7),
        f"{several.status} {several.success} {several.message}",
    ]
    yield from (f"{c}: {shown.summed(np.ravel(several[c.name]), 7)}" for c in several.columns)


# What a command passes on: the call that it ends in, for each of its options alone, with a wrong value, and with each other one.
ENDS = {  # where each command ends, and how it begins
    "run": ("simulation.simulate simulation.comparison.compare_laws", "stick_slip.toml"),
    "check": ("properties.check properties.steepness.smallest_steepness", "lugre_majorant --set k_v=1e6"),
    "design": ("loops.design", "axis_hunts.toml"),
    "export": ("exports.export", "lugre_majorant --parameters canudas1995 --set k_v=1e6 --target c --out c"),
    "fit": ("identify.api.fit", "log.csv --time t --velocity v --force F"),
    "predict": ("identify.predict.predict", "other.csv --time t --velocity v --force F --fit fit"),
    "sweep": ("sweeps.job.Sweep", "stick_slip.toml --vary law.k_v=1:2:2 --out grid"),
    "explore": ("explorer.explore", "stick_slip.toml"),
    "library": ("laws.library.library", "lugre"),
}
GIVEN = {  # a value of each option that takes one
    "set_": "k_v=2e6", "law": "dahl", "contact": "guide", "controller": "axis", "parameters": "canudas1995", "v_max": "0.5",
    "level": "0.5:2", "force": "a=1", "certificate": "c.json", "out": "o", "backend": "wasm", "_backend": "wasm",
    "vary": "controllers.axis.K_p=1:2", "uncertainty": "u.toml", "part": "law", "scenario": "stick_slip.toml", "fmi": "2",
    "target": "c", "step": "1e-3", "creep": "1e-6", "share": "0.9", "steady_error": "0.1", "speed": "0.1",
    "mass": "2", "time": "t",
    "position": "v", "velocity": "v", "acceleration": "v", "load": "F", "pressure": "F", "run": "F", "force_gain": "2",
    "unit": "v=mm/s", "term": "stiffness", "method": "static", "free": "k_v", "filter_": "published",
    "cutoff": "20", "starts": "3", "seed": "4", "output": "velocity", "unknown": "F_c=1:2", "require": "F_c=5%",
    "plan": "stroke=1,speed=1,force=1", "logs": "axis.logs.toml", "fit": "fit", "machine": "body.toml", "command": "F",
    "samples": "5", "threads": "2",
}  # fmt: skip


class _Called(BaseException):
    """A command has come to its end, with these arguments."""


def _call_of(function):
    def called(*args, **kwargs):
        reported = [_told(x) for x in args] + [f"{k}={_told(x)}" for k, x in kwargs.items()]
        raise _Called(function.rpartition(".")[2], *(x for x in reported if "<function" not in x))

    return called


def _told(value):
    if isinstance(value, Scenario):
        return f"{value.name}: {hashlib.sha256(repr(value.data).encode()).hexdigest()[:8]}"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{k}: {_told(x)}' for k, x in value.items())}}}"
    return "<function" if callable(value) and not isinstance(value, type) else repr(value)


def _passed_on(name):
    """The call without options; what each option changes in it, or is refused for; what two are refused for together."""
    command = typer.main.get_command(app).commands[name]
    ends, first = ENDS[name]
    start = shlex.split(first)
    options = {
        p.name: p for p in command.params if p.param_type_name == "option" and p.opts[0] not in (*start, "--help")
    }
    given = {n: [p.opts[0], *([] if p.is_flag else [GIVEN[n]])] for n, p in options.items() if p.is_flag or n in GIVEN}
    valued = {n: p.opts[0] for n, p in options.items() if not p.is_flag}
    keys = {n: GIVEN[n].partition("=")[0] for n in valued if "=" in GIVEN.get(n, "")}  # of those that are KEY=VALUE
    wrong = {f"{n} = {x!r}": [opt, x] for n, opt in valued.items() for x in ("?", "-1", "0", "")}
    wrong |= {f"{n} = {key}={x}": [valued[n], f"{key}={x}"] for n, key in keys.items() for x in ("-1", "0", "x", "")}
    inputs(f"{first} stick_slip.toml body.toml axis.logs.toml axis.toml")
    with pytest.MonkeyPatch.context() as patch:
        for end in ends.split():
            patch.setattr(f"stribeck.{end}", _call_of(end))
        usual = _came(name, start)
        yield f"not tried: {sorted(set(options) - set(given))}"
        yield from usual
        alone = {
            n: [x for x in _came(name, [*start, *words]) if x not in usual] for n, words in (given | wrong).items()
        }
        yield from (f"{n}: {line}" for n, lines in alone.items() for line in lines)
        for a, b in itertools.combinations(given, 2):
            known = [*usual, *alone[a], *alone[b]]
            yield from (f"{a}, {b}: {x}" for x in _came(name, [*start, *given[a], *given[b]]) if x not in known)


def _came(name, words):
    """The arguments that a command ends with, or what it says."""
    try:
        status, out, err = call(name, *words)
    except _Called as called:
        return list(called.args)
    return [f"{status}: {line}" for line in [*out.splitlines()[:3], *err.splitlines()]]


for _name in ENDS:
    kept(f"options/{_name}")(functools.partial(_passed_on, _name))


U, W = symbol("u"), symbol("w")
GROWN = (  # of one argument, and of two
    (lambda x: 2 + ops.sin(x), lambda x: ops.exp(-x), lambda x: ops.atan(x) * (2 / ops.pi), lambda x: ops.sqrt(1 + x * x),
     lambda x: ops.tanh(x) + x, lambda x: x**2, lambda x: ops.log(1 + x), abs, ops.sign, lambda x: x**1.5, lambda x: 1 / (1 + x)),
    (operator.add, operator.mul, operator.sub, lambda x, y: x / (0.5 + y), lambda x, y: x / (1 - y),
     lambda x, y: ops.where(x < y, x, y + 1),
     lambda x, y: ops.clip(x - y, 0.0, 1.0), ops.smaller, lambda x, y: ops.where(ops.either(x < 1, y > 2), x * y, x + y)),
)  # fmt: skip


def _grown(rng, depth):
    """A random expression of u and w."""
    if depth == 0 or rng.random() < 0.2:
        return rng.choice([U, W, U, W, constant(rng.choice([0.5, 1.0, 2.0, 3.0]))])
    if rng.random() < 0.4:
        return rng.choice(GROWN[0])(_grown(rng, depth - 1))
    return rng.choice(GROWN[1])(_grown(rng, depth - 1), _grown(rng, depth - 1))


@kept("prover/claims")
def _():
    """Random claims over whole regions: which are shown, and by what tree."""
    rng = random.Random(1)
    nothing, one, two = Fraction(0), Fraction(1), Fraction(2)
    regions = [{"u": (nothing, None), "w": (nothing, None)}, {"u": (nothing, one), "w": (one, two)}, {"u": (one, None)}]
    many = sum((ops.clip(k * U - W, 0.0, 1.0) for k in range(1, 30)), constant(1.0))
    rooted = [ops.where(ops.sqrt(x) < 2, 1 + U, -U) for x in (U, U - 0.5)]
    for expr in [many, U / W, (U - W) / (U - 1), *rooted, *(_grown(rng, 3) for _ in range(70))]:
        yield f"== {pretty.write(expr, {'u': 'u', 'w': 'w'}, latex=False)}"
        for ranges, closed in zip(regions, (False, True, False), strict=True):
            if not symbols([expr]) <= set(ranges):
                continue
            for relation in (">=0", ">0", "!=0", "=0"):
                try:
                    tree = Prover(Ring({}), {}).show(expr, relation, ranges, Budget(12), closed)
                except Exception as error:
                    yield f"{relation} {type(error).__name__}: {error}"
                    continue
                text = "open" if tree is None else f"shown {len(str(tree))} {shown.digest(str(tree))[0][:8]}"
                yield f"{relation} on {', '.join(f'{n} {a} to {b}' for n, (a, b) in ranges.items())}: {text}"


@kept("laws/extreme")
def _():
    """Constants at the ends of what floats hold."""
    for name, law in laws():
        for constant_name in law.p.numbers:
            for x in (1e-300, 1e300, 1e-30, 1e30):
                message = []
                with warnings.catch_warnings(), np.errstate(all="ignore"):
                    warnings.simplefilter("ignore")
                    try:
                        other = law.replace(**{constant_name: x})
                        message = [overflow(other), trouble(other), numbers(other.steady_force([1e-3, 1.0]))]
                    except InputError as error:
                        message = error.problems
                    except ArithmeticError as error:
                        message = [type(error).__name__]
                if message[:2] != [None, None]:
                    yield f"{name} {constant_name}={x:g}: {message}"


class OnNumPy(ArrayLaw):
    """A law on NumPy's arrays, as torch and JAX have it."""

    def __init__(self, law):
        names = {"atan": "arctan", "both": "logical_and", "either": "logical_or"}
        super().__init__(law, Operations("numpy", **names), np.broadcast_arrays)

    def _arrays(self, *values):
        return [np.asarray(x, float) for x in values]

    def _step(self, p, given):
        return stepping.solved(np, stepping.loop, self._equations, SimpleNamespace(**p), given)[:2]


@kept("python/loads")
def _():
    for path, contact in (("loads_and_factors", "hub"), ("everything", "brush"), ("everything", "felt")):
        law = contact_law(Scenario.load(PLACES[2] / f"{path}.toml"), contact)
        yield f"== {path} {contact}: {law.inputs}"
        for load in (None, np.ones(1), np.ones((3, 1)), np.ones((3, 2)), np.ones((2, 4)), np.ones((1, 5))):
            for given in ({}, {"F_c": 2.0}, {"F_d": 2.0}):
                shape = None if load is None else load.shape
                try:
                    steps = OnNumPy(law).step(0.0, 0.1, 0.5, 2.0, 1e-3, load, **given)
                    yield f"{shape} {given}: {'; '.join(map(numbers, steps))}"
                except InputError as error:
                    yield from (f"{shape} {given}: {x}" for x in error.problems)


@kept("scenario/changed")
def _():
    """A machine with other values: what follows from them."""
    for path in MACHINES[::3]:
        elements = Scenario.load(path).elements
        yield f"== {path.stem}"
        for key in list(elements.values)[::4]:
            moved = elements.with_values({key: 1.5 * elements.values[key] + 0.25})
            others = {n: law.values for n, law in moved.laws.items() if law.values != elements.laws[n].values}
            natural = {n: float(f"{x:.6g}") for n, x in moved.natural.items() if x != elements.natural[n]}
            yield f"{'.'.join(key)}: {float(moved.values[key]):.9g} {others} {natural}"


def _file(name, content):
    """A file with this content, text or columns; its name."""
    if isinstance(content, dict):
        {".npz": np.savez, ".mat": lambda path, **columns: savemat(path, columns)}[Path(name).suffix](name, **content)
    else:
        Path(name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return name


def _table(text, *wanted):
    """What is read of a text file by pyarrow, and line by line without it."""
    reported = _columns(path := _file("table.csv", text), *wanted)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("stribeck.recorded.find_spec", lambda name: None)
        alone = _columns(path, *wanted)
    return reported if reported == alone else f"{reported}\nwithout pyarrow:\n{alone}"


def _columns(data, *wanted):
    """The names of a table, its units and constants, and its columns: at once, or each alone if some are refused."""
    try:
        source = opened(data)
    except InputError as error:
        return "\n".join(f"! {problem}" for problem in error.problems)
    names = wanted or source.names[:9]
    lines = [f"{source.names[:99]} {source.stated or ''} {source.constants or ''}"]
    try:
        result = source.columns({name: name for name in names})
        lines += (f"{n}: {str(x[:9].tolist())[1:-1]}, {len(x)} rows" for n, x in result.items())
    except InputError as error:
        lines += (f"! {problem}" for problem in error.problems)
        lines += (_columns(data, name).partition("\n")[2] for name in names if len(names) > 1)
    return "\n".join(dict.fromkeys(lines))


def _exact(texts):
    """Texts whose numbers are compared letter by letter: they are part of a word."""
    return "_".join(["", *map(str, texts), ""])


def _own(text, k_v=1e6):
    """What a scenario and the commands that take a law say of one in a file."""
    law = {"name": _file("own.py", text) + ":Rooted", "k_v": k_v, "parameters": "canudas1995"}
    reported = [*_refusal("a scenario", {**RIG, "law": law})]
    for command in (
        "library",
        "check --parameters canudas1995 --set",
        "export --target table --out own.csv --parameters canudas1995 --set",
    ):
        first, *words = command.split()
        status, out, err = call(first, law["name"], *words, *[f"k_v={k_v}"] * bool(words))
        reported += [f"{first}: {status}, {len(out.splitlines())} lines", *err.splitlines()]
    return "\n".join(reported)


def _drawn(content, name="record.csv", **more):
    """What a signal of a file is at some times."""
    signal = {
        "kind": "file",
        "path": name if content is None else _file(name, content),
        "time": "t",
        "value": "v",
        **more,
    }
    scenario = Scenario({**RIG, "drive": {"kind": "force", "signal": signal}})
    return f"{scenario.signal.t} {scenario.signal.value} {scenario.signal.at([-1.0, 0.1, 1.0])}"


def _values(lines):
    names = {name: getattr(stribeck, name) for name in stribeck.__all__} | {"np": np, "Turned": Turned}
    names |= {"ops": ops, "coq": coq, "pretty": pretty, "constant": constant, "symbol": symbol, "x": X, "y": Y}
    names |= {"CANUDAS": CANUDAS, "nan": np.nan, "inf": np.inf, "show": show, "nearest": stribeck.errors.nearest}
    names |= {
        each.__name__: each for each in (cells.percent, cells.human, cells.rounded_up, cells.prefixed, Uncertain, Ends)
    }
    names |= {
        "model": lambda fit: "\n".join(model_lines(fit)),
        "cell": cells.text,
        "exact": _exact,
        "assigned": lambda text: _exact(map(repr, parse_assignment(text))),
    }
    names["written"] = lambda expr: "\n".join(pretty.write(expr, SHOWN, latex=latex) for latex in (False, True))
    names |= {"file": _file, "table": _table, "columns": _columns, "read": read, "ColumnNames": ColumnNames}
    names |= {"pd": pd, "pa": pa, "T": np.arange(200) * 1e-3, "RIG": RIG}
    names |= {"LAW": (INPUTS / "laws.py").read_text(), "drawn": _drawn, "own": _own, "Range": Range}
    inputs("\n".join(lines) + "axis.logs.toml")
    for line in lines:
        yield f">>> {line}"
        with warnings.catch_warnings(record=True) as notes:
            warnings.simplefilter("always", stribeck.errors.StribeckNote)
            try:
                yield from str(eval(line, names)).splitlines()
            except InputError as error:
                yield from (f"! {problem}" for problem in error.problems)
            except Exception as error:
                yield f"! {type(error).__name__}: {error}"
        yield from (
            f"note: {each.message}" for each in notes if issubclass(each.category, stribeck.errors.StribeckNote)
        )


_LINES = [x for x in Path(__file__).with_name("expressions.txt").read_text().splitlines() if x and x[0] != "#"]
for _name, _part in itertools.groupby(
    _LINES, lambda line: line.partition("(")[0].rpartition(".")[0] or line.partition("(")[0]
):
    kept(f"calls/{_name}", 1e-5, "wasm")(functools.partial(_values, list(_part)))
