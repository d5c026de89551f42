"""A pneumatic servo written anew from theory.md, section 5, in plain NumPy, and solved with SciPy.

dp_d/dt is a difference quotient along the motion, not a symbolic derivative; nothing of stribeck is used.
"""

from math import atan, exp, pi, tan

import numpy as np
from scipy.integrate import solve_ivp

PLANT = {
    "M": 2.9, "A": 4.19e-4, "L": 1.0, "V1": 1.96e-6, "V2": 4.91e-6, "r": 1.4, "R": 286.9, "T": 293.15, "ps": 7e5,
    "p0": 1e5, "bf": 4.897e-9, "be": 5.173e-9, "sigma_0": 4500.0, "sigma_1": 93.13, "sigma_2": 89.86, "F_c": 32.9,
    "F_s": 38.5, "v_s": 0.02,
}  # fmt: skip
GAINS = {"K_D": 60.0, "K_p": 60.0, "lam": 20.0, "K": 1e-5, "rho": 4e-10, "u_max": 10.0}


def functions(law, p, k_v):
    """S_1 v and w of a law."""

    def g(v):
        return (p["F_c"] + (p["F_s"] - p["F_c"]) * exp(-min((v / p["v_s"]) ** 2, 700.0))) / p["sigma_0"]

    def S_0(v):
        return 2 / pi * atan(k_v * v)

    return {
        "lugre": (lambda v: v, lambda v: abs(v) / g(v)),
        "lugre_arctan": (lambda v: v, lambda v: v * S_0(v) / g(v)),
        "lugre_sobczyk": (lambda v: S_0(v) ** 2 * v, lambda v: v * S_0(v) / g(v)),
        "lugre_majorant": (lambda v: v, lambda v: (v * S_0(v) + 2 / (pi * k_v)) / g(v)),
    }[law]


def sine(offset, amplitude, frequency):
    """The path and three derivatives."""
    w = 2 * pi * frequency
    return lambda t: (
        offset + amplitude * np.sin(w * t), amplitude * w * np.cos(w * t), -amplitude * w**2 * np.sin(w * t),
        -amplitude * w**3 * np.cos(w * t),
    )  # fmt: skip


def move(start, end, begin, length):
    """The seventh-order path of theory.md, from its factors."""
    base = np.polynomial.Polynomial([0, 0, 0, 0, 35, -84, 70, -20]) * (end - start)

    def path(t):
        x = min(max((t - begin) / length, 0.0), 1.0)
        first = (start + base(x),)
        return first + tuple(base.deriv(n)(x) / length**n for n in (1, 2, 3))

    return path


def servo(law, observer, path, gains=None, k_v=1e6, observer_k_v=1e6):
    """The controller of (t, y, v, a, p1, p2, z_hat), and the plant of (x, the valve's angle)."""
    P, G = PLANT, {**GAINS, **(gains or {})}
    s1, w = functions(law, P, k_v)
    s1o, wo = functions(observer or "lugre_sobczyk", P, observer_k_v)

    def estimate(t, y, v, zh):
        yd, dyd, _, _ = path(t)
        s = v - dyd + G["lam"] * (y - yd)
        dzh = s1o(v) - wo(v) * zh - G["K"] * P["sigma_0"] * s
        F_hat = P["sigma_0"] * zh + P["sigma_1"] * dzh + P["sigma_2"] * v if observer else 0.0
        return s, dzh, F_hat

    def desired(t, y, v, zh):
        s, _, F_hat = estimate(t, y, v, zh)
        _, dyd, d2yd, _ = path(t)
        return (-G["K_D"] * s + P["M"] * (d2yd - G["lam"] * (v - dyd)) + F_hat) / P["A"]

    def volumes(y):
        return P["A"] * y + P["V1"], P["A"] * (P["L"] - y) + P["V2"]

    def control(t, y, v, a, p1, p2, zh):
        s, dzh, F_hat = estimate(t, y, v, zh)
        pd, h = desired(t, y, v, zh), 1e-6
        # along the tangent of the motion: central, fourth order
        at = [desired(t + n * h, y + n * h * v, v + n * h * a, zh + n * h * dzh) for n in (-2, -1, 1, 2)]
        dpd = (at[0] - 8 * at[1] + 8 * at[2] - at[3]) / (12 * h)
        v1, v2 = volumes(y)
        gas = P["r"] * P["R"] * P["T"]
        h_hat = -P["r"] * P["A"] * v * (p1 / v1 + p2 / v2)
        u_hat = -h_hat - P["A"] / G["rho"] * s - G["K_p"] * (p1 - p2 - pd) + dpd
        g1, g2 = opened(u_hat, p1, p2)
        angle = u_hat / (gas * (g1 / v1 + g2 / v2))
        top = atan(2 * G["u_max"])
        err = p1 - p2 - pd
        out = {"e": y - path(t)[0], "s": s, "p_err": err, "F_hat": F_hat, "p_d": pd}
        return min(max(angle, -top), top), dzh, -wo(v), out

    def opened(sign, p1, p2):
        if sign >= 0:
            return P["bf"] * (P["ps"] - p1), P["be"] * (p2 - P["p0"])
        return P["be"] * (p1 - P["p0"]), P["bf"] * (P["ps"] - p2)

    def friction(v, z):
        dz = s1(v) - w(v) * z
        return P["sigma_0"] * z + P["sigma_1"] * dz + P["sigma_2"] * v, dz

    def plant(x, angle):
        y, v, p1, p2, z = x
        F, dz = friction(v, z)
        (v1, v2), (g1, g2), gas = volumes(y), opened(angle, p1, p2), P["r"] * P["R"] * P["T"]
        dp1 = (gas * g1 * angle - P["r"] * P["A"] * v * p1) / v1
        dp2 = (-gas * g2 * angle + P["r"] * P["A"] * v * p2) / v2
        return v, (P["A"] * (p1 - p2) - F) / P["M"], dp1, dp2, dz

    return control, plant, friction


