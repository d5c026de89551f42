"""Do the 95 % intervals of fits by simulation hold with ordinary sensors? A table of cells, each a way to measure.

A body of 1.1 kg under LuGre friction (constants within 25 % of those of Canudas de Wit et al. 1995) is driven by two sines
of force that never exceed three times its Coulomb friction. Each cell changes how that is recorded: noise of the
position, sampling, quantisation, drift, outliers; and what is fitted, the position for the force or the force for the
motion. Files are written and read back, so that the whole chain of a user's fit is under test.

    python benchmarks/coverage_cells.py [--cells NAME ...] [--intervals 200] [--experiments 200] [--workers 2] [--list]

Every experiment has a seed of its own; what benchmarks/results/coverage_cells.json has already is not run again. A cell
ends once so many intervals are called known, held or not, or when its experiments are used up; as many run at a time as there
are workers.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import time
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import stribeck

RESULTS = Path(__file__).parent / "results" / "coverage_cells.json"
NOMINAL = {"sigma_0": 1e5, "sigma_1": 316.0, "sigma_2": 0.4, "F_c": 1.0, "v_s": 1e-3}
MASS, FINER = 1.1, 20000.0


@dataclass(frozen=True)
class Cell:
    """How an experiment is recorded and fitted; SI units. ``outliers``: the share of positions that are wild; ``drift``: of
    the position over the record."""

    output: str = "position"
    noise: float = 1e-6
    rate: float = 500.0
    seconds: float = 20.0
    quantum: float = 0.0
    force_noise: float = 0.0
    drift: float = 0.0
    outliers: float = 0.0


CELLS = {
    "position, 0.1 um": Cell(noise=1e-7),
    "position, 1 um": Cell(),
    "position, 10 um": Cell(noise=1e-5),
    "position, 100 Hz": Cell(rate=100.0),
    "position, 2 kHz": Cell(rate=2000.0, seconds=10.0),
    "position, 10 kHz": Cell(rate=10000.0, seconds=4.0),
    "position, encoder steps of 1 um": Cell(noise=0.0, quantum=1e-6),
    "position, drift of 5 um": Cell(drift=5e-6),
    "position, 0.2 % outliers": Cell(outliers=0.002),
    "position, 1 % force noise": Cell(force_noise=0.01),
    "velocity from the position, 1 um": Cell(output="velocity"),
    "force, 5 nm": Cell("force", noise=5e-9, force_noise=0.01),
    "force, 0.1 um": Cell("force", noise=1e-7, force_noise=0.01),
    "force, 1 um": Cell("force", force_noise=0.01),
    "force, 10 um": Cell("force", noise=1e-5, force_noise=0.01),
    "force, 0.1 um, 100 Hz": Cell("force", noise=1e-7, rate=100.0, force_noise=0.01),
    "force, 0.1 um, 2 kHz": Cell("force", noise=1e-7, rate=2000.0, seconds=10.0, force_noise=0.01),
    "force, 0.1 um, 10 kHz": Cell("force", noise=1e-7, rate=10000.0, seconds=4.0, force_noise=0.01),
    "force, encoder steps of 0.1 um": Cell("force", noise=0.0, quantum=1e-7, force_noise=0.01),
}


def record(cell: Cell, seed: int, path: Path) -> dict[str, float]:
    """Write the log of an experiment; the truth behind it."""
    draw = np.random.default_rng(seed)
    truth = {name: value * float(np.exp(draw.uniform(-0.25, 0.25))) for name, value in NOMINAL.items()}
    truth["F_s"] = truth["F_c"] * float(draw.uniform(1.3, 1.6))
    slow, fast = draw.uniform(0.3, 0.5), draw.uniform(1.3, 1.9)
    t = np.arange(0, cell.seconds + 0.5 / FINER, 20 / FINER)
    force = 2.1 * np.sin(2 * np.pi * slow * t) + 0.7 * np.sin(2 * np.pi * fast * t)
    scenario = stribeck.Scenario(
        law={"name": "lugre", "parameters": truth},
        plant={"mass": MASS},
        drive={"kind": "force", "signal": {"kind": "points", "t": t.tolist(), "value": force.tolist()}},
        solve={"t_end": float(t[-1]), "rtol": 1e-9},
        output={"step": 1 / cell.rate},
    )
    found = stribeck.simulate(scenario)
    assert found.status == "done", found.reason
    n = len(found.t)
    y = found["y"] + cell.noise * draw.standard_normal(n) + cell.drift * np.sin(np.pi * found.t / cell.seconds)
    wild = draw.random(n) < cell.outliers
    y = np.where(wild, y + 1e-3 * draw.standard_normal(n), y)
    y = cell.quantum * np.round(y / cell.quantum) if cell.quantum else y
    measured = np.interp(found.t, t, force) + cell.force_noise * draw.standard_normal(n)
    np.savez(path, t=found.t, y=y, F=measured)
    return truth


def one(name: str, seed: int) -> dict[str, Any]:
    """For each parameter of an experiment its truth, interval and verdict; or why there is no fit."""
    cell = CELLS[name]
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        path = Path(folder) / "log.npz"
        truth = {**record(cell, seed, path), "offset": 0.0}
        started = time.process_time()
        try:
            fit = stribeck.fit(
                path, "lugre", time="t", position="y", force="F", method="dynamic", mass=MASS, output=cell.output,
                starts=8, seed=seed,
            )  # fmt: skip
        except stribeck.StribeckError as error:
            return {"failed": str(error)}
    rows = {
        key: {
            "truth": truth[key], "low": e.low, "high": e.high, "known": e.identifiable,
            "covers": bool((e.low is None or e.low <= truth[key]) and (e.high is None or truth[key] <= e.high)),
        }
        for key, e in {**fit.estimates, **fit.body}.items()
    }  # fmt: skip
    return {"seconds": round(time.process_time() - started, 2), "parameters": rows, "notes": list(fit.notes)}


def summary(cases: list[dict[str, Any]]) -> dict[str, Any]:
    """Of the intervals of parameters called known: how many, how many hold the truth, half the median width."""
    fits = [case["parameters"] for case in cases if "parameters" in case]
    rows: dict[str, Any] = {}
    for key in fits[0] if fits else ():
        told = [fit[key] for fit in fits if fit[key]["known"]]
        widths = [(e["high"] - e["low"]) / 2 / abs(e["truth"]) for e in told if e["truth"]]
        rows[key] = {
            "known": len(told), "hold": sum(e["covers"] for e in told),
            "half_width": float(f"{np.median(widths):.2g}") if widths else None,
        }  # fmt: skip
    told = sum(row["known"] for row in rows.values())
    return {
        "experiments": len(cases), "failed": len(cases) - len(fits), "known": told,
        "of": sum(len(fit) for fit in fits), "hold": sum(row["hold"] for row in rows.values()),
        "median_seconds": float(np.median([c["seconds"] for c in cases if "seconds" in c] or [0])), "parameters": rows,
    }  # fmt: skip


def cell_of(name: str, have: dict[str, Any], given: argparse.Namespace, pool: ProcessPoolExecutor) -> dict[str, Any]:
    """The cell's experiments in the order of their seeds, until enough intervals are called known; its summary."""
    cases = have.get("cases", {}) if have.get("cell") == asdict(CELLS[name]) else {}
    told: list[dict[str, Any]] = []
    while len(told) < given.experiments and summary(told)["known"] < given.intervals:
        seeds = range(len(told), min(len(told) + given.workers, given.experiments))
        missing = [seed for seed in seeds if str(seed) not in cases]
        cases.update(zip(map(str, missing), pool.map(partial(one, name), missing), strict=True))
        told += [cases[str(seed)] for seed in seeds]
    return {"cell": asdict(CELLS[name]), "summary": summary(told), "cases": cases}


