"""Do 95 % intervals of static fits hold the truth, where the model is complete and where it lacks something?

Records with known truth: three sines, a position with noise, a tanh-Stribeck friction. Half of them hold nothing else (a note of
lacking terms is then a false alarm); the others hold a delay, a direction, a weight, a spring, a level that grows with the
position or the time, or a stronger level forwards, from 0.3 to 30 % of the friction. Each is fitted by the law behind it
without that term, and by least squares (coulomb_viscous), which lacks the Stribeck curve in every second one. Further ones
have a friction that bends upwards with the speed, by a power of it, beside a Stribeck bend that may be too narrow to be seen, or
a Stribeck curve of another exponent than the law's 2.

    python benchmarks/lacking_terms.py [--cases 280] [--first 0] [--bent 60] [--pointed 35] [--out FILE]
"""

from __future__ import annotations

import argparse
import json
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from held_out import ROWS, STEP, machine

import stribeck
from stribeck.identify.api import read_log

RESULTS = Path(__file__).parent / "results" / "lacking_terms.json"
POWERS = (2.0, 1.5, 3.0, 0.5)  # of the speed, in records that bend otherwise
EXPONENTS = (1.0, 1.0, 0.7, 1.5, 2.0)  # of the Stribeck curve, in records that are pointed
LACKS = ("delay", "direction", "weight", "spring", "position", "time", "forwards")
LAWS = ("stribeck_tanh", "coulomb_viscous")
OF_BENT = ("stribeck", *LAWS)
OF_BOTH = ("mass", "offset", "F_c", "sigma_2")


