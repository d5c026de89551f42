"""Do intervals (95 %) and model ranges of fits by simulation hold the truth? Counts on records with known truth.

    python benchmarks/intervals.py [--cases "machine slide"] [--count 2] [--first 500] [--workers 2]

``--cases`` takes the first words of their names: ``presliding``, ``body``, ``arm``, ``machine``, ``machine slide``. Each
experiment draws its constants, its motion and its noise from its seed. A case that is counted again replaces its counts in
the file.
"""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any

import dynamic_records as records
import numpy as np
from measure import Given, run, say, write

import stribeck
from stribeck.identify.actuator import Logs, fit_machine
from stribeck.identify.actuator.recordings import Channel, Recording, Sought
from stribeck.identify.core.states import Estimate
from stribeck.identify.onebody import simulated
from stribeck.identify.options import FitOptions

Found = tuple[Mapping[str, Estimate], dict[str, float]]  # estimates and their truth
BODY = {
    "position, 0.1 um": records.Sensing(noise=1e-7),
    "position, 1 um": records.Sensing(),
    "position, 10 um": records.Sensing(noise=1e-5),
    "position, 100 Hz": records.Sensing(rate=100.0),
    "position, 2 kHz": records.Sensing(rate=2000.0, seconds=6.0),
    "position, encoder of 1 um": records.Sensing(noise=0.0, quantum=1e-6),
    "position, drift of 5 um": records.Sensing(drift=5e-6),
    "position, 0.2 % outliers": records.Sensing(outliers=0.002),
    "position, 1 % force noise": records.Sensing(force_noise=0.01),
    "position 1 ms late, term delay": records.Sensing(delay=1e-3, term=True),
    "position 1 ms late": records.Sensing(delay=1e-3),
    "velocity from the position": records.Sensing(output="velocity"),
    "force, 5 nm": records.Sensing("force", noise=5e-9, force_noise=0.01),
    "force, 0.1 um": records.Sensing("force", noise=1e-7, force_noise=0.01),
    "force, 1 um": records.Sensing("force", force_noise=0.01),
    "force, encoder of 0.1 um": records.Sensing("force", noise=0.0, quantum=1e-7, force_noise=0.01),
}
TERMS = ("gravity_sin", "gravity_cos", "area", "stiffness", "sigma_2_by_direction")


def presliding(law: str, seed: int) -> Found:
    """A rig that makes small reversals and strokes of several speeds."""
    built = records.presliding(law, seed)
    fit = simulated(built.log, law, FitOptions(mass=0.0, set=records.RIG_LAWS[law], starts=4, seed=seed)).judged()
    return {**fit.estimates, **fit.body}, {**built.law.values, "offset": 0.0}


def body(how: records.Sensing, seed: int) -> Found:
    """A body under two sines of force."""
    columns, truth = records.body(how, seed)
    fit = stribeck.fit(
        columns, "lugre", time="t", position="y", force="F", method="dynamic", mass=records.MASS, output=how.output,
        starts=8, seed=seed, term=("delay",) if how.term else (),
    )  # fmt: skip
    return {**fit.estimates, **fit.body}, truth


def arm(kind: str, seed: int) -> Found:
    """An arm that more than friction holds back."""
    columns, truth = records.arm(kind, seed)
    asked: dict[str, Any] = {"term": [name for name in TERMS if name in truth]}
    if kind == "torque":
        asked |= {"pressure": "tau", "set": {"area": 1.0}}
    fit = stribeck.fit(
        columns, "lugre", time="t", position="y", force="F", method="dynamic", output="position", starts=8, **asked
    )
    return {**fit.estimates, **fit.body}, truth