def main() -> None:
    """Run the cells that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cells", nargs="+", default=list(CELLS), choices=list(CELLS), metavar="NAME")
    parser.add_argument("--intervals", type=int, default=200, help="called known, of a cell")
    parser.add_argument("--experiments", type=int, default=200, help="of a cell, at most")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--list", action="store_true", help="the names of the cells")
    parser.add_argument("--out", type=Path, default=RESULTS)
    given = parser.parse_args()
    if given.list:
        print("\n".join(CELLS))
        return
    result = json.loads(given.out.read_text(encoding="utf-8")) if given.out.exists() else {"cells": {}}
    with ProcessPoolExecutor(given.workers) as pool:
        for name in given.cells:
            result["cells"][name] = cell_of(name, result["cells"].get(name, {}), given, pool)
            told = result["cells"][name]["summary"]
            given.out.write_text(json.dumps(result) + "\n", encoding="utf-8")
            share = f"{100 * told['hold'] / told['known']:.1f} %" if told["known"] else "-"
            print(f"{name}: {share} of {told['known']} intervals hold; {told}", file=sys.stderr, flush=True)
    cells = result["cells"].values()
    known, hold, experiments = (sum(c["summary"][n] for c in cells) for n in ("known", "hold", "experiments"))
    hours = sum(case.get("seconds", 0.0) for c in cells for case in c["cases"].values()) / 3600
    print(f"{hold} of {known} intervals hold, {experiments} experiments, {hours:.1f} hours of processor time")


if __name__ == "__main__":
    main()
