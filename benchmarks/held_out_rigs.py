"""held_out.py's question for what users measure: positions by encoders, of rigs whose friction is none of our laws.

A servo whose arm has a weight (friction grows with what it carries; 12 bits a turn); a joint behind a gear with backlash (its
friction turns round over a way); a direct drive that cogs; an axis with a coarse scale; one that moves in one direction only;
one that is held for seconds by whatever force. Each makes two records with other motions; all fit the first and predict the
second, over the rows in motion. SciPy's fits take speed and acceleration from Savitzky and Golay's filter, and the weight too.

    python benchmarks/held_out_rigs.py [--cases 30] [--first 0] [--motions 1] [--out FILE]

With more motions, each is a second record by itself: what is chance of one motion goes, what is the fit's stays.
"""

from __future__ import annotations

import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from held_out import asked, counted, least_squares, scatter, tanh_stribeck
from scipy.signal import savgol_filter

import stribeck
from stribeck.identify.api import read_log
from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log
from stribeck.identify.predict import FittedModel, load, predict, saved

RESULTS = Path(__file__).parent / "results" / "held_out_rigs.json"
KINDS = ("servo", "backlash", "cogging", "coarse", "one way", "held")
NAMES = {"time": "t", "position": "y", "force": "F"}
RATE = {"servo": 200.0}  # Hz; the others 500
SECONDS, WINDOW = 15.0, 0.06  # of a record; of Savitzky and Golay's filter


def machine(draw: np.random.Generator, kind: str) -> dict[str, float]:
    """Constants of a rig whose friction is some 1; a servo's encoder has 4096 steps a turn."""
    level = float(np.exp(draw.uniform(-1, 3)))
    return {
        "level": level, "dF": level * draw.uniform(0, 0.6), "v_s": draw.uniform(0.02, 0.3), "width": draw.uniform(2e-3, 0.05),
        "sigma_2": level * draw.uniform(0, 1), "mass": level * draw.uniform(0.01, 0.2), "offset": level * draw.uniform(-0.1, 0.1),
        "weight": level * draw.uniform(2, 8) * (kind == "servo"), "grows": draw.uniform(0, 0.15) * (kind == "servo"),
        "lash": draw.uniform(0.005, 0.03) * (kind == "backlash"), "cogs": level * draw.uniform(0.1, 0.8) * (kind == "cogging"),
        "teeth": float(draw.integers(6, 30)), "held": level * draw.uniform(0.3, 0.9) * (kind == "held"),
        "step": {"servo": 2 * np.pi / 4096, "coarse": draw.uniform(1e-4, 1e-3)}.get(kind, draw.uniform(1e-6, 2e-5)),
        "noise": level * draw.choice([0.01, 0.05, 0.2]),
    }  # fmt: skip


def record(m: dict[str, float], kind: str, draw: np.random.Generator) -> dict[str, np.ndarray]:
    """Three sines, from 0.1 to 1.5 Hz, and what is measured of them."""
    h = 1 / RATE.get(kind, 500.0)
    t = np.arange(0, SECONDS, h)
    w = 2 * np.pi * np.exp(draw.uniform(np.log(0.1), np.log(1.5), 3))
    speed, phase = draw.uniform(0.1, 1.0, 3), draw.uniform(0, 6, 3)
    v = np.sin(np.outer(t, w) + phase) @ speed
    if kind == "one way":
        v += speed.sum() * 1.05
    if kind == "held":
        moves = np.convolve((t % 5 > 2).astype(float), np.hanning(101) / np.hanning(101).sum(), "same")
        v = np.where(moves > 1e-9, v * moves, 0.0)
    y, a = np.cumsum(v) * h, np.gradient(v, h)
    sign = np.tanh(v / m["width"])
    if m["lash"]:
        for i in range(1, len(y)):
            sign[i] = np.clip(sign[i - 1] + (y[i] - y[i - 1]) / m["lash"], -1, 1)
    carried = m["mass"] * a + m["weight"] * np.sin(y)
    curve = m["level"] + m["dF"] * np.exp(-((v / m["v_s"]) ** 2)) + m["grows"] * abs(carried)
    force = carried + curve * sign + m["sigma_2"] * v + m["offset"] + m["cogs"] * np.sin(m["teeth"] * y)
    force = np.where(v == 0, m["held"] * np.sin(2.1 * t), force) if m["held"] else force
    return {"t": t, "y": m["step"] * np.round(y / m["step"]), "F": force + m["noise"] * draw.standard_normal(len(t))}


