"""Rigs as users have them: positions by encoders, a servo with a weight, backlash, cogging, one direction."""

from __future__ import annotations

import numpy as np
from scipy.signal import savgol_filter

from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log

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


def in_motion(columns: dict[str, np.ndarray], log: Log) -> np.ndarray:
    """The rows of a record in which its log moves, by their time."""
    return np.searchsorted(columns["t"], log.time[~at_rest(log)] - 1e-9)
