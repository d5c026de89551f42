"""The smooth versions of |v|: CPU time over that of lugre, and how far the position is from lugre's, at one k_v."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
from measure import Given, in_turn, run, spread

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


def benchmark(given: Given) -> dict[str, Any]:
    """Every example under each law."""
    result: dict[str, Any] = {}
    for name in SCENARIOS:
        scenarios = under(name)
        y = {label: simulate(s.with_changes({"solve.rtol": 1e-11}))["y"] for label, s in scenarios.items()}
        runs = {label: partial(simulate, scenario) for label, scenario in scenarios.items()}
        in_turn(runs, 1)
        taken = in_turn(runs, given.repetitions)
        seconds = {label: spread([s.cpu for s in x])["median"] for label, x in taken.items()}
        result[name] = {
            label: {
                "cpu_over_lugre": seconds[label] / seconds["lugre"],
                "deviation_of_peak": float(np.max(np.abs(y[label] - y["lugre"])) / np.max(np.abs(y["lugre"]))),
            }
            for label in scenarios
        }
    return {"steepness": STEEPNESS, "repetitions": given.repetitions, "results": result}


if __name__ == "__main__":
    run(benchmark, __doc__, "majorants", repetitions=(9, 1))
