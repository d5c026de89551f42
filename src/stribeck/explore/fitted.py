"""The scenario of a fit, driven as its record was, and what was measured, to be shown beside the simulation."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, arg
from stribeck.explore.beside import Beside, Report, short
from stribeck.files import read_file
from stribeck.identify import api, predict
from stribeck.identify.actuator.coordinates import NEUTRAL, MachineCoordinate
from stribeck.identify.actuator.estimate import first_noise
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording, read_logs
from stribeck.identify.actuator.runs import Compared, RecordedRun
from stribeck.identify.actuator.solve import search
from stribeck.identify.actuator.starts import begun
from stribeck.identify.data.prepare import Preparation
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.log import Log
from stribeck.laws.base import PARAMETERS, Law
from stribeck.scenario import Scenario
from stribeck.simulation import simulate

_PARTS = (0.03, 0.1, 0.3, 1.0)  # of the record, to which the start is fitted one after the other
_FIRST = "log.0."  # what begins the names of the first recording's own numbers
_MOST = 6000  # rows of a record that a page shows, from its beginning


def of_folder(folder: Path, trust: bool) -> Report:
    """What ``stribeck fit --out`` left in a folder, of one body or of a machine.

    Raises:
        InputError: files that it names are gone, or cannot be read as then.
    """
    return _of_fit(folder, trust) if (folder / predict.FILE).exists() else _of_machine_fit(folder, trust)


def _of_fit(folder: Path, trust: bool) -> Report:
    """The law along the measured motion, or under the measured force where the motion was fitted."""
    model = predict.load(folder, trust)
    if not model.files:
        raise InputError(f"{arg('report')}: {show(str(folder))}: names no file of a record; must be fitted from a file")
    files = [folder / name for name in model.files]
    reading = ColumnNames(dict(model.columns), dict(model.units), model.force_gain)
    simulated = api.is_simulated([model.law], model.method)
    log = api.log_of(files, reading, Preparation(model.cutoff, None, simulated, model.published))
    first = next(log.runs())
    log = log.rows(slice(first.start, min(first.stop, first.start + _MOST)))
    by_force = model.output != "force"
    scenario = _scenario(files[0].stem, model, log, by_force, trust)
    if by_force:
        scenario = _begun(scenario, log)
    return Report(scenario, _intervals(folder, scenario.law), _measured(model, log, by_force, files))


def _scenario(name: str, model: predict.FittedModel, log: Log, by_force: bool, trust: bool) -> Scenario:
    kind = laws.find(model.law)
    values = {n: x for n, x in model.values.items() if n in kind.constants()}
    machine = {n: values.pop(n) for n in list(values) if n in PARAMETERS}
    law = {"name": model.law, **values, **({"parameters": machine} if machine else {})}
    t = log.time - log.time[0]
    value = log.force - predict.beside(model, log, without=("mass",)) if by_force else log.velocity
    start = {"y": float(log.position[0])} | ({"v": float(log.velocity[0])} if by_force else {})
    if kind.has_z:  # as bristles are that have slid at this speed
        start["z"] = float(kind({**values, **machine}).steady_deflection(float(log.velocity[0])))
    drive = {"kind": "force" if by_force else "velocity"}
    plant: dict[str, object] = {"initial": start}
    if by_force:
        plant["mass"] = float(model.values["mass"])
    return Scenario(
        {
            "schema": 1, "name": name, "law": law, "plant": plant,
            "drive": {**drive, "signal": {"kind": "points", "t": short(t), "value": short(value, float(abs(value).max()))}},
            "solve": {"t_end": float(t[-1])}, "output": {"step": float(log.step)},
        },
        folder=Path(), trust=trust,
    )  # fmt: skip


def _begun(scenario: Scenario, log: Log) -> Scenario:
    """With the start, bristles too, from which the simulation follows the measured position: from a short part of it on."""
    from scipy.optimize import least_squares

    t, y = log.time - log.time[0], log.position
    scales = scenario.law.scales(scenario.law.p)
    size = {"y": scales.length, "v": scales.speed, "z": scales.length}
    start = {n: x for n, x in scenario.initial.items() if n in size}
    begin = np.array([start[n] / size[n] for n in start])

    def changed(u: Array, end: float) -> Scenario:
        values = {f"plant.initial.{n}": float(x) * size[n] for n, x in zip(start, u, strict=True)}
        return scenario.with_changes({**values, "solve.t_end": end})

    for share in _PARTS:
        rows = max(int(share * len(t)), 8)

        def missed(u: Array, rows: int = rows) -> Array:
            found = simulate(changed(u, float(t[rows - 1])))["y"]
            left = np.full(rows, y[:rows].std() + scales.length)
            left[: len(found)] = found[:rows] - y[: len(found)]
            return left / scales.length

        best = least_squares(missed, begin, diff_step=[1e-3] * len(start), max_nfev=20)
        if best.cost < 0.5 * float(missed(begin) @ missed(begin)):
            begin = best.x
    return changed(begin, scenario.solve.t_end)


def _measured(model: predict.FittedModel, log: Log, by_force: bool, files: list[Path]) -> Beside:
    t, name = log.time - log.time[0], ", ".join(path.name for path in files)
    about = f"{name}, the first {len(log)} rows"
    if by_force:
        return Beside(about, {"y": (t, log.position), "v": (t, log.velocity)})
    left = [n for n in model.body if n == "delay" or n.startswith(("F_c_by", "sigma_2_by"))]
    left += dict.fromkeys(form for form, _ in model.predictor.forms) if model.predictor else []
    if left:
        about += f"; the curve has no {', '.join(left)}, which the fit has"
    friction = log.force - predict.beside(model, log)
    return Beside(about, {"y": (t, log.position), "v": (t, log.velocity), "F": (t, friction)}, ("y", "v"))


def _intervals(folder: Path, law: Law) -> dict[str, tuple[float, float]]:
    """The intervals that parameters.toml tells, by the path of each number."""
    found = _toml(folder / "parameters.toml")
    paths = {n: f"law.parameters.{n}" if n in PARAMETERS else f"law.{n}" for n in law.constants()}
    tables = (found.get(name) for name in ("parameters", "body"))
    told: dict[str, object] = {n: x for table in tables if isinstance(table, Mapping) for n, x in table.items()}
    _check(folder, {n: x for n, x in told.items() if isinstance(x, Mapping)})
    return _ends({paths.get(n, "plant.mass" if n == "mass" else n): x for n, x in told.items()})


def _check(folder: Path, parameters: object) -> None:
    """Refuse numbers that no fit wrote.

    Raises:
        InputError: what was found is no table, or holds entries without a value, or ends that are no numbers.
    """
    place = f"{arg('report')}: {show(str(folder / 'parameters.toml'))}: parameters"
    if not isinstance(parameters, Mapping):
        found = "missing" if parameters is None else show(parameters)
        raise InputError(f"{place}: {found}: must be a table")
    problems = []
    for name, each in parameters.items():
        if not isinstance(each, Mapping) or "value" not in each:
            problems.append(f"{place}.{name}: {show(each)}: must be a table with a value")
            continue
        ends = {key: each[key] for key in ("value", "low", "high") if key in each}
        wrong = {key: x for key, x in ends.items() if isinstance(x, bool) or not isinstance(x, int | float) or x != x}
        problems += [f"{place}.{name}.{key}: {show(x)}: must be a number" for key, x in wrong.items()]
    if problems:
        raise InputError(problems)


def _ends(told: Mapping[str, object]) -> dict[str, tuple[float, float]]:
    found = {}
    for path, x in told.items():
        low, high = (x.get("low"), x.get("high")) if isinstance(x, Mapping) else (None, None)
        if isinstance(low, float) and isinstance(high, float):
            found[path] = (low, high)
    return found


def _of_machine_fit(folder: Path, trust: bool) -> Report:
    """The fitted machine in its first recording."""
    kept = _toml(folder / "parameters.toml")
    logs = kept.get("logs")
    if not isinstance(logs, str) or not (folder / "machine.toml").is_file():
        must = "must be a folder of a fit that is done (its parameters.toml names the logs; machine.toml is beside it)"
        raise InputError(f"{arg('report')}: {show(str(folder))}: {must}")
    _check(folder, kept.get("parameters"))
    parameters = _of_first(cast("Mapping[str, Mapping[str, float]]", kept["parameters"]))
    value = {name: float(each["value"]) for name, each in parameters.items()}
    scenario = Scenario.load(folder / "machine.toml", {}, trust=trust)
    scenario = scenario.with_changes({name: x for name, x in value.items() if not name.startswith("outputs.")})
    recording = read_logs(folder / logs, needs_unknown=False).recordings[0]
    last = min(len(recording.t), _MOST) - 1
    end, shown = float(recording.t[last]), None if last + 1 == len(recording.t) else (0.0, float(recording.t[last]))
    run, begins = begun(scenario, recording, 0, set(parameters), shown)
    columns = {each.column: _true(each, value) for each in run.targets}
    start = _started(run, begins, columns, recording)
    about = f"{Path(recording.file).name}, {_part(recording, end)}"
    return Report(
        run.scenario.with_changes(start) if start else run.scenario, _ends(parameters), Beside(about, columns)
    )


def _of_first(parameters: Mapping[str, Mapping[str, float]]) -> dict[str, Mapping[str, float]]:
    """What was found of all recordings and of the first one alone, by the machine's paths."""
    found = {name: each for name, each in parameters.items() if not name.startswith("log.")}
    for name, each in parameters.items():
        if name.startswith(_FIRST):
            path = name.removeprefix(_FIRST)
            start = path.split(".")
            found[f"bodies.{start[1]}.initial.{start[2]}" if start[0] == "initial" else path] = each
    return found


