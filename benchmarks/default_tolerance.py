"""What the default tolerance costs and gives: random scenarios of all laws, drives and signals, at rtol 1e-6, 1e-7 and 1e-8
against 1e-11, all with the compiled solver.

    python benchmarks/default_tolerance.py [--count 240] [--seed 1]

An error is the largest difference of y, v or F over all rows, as a part of that column's peak (of y: of its range). Where a
row lies on a jump of a signal F has two values; such rows are few and left out by leaving out a row in a hundred, the worst
ones, in a second column. Steps are counted, as times on a busy machine tell little.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
from measure import finish, options, say, timed

import stribeck

sys.path.insert(0, str(Path(__file__).parent.parent))

from tests.simulation.random_rigs import random_rig

RTOLS = (1e-6, 1e-7, 1e-8)
REFERENCE = 1e-11
QUANTILES = (0.5, 0.9, 0.99, 1.0)
PROMISED = {"y": 1e-6, "v": 1e-6, "F": 1e-4}  # at default settings, README


def run(data: dict[str, Any], rtol: float) -> tuple[Any, float]:
    """A solution and its processor time, s."""
    scenario = stribeck.Scenario({**data, "solve": {**data["solve"], "rtol": rtol}})
    results: list[Any] = []
    times = [timed(lambda: results.append(stribeck.simulate(scenario))).cpu for _ in range(3)]
    return results[-1], min(times)


def errors(found: Any, reference: Any) -> dict[str, float]:
    """Of y, v and F as parts of their peaks, the worst row and all but a hundredth of the rows."""
    row: dict[str, float] = {}
    for name in PROMISED:
        theirs = np.asarray(reference[name])
        peak = float(np.ptp(theirs) if name == "y" else np.max(abs(theirs)))
        off = abs(np.asarray(found[name]) - theirs) / max(peak, 1e-300)
        row[name], row[f"{name}_99"] = float(np.max(off)), float(np.quantile(off, 0.99))
    return row


def main() -> None:
    """Run all, print a table, and write the results."""
    given = options(__doc__, "default_tolerance", count=(240, 4), seed=1)
    rows: list[dict[str, Any]] = []
    for k in range(given.count):
        data = random_rig([given.seed, k])
        reference, _ = run(data, REFERENCE)
        if reference.status != "done":
            say(f"{k}: {data['law']['name']}, {data['drive']['kind']}: the reference ended: {reference.reason}")
            continue
        for rtol in RTOLS:
            outcome, seconds = run(data, rtol)
            steps = int(outcome.stats["accepted"] + outcome.stats["rejected"])
            row = {"rig": k, "law": data["law"]["name"], "drive": data["drive"]["kind"], "rtol": rtol, "steps": steps}
            rows.append({**row, "seconds": seconds, **errors(outcome, reference)})
        if k % 20 == 19:
            say(f"{k + 1} of {given.count}")
    result: dict[str, Any] = {"seed": given.seed, "count": given.count, "table": []}
    for rtol in RTOLS:
        of = [r for r in rows if r["rtol"] == rtol]
        line: dict[str, Any] = {"rtol": rtol, "scenarios": len(of), "steps": float(np.median([r["steps"] for r in of]))}
        line["seconds"] = sum(r["seconds"] for r in of)
        for name, limit in PROMISED.items():
            line[name] = [float(np.quantile([r[name] for r in of], q)) for q in QUANTILES]
            line[f"{name}_above"] = sum(r[name] > limit for r in of)
            line[f"{name}_99_above"] = sum(r[f"{name}_99"] > limit for r in of)
        line["worst"] = {name: max(of, key=lambda r: float(r[name])) for name in PROMISED}
        result["table"].append(line)
    finish(given, result)


if __name__ == "__main__":
    main()
