"""Synthetic records for counts on static fits, each with its truth, and the plain fits that a user would write.

Speeds measured; incomplete laws (a term lacks, the curve bends otherwise, another exponent); friction of another kind
altogether; rigs with encoders; rigs of kinds of which no rule of the fit was made.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import curve_fit
from scipy.signal import savgol_filter

from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log

Draw = np.random.Generator
Columns = dict[str, np.ndarray]
Constants = dict[str, float]
STEP, ROWS = 2e-3, 3000


def log_uniform(draw: Draw, low: float, high: float, count: int | None = None) -> Any:
    """Numbers whose logarithms are uniform."""
    return np.exp(draw.uniform(np.log(low), np.log(high), count))


class Sines(NamedTuple):
    """A motion of several sines: their rates (rad/s), speeds and phases."""

    w: np.ndarray
    speed: np.ndarray
    phase: np.ndarray

    def y(self, t: Any) -> Any:
        """The position at times."""
        return -np.cos(np.multiply.outer(t, self.w) + self.phase) @ (self.speed / self.w)

    def way(self, t: Any) -> Any:
        """The position from that at time 0 on."""
        return (np.cos(self.phase) - np.cos(np.multiply.outer(t, self.w) + self.phase)) @ (self.speed / self.w)

    def v(self, t: Any) -> Any:
        """The speed at times."""
        return np.sin(np.multiply.outer(t, self.w) + self.phase) @ self.speed

    def a(self, t: Any) -> Any:
        """The acceleration at times."""
        return np.cos(np.multiply.outer(t, self.w) + self.phase) @ (self.speed * self.w)


def sines(
    draw: Draw, rates: tuple[float, float], speeds: tuple[float, float], count: int = 3, slow: float = 1.0
) -> Sines:
    """Sines of rates (Hz) and speeds within these; ``slow``: times both."""
    w = 2 * np.pi * log_uniform(draw, *rates, count) * slow
    return Sines(w, draw.uniform(*speeds, count) * slow, draw.uniform(0, 6, count))


def stribeck_level(m: Constants, v: Any) -> Any:
    """The level of a Stribeck curve, at a speed."""
    return m["F_c"] + m["dF"] * np.exp(-((v / m["v_s"]) ** 2))


def smooth_curve(m: Constants, v: Any) -> Any:
    """The friction at a speed: a Stribeck curve with a smooth sign, and viscous friction."""
    return stribeck_level(m, v) * np.tanh(v / m["width"]) + m["sigma_2"] * v


# -- speeds measured ------------------------------------------------------------------------------------------------

SPEED_FRICTION = ("coulomb", "stribeck", "asymmetric", "temperature", "cogging", "hysteresis")
BESIDE = 50  # rows beside rest that are not compared, nor fitted by SciPy: 0.1 s
SPEED_MOTIONS = ("mixed", "one way", "steps", "with rest")


def speed_motion(draw: Draw, kind: str) -> np.ndarray:
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


def speed_machine(draw: Draw, kind: str) -> Constants:
    """Constants of a machine; friction of some 10 N."""
    return {
        "mass": draw.uniform(0, 3), "F_c": draw.uniform(5, 12), "sigma_2": draw.uniform(0, 8),
        "dF": draw.uniform(0, 6) if kind != "coulomb" else 0.0, "v_s": draw.uniform(0.03, 0.3),
        "width": draw.uniform(0.002, 0.05), "offset": draw.uniform(-2, 2),
        "one_side": draw.uniform(0.1, 0.4) * (kind == "asymmetric"), "warms": draw.uniform(0.05, 0.2) * (kind == "temperature"),
        "cogs": draw.uniform(0.5, 2) * (kind == "cogging"), "slow": draw.uniform(0.005, 0.05) * (kind == "hysteresis"),
        "force_noise": draw.choice([0.05, 0.3, 1.0]), "speed_noise": draw.choice([1e-4, 1e-3, 1e-2]),
    }  # fmt: skip


def speed_record(m: Constants, v: np.ndarray, draw: Draw) -> Columns:
    """What is measured."""
    t = np.arange(len(v)) * STEP
    sign = np.tanh(v / m["width"])
    if m["slow"]:
        for i in range(1, len(v)):
            sign[i] = sign[i - 1] + (sign[i] - sign[i - 1]) * min(STEP / m["slow"], 1.0)
    level = stribeck_level(m, v) * (1 + m["one_side"] * (v > 0))
    level *= 1 - m["warms"] * t / t[-1]
    y = np.cumsum(v) * STEP
    force = (
        m["mass"] * np.gradient(v, STEP) + level * sign + m["sigma_2"] * v + m["offset"] + m["cogs"] * np.sin(60 * y)
    )
    return {
        "t": t, "v": v + m["speed_noise"] * draw.standard_normal(len(v)),
        "F": force + m["force_noise"] * draw.standard_normal(len(v)),
    }  # fmt: skip


def least_squares(v: np.ndarray, a: np.ndarray, force: np.ndarray, beside: np.ndarray) -> Any:
    """Mass, Coulomb, viscous and offset, and columns ``beside`` these."""

    def columns(v: np.ndarray, a: np.ndarray, beside: np.ndarray) -> np.ndarray:
        return np.column_stack([a, np.sign(v), v, np.ones(len(v)), *beside.T])

    result = np.linalg.lstsq(columns(v, a, beside), force, rcond=None)[0]
    return lambda v, a, beside: columns(v, a, beside) @ result


def tanh_stribeck(v: np.ndarray, a: np.ndarray, force: np.ndarray, beside: np.ndarray) -> Any:
    """The same with a Stribeck curve and a smooth sign."""

    def curve(x: Any, mass: float, f_c: float, df: float, v_s: float, width: float, s2: float, *rest: float) -> Any:
        level = f_c + df * np.exp(-((x[0] / v_s) ** 2))
        further = x[2] @ np.array(rest[1:])
        return mass * x[1] + level * np.tanh(x[0] / width) + s2 * x[0] + rest[0] + further

    start = [1, 8, 2, 0.1, 0.01, 1, 0, *[0] * beside.shape[1]]
    try:
        result, _ = curve_fit(lambda _, *p: curve((v, a, beside), *p), v, force, start, maxfev=5000)
    except RuntimeError:
        return None
    return lambda v, a, beside: curve((v, a, beside), *result)


def away_from_rest(log: Log) -> np.ndarray:
    """The rows in motion, and not so near to rest that a filter mixes the two: the speed jumps there, and the acceleration of
    a jump is the filter's."""
    return ~np.convolve(np.pad(at_rest(log), BESIDE, mode="edge"), np.ones(2 * BESIDE + 1), "valid").astype(bool)


