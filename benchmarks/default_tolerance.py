"""What the default tolerance costs and gives: random scenarios of all laws, drives and signals, at rtol 1e-6, 1e-7 and 1e-8
against 1e-11, all with the compiled solver.

    python benchmarks/default_tolerance.py [--count 240] [--seed 1]

An error is the largest difference of y, v or F over all rows, as a part of that column's peak (of y: of its range). Steps are
counted, as times on a busy machine tell little.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from measure import Given, run, say

import stribeck
from tests.simulation.random_rigs import random_rig

RTOLS = (1e-6, 1e-7, 1e-8)
REFERENCE = 1e-11
QUANTILES = (0.5, 0.9, 0.99, 1.0)
COLUMNS = ("y", "v", "F")


def solved(data: dict[str, Any], rtol: float) -> stribeck.Solution:
    """The scenario at a tolerance."""
    return stribeck.simulate(stribeck.Scenario({**data, "solve": {**data["solve"], "rtol": rtol}}))


def error(name: str, found: stribeck.Solution, reference: stribeck.Solution) -> float:
    """The largest of a column as a part of its peak."""
    theirs = np.asarray(reference[name])
    peak = float(np.ptp(theirs) if name == "y" else np.max(abs(theirs)))
    return float(np.max(abs(np.asarray(found[name]) - theirs))) / max(peak, 1e-300)


def benchmark(given: Given) -> dict[str, Any]:
    """Run all scenarios."""
    rows: list[dict[str, Any]] = []
    for k in range(given.count):
        data = random_rig([given.seed, k])
        reference = solved(data, REFERENCE)
        if reference.status != "done":
            say(f"{k}: {data['law']['name']}, {data['drive']['kind']}: the reference ended: {reference.reason}")
            continue
        for rtol in RTOLS:
            outcome = solved(data, rtol)
            steps = int(outcome.stats["accepted"] + outcome.stats["rejected"])
            rows.append({"rtol": rtol, "steps": steps, **{name: error(name, outcome, reference) for name in COLUMNS}})
        if k % 20 == 19:
            say(f"{k + 1} of {given.count}")
    table = []
    for rtol in RTOLS:
        of = [r for r in rows if r["rtol"] == rtol]
        line: dict[str, Any] = {"rtol": rtol, "scenarios": len(of), "steps": float(np.median([r["steps"] for r in of]))}
        line |= {name: [float(np.quantile([r[name] for r in of], q)) for q in QUANTILES] for name in COLUMNS}
        table.append(line)
    return {"seed": given.seed, "count": given.count, "table": table}


if __name__ == "__main__":
    run(benchmark, __doc__, "default_tolerance", count=(240, 4), seed=1)
