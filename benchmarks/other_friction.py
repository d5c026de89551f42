"""Records whose friction is another law altogether: Maxwell slips, bristles, a gear, a belt, memory, a servo."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

MOTIONS = ("sine", "to and fro", "constant speeds", "several sines")
STEP, WITHIN, LASTS = 2e-3, 10, 16.0  # s between rows; steps of the friction in one; s of a record
OF_ALL = ("mass", "F_c", "sigma_2")
Machine = dict[str, float]
Motion = tuple[np.ndarray, np.ndarray, np.ndarray]  # position, speed, acceleration


def machine(draw: np.random.Generator, stribeck_too: bool) -> Machine:
    """Constants of a machine that makes 0.1 to 0.5 m/s."""
    level = float(np.exp(draw.uniform(0, 3)))
    fastest = float(draw.uniform(0.1, 0.5))
    return {
        "F_c": level, "F_s": level * (1 + draw.uniform(0.15, 0.7) * stribeck_too),
        "v_s": fastest * float(np.exp(draw.uniform(np.log(0.02), np.log(0.2)))),
        "sigma_2": level / fastest * draw.uniform(0.1, 0.6), "mass": level * draw.uniform(0.01, 0.15) / fastest,
        "offset": level * draw.uniform(-0.1, 0.1), "fastest": fastest,
        "noise": level * draw.choice([1e-3, 5e-3, 2e-2]), "encoder": draw.choice([1e-7, 1e-6, 5e-6]),
    }  # fmt: skip


def motion(draw: np.random.Generator, kind: str, fastest: float) -> Motion:
    """What is driven, at the steps of the friction."""
    t = np.arange(round(LASTS / STEP) * WITHIN) * STEP / WITHIN
    if "sine" in kind:
        w = 2 * np.pi * np.exp(draw.uniform(np.log(0.15), np.log(1.2), 1 if kind == "sine" else 4))
        share, phase = draw.uniform(0.3, 1, len(w)), draw.uniform(0, 6, len(w))
        share *= fastest / share.sum()
        angle = np.outer(t, w) + phase
        return -np.cos(angle) @ (share / w), np.sin(angle) @ share, np.cos(angle) @ (share * w)
    if kind == "to and fro":
        every = draw.uniform(0.4, 1.5)
        levels = fastest * np.array([(-1) ** i for i in range(int(LASTS / every) + 2)])
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


def curve(m: Machine, v: np.ndarray) -> np.ndarray:
    """The level of a Stribeck curve, at a speed."""
    return np.asarray(m["F_c"] + (m["F_s"] - m["F_c"]) * np.exp(-((v / m["v_s"]) ** 2)))


# -- kinds of friction: its force along a motion, and what the truth is beside the machine's own ----------------------


def complete(draw: np.random.Generator, m: Machine, at: Motion) -> np.ndarray:
    """The law itself."""
    return np.asarray(curve(m, at[1]) * np.sign(at[1]) + m["sigma_2"] * at[1])


def root(draw: np.random.Generator, m: Machine, at: Motion) -> np.ndarray:
    """Grease that thins, beside Coulomb and viscous friction."""
    v = at[1]
    grows = m["F_c"] * draw.uniform(0.05, 0.5) * np.sqrt(abs(v) / m["fastest"])
    return complete(draw, m, at) + grows * np.sign(v)


def gms(draw: np.random.Generator, m: Machine, at: Motion) -> np.ndarray:
    """Four Maxwell slips in parallel (Al-Bender, Lampaert, Swevers 2005)."""
    v, dt = at[1], STEP / WITHIN
    share = draw.dirichlet(np.full(4, 3.0))
    bends = (
        m["F_s"] * share / (float(np.exp(draw.uniform(np.log(5e-6), np.log(2e-4)))) * np.array([0.25, 0.5, 1.0, 2.0]))
    )
    attraction = m["F_c"] * float(np.exp(draw.uniform(np.log(20), np.log(500))))  # N/s
    s, force, slips, out = curve(m, v), np.zeros(4), np.zeros(4, bool), np.empty(len(v))
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


def directions(draw: np.random.Generator, m: Machine, at: Motion) -> np.ndarray:
    """Levels, slopes and bends that differ forwards and backwards; the means are the machine's."""
    v, unlike = at[1], draw.uniform(-0.3, 0.3, 2)
    way = np.sign(v)
    return np.asarray(curve(m, v) * (1 + unlike[0] * way) * way + m["sigma_2"] * (1 + unlike[1] * way) * v)


def worm(draw: np.random.Generator, m: Machine, at: Motion) -> np.ndarray:
    """A gear whose friction grows with what it transmits: inertia and an arm's weight, which the force holds too."""
    y, v, a = at
    weight = m["F_c"] * draw.uniform(0, 1.5) * np.sin(y + draw.uniform(0, 6))
    loss = draw.uniform(0.05, 0.4)
    return complete(draw, m, at) + weight + loss * abs(m["mass"] * a + weight) * np.sign(v)