def _started(
    run: RecordedRun, begins: list[MachineCoordinate], columns: Mapping[str, tuple[Array, Array]], recording: Recording
) -> dict[str, float]:
    """The start from which the fitted machine follows the recording: the fit does not keep the one that it found."""
    if not begins:
        return run.start
    run = replace(run, targets=[Compared(name, t, x) for name, (t, x) in columns.items()])
    problem = MachineProblem([run], begins, first_noise([recording])[0])
    found = problem.values(search(problem, 1, 0).u)
    return run.start | {path: share * found[c.name] for c in begins for path, share in c.targets.items()}


def _toml(path: Path) -> dict[str, object]:
    try:
        return tomllib.loads(read_file(path).decode())
    except (OSError, ValueError):
        return {}


def _part(recording: Recording, end: float) -> str:
    whole = float(recording.t[-1])
    return "the whole record" if end >= whole else f"its first {end:.4g} s of {whole:.4g} s"


def _true(reading: Compared, value: Mapping[str, float]) -> tuple[Array, Array]:
    """A reading without what its sensor adds, where that was fitted."""
    of = {what: value.get(f"outputs.{reading.column}.{what}", neutral) for what, neutral in NEUTRAL.items()}
    return reading.t - of["delay"] - of["clock"] * reading.t, (reading.x - of["offset"]) / of["gain"]