def measured(columns: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speed, acceleration, and the columns of a weight, as SciPy alone has them."""
    y, h = columns["y"], float(columns["t"][1] - columns["t"][0])
    rows = 2 * round(WINDOW / h / 2) + 1
    v, a = (savgol_filter(y, rows, 3, deriv, h) for deriv in (1, 2))
    return v, a, np.column_stack([np.sin(y), np.cos(y)])


def one(seed: int, motions: int = 1, rigs: tuple[Any, Any, Any] = (KINDS, machine, record)) -> dict[str, Any]:
    """The errors on the second record, as shares of its force; and on further ones, of other motions."""
    kinds, constants, measure = rigs
    draw, kind = np.random.default_rng(seed), kinds[seed % len(kinds)]
    m = constants(draw, kind)
    made = [measure(m, kind, draw) for _ in range(1 + motions)]
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        paths = [Path(folder) / f"{i}.npz" for i in range(len(made))]
        for path, columns in zip(paths, made, strict=True):
            np.savez(path, **columns)
        fit = stribeck.fit(paths[0], **NAMES)
        fit = getattr(fit, "best", fit)
        (Path(folder) / "fit.json").write_text(saved(fit), encoding="utf-8")
        model, ways = load(folder), plain(made[0], in_motion(made[0], read_log(paths[0], columns=NAMES)))
        told = [missed(model, ways, c, read_log(p, columns=NAMES)) for c, p in zip(made[1:], paths[1:], strict=True)]
    left, errors = told[0]
    best = plainest(errors)
    found = {
        "friction": kind, "motion": "sines", "law": model.law, "values": sorted(model.values), "errors": errors,
        "worse": float(np.log(errors["ours"] / errors[best])), "standard_error": scatter(left["ours"], left[best]),
    }  # fmt: skip
    return {**found, "others": compared([e for _, e in told])} if motions > 1 else found


def plainest(errors: dict[str, float]) -> str:
    """The best of the plain fits."""
    return min((n for n in errors if n != "ours"), key=lambda n: errors[n])


def in_motion(columns: dict[str, np.ndarray], log: Log) -> np.ndarray:
    """The rows of a record in which its log moves, by their time."""
    return np.searchsorted(columns["t"], log.time[~at_rest(log)] - 1e-9)


def plain(columns: dict[str, np.ndarray], rows: np.ndarray) -> dict[str, tuple[Any, bool]]:
    """SciPy's fits to a record, and whether each has a weight."""
    (v, a, w), found = measured(columns), {}
    for name, way in (("least squares", least_squares), ("tanh-Stribeck", tanh_stribeck)):
        for beside in (False, True):
            there = way(v[rows], a[rows], columns["F"][rows], w[rows] if beside else w[rows, :0])
            if there is not None:
                found[name + (" with weight" if beside else "")] = there, beside
    return found


def missed(
    model: FittedModel, ways: dict[str, tuple[Any, bool]], columns: dict[str, np.ndarray], log: Log
) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """What each fit misses of a record's force at its rows in motion, and as a share of it."""
    (v, a, w), rows, found = measured(columns), in_motion(columns, log), predict(model, log).traces
    force = columns["F"][rows]
    left = {"ours": (found.measured - found.fitted)[~at_rest(log)]}
    for name, (there, beside) in ways.items():
        left[name] = force - there(v[rows], a[rows], w[rows] if beside else w[rows, :0])
    return left, {name: float(np.linalg.norm(x) / np.linalg.norm(force)) for name, x in left.items()}


def compared(errors: list[dict[str, float]]) -> dict[str, Any]:
    """Over all motions: on how many ours is within a hundredth of the best plain fit of each, as one knows it afterwards; and
    against each plain fit, used throughout, the mean of the logarithm of the ratio and its standard error."""
    good = sum(bool(np.log(e["ours"] / e[plainest(e)]) <= 0.01) for e in errors)
    against = {}
    for name in (n for n in errors[0] if n != "ours"):
        ratios = [np.log(e["ours"] / e[name]) for e in errors]
        against[name] = float(np.mean(ratios)), float(np.std(ratios, ddof=1) / np.sqrt(len(ratios)))
    return {"motions": len(errors), "good": good, "against": against}


def told_of_motions(cases: dict[str, Any]) -> None:
    """Of each case, and each kind: whether ours is worse than the plain fit that is the best one over all motions."""
    for seed, case in cases.items():
        found = case["others"]
        name = max(found["against"], key=lambda n: found["against"][n][0])
        mean, error = found["against"][name]
        worse = "WORSE" if mean > 0.01 and mean > 2 * error else ""
        good = f"{found['good']} of {found['motions']}"
        print(f"{seed} {case['friction']}: within a hundredth on {good}; {mean:+.2%} +- {error:.2%} of {name} {worse}")


if __name__ == "__main__":
    given = asked(__doc__, 30, RESULTS, {"motions": 1})
    found = counted(lambda seed: one(seed, given.motions), given)
    if given.motions > 1:
        told_of_motions(found)