def belt(draw: np.random.Generator, m: Machine, at: Motion) -> np.ndarray:
    """A level that goes round with a pulley."""
    y, v, _ = at
    round_ = 1 + draw.uniform(0.02, 0.2) * np.sin(2 * np.pi * y / draw.uniform(0.03, 0.12) + draw.uniform(0, 6))
    return np.asarray(curve(m, v) * round_ * np.sign(v) + m["sigma_2"] * v)


def contacts(draw: np.random.Generator, m: Machine, at: Motion) -> np.ndarray:
    """A bearing and a seal: two Stribeck bends with unlike speeds, of unlike heights."""
    v, share = at[1], draw.uniform(0.2, 0.8)
    other = m["v_s"] / draw.uniform(4, 30)
    rise = m["F_s"] - m["F_c"]
    level = m["F_c"] + rise * (share * np.exp(-((v / m["v_s"]) ** 2)) + (1 - share) * np.exp(-((v / other) ** 2)))
    return np.asarray(level * np.sign(v) + m["sigma_2"] * v)


def bristles(draw: np.random.Generator, m: Machine, at: Motion) -> np.ndarray:
    """Bristles that bend by up to a millimetre before they slide (LuGre; without a Stribeck bend, Dahl)."""
    v, dt = at[1], STEP / WITHIN
    bend = float(np.exp(draw.uniform(np.log(1e-5), np.log(1e-3))))
    g, z, out = bend * curve(m, v) / m["F_c"], 0.0, np.empty(len(v))
    fade, aim = np.exp(-abs(v) * dt / g), g * np.sign(v)
    for i in range(len(v)):
        z = aim[i] + (z - aim[i]) * fade[i]
        out[i] = z
    damping = draw.uniform(0, 0.3) * np.sqrt(m["F_c"] / bend * m["mass"])
    return np.asarray(m["F_c"] / bend * out + damping * np.gradient(out, dt) + m["sigma_2"] * v)


def memory(draw: np.random.Generator, m: Machine, at: Motion) -> np.ndarray:
    """The Stribeck curve of a speed that was: frictional memory."""
    v = at[1]
    late = round(float(np.exp(draw.uniform(np.log(2e-3), np.log(5e-2)))) * WITHIN / STEP)
    return np.asarray(curve(m, np.concatenate([np.full(late, v[0]), v[:-late]])) * np.sign(v) + m["sigma_2"] * v)


def servo(draw: np.random.Generator, m: Machine, at: Motion) -> tuple[Motion, np.ndarray]:
    """A body behind a spring and a damper of a servo that follows the motion, and sticks below break-away (Karnopp)."""
    wanted, fast, _ = at
    dt, stick = STEP / WITHIN, 1e-5
    stiff = m["mass"] * (2 * np.pi * draw.uniform(2, 8)) ** 2
    damper = 2 * draw.uniform(0.3, 0.9) * np.sqrt(stiff * m["mass"])
    y, v, out = float(wanted[0]), 0.0, np.empty((len(fast), 4))
    drop = m["F_s"] - m["F_c"]
    for i in range(len(fast)):
        push = stiff * (wanted[i] - y) + damper * (fast[i] - v)
        load = push - m["offset"]
        if abs(v) < stick and abs(load) <= m["F_s"]:
            v = a = 0.0
        else:
            way = np.sign(v) if abs(v) >= stick else np.sign(load)
            a = (load - (m["F_c"] + drop * np.exp(-((v / m["v_s"]) ** 2))) * way - m["sigma_2"] * v) / m["mass"]
            after = v + a * dt
            v = 0.0 if after * v < 0 and abs(v) >= stick else after
        y += v * dt
        out[i] = y, v, a, push
    return (out[:, 0], out[:, 1], out[:, 2]), out[:, 3]


KINDS: dict[str, tuple[bool | None, Callable[..., np.ndarray] | None, tuple[str, ...]]] = {
    # with a Stribeck bend (None: every second one), the friction, what has a truth beside OF_ALL
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


def record(kind: str, seed: int) -> tuple[dict[str, np.ndarray], dict[str, float], str]:
    """A record, the truth of each number that has one, and its motion."""
    draw = np.random.default_rng([seed, list(KINDS).index(kind)])
    bend, friction, further = KINDS[kind]
    m = machine(draw, bool(seed // len(MOTIONS) % 2) if bend is None else bend)
    moves = MOTIONS[seed % len(MOTIONS)]
    at = motion(draw, moves, m["fastest"])
    if friction is None:
        at, force = servo(draw, m, at)
    else:
        force = friction(draw, m, at) + m["mass"] * at[2] + m["offset"]
    rows = slice(WITHIN // 2, None, WITHIN)
    y, force = at[0][rows], force[rows]
    scale = m["encoder"]
    y = np.round((y + 0.3 * scale * draw.standard_normal(len(y))) / scale) * scale
    force = force + m["noise"] * draw.standard_normal(len(force))
    truth = {n: m[n] for n in (*OF_ALL, *further) if m["F_s"] > m["F_c"] or n not in ("F_s", "v_s")}
    return {"t": np.arange(len(y)) * STEP, "y": y, "F": force}, truth, moves
