"""Do the 95 % intervals of fits of the motion hold where more than friction holds back the body?

Arms under LuGre friction and a torque of two sines: with a weight, with a weight beside a horizontal zero, under a torque
that is known row by row, with an offset, with viscous friction that depends on the direction, with a spring. The motion is
SciPy's, of equations written here; the position has noise, and the torque where that is asked for.

    python benchmarks/arm_coverage.py [--first 0] [--experiments 2] [--force-noise 0] [--kinds sin ...] [--output position]
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import stribeck

RESULTS = Path(__file__).parent / "results" / "arm_coverage.json"
KINDS = ("sin", "sincos", "torque", "offset", "direction", "spring")
TERMS = ("gravity_sin", "gravity_cos", "area", "stiffness", "sigma_2_by_direction")
RATE, SECONDS, NOISE = 500.0, 12.0, 1e-5


def constants(kind: str, draw: np.random.Generator) -> dict[str, float]:
    """Friction, inertia and what is beside them; rad, N m."""
    about = {"sigma_0": 300.0, "sigma_1": 1.5, "sigma_2": 0.05, "F_c": 0.3, "v_s": 0.05, "mass": 0.05}
    found = {name: value * float(np.exp(draw.uniform(-0.25, 0.25))) for name, value in about.items()}
    found["F_s"] = found["F_c"] * float(draw.uniform(1.3, 1.6))
    weight = float(np.exp(draw.uniform(-0.25, 0.25)))
    beside = {
        "sin": {"gravity_sin": weight},
        "sincos": {"gravity_sin": weight, "gravity_cos": draw.uniform(-0.5, 0.5)},
        "torque": {"area": 1.0},
        "offset": {"gravity_sin": weight, "offset": draw.uniform(-0.2, 0.2)},
        "direction": {"gravity_sin": 0.6 * weight, "sigma_2_by_direction": draw.uniform(0.005, 0.02)},
        "spring": {"stiffness": 1.5 * weight},
    }[kind]
    return {**found, "offset": 0.0, **beside}


def record(kind: str, seed: int, force_noise: float) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """What is measured, and the truth behind it."""
    draw = np.random.default_rng(seed)
    p = constants(kind, draw)
    slow, fast, size, *phase = *draw.uniform([0.4, 1.3, 0.9], [0.7, 2.1, 1.2]), *draw.uniform(0, 6, 4)

    def torque(t: Any) -> Any:
        return size * (np.sin(2 * np.pi * slow * t + phase[0]) + 0.6 * np.sin(2 * np.pi * fast * t + phase[1]))

    def load(t: Any) -> Any:
        return 0.3 * np.sin(2 * np.pi * 0.9 * t + phase[2]) + 0.2 * np.sin(2 * np.pi * 0.23 * t + phase[3])

    def rates(t: float, x: np.ndarray) -> list[float]:
        y, v, z = x
        held = p["offset"] + p.get("gravity_sin", 0.0) * np.sin(y) + p.get("gravity_cos", 0.0) * np.cos(y)
        held += p.get("stiffness", 0.0) * y + p.get("sigma_2_by_direction", 0.0) * abs(v) + p.get("area", 0.0) * load(t)
        level = p["F_c"] + (p["F_s"] - p["F_c"]) * np.exp(-((v / p["v_s"]) ** 2))
        bending = v - p["sigma_0"] * abs(v) / level * z
        friction = p["sigma_0"] * z + p["sigma_1"] * bending + p["sigma_2"] * v
        return [v, (torque(t) - held - friction) / p["mass"], bending]

    # an error that grows to the noise would be taken for the machine's
    t = np.arange(0, SECONDS, 1 / RATE)
    found = solve_ivp(
        rates, (0, t[-1]), [0.0, 0.0, 0.0], t_eval=t, method="LSODA", rtol=1e-12, atol=[1e-14, 1e-13, 1e-15], max_step=2e-3
    )  # fmt: skip
    assert found.success, found.message
    y = found.y[0] + NOISE * draw.standard_normal(len(t))
    return {"t": t, "y": y, "F": torque(t) + force_noise * draw.standard_normal(len(t)), "tau": load(t)}, p


def one(kind: str, seed: int, force_noise: float, output: str) -> dict[str, Any]:
    """For each number its truth, interval and verdict; or why there is no fit."""
    log, truth = record(kind, seed, force_noise)
    asked: dict[str, Any] = {"terms": [name for name in TERMS if name in truth]}
    if kind == "torque":
        asked |= {"pressure": "tau", "constants": {"area": 1.0}}
    started = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            fit = stribeck.fit(
                log, "lugre", time="t", position="y", force="F", method="dynamic", output=output, starts=8, **asked
            )
        except stribeck.StribeckError as error:
            return {"failed": str(error)}
    rows = {
        name: {
            "truth": truth[name], "value": e.value, "low": e.low, "high": e.high, "known": e.identifiable, "why": e.why,
            "holds": bool(e.identifiable and e.low <= truth[name] <= e.high),
        }
        for name, e in {**fit.estimates, **fit.body}.items()
    }  # fmt: skip
    return {"seconds": round(time.process_time() - started, 1), "parameters": rows, "notes": list(fit.notes)}


def main() -> None:
    """Run what is asked for; a line for each experiment, and the counts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--experiments", type=int, default=2)
    parser.add_argument("--force-noise", type=float, default=0.0, help="N m")
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=KINDS)
    parser.add_argument("--output", choices=("position", "velocity"), default="position")
    parser.add_argument("--out", type=Path, default=RESULTS)
    given = parser.parse_args()
    cases: dict[str, Any] = json.loads(given.out.read_text(encoding="utf-8")) if given.out.is_file() else {}
    for seed in range(given.first, given.first + given.experiments):
        for kind in given.kinds:
            name = f"{kind}, {given.output}, {given.force_noise:g} N m, {seed}"
            cases[name] = case = one(kind, seed, given.force_noise, given.output)
            told = case.get("parameters", {})
            missed = {n: e for n, e in told.items() if e["known"] and not e["holds"]}
            print(name, case.get("failed") or f"{sum(e['known'] for e in told.values())} of {len(told)} known", missed or "",
                  case.get("seconds"), flush=True)  # fmt: skip
            given.out.write_text(json.dumps(cases, indent=1) + "\n", encoding="utf-8")
    told = [e for case in cases.values() for e in case.get("parameters", {}).values()]
    print(
        f"{sum(e['holds'] for e in told)} of {sum(e['known'] for e in told)} known hold, of {len(told)} in {len(cases)}"
    )


if __name__ == "__main__":
    main()
