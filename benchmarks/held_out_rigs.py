"""held_out.py's question for what users measure: positions by encoders, of rigs whose friction is none of our laws.

A servo whose arm has a weight (friction grows with what it carries; 12 bits a turn); a joint behind a gear with backlash (its
friction turns round over a way); a direct drive that cogs; an axis with a coarse scale; one that moves in one direction only;
one that is held for seconds by whatever force. Each makes two records with other motions; all fit the first and predict the
second, over the rows in motion. SciPy's fits take speed and acceleration from Savitzky and Golay's filter, and the weight too.

    python benchmarks/held_out_rigs.py [--cases 30] [--first 0] [--out FILE]
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
from stribeck.identify.predict import load, predict, saved

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


def one(seed: int) -> dict[str, Any]:
    """The errors on the second record, as shares of its force."""
    draw, kind = np.random.default_rng(seed), KINDS[seed % len(KINDS)]
    m = machine(draw, kind)
    made = [record(m, kind, draw) for _ in range(2)]
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        paths = [Path(folder) / name for name in ("first.npz", "second.npz")]
        for path, columns in zip(paths, made, strict=True):
            np.savez(path, **columns)
        fit = stribeck.fit(paths[0], **NAMES)
        fit = getattr(fit, "best", fit)
        (Path(folder) / "fit.json").write_text(saved(fit), encoding="utf-8")
        logs = [read_log(path, columns=NAMES) for path in paths]
        model = load(folder)
        found = predict(model, logs[1])
        # each at the rows in motion of the log, by its time
        rows = [np.searchsorted(c["t"], log.time[~at_rest(log)] - 1e-9) for c, log in zip(made, logs, strict=True)]
        force = made[1]["F"][rows[1]]
        left = {"ours": (found.traces.measured - found.traces.fitted)[~at_rest(logs[1])]}
        (v, a, w), after = measured(made[0]), measured(made[1])
        for name, way in (("least squares", least_squares), ("tanh-Stribeck", tanh_stribeck)):
            for beside in (False, True):
                told = [(x[r][:, :] if beside else x[r][:, :0]) for x, r in zip((w, after[2]), rows, strict=True)]
                there = way(v[rows[0]], a[rows[0]], made[0]["F"][rows[0]], told[0])
                if there is not None:
                    label = name + (" with weight" if beside else "")
                    left[label] = force - there(after[0][rows[1]], after[1][rows[1]], told[1])
    errors = {name: float(np.linalg.norm(x) / np.linalg.norm(force)) for name, x in left.items()}
    best = min((n for n in errors if n != "ours"), key=lambda n: errors[n])
    return {
        "friction": kind, "motion": "sines", "law": model.law, "values": sorted(model.values), "errors": errors,
        "worse": float(np.log(errors["ours"] / errors[best])), "standard_error": scatter(left["ours"], left[best]),
    }  # fmt: skip


if __name__ == "__main__":
    counted(one, asked(__doc__, 30, RESULTS))