def record(seed: int) -> tuple[str, dict[str, np.ndarray], dict[str, float]]:
    """What the record holds beside the law, the record, and the truth of each number that has one."""
    draw = np.random.default_rng(seed)
    what = LACKS[seed // 2 % len(LACKS)] if seed % 2 else "nothing"
    m = machine(draw, ("coulomb", "stribeck")[seed // (2 * len(LACKS)) % 2])
    size, noise = float(np.exp(draw.uniform(np.log(0.003), np.log(0.3)))), draw.choice([1e-6, 1e-5, 1e-4])
    t = np.arange(2 * ROWS) * STEP
    w = 2 * np.pi * np.exp(draw.uniform(np.log(0.15), np.log(1.8), 3))
    speed, phase = draw.uniform(0.2, 1.0, 3), draw.uniform(0, 6, 3)
    late = 30 * size * STEP if what == "delay" else 0.0
    v, a = np.sin(np.outer(t, w) + phase) @ speed, np.cos(np.outer(t, w) + phase) @ (speed * w)
    y, measured = (-np.cos(np.outer(x, w) + phase) @ (speed / w) for x in (t, t - late))
    level = m["F_c"] + m["dF"] * np.exp(-((v / m["v_s"]) ** 2))
    beside = {"direction": abs(v), "weight": np.sin(y), "spring": y}.get(what, 0.0 * t)
    level += size * {"position": m["F_c"] * y, "time": level * (2 * t / t[-1] - 1), "forwards": level * (v > 0)}.get(
        what, 0.0 * t
    )
    force = m["mass"] * a + level * np.tanh(v / m["width"]) + m["sigma_2"] * v + m["offset"] + size * m["F_c"] * beside
    truth = {n: float(m[n]) for n in ("mass", "offset", "F_c", "sigma_2")}
    truth |= {"k_v": 1 / m["width"]} | ({"F_s": m["F_c"] + m["dF"], "v_s": m["v_s"]} if m["dF"] else {})
    if what == "forwards":  # friction has two levels then, and an offset of half their difference
        truth = {n: truth[n] for n in ("mass", "sigma_2", "k_v")}
    measured = measured + noise * draw.standard_normal(len(t))
    return what, {"t": t, "y": measured, "F": force + m["force_noise"] * draw.standard_normal(len(t))}, truth


def bent(seed: int) -> tuple[str, dict[str, np.ndarray], dict[str, float]]:
    """As :func:`record`, of a curve that bends upwards with the speed, beside a Stribeck bend that may be too narrow to be
    seen: a law that lacks the one spends its bend on it, far from where the truth has the other."""
    draw = np.random.default_rng(seed)
    power, level = POWERS[seed % len(POWERS)], float(np.exp(draw.uniform(-1, 2)))
    v_s, rises = float(np.exp(draw.uniform(np.log(1e-3), np.log(0.2)))), draw.uniform(0.2, 0.8)
    viscous, bends = level * draw.uniform(0.05, 0.4), level * float(np.exp(draw.uniform(np.log(0.05), np.log(0.4))))
    mass, offset, noise = level * draw.uniform(0, 0.3), level * draw.uniform(-0.1, 0.1), draw.choice([1e-3, 5e-3, 2e-2])
    t = np.arange(2 * ROWS) * STEP
    w = 2 * np.pi * np.exp(draw.uniform(np.log(0.15), np.log(1.8), 1 + seed % 2))
    speed, phase = draw.uniform(0.4, 1.3, len(w)), draw.uniform(0, 6, len(w))
    v, a = np.sin(np.outer(t, w) + phase) @ speed, np.cos(np.outer(t, w) + phase) @ (speed * w)
    y = -np.cos(np.outer(t, w) + phase) @ (speed / w) + 1e-7 * draw.standard_normal(len(t))
    curve = level * (1 + rises * np.exp(-((v / v_s) ** 2))) + viscous * abs(v) + bends * abs(v) ** power
    force = mass * a + curve * np.sign(v) + offset + level * noise * draw.standard_normal(len(t))
    truth = {"mass": mass, "offset": offset, "F_c": level, "sigma_2": viscous, "F_s": level * (1 + rises), "v_s": v_s}
    return f"bent, |v|^{power:g}", {"t": t, "y": y, "F": force}, truth


def pointed(seed: int) -> tuple[str, dict[str, np.ndarray], dict[str, float]]:
    """As :func:`record`, of a Stribeck curve whose exponent may be another than 2."""
    draw = np.random.default_rng(seed)
    exponent, level = EXPONENTS[seed % len(EXPONENTS)], float(np.exp(draw.uniform(-1, 2)))
    v_s, rises = float(np.exp(draw.uniform(np.log(5e-3), np.log(0.1)))), draw.uniform(0.2, 0.8)
    viscous, mass, offset = (
        level * draw.uniform(0.05, 0.4),
        level * draw.uniform(0, 0.3),
        level * draw.uniform(-0.1, 0.1),
    )
    noise, t = draw.choice([1e-3, 5e-3, 2e-2]), np.arange(2 * ROWS) * STEP
    w = 2 * np.pi * np.exp(draw.uniform(np.log(0.15), np.log(1.8), 1 + seed % 2))
    speed, phase = draw.uniform(0.3, 1.0, len(w)), draw.uniform(0, 6, len(w))
    v, a = np.sin(np.outer(t, w) + phase) @ speed, np.cos(np.outer(t, w) + phase) @ (speed * w)
    y = -np.cos(np.outer(t, w) + phase) @ (speed / w) + 1e-7 * draw.standard_normal(len(t))
    curve = level * (1 + rises * np.exp(-(abs(v / v_s) ** exponent))) + viscous * abs(v)
    force = mass * a + curve * np.sign(v) + offset + level * noise * draw.standard_normal(len(t))
    truth = {"mass": mass, "offset": offset, "F_c": level, "sigma_2": viscous, "F_s": level * (1 + rises)}
    return f"pointed, |v/v_s|^{exponent:g}", {"t": t, "y": y, "F": force}, truth


def one(made: tuple[str, dict[str, np.ndarray], dict[str, float]], laws: tuple[str, ...] = LAWS) -> dict[str, Any]:
    """By law: the numbers that have a truth, with verdict and interval; and whether terms are said to lack."""
    what, columns, truth = made
    case: dict[str, Any] = {"holds beside": what}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        log = read_log(columns, columns={"time": "t", "position": "y", "force": "F"})
        for law in laws:
            try:
                fit = stribeck.fit(log, law, select=False)
            except stribeck.StribeckError as error:
                case[law] = {"failed": str(error).splitlines()[0]}
                continue
            told = {**fit.estimates, **fit.body}
            case[law] = {
                "said to lack": any("of the squared residual away: intervals" in note for note in fit.notes),
                "numbers": {
                    n: held(told[n], x) for n, x in truth.items() if n in told and (law != LAWS[1] or n in OF_BOTH)
                },
            }
    return case


def held(told: Any, truth: float) -> dict[str, Any]:
    """The verdict on a number, its interval, and whether that holds the truth."""
    holds = (told.low is None or told.low <= truth) and (told.high is None or truth <= told.high)
    return {
        "truth": truth, "value": told.value, "low": told.low, "high": told.high, "known": told.identifiable, "holds": bool(holds),
    }  # fmt: skip


def summary(cases: list[dict[str, Any]], law: str) -> dict[str, Any]:
    """How many intervals of numbers called known hold, of how many; records said to lack terms; and the median of the
    error in halves of the interval (0.34 where these are neither too wide nor too narrow)."""
    fits = [case[law] for case in cases if "numbers" in case[law]]
    told = [e for fit in fits for e in fit["numbers"].values()]
    known = [e for e in told if e["known"] and e["high"] > e["low"]]
    wide = [2 * abs(e["value"] - e["truth"]) / (e["high"] - e["low"]) for e in known]
    return {
        "records": len(cases), "said to lack": sum(fit["said to lack"] for fit in fits), "numbers": len(told),
        "known": len(known), "hold": sum(e["holds"] for e in known),
        "median error in halves": round(float(np.median(wide)), 3) if wide else None,
    }  # fmt: skip


def counted(cases: dict[str, dict[str, Any]]) -> dict[str, Any]:
    """The counts by law and by what the records hold, and each number called known that is missed."""
    kinds = ["nothing", *LACKS, *(f"bent, |v|^{power:g}" for power in POWERS)]
    kinds += [f"pointed, |v/v_s|^{exponent:g}" for exponent in dict.fromkeys(EXPONENTS)]
    counts = {
        f"{law}, {'complete' if what == 'nothing' else what}": summary(chosen, law)
        for law in OF_BENT
        for what in kinds
        if (chosen := [case for case in cases.values() if case["holds beside"] == what and law in case])
    }
    missed = {
        f"{key}, {law}, {case['holds beside']}, {n}": e
        for key, case in cases.items() for law in OF_BENT for n, e in case.get(law, {}).get("numbers", {}).items()
        if e["known"] and not e["holds"]
    }  # fmt: skip
    return {"counts": counts, "missed": missed}


def main() -> None:
    """Run the cases that are asked for and print the counts."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=280)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--bent", type=int, default=60)
    parser.add_argument("--pointed", type=int, default=35)
    parser.add_argument("--out", type=Path, default=RESULTS)
    given = parser.parse_args()
    cases: dict[str, dict[str, Any]] = {}
    for seed in range(given.first, given.first + given.cases):
        cases[str(seed)] = one(record(seed))
        given.out.write_text(json.dumps(counted(cases), indent=1) + "\n", encoding="utf-8")
    for seed in range(given.first, given.first + given.bent):
        cases[f"bent {seed}"] = one(bent(seed), OF_BENT)
        given.out.write_text(json.dumps(counted(cases), indent=1) + "\n", encoding="utf-8")
    for seed in range(given.first, given.first + given.pointed):
        cases[f"pointed {seed}"] = one(pointed(seed), OF_BENT[:2])
        given.out.write_text(json.dumps(counted(cases), indent=1) + "\n", encoding="utf-8")
    for name, count in counted(cases)["counts"].items():
        print(name, count)


if __name__ == "__main__":
    main()
