"""Do the 95 % intervals of ``stribeck fit --method dynamic`` cover the truth in 95 % of cases?

Synthetic experiments with known truth, each with constants and noise of its own: a rig that follows small
reversals and strokes of several speeds, an encoder of 5 nm, a force sensor with noise of 1 % of the Coulomb friction.
Every fourth one lacks the small reversals, the slow strokes or all strokes.

    python benchmarks/interval_coverage.py [--experiments 200] [--workers 2]     writes benchmarks/results/coverage.json
"""

from __future__ import annotations

import argparse
import json
import math
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from stribeck.identify.onebody import fit_simulated
from stribeck.identify.options import FitOptions
from stribeck.identify.plan import Test, motion
from stribeck.identify.synthetic import Experiment, Sensors, experiment
from stribeck.laws import find

LAWS: dict[str, dict[str, float]] = {
    "lugre": {},
    "lugre_sobczyk": {"k_v": 1e5},
    "elastoplastic_majorant": {"k_v": 1e5, "z_ba": 4e-6},
}
NOMINAL = {"sigma_0": 1e6, "sigma_1": 1e3, "sigma_2": 30.0, "F_c": 10.0, "F_s": 14.0, "v_s": 5e-3}
STEP, FINER = 1e-3, 4  # s between samples; the rig moves on a mesh four times as fine
STARTS = 4


def loop(size: float, rate: float, cycles: int = 2) -> Test:
    """There and back by ``size`` at a rate in Hz."""
    return Test("presliding loop", "", "motion", size, math.pi * rate * size, None, 1 / rate, cycles)


def stroke(speed: float) -> Test:
    """A stroke at a speed, there and back in 0.4 s."""
    return Test("constant speed", "", "motion", 0.14 * speed, speed, None, 0.4, 1)


LOOPS = [loop(size, rate) for size in (8e-6, 2e-5, 6e-5) for rate in (4.0, 20.0)]
STROKES = [stroke(speed) for speed in (5e-4, 2e-3, 5e-3, 1e-2, 3e-2, 0.1)]
# every fourth experiment leaves something out, so that some parameters cannot be determined
PARTIAL = (LOOPS[:4], STROKES, STROKES[-2:])


def tests(seed: int) -> list[Test]:
    """The motions of an experiment."""
    return [*LOOPS, *STROKES] if seed % 4 != 3 else PARTIAL[seed // 4 % 3]


def case(name: str, seed: int) -> Experiment:
    """An experiment with a law whose constants are drawn within 25 % of the nominal ones."""
    draw = np.random.default_rng((seed, sum(name.encode())))
    values = {key: value * float(np.exp(draw.uniform(-0.25, 0.25))) for key, value in NOMINAL.items()}
    values["F_s"] = values["F_c"] * float(draw.uniform(1.2, 1.6))
    law = find(name)({**values, **LAWS[name]})
    sensors = Sensors(position_resolution=5e-9, force_noise=0.01 * values["F_c"])
    number = 1000 * list(LAWS).index(name) + seed
    return experiment(law, motion(tests(seed), STEP / FINER), sensors, seed=number, every=FINER)


def covered(name: str, seed: int) -> dict[str, dict[str, Any]]:
    """For each parameter: truth, interval, verdict, and whether the interval covers the truth."""
    made = case(name, seed)
    options = FitOptions(mass=0.0, constants=LAWS[name], starts=STARTS, seed=seed)
    fit = fit_simulated(made.log, name, options)
    truth = {**made.law.values, "offset": 0.0}
    return {
        key: {
            "truth": truth[key], "value": each.value, "low": each.low, "high": each.high,
            "identifiable": each.identifiable,
            "covers": (each.low is None or each.low <= truth[key]) and (each.high is None or truth[key] <= each.high),
        }
        for key, each in {**fit.estimates, **fit.body}.items()
    }  # fmt: skip


def summary(cases: list[dict[str, dict[str, Any]]]) -> dict[str, dict[str, float]]:
    """For each parameter: how often it was declared identifiable, how often the interval then covered the truth, and
    the median of its half-width relative to the truth."""
    found = {}
    for key in cases[0]:
        told = [each[key] for each in cases if each[key]["identifiable"]]
        widths = [(e["high"] - e["low"]) / 2 / abs(e["truth"]) for e in told if e["truth"]]
        found[key] = {
            "declared_identifiable": len(told),
            "covers": round(sum(e["covers"] for e in told) / len(told), 4) if told else None,
            "median_relative_half_width": float(f"{np.median(widths):.3g}") if widths else None,
        }
    return found


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--experiments", "--repetitions", type=int, default=200, help="with each law")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent / "results" / "coverage.json")
    given = parser.parse_args()
    result: dict[str, Any] = {
        "what": "share of 95 % profile-likelihood intervals that cover the truth; synthetic experiments",
        "command": f"python benchmarks/interval_coverage.py --experiments {given.experiments}",
        "experiments": given.experiments, "samples": len(case("lugre", 0).log), "laws": {},
    }  # fmt: skip
    for name in LAWS:
        started = time.perf_counter()
        with ProcessPoolExecutor(given.workers) as pool:
            cases = list(pool.map(partial(covered, name), range(given.experiments)))
        result["laws"][name] = {"constants": LAWS[name], "parameters": summary(cases)}
        print(f"{name}: {time.perf_counter() - started:.0f} s", file=sys.stderr)
        for key, each in result["laws"][name]["parameters"].items():
            print(f"  {key:8} {each}", file=sys.stderr)
    given.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