# -- incomplete laws --------------------------------------------------------------------------------------------------

Made = tuple[str, Columns, Constants, Callable[[float], float] | None]
POWERS = (2.0, 1.5, 3.0, 0.5)  # of the speed, in records that bend otherwise
EXPONENTS = (1.0, 1.0, 0.7, 1.5, 2.0)  # of the Stribeck curve, in records that are pointed
LACKS = ("delay", "direction", "weight", "spring", "position", "time", "forwards")


def lacking(seed: int) -> Made:
    """What the lacking holds beside the law, the lacking, and the truth of each number that has one."""
    draw = np.random.default_rng(seed)
    what = LACKS[seed // 2 % len(LACKS)] if seed % 2 else "nothing"
    m = speed_machine(draw, ("coulomb", "stribeck")[seed // (2 * len(LACKS)) % 2])
    size, noise = float(log_uniform(draw, 0.003, 0.3)), draw.choice([1e-6, 1e-5, 1e-4])
    t, at = np.arange(2 * ROWS) * STEP, sines(draw, (0.15, 1.8), (0.2, 1.0))
    late = 30 * size * STEP if what == "delay" else 0.0
    y, v, a, level = at.y(t), at.v(t), at.a(t), stribeck_level(m, at.v(t))
    beside = {"direction": abs(v), "weight": np.sin(y), "spring": y}.get(what, 0.0 * t)
    level += size * {"position": m["F_c"] * y, "time": level * (2 * t / t[-1] - 1), "forwards": level * (v > 0)}.get(
        what, 0.0 * t
    )
    force = m["mass"] * a + level * np.tanh(v / m["width"]) + m["sigma_2"] * v + m["offset"] + size * m["F_c"] * beside
    truth = {n: float(m[n]) for n in ("mass", "offset", "F_c", "sigma_2")}
    truth |= {"k_v": 1 / m["width"]} | ({"F_s": m["F_c"] + m["dF"], "v_s": m["v_s"]} if m["dF"] else {})
    if what == "forwards":  # friction has two levels then, and an offset of half their difference
        truth = {n: truth[n] for n in ("mass", "sigma_2", "k_v")}
    measured = at.y(t - late) + noise * draw.standard_normal(len(t))
    plain = what in ("nothing", "delay", "weight", "spring")
    reported = {"t": t, "y": measured, "F": force + m["force_noise"] * draw.standard_normal(len(t))}
    return what, reported, truth, (lambda u: float(smooth_curve(m, u))) if plain else None


def bent(seed: int) -> Made:
    """As :func:`lacking`, of a curve that bends upwards with the speed, beside a Stribeck bend that may be too narrow to be
    seen: a law that lacks the one spends its bend on it, far from where the truth has the other."""
    power = POWERS[seed % len(POWERS)]
    columns, truth, friction = curved(seed, 2.0, power, (1e-3, 0.2), (0.4, 1.3))
    return f"bent, |v|^{power:g}", columns, truth, friction


def pointed(seed: int) -> Made:
    """As :func:`lacking`, of a Stribeck curve whose exponent may be another than 2."""
    exponent = EXPONENTS[seed % len(EXPONENTS)]
    columns, truth, friction = curved(seed, exponent, None, (5e-3, 0.1), (0.3, 1.0))
    return f"pointed, |v/v_s|^{exponent:g}", columns, {n: x for n, x in truth.items() if n != "v_s"}, friction


def curved(
    seed: int, exponent: float, power: float | None, stribeck: tuple[float, float], speeds: tuple[float, float]
) -> tuple[Columns, Constants, Callable[[float], float]]:
    """A record of a Stribeck curve of an exponent and, with a ``power`` of the speed, a further term; its truth."""
    draw = np.random.default_rng(seed)
    level = float(np.exp(draw.uniform(-1, 2)))
    v_s, rises = float(log_uniform(draw, *stribeck)), draw.uniform(0.2, 0.8)
    viscous = level * draw.uniform(0.05, 0.4)
    bends = 0.0 if power is None else level * float(log_uniform(draw, 0.05, 0.4))
    mass, offset, noise = level * draw.uniform(0, 0.3), level * draw.uniform(-0.1, 0.1), draw.choice([1e-3, 5e-3, 2e-2])
    t, at = np.arange(2 * ROWS) * STEP, sines(draw, (0.15, 1.8), speeds, 1 + seed % 2)
    y, v = at.y(t) + 1e-7 * draw.standard_normal(len(t)), at.v(t)

    def curve(u: Any) -> Any:
        further = 0.0 if power is None else bends * u**power
        return level * (1 + rises * np.exp(-((u / v_s) ** exponent))) + viscous * u + further

    force = mass * at.a(t) + curve(abs(v)) * np.sign(v) + offset + level * noise * draw.standard_normal(len(t))
    truth = {"mass": mass, "offset": offset, "F_c": level, "sigma_2": viscous, "F_s": level * (1 + rises), "v_s": v_s}
    return {"t": t, "y": y, "F": force}, truth, lambda u: float(curve(u))


# -- friction of another kind ----------------------------------------------------------------------------------------

OTHER_MOTIONS = ("sine", "to and fro", "constant speeds", "several sines")
WITHIN, OTHER_LASTS = 10, 16.0  # steps of the friction in one of the rows; s of a record
KNOWN_OF_ALL = ("mass", "F_c", "sigma_2")
Motion = tuple[np.ndarray, np.ndarray, np.ndarray]  # position, speed, acceleration


def other_machine(draw: Draw, stribeck_too: bool) -> Constants:
    """Constants of a machine that makes 0.1 to 0.5 m/s."""
    level, fastest = float(np.exp(draw.uniform(0, 3))), float(draw.uniform(0.1, 0.5))
    m = {
        "F_c": level, "F_s": level * (1 + draw.uniform(0.15, 0.7) * stribeck_too),
        "v_s": fastest * float(log_uniform(draw, 0.02, 0.2)),
        "sigma_2": level / fastest * draw.uniform(0.1, 0.6), "mass": level * draw.uniform(0.01, 0.15) / fastest,
        "offset": level * draw.uniform(-0.1, 0.1), "fastest": fastest,
        "noise": level * draw.choice([1e-3, 5e-3, 2e-2]), "encoder": draw.choice([1e-7, 1e-6, 5e-6]),
    }  # fmt: skip
    return m | {"dF": m["F_s"] - m["F_c"]}


def other_motion(draw: Draw, kind: str, fastest: float) -> Motion:
    """What is driven, at the steps of the friction."""
    t = np.arange(round(OTHER_LASTS / STEP) * WITHIN) * STEP / WITHIN
    if "sine" in kind:
        at = sines(draw, (0.15, 1.2), (0.3, 1), 1 if kind == "sine" else 4)
        at = at._replace(speed=at.speed * (fastest / at.speed.sum()))
        return at.y(t), at.v(t), at.a(t)
    if kind == "to and fro":
        every = draw.uniform(0.4, 1.5)
        levels = fastest * np.array([(-1) ** i for i in range(int(OTHER_LASTS / every) + 2)])
    else:
        every = draw.uniform(0.6, 1.0)
        levels = fastest * draw.permutation(np.concatenate([s * np.geomspace(0.03, 1, 6) for s in (1, -1)] * 3))
    ramp = draw.uniform(0.1, 0.25)  # of a stretch: the speed changes by half a cosine
    number, share = np.divmod(t / every, 1.0)
    i = np.minimum(number.astype(int), len(levels) - 2)
    part = np.clip(share / ramp, 0, 1)
    rise = levels[i + 1] - levels[i]
    v = levels[i] + rise * (1 - np.cos(np.pi * part)) / 2
    a = rise * np.pi / (2 * ramp * every) * np.sin(np.pi * part)
    return np.cumsum(v) * STEP / WITHIN, v, a


# -- kinds of friction: its force along a motion ---------------------------------------------------------------------


def complete(draw: Draw, m: Constants, at: Motion) -> np.ndarray:
    """The law itself."""
    return np.asarray(stribeck_level(m, at[1]) * np.sign(at[1]) + m["sigma_2"] * at[1])


def root(draw: Draw, m: Constants, at: Motion) -> np.ndarray:
    """Grease that thins, beside Coulomb and viscous friction."""
    v = at[1]
    grows = m["F_c"] * draw.uniform(0.05, 0.5) * np.sqrt(abs(v) / m["fastest"])
    return complete(draw, m, at) + grows * np.sign(v)


def gms(draw: Draw, m: Constants, at: Motion) -> np.ndarray:
    """Four Maxwell slips in parallel (Al-Bender, Lampaert, Swevers 2005)."""
    v, dt = at[1], STEP / WITHIN
    share = draw.dirichlet(np.full(4, 3.0))
    bends = m["F_s"] * share / (float(log_uniform(draw, 5e-6, 2e-4)) * np.array([0.25, 0.5, 1.0, 2.0]))
    attraction = m["F_c"] * float(log_uniform(draw, 20, 500))  # N/s
    s, force, slips, out = stribeck_level(m, v), np.zeros(4), np.zeros(4, bool), np.empty(len(v))
    fade = np.exp(-attraction * dt / s)
    sign = np.sign(v)
    for i in range(len(v)):
        if i and sign[i] != sign[i - 1]:
            slips[:] = False
        drawn = share * s[i] * sign[i] + (force - share * s[i] * sign[i]) * fade[i]
        bent = force + bends * v[i] * dt
        slips |= abs(bent) >= share * s[i]
        bent = np.clip(bent, -share * max(s[i], s[i - 1] if i else s[i]), share * max(s[i], s[i - 1] if i else s[i]))
        force = np.where(slips, drawn, bent)
        out[i] = force.sum()
    return out + m["sigma_2"] * v


def directions(draw: Draw, m: Constants, at: Motion) -> np.ndarray:
    """Levels, slopes and bends that differ forwards and backwards; the means are the machine's."""
    v, unlike = at[1], draw.uniform(-0.3, 0.3, 2)
    way = np.sign(v)
    return np.asarray(stribeck_level(m, v) * (1 + unlike[0] * way) * way + m["sigma_2"] * (1 + unlike[1] * way) * v)


def worm(draw: Draw, m: Constants, at: Motion) -> np.ndarray:
    """A gear whose friction grows with what it transmits: inertia and an arm's weight, which the force holds too."""
    y, v, a = at
    weight = m["F_c"] * draw.uniform(0, 1.5) * np.sin(y + draw.uniform(0, 6))
    loss = draw.uniform(0.05, 0.4)
    return complete(draw, m, at) + weight + loss * abs(m["mass"] * a + weight) * np.sign(v)


def belt(draw: Draw, m: Constants, at: Motion) -> np.ndarray:
    """A level that goes round with a pulley."""
    y, v, _ = at
    round_ = 1 + draw.uniform(0.02, 0.2) * np.sin(2 * np.pi * y / draw.uniform(0.03, 0.12) + draw.uniform(0, 6))
    return np.asarray(stribeck_level(m, v) * round_ * np.sign(v) + m["sigma_2"] * v)


def contacts(draw: Draw, m: Constants, at: Motion) -> np.ndarray:
    """A bearing and a seal: two Stribeck bends with unlike speeds, of unlike heights."""
    v, share = at[1], draw.uniform(0.2, 0.8)
    other = m["v_s"] / draw.uniform(4, 30)
    level = m["F_c"] + m["dF"] * (share * np.exp(-((v / m["v_s"]) ** 2)) + (1 - share) * np.exp(-((v / other) ** 2)))
    return np.asarray(level * np.sign(v) + m["sigma_2"] * v)


def bristles(draw: Draw, m: Constants, at: Motion) -> np.ndarray:
    """Bristles that bend by up to a millimeter before they slide (LuGre; without a Stribeck bend, Dahl)."""
    v, dt = at[1], STEP / WITHIN
    bend = float(log_uniform(draw, 1e-5, 1e-3))
    g, z, out = bend * stribeck_level(m, v) / m["F_c"], 0.0, np.empty(len(v))
    fade, aim = np.exp(-abs(v) * dt / g), g * np.sign(v)
    for i in range(len(v)):
        z = aim[i] + (z - aim[i]) * fade[i]
        out[i] = z
    damping = draw.uniform(0, 0.3) * np.sqrt(m["F_c"] / bend * m["mass"])
    return np.asarray(m["F_c"] / bend * out + damping * np.gradient(out, dt) + m["sigma_2"] * v)


def memory(draw: Draw, m: Constants, at: Motion) -> np.ndarray:
    """The Stribeck curve of a speed that was: frictional memory."""
    v = at[1]
    late = round(float(log_uniform(draw, 2e-3, 5e-2)) * WITHIN / STEP)
    return np.asarray(
        stribeck_level(m, np.concatenate([np.full(late, v[0]), v[:-late]])) * np.sign(v) + m["sigma_2"] * v
    )


def servo(draw: Draw, m: Constants, at: Motion) -> tuple[Motion, np.ndarray]:
    """A body behind a spring and a damper of a servo that follows the motion, and sticks below break-away (Karnopp)."""
    wanted, fast, _ = at
    dt, stick = STEP / WITHIN, 1e-5
    stiff = m["mass"] * (2 * np.pi * draw.uniform(2, 8)) ** 2
    damper = 2 * draw.uniform(0.3, 0.9) * np.sqrt(stiff * m["mass"])
    y, v, out = float(wanted[0]), 0.0, np.empty((len(fast), 4))
    for i in range(len(fast)):
        push = stiff * (wanted[i] - y) + damper * (fast[i] - v)
        load = push - m["offset"]
        if abs(v) < stick and abs(load) <= m["F_s"]:
            v = a = 0.0
        else:
            way = np.sign(v) if abs(v) >= stick else np.sign(load)
            a = (load - stribeck_level(m, v) * way - m["sigma_2"] * v) / m["mass"]
            after = v + a * dt
            v = 0.0 if after * v < 0 and abs(v) >= stick else after
        y += v * dt
        out[i] = y, v, a, push
    return (out[:, 0], out[:, 1], out[:, 2]), out[:, 3]


OTHER_KINDS: dict[str, tuple[bool | None, Callable[..., np.ndarray] | None, tuple[str, ...]]] = {
    # with a Stribeck bend (None: every second one), the friction, what has a truth beside KNOWN_OF_ALL
    "coulomb": (False, complete, ("offset",)),
    "stribeck": (True, complete, ("offset", "F_s", "v_s")),
    "root": (False, root, ("offset",)),
    "gms": (True, gms, ("offset", "F_s", "v_s")),
    "directions": (None, directions, ("F_s", "v_s")),
    "worm": (None, worm, ("F_s", "v_s")),
    "belt": (None, belt, ("offset", "F_s", "v_s")),
    "contacts": (True, contacts, ("offset", "F_s")),
    "bristles": (None, bristles, ("offset", "F_s", "v_s")),
    "servo": (True, None, ("offset", "F_s", "v_s")),
    "memory": (True, memory, ("offset", "F_s", "v_s")),
}


def sensed(draw: Draw, m: Constants, at: Motion, force: np.ndarray, shift: float = 0.0) -> Columns:
    """What an encoder, shifted, and a force sensor measure."""
    y, force = at[0][WITHIN // 2 :: WITHIN], force[WITHIN // 2 :: WITHIN]
    y = m["encoder"] * np.round((y + shift + 0.3 * m["encoder"] * draw.standard_normal(len(y))) / m["encoder"])
    return {"t": np.arange(len(y)) * STEP, "y": y, "F": force + m["noise"] * draw.standard_normal(len(y))}


def other_record(kind: str, seed: int) -> tuple[Columns, Constants, str]:
    """A record, the truth of each number that has one, and its motion."""
    draw = np.random.default_rng([seed, list(OTHER_KINDS).index(kind)])
    bend, friction, further = OTHER_KINDS[kind]
    m = other_machine(draw, bool(seed // len(OTHER_MOTIONS) % 2) if bend is None else bend)
    moves = OTHER_MOTIONS[seed % len(OTHER_MOTIONS)]
    at = other_motion(draw, moves, m["fastest"])
    if friction is None:
        at, force = servo(draw, m, at)
    else:
        force = friction(draw, m, at) + m["mass"] * at[2] + m["offset"]
    truth = {n: m[n] for n in (*KNOWN_OF_ALL, *further) if m["F_s"] > m["F_c"] or n not in ("F_s", "v_s")}
    return sensed(draw, m, at, force), truth, moves


# -- rigs with encoders -----------------------------------------------------------------------------------------------

RIGS = ("servo", "backlash", "cogging", "coarse", "one way", "held")
RIG_RATE = {"servo": 200.0}  # Hz; the others 500
RIG_SECONDS, WINDOW = 15.0, 0.06  # of a record; of Savitzky and Golay's filter


def rig(draw: Draw, kind: str) -> Constants:
    """Constants of a rig whose friction is some 1; a servo's encoder has 4096 steps a turn."""
    level = float(np.exp(draw.uniform(-1, 3)))
    return {
        "F_c": level, "dF": level * draw.uniform(0, 0.6), "v_s": draw.uniform(0.02, 0.3), "width": draw.uniform(2e-3, 0.05),
        "sigma_2": level * draw.uniform(0, 1), "mass": level * draw.uniform(0.01, 0.2), "offset": level * draw.uniform(-0.1, 0.1),
        "weight": level * draw.uniform(2, 8) * (kind == "servo"), "grows": draw.uniform(0, 0.15) * (kind == "servo"),
        "lash": draw.uniform(0.005, 0.03) * (kind == "backlash"), "cogs": level * draw.uniform(0.1, 0.8) * (kind == "cogging"),
        "teeth": float(draw.integers(6, 30)), "held": level * draw.uniform(0.3, 0.9) * (kind == "held"),
        "step": {"servo": 2 * np.pi / 4096, "coarse": draw.uniform(1e-4, 1e-3)}.get(kind, draw.uniform(1e-6, 2e-5)),
        "noise": level * draw.choice([0.01, 0.05, 0.2]),
    }  # fmt: skip


def rig_record(m: Constants, kind: str, draw: Draw) -> Columns:
    """Three sines, from 0.1 to 1.5 Hz, and what is measured of them."""
    h = 1 / RIG_RATE.get(kind, 500.0)
    t = np.arange(0, RIG_SECONDS, h)
    at = sines(draw, (0.1, 1.5), (0.1, 1.0))
    v = at.v(t)
    if kind == "one way":
        v += at.speed.sum() * 1.05
    if kind == "held":
        moves = np.convolve((t % 5 > 2).astype(float), np.hanning(101) / np.hanning(101).sum(), "same")
        v = np.where(moves > 1e-9, v * moves, 0.0)
    y, a = np.cumsum(v) * h, np.gradient(v, h)
    sign = np.tanh(v / m["width"])
    if m["lash"]:
        for i in range(1, len(y)):
            sign[i] = np.clip(sign[i - 1] + (y[i] - y[i - 1]) / m["lash"], -1, 1)
    carried = m["mass"] * a + m["weight"] * np.sin(y)
    level = stribeck_level(m, v) + m["grows"] * abs(carried)
    force = carried + level * sign + m["sigma_2"] * v + m["offset"] + m["cogs"] * np.sin(m["teeth"] * y)
    force = np.where(v == 0, m["held"] * np.sin(2.1 * t), force) if m["held"] else force
    return {"t": t, "y": m["step"] * np.round(y / m["step"]), "F": force + m["noise"] * draw.standard_normal(len(t))}


def measured(columns: Columns, log: Log) -> tuple[np.ndarray, ...]:
    """Speed, acceleration, force, and the columns of a weight, as SciPy alone has them, where the log moves."""
    y, h = columns["y"], float(columns["t"][1] - columns["t"][0])
    inside, rows = np.searchsorted(columns["t"], log.time[~at_rest(log)] - 1e-9), 2 * round(WINDOW / h / 2) + 1
    v, a = (savgol_filter(y, rows, 3, deriv, h) for deriv in (1, 2))
    return v[inside], a[inside], columns["F"][inside], np.column_stack([np.sin(y), np.cos(y)])[inside]


# -- rigs of other kinds ----------------------------------------------------------------------------------------------

USUAL = (2e-3, 15.0)  # step and duration of a record, s
UNSEEN = dict.fromkeys(("gap", "shaft", "warms", "weight and spring", "spring", "current", "two ripples", "slow"), USUAL) | {
    "short": (2e-3, 3.0), "long": (0.01, 1800.0), "50 Hz": (0.02, 15.0), "dahl": USUAL,
}  # fmt: skip
SLOW = 0.05  # times the rates and the speeds of the others


def unseen_rig(draw: Draw, kind: str) -> Constants:
    """Constants of a rig whose friction is some ``level``; each kind uses those that it has."""
    level = float(np.exp(draw.uniform(-1, 3)))
    return {
        "F_c": level, "dF": level * draw.uniform(0, 0.6), "v_s": draw.uniform(0.02, 0.3), "width": draw.uniform(2e-3, 0.02),
        "sigma_2": level * draw.uniform(0, 1), "mass": level * draw.uniform(0.01, 0.2), "offset": level * draw.uniform(-0.1, 0.1),
        "noise": level * draw.choice([0.01, 0.05]), "step": draw.uniform(1e-6, 2e-5), "share": draw.uniform(0.3, 0.8),
        "gap": draw.uniform(0.005, 0.03), "shaft": level * draw.uniform(20, 200), "spring": level * draw.uniform(0.5, 2),
        "weight": level * draw.uniform(2, 6), "current": level * draw.uniform(0.05, 0.3), "warms": draw.uniform(0.1, 0.4),
        "one": level * draw.uniform(0.1, 0.4), "two": level * draw.uniform(0.05, 0.3), "waves": float(draw.integers(6, 15)),
        "more": float(draw.integers(20, 60)), "yields": draw.uniform(1e-3, 0.02),
    }  # fmt: skip


def behind(m: Constants, kind: str, t: np.ndarray, at: Sines) -> np.ndarray:
    """The force of a load behind a gap, stiff where it is closed, or behind a shaft."""
    mass, gap = m["mass"] * m["share"], m["gap"] if kind == "gap" else 0.0
    stiff = 400 * m["F_c"] if gap else m["shaft"]
    damping = 2 * m["share"] * np.sqrt(stiff * mass) * (1.0 if gap else 0.3)

    def shaft(way: float, rate: float) -> float:
        closed = np.sign(way) * max(abs(way) - gap / 2, 0.0)
        return float(stiff * closed + (damping * rate if closed or not gap else 0.0))

    def rates(s: float, x: np.ndarray) -> list[float]:
        pull = shaft(float(at.way(s)) - x[0], float(at.v(s)) - x[1])
        return [x[1], (pull - m["share"] * float(smooth_curve(m, x[1]))) / mass]

    begin = [0.0, float(at.v(t[0]))]
    solution = solve_ivp(rates, (0, t[-1]), begin, "LSODA", t_eval=t, max_step=5e-3, rtol=1e-6, atol=1e-9).y
    return np.array([shaft(a, b) for a, b in zip(at.way(t) - solution[0], at.v(t) - solution[1], strict=True)])


def yielding(m: Constants, y: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Dahl's part of the level that has turned: it goes on exponentially with the way."""
    part = np.sign(v)
    for i in range(1, len(y)):
        way = np.sign(y[i] - y[i - 1])
        part[i] = way - (way - part[i - 1]) * np.exp(-abs(y[i] - y[i - 1]) / m["yields"])
    return part


def unseen_record(m: Constants, kind: str, draw: Draw) -> Columns:
    """What is measured of a motion."""
    step, lasts = UNSEEN[kind]
    t = np.arange(0, lasts, step)
    at = sines(draw, (0.1, 1.5), (0.1, 1.0), slow=SLOW if kind == "slow" else 1.0)
    y, v, inertia = at.way(t), at.v(t), m["mass"] * at.a(t)
    force = inertia + smooth_curve(m, v)
    if kind in ("gap", "shaft"):
        force = (1 - m["share"]) * force + behind(m, kind, t, at)
    if kind == "dahl":
        force = inertia + stribeck_level(m, v) * yielding(m, y, v) + m["sigma_2"] * v
    if kind == "warms":
        force -= m["warms"] * (1 - np.exp(-(t + draw.uniform(0, 20)) / 8.0)) * smooth_curve(m, v)
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


MEASURED = {"rigs": (RIGS, rig, rig_record), "kinds": (UNSEEN, unseen_rig, unseen_record)}