def of_machine(name: str, lacks: str, fault: str, seed: int) -> Found:
    """A machine by its recordings."""
    case, draw = records.CASES[name], np.random.default_rng([seed, len(name), len(lacks), len(fault)])
    truth = {
        n: x * (1.0 if n in records.KEPT else float(np.exp(0.15 * draw.standard_normal())))
        for n, x in case.usual.items()
    }
    term = records.lacking(draw, lacks) if lacks else records.Term()
    recordings = []
    for i in range(case.recordings):
        size = 0.7 + 0.6 * i if case.recordings > 1 else 1.0
        t, y, u = case.record(draw, truth, size, term)
        t, y, u = records.FAULTS[fault](t, y, u, draw) if fault else (t, y, u)
        every = 2 if fault == "coarse input" else 1
        sensor = "motor.y" if name == "belt" else "arm.y"
        outputs = {sensor: Channel("y", t, y + case.noise * draw.standard_normal(len(y)))}
        inputs = {case.drive: Channel("u", t[::every], u[::every], held=case.held)}
        recordings.append(Recording(f"run{i}", t, outputs, inputs, case.known(size)))
    sought = tuple(Sought(n, x / 8, 8 * x) for n, x in case.usual.items())
    fit = fit_machine(case.machine, Logs(tuple(recordings), sought), starts=3, seed=seed, baselines=False)
    return fit.estimates, truth


CASES: dict[str, Callable[[int], Found]] = {
    **{f"presliding, {law}": partial(presliding, law) for law in records.RIG_LAWS},
    **{f"body, {name}": partial(body, how) for name, how in BODY.items()},
    **{f"arm, {kind}": partial(arm, kind) for kind in records.HELD},
    **{f"machine {name}": partial(of_machine, name, "", "") for name in records.CASES},
    **{
        f"machine {n}, {fault}": partial(of_machine, n, "", fault) for n in ("arm", "slide") for fault in records.FAULTS
    },
    **{f"machine {n} that lacks {x}": partial(of_machine, n, x, "") for n in ("arm", "geared") for x in records.LACKS},
}


def experiment(name: str, seed: int) -> dict[str, Any]:
    """For each number its truth, estimate, both uncertainties and state; or why there is no fit."""
    started = time.process_time()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            estimates, truth = CASES[name](seed)
    except stribeck.StribeckError as error:
        return {"seed": seed, "failed": str(error)}
    rows = [
        {"name": n, "truth": truth[n], "value": e.value, "identified": e.identifiable, "state": str(e.state),
         "interval": holds(e.interval, truth[n]), "range": holds(e.range or e.interval, truth[n]),
         "half": (e.interval[1] - e.interval[0]) / 2 / abs(truth[n]) if truth[n] else None}
        for n, e in estimates.items()
    ]  # fmt: skip
    return {"seed": seed, "seconds": time.process_time() - started, "rows": rows}


def holds(ends: tuple[float, float], truth: float) -> bool:
    """Whether an interval or a range holds the truth."""
    return bool(ends[0] <= truth <= ends[1])


def counted(found: list[dict[str, Any]]) -> dict[str, Any]:
    """The counts of a case; those that miss by name, with their seeds."""
    rows = [(x["seed"], row) for x in found for row in x.get("rows", ())]
    texts = [(seed, row) for seed, row in rows if row["identified"]]
    widths = [row["half"] for _, row in texts if row["half"] is not None and np.isfinite(row["half"])]
    return {
        "first": found[0]["seed"], "experiments": len(found), "failed": [x["failed"] for x in found if "failed" in x],
        "numbers": len(rows), "identifiable": len(texts), "interval": sum(row["interval"] for _, row in texts),
        "range": sum(row["range"] for _, row in texts),
        "median_half_width": round(float(np.median(widths)), 5) if widths else None,
        "missed": [f"{row['name']}, {seed}" for seed, row in texts if not row["interval"]],
        "median_seconds": round(float(np.median([x["seconds"] for x in found if "seconds" in x] or [0.0])), 1),
    }  # fmt: skip


def benchmark(given: Given) -> dict[str, Any]:
    """Count the cases that are asked for."""
    kept = json.loads(given.out.read_text(encoding="utf-8")) if given.out.is_file() else {"cases": {}}
    chosen = [name for name in CASES if name.startswith(given.cases)]
    with ProcessPoolExecutor(given.workers) as pool:
        for name in chosen[:: 12 if given.quick and not given.cases else 1]:
            result = list(pool.map(partial(experiment, name), range(given.first, given.first + given.count)))
            kept["cases"][name] = counted(result)
            say(f"{name}: {kept['cases'][name]}")
            write(given.out, {**kept, "machine": given.machine})
    return {"cases": kept["cases"]}


if __name__ == "__main__":
    run(benchmark, __doc__, "coverage", cases="", count=(2, 1), first=500, workers=2)
