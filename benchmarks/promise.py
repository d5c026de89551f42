"""Not a speed: how large are errors? Of y, v and F over all rows, as parts of their peaks.

    python benchmarks/promise.py [--rigs 240] [--count 600] [--seed 1] [--minutes 15]

At tolerances (default_tolerance.json): random scenarios of all laws, drives and signals, at rtol 1e-6, 1e-7 and 1e-8 against
1e-11. Steps are counted, as times on a busy machine tell little.

At default settings (promise.json): y and v must be right to 1e-6 of their peaks, F to 1e-4, or a note must say so. Random
laws, drives and signals with constants over many decades, from motions far below a law's scales to laws that are far
from passive, where F is a small difference of large terms. References: promise.c, equations written apart, in extended precision,
by another method; at two tolerances, and where those differ by a tenth of the promise the set is left out. A set is left out too
where the reference takes more than 20 000 steps.
"""

from __future__ import annotations

import ctypes
import re
import sys
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
from measure import Given, compiled, finish, run, say

import stribeck
from stribeck.laws import builtin
from tests.simulation.random_rigs import random_rig

LAWS = (
    "lugre", "lugre_arctan", "lugre_sobczyk", "lugre_majorant", "elastoplastic", "elastoplastic_sobczyk",
    "elastoplastic_majorant", "dahl", "coulomb_viscous", "stribeck",
)  # fmt: skip
DRIVES, SIGNALS = ("force", "spring", "pid"), ("step", "sine", "ramp")
FIELDS = (
    "law", "drive", "signal", "mass", "sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s", "k_v", "z_ba", "stiffness",
    "K_p", "K_i", "K_d", "value", "time", "frequency", "rate", "t_end", "tolerance", "most",
)  # fmt: skip
PROMISED = {"y": 1e-6, "v": 1e-6, "F": 1e-4}
RTOLS, TIGHT = (1e-6, 1e-7, 1e-8), 1e-11
QUANTILES = (0.5, 0.9, 0.99, 1.0)
ROWS, MOST_STEPS, TOLERANCES = 201, 20_000, (1e-12, 1e-10)
Case = dict[str, Any]


def at_tolerances(given: Given) -> dict[str, Any]:
    """Quantiles of the errors of random scenarios at each tolerance, against a tight one; of y as parts of its range."""
    rows: dict[float, list[dict[str, float]]] = {rtol: [] for rtol in RTOLS}
    for k in range(given.rigs):
        data = random_rig([given.seed, k])
        tight, *looser = (
            stribeck.simulate(stribeck.Scenario({**data, "solve": {**data["solve"], "rtol": rtol}}))
            for rtol in (TIGHT, *RTOLS)
        )
        if tight.status != "done":
            say(f"{k}: {data['law']['name']}, {data['drive']['kind']}: the reference ended: {tight.reason}")
            continue
        peaks = {name: float(np.ptp(tight[name]) if name == "y" else np.max(abs(tight[name]))) for name in PROMISED}
        for rtol, found in zip(RTOLS, looser, strict=True):
            row = {n: float(np.max(abs(found[n] - tight[n]))) / max(peak, 1e-300) for n, peak in peaks.items()}
            rows[rtol].append(row | {"steps": int(found.stats["accepted"] + found.stats["rejected"])})
    table = [
        {"rtol": rtol, "scenarios": len(of), "steps": float(np.median([r["steps"] for r in of])),
         **{name: [float(np.quantile([r[name] for r in of], q)) for q in QUANTILES] for name in PROMISED}}
        for rtol, of in rows.items()
    ]  # fmt: skip
    return {"seed": given.seed, "count": given.rigs, "table": table}


def random_case(rng: np.random.Generator) -> Case:
    """A law with constants over many decades, and a drive of any strength."""

    def decades(low: float, high: float) -> float:
        return float(f"{10 ** rng.uniform(low, high):.3g}")

    law = str(rng.choice(LAWS, p=[0.09, 0.09, 0.09, 0.3, 0.07, 0.07, 0.14, 0.05, 0.05, 0.05]))
    p: Case = {"law": law, "drive": str(rng.choice(DRIVES)), "signal": str(rng.choice(SIGNALS)), "mass": decades(-9, 5)}
    p |= {"sigma_0": decades(0, 12), "sigma_1": decades(-3, 10), "sigma_2": decades(-8, 6), "F_c": decades(-7, 4)}
    p |= {"F_s": p["F_c"] * rng.uniform(1, 3), "v_s": decades(-7, 1), "k_v": decades(0, 8)}
    if rng.random() < 0.5:  # near passive, as machines are
        p["sigma_1"] = float(2 * rng.uniform(0.01, 1) * np.sqrt(p["sigma_0"] * p["mass"]))
    p["z_ba"] = p["F_c"] / p["sigma_0"] * rng.uniform(0.05, 0.95)
    force = p["F_s"] * (decades(-7, 1) if rng.random() < 0.5 else rng.uniform(0.5, 3))
    period = 2 * np.pi * np.sqrt(p["mass"] / p["sigma_0"]) * decades(0, 3)
    p["stiffness"] = p["sigma_0"] * decades(-4, 0)
    p["K_p"] = p["stiffness"]
    p["K_d"] = 2 * rng.uniform(0.2, 1) * float(np.sqrt(p["K_p"] * p["mass"]))
    p["K_i"] = 0.2 * p["K_p"] * float(np.sqrt(p["K_p"] / p["mass"])) * rng.uniform(0.01, 1)
    size = force if p["drive"] == "force" else force / p["stiffness"]
    p |= {"value": size, "frequency": 1 / period, "rate": size / period, "time": 0.1037 * period, "t_end": 2 * period}
    return p


