"""Is the default static fit ever worse than least squares, or a tanh-Stribeck fit of SciPy, on a record that none has seen?

Machines at random, whose friction is mostly none of our laws: asymmetric, Stribeck with an offset, drifting with
temperature, cogging, backlash-like hysteresis, a plain Coulomb level; noise of speed and force; rests, one direction only,
few speeds. Each makes two records with other motions. All fit the first and predict the second, over the rows in motion; those
within 0.1 s of rest, where the speed jumps, are neither fitted by SciPy nor compared.

    python benchmarks/held_out.py [--cases 100] [--first 0] [--out FILE]
"""

from __future__ import annotations

import argparse
import json
import tempfile
import warnings
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import curve_fit
from scipy.stats import binomtest

import stribeck
from stribeck.identify.api import read_log
from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log
from stribeck.identify.predict import load, predict, saved

RESULTS = Path(__file__).parent / "results" / "held_out.json"
FRICTION = ("coulomb", "stribeck", "asymmetric", "temperature", "cogging", "hysteresis")
BESIDE = 50  # rows beside rest that are not compared, nor fitted by SciPy: 0.1 s
MOTION = ("mixed", "one way", "steps", "with rest")
STEP, ROWS = 2e-3, 3000
BLOCK = 125  # rows


def motion(draw: np.random.Generator, kind: str) -> np.ndarray:
    """A speed in m/s, a row each 2 ms."""
    t = np.arange(ROWS) * STEP
    a, b = draw.uniform(0.3, 1.5, 2)
    v = np.sin(2 * np.pi * a * t + draw.uniform(0, 6)) + 0.6 * np.sin(2 * np.pi * b * t + draw.uniform(0, 6))
    if kind == "one way":
        return 1.8 + v
    if kind == "with rest":
        return np.where((t // 0.75) % 4 < 1, 0.0, v)
    if kind == "steps":
        levels = np.repeat(draw.choice([-1.0, -0.5, -0.2, 0.2, 0.5, 1.0], 12), ROWS // 12)
        return np.convolve(np.pad(levels, 30, mode="edge"), np.hanning(61) / np.hanning(61).sum(), "valid")
    return v


def machine(draw: np.random.Generator, kind: str) -> dict[str, float]:
    """Constants of a machine; friction of some 10 N."""
    return {
        "mass": draw.uniform(0, 3), "F_c": draw.uniform(5, 12), "sigma_2": draw.uniform(0, 8),
        "dF": draw.uniform(0, 6) if kind != "coulomb" else 0.0, "v_s": draw.uniform(0.03, 0.3),
        "width": draw.uniform(0.002, 0.05), "offset": draw.uniform(-2, 2),
        "one_side": draw.uniform(0.1, 0.4) * (kind == "asymmetric"), "warms": draw.uniform(0.05, 0.2) * (kind == "temperature"),
        "cogs": draw.uniform(0.5, 2) * (kind == "cogging"), "slow": draw.uniform(0.005, 0.05) * (kind == "hysteresis"),
        "force_noise": draw.choice([0.05, 0.3, 1.0]), "speed_noise": draw.choice([1e-4, 1e-3, 1e-2]),
    }  # fmt: skip


def record(m: dict[str, float], v: np.ndarray, draw: np.random.Generator) -> dict[str, np.ndarray]:
    """What is measured."""
    t = np.arange(len(v)) * STEP
    sign = np.tanh(v / m["width"])
    if m["slow"]:
        for i in range(1, len(v)):
            sign[i] = sign[i - 1] + (sign[i] - sign[i - 1]) * min(STEP / m["slow"], 1.0)
    level = (m["F_c"] + m["dF"] * np.exp(-((v / m["v_s"]) ** 2))) * (1 + m["one_side"] * (v > 0))
    level *= 1 - m["warms"] * t / t[-1]
    y = np.cumsum(v) * STEP
    force = (
        m["mass"] * np.gradient(v, STEP) + level * sign + m["sigma_2"] * v + m["offset"] + m["cogs"] * np.sin(60 * y)
    )
    return {
        "t": t, "v": v + m["speed_noise"] * draw.standard_normal(len(v)),
        "F": force + m["force_noise"] * draw.standard_normal(len(v)),
    }  # fmt: skip


def least_squares(v: np.ndarray, a: np.ndarray, force: np.ndarray, beside: np.ndarray | None = None) -> Any:
    """Mass, Coulomb, viscous and offset, and columns ``beside`` these."""

    def columns(v: np.ndarray, a: np.ndarray, beside: np.ndarray | None = None) -> np.ndarray:
        return np.column_stack([a, np.sign(v), v, np.ones(len(v)), *([] if beside is None else beside.T)])

    found = np.linalg.lstsq(columns(v, a, beside), force, rcond=None)[0]
    return lambda v, a, beside=None: columns(v, a, beside) @ found


def tanh_stribeck(v: np.ndarray, a: np.ndarray, force: np.ndarray, beside: np.ndarray | None = None) -> Any:
    """The same with a Stribeck curve and a smooth sign."""

    def curve(x: Any, mass: float, f_c: float, df: float, v_s: float, width: float, s2: float, *rest: float) -> Any:
        level = f_c + df * np.exp(-((x[0] / v_s) ** 2))
        further = 0.0 if x[2] is None else x[2] @ np.array(rest[1:])
        return mass * x[1] + level * np.tanh(x[0] / width) + s2 * x[0] + rest[0] + further

    start = [1, 8, 2, 0.1, 0.01, 1, 0, *([] if beside is None else [0] * beside.shape[1])]
    try:
        found, _ = curve_fit(lambda _, *p: curve((v, a, beside), *p), v, force, start, maxfev=5000)
    except RuntimeError:
        return None
    return lambda v, a, beside=None: curve((v, a, beside), *found)


def one(seed: int) -> dict[str, Any]:
    """The errors on the second record, as shares of its force."""
    draw = np.random.default_rng(seed)
    kind, moves = FRICTION[seed % len(FRICTION)], MOTION[seed // len(FRICTION) % len(MOTION)]
    m = machine(draw, kind)
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        paths = [Path(folder) / name for name in ("first.npz", "second.npz")]
        for path in paths:
            np.savez(path, **record(m, motion(draw, moves), draw))
        names = {"time": "t", "velocity": "v", "force": "F"}
        fit = stribeck.fit(paths[0], **names)
        fit = getattr(fit, "best", fit)
        (Path(folder) / "fit.json").write_text(saved(fit), encoding="utf-8")
        first, second = (read_log(path, columns=names) for path in paths)
        model = load(folder)
        found = predict(model, second)
        rows, tested = away_from_rest(first), away_from_rest(second)
        size = float(np.linalg.norm(second.force[tested]))
        left = {"ours": (found.traces.measured - found.traces.fitted)[tested]}
        errors = {"ours": float(np.linalg.norm(left["ours"])) / size}
        for name, way in (("least squares", least_squares), ("tanh-Stribeck", tanh_stribeck)):
            there = way(first.velocity[rows], first.acceleration[rows], first.force[rows])
            if there is not None:
                left[name] = second.force[tested] - there(second.velocity[tested], second.acceleration[tested])
                errors[name] = float(np.linalg.norm(left[name])) / size
    best = min((n for n in errors if n != "ours"), key=lambda n: errors[n])
    told = {"worse": float(np.log(errors["ours"] / errors[best])), "standard_error": scatter(left["ours"], left[best])}
    return {
        "friction": kind, "motion": moves, "law": model.law, "values": sorted(model.values), "errors": errors, **told,
    }  # fmt: skip


def away_from_rest(log: Log) -> np.ndarray:
    """The rows in motion, and not so near to rest that a filter mixes the two: the speed jumps there, and the acceleration of
    a jump is the filter's."""
    return ~np.convolve(np.pad(at_rest(log), BESIDE, mode="edge"), np.ones(2 * BESIDE + 1), "valid").astype(bool)


def scatter(one: np.ndarray, other: np.ndarray) -> float:
    """The standard error of the logarithm of the ratio of two errors on one record: its quarters of a second drawn anew."""
    blocks = [np.add.reduceat(x * x, np.arange(0, len(x), BLOCK)) for x in (one, other)]
    draw = np.random.default_rng(0)
    taken = draw.integers(0, len(blocks[0]), (1000, len(blocks[0])))
    return float(np.std(np.log(blocks[0][taken].sum(1) / blocks[1][taken].sum(1)) / 2))


def counted(of: Callable[[int], dict[str, Any]], given: argparse.Namespace) -> dict[str, Any]:
    """Run the cases that are asked for, and name those where ours is worse by more than a hundredth of the error.

    Beside stands by how much (in logarithms), and the standard error of that on this one record. Last the count, with the 95 %
    interval of its rate (Clopper and Pearson). Returns the cases.
    """
    found: dict[str, Any] = {}
    for seed in range(given.first, given.first + given.cases):
        found[str(seed)] = case = of(seed)
        shown = {n: round(e, 4) for n, e in case["errors"].items()}
        told = f"{case['worse']:+.2%} +- {case['standard_error']:.2%}"
        worse = "WORSE" if case["worse"] > 0.01 else ""
        print(seed, case["friction"], case["motion"], case["law"], shown, told, worse, flush=True)
        given.out.write_text(json.dumps({"cases": found}, indent=1) + "\n", encoding="utf-8")
    good = sum(case["worse"] <= 0.01 for case in found.values())
    rate = binomtest(good, len(found)).proportion_ci()
    mean = float(np.mean([case["worse"] for case in found.values()]))
    print(f"{good} of {len(found)} within a hundredth or better: {rate.low:.1%} to {rate.high:.1%}; mean {mean:+.2%}")
    return found


def asked(told: str | None, cases: int, out: Path, further: Mapping[str, int] | None = None) -> argparse.Namespace:
    """The options; ``further`` whole numbers with their defaults."""
    parser = argparse.ArgumentParser(description=told, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=cases)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--out", type=Path, default=out)
    for name, usual in (further or {}).items():
        parser.add_argument(f"--{name}", type=int, default=usual)
    return parser.parse_args()


if __name__ == "__main__":
    counted(one, asked(__doc__, 100, RESULTS))
