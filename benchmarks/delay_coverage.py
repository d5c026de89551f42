"""Do fits of the motion find a delay between force and motion, and do their intervals hold, with the term and without it?

A body under LuGre friction (constants within 25 % of those of Canudas de Wit et al. 1995) is driven by two sines of force;
SciPy's LSODA solves its equations, written here. The force is recorded at its time and the motion late by a known delay,
by several sensors of the position. What `--term delay` finds is counted, and what the fit tells of the same record without it.

    python benchmarks/delay_coverage.py [--seeds 0 12] [--without] [--output position velocity] [--law lugre]

A line of JSON for each experiment, and the counts at the end.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
import warnings

import numpy as np
from scipy.integrate import solve_ivp

import stribeck

NOMINAL = {"sigma_0": 1e5, "sigma_1": 316.0, "sigma_2": 0.4, "F_c": 1.0, "v_s": 1e-3}
MASS = 1.1
DELAYS = (0.0, 0.3, -0.3, 1e-3, -1e-3, 5e-3, -5e-3)  # the second and third in samples, the others in s
SENSORS = ((500.0, 1e-6, 0.0), (1000.0, 1e-7, 0.0), (2000.0, 1e-6, 0.0), (500.0, 0.0, 1e-6))  # rate, noise, step
LIMIT = {"lugre": 0.0, "elastoplastic": 0.7}  # of the bristles' way, below which nothing slips


def record(seed: int, law: str = "lugre", seconds: float = 10.0) -> tuple[dict[str, np.ndarray], dict[str, float], str]:
    """The columns of an experiment, the truth behind it, and how it was recorded."""
    draw = np.random.default_rng(seed)
    truth = {name: value * float(np.exp(draw.uniform(-0.25, 0.25))) for name, value in NOMINAL.items()}
    truth["F_s"] = truth["F_c"] * float(draw.uniform(1.3, 1.6))
    slow, fast = float(draw.uniform(0.3, 0.5)), float(draw.uniform(1.3, 1.9))
    delay = DELAYS[seed % len(DELAYS)]
    rate, noise, quantum = SENSORS[(seed // len(DELAYS) + seed) % len(SENSORS)]
    told = f"{delay:g}, {rate:g} Hz, noise {noise:g} m, steps {quantum:g} m"
    delay = delay / rate if abs(delay) == 0.3 else delay
    p = truth

    def force(t: np.ndarray) -> np.ndarray:
        return 2.1 * np.sin(2 * np.pi * slow * t + 0.3) + 0.7 * np.sin(2 * np.pi * fast * t)

    def rates(t: float, x: np.ndarray) -> list[float]:
        v, w = x[1], x[2]  # w: sigma_0 z
        level = p["F_c"] + (p["F_s"] - p["F_c"]) * np.exp(-((v / p["v_s"]) ** 2))
        rate_of_z = v - slips(w / p["sigma_0"], v, level) * abs(v) * w / level
        return [v, (force(t) - w - p["sigma_1"] * rate_of_z - p["sigma_2"] * v) / MASS, p["sigma_0"] * rate_of_z]

    def slips(z: float, v: float, level: float) -> float:
        highest = level / p["sigma_0"]
        least = LIMIT[law] * p["F_c"] / p["sigma_0"]
        if law == "lugre":
            return 1.0
        if z * v <= 0 or abs(z) <= least:
            return 0.0
        if abs(z) >= highest:
            return 1.0
        return 0.5 + 0.5 * np.sin(np.pi * (abs(z) - 0.5 * (highest + least)) / (highest - least))

    margin = 0.02
    t = np.arange(0, seconds, 1 / rate)
    at = t + margin - delay
    found = solve_ivp(
        rates, (0, at[-1]), [0.0, 0.0, 0.0], "LSODA", t_eval=at, rtol=1e-12, atol=[1e-14, 1e-13, 1e-10], max_step=2e-3
    )  # fmt: skip
    assert found.success
    y = found.y[0] + noise * draw.standard_normal(len(t))
    y = quantum * np.round(y / quantum) if quantum else y
    return {"t": t, "y": y, "F": force(t + margin)}, {**truth, "mass": MASS, "offset": 0.0, "delay": delay}, told


def one(seed: int, output: str, law: str, term: bool, mass: float | None) -> dict[str, object]:
    """What a fit tells of an experiment."""
    columns, truth, told = record(seed, law)
    started, given = time.process_time(), {"z_ba": 0.7 * truth["F_c"] / truth["sigma_0"]} if law != "lugre" else {}
    case = {"seed": seed, "output": output, "record": told, "delay": truth["delay"]}
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            fit = stribeck.fit(
                columns, law, time="t", position="y", force="F", method="dynamic", output=output, mass=mass, starts=8,
                terms=("delay",) if term else (), constants=given,
            )  # fmt: skip
    except stribeck.StribeckError as error:
        return {**case, "failed": str(error)}
    rows = {}
    for name, e in {**fit.estimates, **fit.body}.items():
        holds = (e.low is None or e.low <= truth[name]) and (e.high is None or truth[name] <= e.high)
        rows[name] = [truth[name], e.best, e.low, e.high, e.identifiable, holds]
    return {**case, "seconds": round(time.process_time() - started, 1), "numbers": rows, "notes": list(fit.notes)}


def main() -> None:
    """Run the experiments that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", nargs=2, type=int, default=(0, 14), metavar=("FIRST", "LAST"))
    parser.add_argument("--output", nargs="+", default=["position", "velocity"])
    parser.add_argument("--law", default="lugre", choices=list(LIMIT))
    parser.add_argument("--without", action="store_true", help="the term delay, though the motion is late")
    parser.add_argument("--free-mass", action="store_true", help="fit the mass too")
    given = parser.parse_args()
    counts: dict[str, list[int]] = {}
    for seed in range(*given.seeds):
        for output in given.output:
            case = one(seed, output, given.law, not given.without, None if given.free_mass else MASS)
            print(json.dumps(case, default=float), flush=True)
            for name, (*_, known, holds) in case.get("numbers", {}).items():  # type: ignore[attr-defined]
                count = counts.setdefault(name, [0, 0, 0])
                count[0], count[1], count[2] = count[0] + 1, count[1] + known, count[2] + (known and holds)
    for name, (all_, known, hold) in counts.items():
        print(f"{name}: {hold} of {known} intervals hold, of {all_} numbers", file=sys.stderr)


if __name__ == "__main__":
    main()
