"""The scenario of a fit, driven as its record was, and what was measured, to be shown beside the simulation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.constants import show
from stribeck.errors import InputError, arg
from stribeck.explore.beside import Beside, Report, short
from stribeck.identify import api, predict
from stribeck.identify.actuator.coordinates import NEUTRAL, MachineCoordinate
from stribeck.identify.actuator.estimate import first_noise
from stribeck.identify.actuator.problem import MachineProblem
from stribeck.identify.actuator.recordings import Recording, read_logs
from stribeck.identify.actuator.result import MachineFit
from stribeck.identify.actuator.runs import Compared, RecordedRun
from stribeck.identify.actuator.solve import search
from stribeck.identify.actuator.starts import begun
from stribeck.identify.core.states import Estimate
from stribeck.identify.data.prepare import Preparation
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.log import Log
from stribeck.identify.result import Fit, LogFit
from stribeck.laws.base import PARAMETERS
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
    found = Fit.load(folder, trust)
    return _of_log(folder, found, trust) if isinstance(found, LogFit) else _of_machine(folder, found)


def _of_log(folder: Path, fit: LogFit, trust: bool) -> Report:
    """The law along the measured motion, or under the measured force where the motion was fitted."""
    kept = fit.reading
    if not kept.files:
        raise InputError(f"{arg('report')}: {show(str(folder))}: names no file of a record; must be fitted from a file")
    files = [Path(name) for name in kept.files]
    reading = ColumnNames(dict(kept.columns), dict(kept.units), kept.force_gain)
    simulated = api.is_simulated([fit.law_name], fit.method)
    log = api.log_of(files, reading, Preparation(kept.cutoff, None, simulated, kept.published))
    first = next(log.runs())
    log = log.rows(slice(first.start, min(first.stop, first.start + _MOST)))
    by_force = kept.output != "force"
    scenario = _scenario(files[0].stem, fit, log, by_force, trust)
    if by_force:
        scenario = _begun(scenario, log)
    return Report(scenario, _intervals(fit), _measured(fit, log, by_force, files))


def _scenario(name: str, fit: LogFit, log: Log, by_force: bool, trust: bool) -> Scenario:
    kind = laws.find(fit.law_name)
    values = {n: x for n, x in fit.of_curve.items() if n in kind.constants()}
    machine = {n: values.pop(n) for n in list(values) if n in PARAMETERS}
    law = {"name": fit.law_name, **values, **({"parameters": machine} if machine else {})}
    t = log.time - log.time[0]
    value = log.force - predict.beside(fit, log, without=("mass",)) if by_force else log.velocity
    start = {"y": float(log.position[0])} | ({"v": float(log.velocity[0])} if by_force else {})
    if kind.has_z:  # as bristles are that have slid at this speed
        start["z"] = float(kind({**values, **machine}).steady_deflection(float(log.velocity[0])))
    drive = {"kind": "force" if by_force else "velocity"}
    plant: dict[str, object] = {"initial": start}
    if by_force:
        plant["mass"] = float(fit.of_curve["mass"])
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


def _measured(fit: LogFit, log: Log, by_force: bool, files: list[Path]) -> Beside:
    t, name = log.time - log.time[0], ", ".join(path.name for path in files)
    about = f"{name}, the first {len(log)} rows"
    if by_force:
        return Beside(about, {"y": (t, log.position), "v": (t, log.velocity)})
    left = [n for n in fit.terms if n == "delay" or n.startswith(("F_c_by", "sigma_2_by"))]
    left += dict.fromkeys(form for form, _ in fit.predictor.forms) if fit.predictor else []
    if left:
        about += f"; the curve has no {', '.join(left)}, which the fit has"
    friction = log.force - predict.beside(fit, log)
    return Beside(about, {"y": (t, log.position), "v": (t, log.velocity), "F": (t, friction)}, ("y", "v"))


def _intervals(fit: LogFit) -> dict[str, tuple[float, float]]:
    """The closed intervals, by the path of each number."""
    paths = {n: f"law.parameters.{n}" if n in PARAMETERS else f"law.{n}" for n in laws.find(fit.law_name).constants()}
    return _closed(
        {paths.get(n, "plant.mass" if n == "mass" else n): e for n, e in {**fit.estimates, **fit.body}.items()}
    )


def _closed(estimates: Mapping[str, Estimate]) -> dict[str, tuple[float, float]]:
    return {n: e.interval for n, e in estimates.items() if e.low is not None and e.high is not None}


def _of_machine(folder: Path, fit: Fit) -> Report:
    """The fitted machine in its first recording."""
    assert isinstance(fit, MachineFit)
    if fit.source is None or not fit.data:
        must = "must be a folder of a fit that is done (its fit.json names the logs; machine.toml is beside it)"
        raise InputError(f"{arg('report')}: {show(str(folder))}: {must}")
    estimates = _of_first(fit.estimates)
    value = {name: e.value for name, e in estimates.items()}
    scenario = fit.machine.with_changes({name: x for name, x in value.items() if not name.startswith("outputs.")})
    recording = read_logs(fit.source, needs_unknown=False).recordings[0]
    last = min(len(recording.t), _MOST) - 1
    end, shown = float(recording.t[last]), None if last + 1 == len(recording.t) else (0.0, float(recording.t[last]))
    run, begins = begun(scenario, recording, 0, set(estimates), shown)
    columns = {each.column: _true(each, value) for each in run.targets}
    start = _started(run, begins, columns, recording)
    about = f"{Path(recording.file).name}, {_part(recording, end)}"
    return Report(
        run.scenario.with_changes(start) if start else run.scenario, _closed(estimates), Beside(about, columns)
    )


def _of_first(parameters: Mapping[str, Estimate]) -> dict[str, Estimate]:
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


def _part(recording: Recording, end: float) -> str:
    whole = float(recording.t[-1])
    return "the whole record" if end >= whole else f"its first {end:.4g} s of {whole:.4g} s"


def _true(reading: Compared, value: Mapping[str, float]) -> tuple[Array, Array]:
    """A reading without what its sensor adds, where that was fitted."""
    of = {what: value.get(f"outputs.{reading.column}.{what}", neutral) for what, neutral in NEUTRAL.items()}
    return reading.t - of["delay"] - of["clock"] * reading.t, (reading.x - of["offset"]) / of["gain"]
