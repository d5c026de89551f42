"""Kinds of rigs of which no rule of the fit was made: a gap or an elastic shaft, Dahl's friction, warmth, springs."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

KINDS = (
    "gap",
    "shaft",
    "warms",
    "weight and spring",
    "spring",
    "current",
    "two ripples",
    "slow",
    "short",
    "long",
    "50 Hz",
    "dahl",
)
STEP, SECONDS = {"50 Hz": 0.02, "long": 0.01}, {"short": 3.0, "long": 1800.0}  # s; the others 2 ms and 15 s
SLOW = 0.05  # times the rates and the speeds of the others

Of = Callable[[np.ndarray], np.ndarray]


def machine(draw: np.random.Generator, kind: str) -> dict[str, float]:
    """Constants of a rig whose friction is some ``level``; each kind uses those that it has."""
    level = float(np.exp(draw.uniform(-1, 3)))
    return {
        "level": level, "dF": level * draw.uniform(0, 0.6), "v_s": draw.uniform(0.02, 0.3), "width": draw.uniform(2e-3, 0.02),
        "sigma_2": level * draw.uniform(0, 1), "mass": level * draw.uniform(0.01, 0.2), "offset": level * draw.uniform(-0.1, 0.1),
        "noise": level * draw.choice([0.01, 0.05]), "step": draw.uniform(1e-6, 2e-5), "share": draw.uniform(0.3, 0.8),
        "gap": draw.uniform(0.005, 0.03), "shaft": level * draw.uniform(20, 200), "spring": level * draw.uniform(0.5, 2),
        "weight": level * draw.uniform(2, 6), "current": level * draw.uniform(0.05, 0.3), "warms": draw.uniform(0.1, 0.4),
        "one": level * draw.uniform(0.1, 0.4), "two": level * draw.uniform(0.05, 0.3), "waves": float(draw.integers(6, 15)),
        "more": float(draw.integers(20, 60)), "yields": draw.uniform(1e-3, 0.02),
    }  # fmt: skip


def motion(draw: np.random.Generator, slow: float) -> tuple[Of, Of, Of]:
    """Position, speed and acceleration at times: three sines."""
    w, speed = 2 * np.pi * np.exp(draw.uniform(np.log(0.1), np.log(1.5), 3)) * slow, draw.uniform(0.1, 1.0, 3) * slow
    phase = draw.uniform(0, 6, 3)
    return (
        lambda t: (np.cos(phase) - np.cos(np.multiply.outer(t, w) + phase)) @ (speed / w),
        lambda t: np.sin(np.multiply.outer(t, w) + phase) @ speed,
        lambda t: np.cos(np.multiply.outer(t, w) + phase) @ (speed * w),
    )


def curve(m: dict[str, float], v: np.ndarray) -> np.ndarray:
    """The friction at a speed."""
    return (m["level"] + m["dF"] * np.exp(-((v / m["v_s"]) ** 2))) * np.tanh(v / m["width"]) + m["sigma_2"] * v


def behind(m: dict[str, float], kind: str, t: np.ndarray, position: Of, speed: Of) -> np.ndarray:
    """The force of a load behind a gap, stiff where it is closed, or behind a shaft."""
    mass, gap = m["mass"] * m["share"], m["gap"] if kind == "gap" else 0.0
    stiff = 400 * m["level"] if gap else m["shaft"]
    damping = 2 * m["share"] * np.sqrt(stiff * mass) * (1.0 if gap else 0.3)

    def shaft(way: float, rate: float) -> float:
        closed = np.sign(way) * max(abs(way) - gap / 2, 0.0)
        return float(stiff * closed + (damping * rate if closed or not gap else 0.0))

    def rates(s: float, x: np.ndarray) -> list[float]:
        pull = shaft(float(position(s)) - x[0], float(speed(s)) - x[1])
        return [x[1], (pull - m["share"] * float(curve(m, x[1]))) / mass]

    begin = [0.0, float(speed(t[0]))]
    found = solve_ivp(rates, (0, t[-1]), begin, "LSODA", t_eval=t, max_step=5e-3, rtol=1e-6, atol=1e-9).y
    return np.array([shaft(a, b) for a, b in zip(position(t) - found[0], speed(t) - found[1], strict=True)])


def yielding(m: dict[str, float], y: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Dahl's part of the level that has turned: it goes on exponentially with the way."""
    part = np.sign(v)
    for i in range(1, len(y)):
        way = np.sign(y[i] - y[i - 1])
        part[i] = way - (way - part[i - 1]) * np.exp(-abs(y[i] - y[i - 1]) / m["yields"])
    return part


def record(m: dict[str, float], kind: str, draw: np.random.Generator) -> dict[str, np.ndarray]:
    """What is measured of a motion."""
    t = np.arange(0, SECONDS.get(kind, 15.0), STEP.get(kind, 2e-3))
    position, speed, rate = motion(draw, SLOW if kind == "slow" else 1.0)
    y, v, a = position(t), speed(t), rate(t)
    force = m["mass"] * a + curve(m, v)
    if kind in ("gap", "shaft"):
        force = (1 - m["share"]) * force + behind(m, kind, t, position, speed)
    if kind == "dahl":
        force = (
            m["mass"] * a
            + (m["level"] + m["dF"] * np.exp(-((v / m["v_s"]) ** 2))) * yielding(m, y, v)
            + m["sigma_2"] * v
        )
    if kind == "warms":
        force -= m["warms"] * (1 - np.exp(-(t + draw.uniform(0, 20)) / 8.0)) * curve(m, v)
    if kind == "weight and spring":
        force += m["weight"] * np.sin(y + 0.4)
    if kind in ("spring", "weight and spring"):
        force += m["spring"] * y
    if kind == "two ripples":
        force += m["one"] * np.sin(m["waves"] * y) + m["two"] * np.sin(m["more"] * y + 1)
    force += m["offset"] + m["noise"] * draw.standard_normal(len(t))
    if kind == "current":
        force = m["current"] * np.round(force / m["current"])
    return {"t": t, "y": m["step"] * np.round(y / m["step"]), "F": force}
