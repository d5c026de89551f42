"""Records whose friction law lacks a term, bends otherwise, or has another exponent: the truth stands beside each."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from held_out import ROWS, STEP, machine

Made = tuple[str, dict[str, np.ndarray], dict[str, float], Callable[[float], float] | None]
POWERS = (2.0, 1.5, 3.0, 0.5)  # of the speed, in records that bend otherwise
EXPONENTS = (1.0, 1.0, 0.7, 1.5, 2.0)  # of the Stribeck curve, in records that are pointed
LACKS = ("delay", "direction", "weight", "spring", "position", "time", "forwards")


def record(seed: int) -> Made:
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
    plain = what in ("nothing", "delay", "weight", "spring")
    told = {"t": t, "y": measured, "F": force + m["force_noise"] * draw.standard_normal(len(t))}

    def friction(u: float) -> float:
        rise = m["dF"] * np.exp(-((u / m["v_s"]) ** 2))
        return float((m["F_c"] + rise) * np.tanh(u / m["width"]) + m["sigma_2"] * u)

    return what, told, truth, friction if plain else None


def bent(seed: int) -> Made:
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

    def friction(u: float) -> float:
        return float(level * (1 + rises * np.exp(-((u / v_s) ** 2))) + viscous * u + bends * u**power)

    return f"bent, |v|^{power:g}", {"t": t, "y": y, "F": force}, truth, friction


def pointed(seed: int) -> Made:
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

    def friction(u: float) -> float:
        return float(level * (1 + rises * np.exp(-((u / v_s) ** exponent))) + viscous * u)

    return f"pointed, |v/v_s|^{exponent:g}", {"t": t, "y": y, "F": force}, truth, friction