def solve(law, observer, path, t_end, gains=None, k_v=1e6, observer_k_v=1e6, start=(0.51, 0.0, 4e5, 4e5), rows=401):
    """Columns of the trajectory on an even grid, without the friction term for ``observer`` None."""
    P, G = PLANT, {**GAINS, **(gains or {})}
    control, plant, friction = servo(law, observer, path, gains, k_v, observer_k_v)

    def evaluate(t, x):
        y, v, p1, p2, z, zh = x
        F = friction(v, z)[0]
        angle, dzh, _, out = control(t, y, v, (P["A"] * (p1 - p2) - F) / P["M"], p1, p2, zh)
        V = (P["M"] * out["s"] ** 2 + G["rho"] * out["p_err"] ** 2 + (zh - z) ** 2 / G["K"]) / 2
        return (*plant(x[:5], angle), dzh), {**out, "u": tan(angle) / 2, "F": F, "V": V}

    t = np.linspace(0, t_end, rows)
    solution = solve_ivp(
        lambda t, x: evaluate(t, x)[0], (0, t_end), (*start, 0.0, 0.0), method="LSODA", t_eval=t, rtol=1e-9,
        atol=[1e-11, 1e-10, 1e-4, 1e-4, 1e-12, 1e-12], max_step=0.02,
    )  # fmt: skip
    assert solution.success, solution.message
    table = dict(zip(("y", "v", "p_1", "p_2", "z", "z_hat"), solution.y, strict=True))
    extra = [evaluate(*each)[1] for each in zip(t, solution.y.T, strict=True)]
    return {"t": t, **table, **{n: np.array([row[n] for row in extra]) for n in extra[0]}}


def sampled(law, observer, path, t_end, period, delay, noise, count, bandwidth, seed, start=(0.51, 0.0, 4e5, 4e5)):
    """Rows at the instants of a controller that reads with noise and a count, estimates, and acts ``delay`` later."""
    control, plant, friction = servo(law, observer, path)
    random, x, zh, angle, waiting, rows = np.random.default_rng(seed), np.array([*start, 0.0]), 0.0, 0.0, [], []
    q = exp(-bandwidth * period)
    estimate = np.array([x[0] - period * x[1], x[1], 0.0])
    step = np.array([[1, period, period**2 / 2], [0, 1, period], [0, 0, 1]])
    gains = np.array([1 - q**3, 1.5 * (1 - q**2) * (1 - q) / period, (1 - q) ** 3 / period**2])
    for k in range(round(t_end / period) + 1):
        reading = count * round((x[0] + noise * random.standard_normal()) / count)
        estimate = step @ estimate
        estimate = estimate + gains * (reading - estimate[0])
        wanted, rate, slope, out = control(k * period, *estimate, x[2], x[3], zh)
        waiting.append((k * period + delay, wanted))
        rows.append({"y": x[0], "v": x[1], "p_1": x[2], "F": friction(x[1], x[4])[0], "z_hat": zh,
                     "u": tan(angle) / 2, "F_hat": out["F_hat"]})  # fmt: skip
        zh += rate * np.expm1(slope * period) / slope
        t, until = k * period, (k + 1) * period
        for at in (waiting[0][0], until):
            if at > t:
                solution = solve_ivp(lambda _, x: plant(x, angle), (t, at), x, method="LSODA", rtol=1e-9,  # noqa: B023
                                  atol=[1e-12, 1e-11, 1e-4, 1e-4, 1e-13])  # fmt: skip
                x, t = solution.y[:, -1], at
            if at < until:
                angle = waiting.pop(0)[1]
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}
