"""Machines whose friction is mostly none of our laws, with measured speeds; and the plain fits that a user would write."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import curve_fit

from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log

FRICTION = ("coulomb", "stribeck", "asymmetric", "temperature", "cogging", "hysteresis")
BESIDE = 50  # rows beside rest that are not compared, nor fitted by SciPy: 0.1 s
MOTION = ("mixed", "one way", "steps", "with rest")
STEP, ROWS = 2e-3, 3000


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


def away_from_rest(log: Log) -> np.ndarray:
    """The rows in motion, and not so near to rest that a filter mixes the two: the speed jumps there, and the acceleration of
    a jump is the filter's."""
    return ~np.convolve(np.pad(at_rest(log), BESIDE, mode="edge"), np.ones(2 * BESIDE + 1), "valid").astype(bool)
