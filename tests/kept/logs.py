"""Recordings that cases name, made afresh: synthetic, of known friction."""

import numpy as np


def log(first, second, seed, rows=1500):
    """A body of 2 kg that is moved along two sines, its friction smooth Coulomb and viscous; noise on the force."""
    t = 2e-3 * np.arange(rows)
    v = 0.1 * np.sin(2 * np.pi * first * t) + 0.05 * np.sin(2 * np.pi * second * t + 1)
    force = 2 * np.gradient(v, 2e-3) + 5 * np.tanh(1e4 * v) + 20 * v + 1
    return {"t": t, "v": v, "F": force + 0.1 * np.random.default_rng(seed).standard_normal(rows)}


def turned():
    """A joint with an encoder, a weight and a curve of Stribeck's."""
    t = 2e-3 * np.arange(2000) + 7e-4  # no sample at a zero of the speed, whose sign is by rounding there
    q = 0.6 * np.sin(2 * np.pi * 0.5 * t) + 0.2 * np.sin(2 * np.pi * 1.3 * t)
    v, a = np.gradient(q, t), np.gradient(np.gradient(q, t), t)
    curve = np.tanh(200 * v) * (1 + 0.5 * np.exp(-((v / 0.2) ** 2))) + 0.4 * v
    force = 0.3 * a + curve + 2 * np.sin(q) + 0.02 * np.random.default_rng(1).standard_normal(len(t))
    return {"t": t, "q": np.degrees(np.round(q / 1e-4) * 1e-4), "F": force}


def pushed(seed, amplitude, mass=1.0):
    """A body of 1 kg with LuGre friction under a force that is straight between its samples; an encoder and its noise."""
    n, step, fine = 100, 0.01, 400
    t = step * np.arange(n + 1)
    u = amplitude * np.sin(9 * t) * (1 + 0.6 * np.sin(23 * t + seed))
    y, v, z, rows = 0.0, 0.0, 0.0, []
    for i in range(n + 1):
        rows.append(y)
        for k in range(fine):
            force = u[i] + (u[min(i + 1, n)] - u[i]) * k / fine
            g = (1 + 0.3 * np.exp(-((v / 0.02) ** 2))) / 2e4
            rate = v - abs(v) / g * z
            v += step / fine * (force - 2e4 * z - 60 * rate - 4 * v) / mass
            y, z = y + step / fine * v, z + step / fine * rate
    return {"t": t, "y": np.array(rows) + 2e-5 * np.random.default_rng(seed).standard_normal(n + 1), "u": u}


def bristles():
    """A body that a force moves to and fro within its presliding and beyond it."""
    result = pushed(3, 4.0)
    return {"t": result["t"], "y": result["y"], "F": result["u"]}


MADE = {
    "log.csv": lambda: log(0.37, 0.91, 0), "other.csv": lambda: log(0.5, 1.3, 1), "turned.csv": turned,
    "axis_1.csv": lambda: pushed(1, 5.0), "axis_2.csv": lambda: pushed(2, 4.0), "bristles.csv": bristles,
}  # fmt: skip


def write(name, path):
    columns = MADE[name]()
    rows = (",".join(f"{x:.10g}" for x in row) for row in zip(*columns.values(), strict=True))
    path.write_text(",".join(columns) + "\n" + "\n".join(rows) + "\n", encoding="utf-8")
