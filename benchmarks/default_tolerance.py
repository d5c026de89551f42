"""What the default tolerance costs and gives: random scenarios of all laws, drives and signals, at rtol 1e-6, 1e-7 and 1e-8
against 1e-11, all with the compiled solver.

    python benchmarks/default_tolerance.py [--count 240] [--seed 1]
    python benchmarks/default_tolerance.py --long

With --long: not random ones but the examples, those shorter than 20 s made 20 s long, machines among them, and stick-slip of 40 s
and a hunting servo of 60 s under four laws; y, v and F of every body and contact.

An error is the largest difference of y, v or F over all rows, as a part of that column's peak (of y: of its range). Where a
row lies on a jump of a signal F has two values; such rows are few and left out by leaving out a row in a hundred, the worst
ones, in a second column. Steps are counted, as times on a busy machine tell little.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
from measure import RESULTS, machine, say, timed

import stribeck

sys.path.insert(0, str(Path(__file__).parent.parent))

from tests.simulation.random_rigs import random_rig

RTOLS = (1e-6, 1e-7, 1e-8)
REFERENCE = 1e-11
QUANTILES = (0.5, 0.9, 0.99, 1.0)
PROMISED = {"y": 1e-6, "v": 1e-6, "F": 1e-4}  # at default settings, README
LONG = 20.0  # s
SHORTEST = 0.02  # s: what is shorter is run again


def run(data: dict[str, Any], rtol: float) -> tuple[Any, float]:
    """A solution and its processor time, s."""
    scenario = stribeck.Scenario({**data, "solve": {**data["solve"], "rtol": rtol}})
    found: list[Any] = []
    times = [timed(lambda: found.append(stribeck.simulate(scenario))).cpu for _ in range(3)]
    return found[-1], min(times)


def errors(found: Any, reference: Any) -> dict[str, float]:
    """Of y, v and F as parts of their peaks, the worst row and all but a hundredth of the rows."""
    row: dict[str, float] = {}
    for name in PROMISED:
        theirs = np.asarray(reference[name])
        peak = float(np.ptp(theirs) if name == "y" else np.max(abs(theirs)))
        off = abs(np.asarray(found[name]) - theirs) / max(peak, 1e-300)
        row[name], row[f"{name}_99"] = float(np.max(off)), float(np.quantile(off, 0.99))
    return row


def long_cases() -> dict[str, stribeck.Scenario]:
    """Stick-slip and a hunting servo under four laws, and every example that is a scenario."""
    laws: tuple[dict[str, Any], ...] = (
        {"name": "lugre"}, {"name": "lugre_majorant", "k_v": 1e7}, {"name": "lugre_sobczyk", "k_v": 1e6},
        {"name": "elastoplastic_majorant", "k_v": 1e7, "z_ba": 7e-6},
    )  # fmt: skip
    pull = {"kind": "spring", "stiffness": 2.0, "signal": {"kind": "ramp", "rate": 0.1}}
    hold = {"kind": "pid", "K_p": 3.0, "K_i": 4.0, "K_d": 6.0, "signal": {"kind": "step", "time": 0.0, "value": 1.0}}
    cases = {}
    for law in laws:
        for name, drive, end in (("stick-slip 40 s", pull, 40.0), ("hunting servo 60 s", hold, 60.0)):
            data = {
                "schema": 1, "law": {**law, "parameters": "canudas1995"}, "plant": {"mass": 1.0}, "drive": drive,
                "solve": {"t_end": end}, "output": {"step": 0.01},
            }  # fmt: skip
            cases[f"{name}, {law['name']}"] = stribeck.Scenario(data)
    for path in sorted(Path(stribeck.__file__).parent.glob("examples/*.toml")):
        found = stribeck.Scenario.load(path)
        cases[path.name] = found.with_changes({"solve.t_end": max(float(found.solve.t_end), LONG)})
    return cases


def long_runs(out: Path) -> None:
    """Print what each tolerance costs and the largest errors, and write them."""
    rows = []
    for name, scenario in long_cases().items():
        reference = stribeck.simulate(scenario.with_changes({"solve.rtol": REFERENCE}))
        for rtol in RTOLS:
            found = stribeck.simulate(scenario.with_changes({"solve.rtol": rtol}))
            row: dict[str, Any] = {
                "case": name,
                "rtol": rtol,
                "steps": found.stats["accepted"] + found.stats["rejected"],
            }
            for quantity in PROMISED:
                names = [c.name for c in reference.columns if c.name.rpartition(".")[2] == quantity]
                off = [_largest(found[n], reference[n]) for n in names]
                row[quantity] = max(off)
            row["above"] = [q for q, limit in PROMISED.items() if row[q] > limit]
            rows.append(row)
            say(json.dumps(row))
    out.write_text(json.dumps({"machine": machine(), "rows": rows}, indent=1) + "\n", encoding="utf-8")


def _largest(found: Any, reference: Any) -> float:
    """The largest difference as a part of the peak."""
    peak = float(np.max(abs(np.asarray(reference))))
    return float(np.max(abs(np.asarray(found) - np.asarray(reference)))) / peak if peak else 0.0


def main() -> None:
    """Run all, print a table, and write the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=240)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=RESULTS / "default_tolerance.json")
    parser.add_argument("--long", action="store_true", help="examples and long runs instead of random ones")
    given = parser.parse_args()
    if given.long:
        return long_runs(given.out.with_stem("default_tolerance_long"))
    rows: list[dict[str, Any]] = []
    for k in range(given.count):
        data = random_rig([given.seed, k])
        reference, _ = run(data, REFERENCE)
        if reference.status != "done":
            say(f"{k}: {data['law']['name']}, {data['drive']['kind']}: the reference ended: {reference.reason}")
            continue
        for rtol in RTOLS:
            found, seconds = run(data, rtol)
            steps = int(found.stats["accepted"] + found.stats["rejected"])
            row = {"rig": k, "law": data["law"]["name"], "drive": data["drive"]["kind"], "rtol": rtol, "steps": steps}
            rows.append({**row, "seconds": seconds, **errors(found, reference)})
        if k % 20 == 19:
            say(f"{k + 1} of {given.count}")
    result: dict[str, Any] = {"machine": machine(), "seed": given.seed, "count": given.count, "table": []}
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
        say(json.dumps(line))
    given.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
