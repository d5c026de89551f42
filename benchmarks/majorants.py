"""The smooth versions of |v|: CPU time over that of lugre, and how far the position is from lugre's, at one k_v."""

from __future__ import annotations

from time import process_time
from typing import Any

import numpy as np
from measure import machine, options, spread, table, write

from stribeck import Scenario, examples, simulate

STEEPNESS = 1e6  # s/m
SCENARIOS = ("presliding", "stick_slip", "sine_force", "limit_cycle", "break_away")
VARIANTS: dict[str, dict[str, Any]] = {
    "lugre": {"name": "lugre"},
    "lugre_sobczyk": {"name": "lugre_sobczyk", "k_v": STEEPNESS},
    **{
        f"lugre_majorant, {word}": {"name": "lugre_majorant", "k_v": STEEPNESS, "smooth_abs": word}
        for word in ("atan", "sqrt", "compact")
    },
}


def under(name: str) -> dict[str, Scenario]:
    """An example scenario under each law."""
    data = Scenario.load(examples.path(name)).data
    return {
        label: Scenario({**data, "law": {**law, "parameters": data["law"]["parameters"]}})
        for label, law in VARIANTS.items()
    }


def _cell(result: dict[str, float]) -> str:
    return f"{result['cpu_over_lugre']:.2f}, {result['deviation_of_peak']:.1e}"


def main() -> None:
    """Print a table and write the results."""
    given = options(__doc__, "majorants", repetitions=(9, 1))
    found: dict[str, Any] = {}
    for name in SCENARIOS:
        scenarios = under(name)
        y = {label: simulate(s.with_changes({"solve.rtol": 1e-11}))["y"] for label, s in scenarios.items()}
        seconds: dict[str, list[float]] = {label: [] for label in scenarios}
        for scenario in scenarios.values():
            simulate(scenario)
        for _ in range(given.repetitions):
            for label, scenario in scenarios.items():
                started = process_time()
                simulate(scenario)
                seconds[label].append(process_time() - started)
        lugre = spread(seconds["lugre"])["median"]
        found[name] = {
            label: {
                "cpu_over_lugre": spread(seconds[label])["median"] / lugre,
                "deviation_of_peak": float(np.max(np.abs(y[label] - y["lugre"])) / np.max(np.abs(y["lugre"]))),
            }
            for label in scenarios
        }
    rows = [[label, *(_cell(found[name][label]) for name in SCENARIOS)] for label in VARIANTS]
    print(f"k_v = {STEEPNESS:g} s/m: CPU time over lugre's, largest deviation of y over its peak")
    print(table(["law", *SCENARIOS], rows))
    write(given.out, {"machine": machine(), "steepness": STEEPNESS, "repetitions": given.repetitions, "results": found})


if __name__ == "__main__":
    main()