def scenario_of(p: Case) -> dict[str, Any]:
    """The same for Stribeck."""
    names = builtin()[p["law"]].constants()
    machine_names = ("sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s")
    law = {"name": p["law"], **{n: p[n] for n in ("k_v", "z_ba") if n in names}}
    law["parameters"] = {n: p[n] for n in machine_names}
    drive = {
        "force": {}, "spring": {"stiffness": p["stiffness"]}, "pid": {n: p[n] for n in ("K_p", "K_i", "K_d")},
    }[p["drive"]]  # fmt: skip
    signal = {
        "step": {"value": p["value"], "time": p["time"]}, "sine": {"amplitude": p["value"], "frequency": p["frequency"]},
        "ramp": {"rate": p["rate"]},
    }[p["signal"]]  # fmt: skip
    return {
        "schema": 1, "name": "promise", "law": law, "plant": {"mass": p["mass"]},
        "drive": {"kind": p["drive"], **drive, "signal": {"kind": p["signal"], **signal}},
        "solve": {"t_end": p["t_end"]}, "output": {"step": p["t_end"] / (ROWS - 1)},
    }  # fmt: skip


def reference(
    library: ctypes.CDLL, p: Case, tolerance: float
) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]] | None:
    """Rows of t, y, v, z, F and the peaks of these over the motion, also between rows; None where it was not solved."""
    places = {"law": LAWS, "drive": DRIVES, "signal": SIGNALS}
    given = {**p, "tolerance": tolerance, "most": MOST_STEPS}
    numbers = [float(places[n].index(given[n]) if n in places else given[n]) for n in FIELDS]
    out, peaks = np.full((ROWS, 5), np.nan), np.zeros(5)
    problem = (ctypes.c_double * len(FIELDS))(*numbers)
    step = ctypes.c_double(p["t_end"] / (ROWS - 1))
    reached = library.reference(problem, ROWS, step, *(ctypes.c_void_p(x.ctypes.data) for x in (out, peaks)))
    return (out, peaks) if reached == ROWS else None


def outcome(library: ctypes.CDLL, p: Case) -> tuple[str, dict[str, float]]:
    """What became of a set, and the errors as parts of the peaks."""
    solved = [reference(library, p, tolerance) for tolerance in TOLERANCES]
    if solved[0] is None or solved[1] is None:
        return "no reference", {}
    (fine, peaks), (coarse, _) = solved
    with warnings.catch_warnings(record=True) as notes:
        warnings.simplefilter("always")
        solution = stribeck.simulate(scenario_of(p))
    if solution.status != "done":
        return "failed: " + re.sub(r"at t = \S+ s ", "", str(solution.reason)), {}
    errors = {}
    for i, (name, most) in enumerate(PROMISED.items()):
        column = 4 if name == "F" else i + 1
        peak = max(float(peaks[column]), 1e-300)
        if np.max(abs(fine - coarse)[:, column]) > 0.1 * most * peak:
            return "reference unsure", {}
        errors[name] = float(np.max(abs(solution[name] - fine[:, column]))) / peak
    if all(errors[name] <= most for name, most in PROMISED.items()):
        return "kept", errors
    text = any("accuracy not reached" in str(n.message) for n in notes)
    return ("said" if text else "broken"), errors


def benchmark(given: Given) -> dict[str, Any]:
    """Measure at tolerances, and count at default settings."""
    finish(given, at_tolerances(given), stem="default_tolerance")
    library, rng = compiled(Path(__file__).with_suffix(".c")), np.random.default_rng(given.seed)
    counts, begun = Counter[str](), time.process_time()
    worst: dict[str, float] = dict.fromkeys(PROMISED, 0.0)
    wrong: list[Case] = []
    for i in range(given.count):
        if time.process_time() - begun > 60 * given.minutes:
            break
        p = random_case(rng)
        what, errors = outcome(library, p)
        counts[what] += 1
        if what == "kept":
            worst = {name: max(x, errors[name]) for name, x in worst.items()}
        elif what not in ("no reference", "reference unsure"):
            wrong.append({"index": i, "what": what, "errors": errors, **p})
            print(i, what, errors, p, flush=True)
    return {"seed": given.seed, "counts": dict(counts), "worst_kept": worst, "not_kept": wrong}


if __name__ == "__main__":
    results = run(benchmark, __doc__, "promise", rigs=(240, 4), count=(600, 20), seed=1, minutes=15.0)
    sys.exit(1 if "broken" in results["counts"] else 0)
