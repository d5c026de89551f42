"""Friction laws and signals, written from shared/design/theory.md and machine.md alone; see apart.py."""

from math import atan, copysign, cos, exp, pi, sin, sqrt, tanh

import numpy as np
from scipy.interpolate import PPoly, make_interp_spline
from scipy.optimize import brentq

# -- friction laws: (constants, w, z) -> (dz/dt, F) ------------------------------------------------------------------


def stribeck_level(c, w):
    return c["F_c"] + (c["F_s"] - c["F_c"]) * exp(-(abs(w / c["v_s"]) ** (c.get("delta") or 2.0)))


def smooth_sign(c, w):
    return 2 / pi * atan(c["k_v"] * w)


def majorant(c, w):
    k, kind = c["k_v"], c.get("smooth_abs", "atan")
    if kind == "sqrt":
        return sqrt(w * w + 1 / k**2)
    if kind == "compact":
        x = k * w
        return abs(w) if abs(x) >= 1 else (3 + 6 * x * x - x**4) / (8 * k)
    return w * smooth_sign(c, w) + 2 / (pi * k)


def share(c, z, G):
    """The plastic share of the majorant law: a quintic smoothstep between z_ba and g."""
    s = min(max((abs(z) - c["z_ba"]) / (G - c["z_ba"]), 0.0), 1.0)
    return s**3 * (10 - 15 * s + 6 * s * s)


def dupont(c, z, G):
    if abs(z) <= c["z_ba"]:
        return 0.0
    return 1.0 if abs(z) >= G else 0.5 + 0.5 * sin(pi * (abs(z) - (G + c["z_ba"]) / 2) / (G - c["z_ba"]))


def bristles(law, c, w, z):
    if law == "dahl":
        return w - c["sigma_0"] / c["F_c"] * abs(w) * z, c["sigma_0"] * z
    G = stribeck_level(c, w) / c["sigma_0"]
    if law == "lugre":
        rate = w - abs(w) / G * z
    elif law == "lugre_arctan":
        rate = w - w * smooth_sign(c, w) / G * z
    elif law == "lugre_sobczyk":
        rate = smooth_sign(c, w) ** 2 * w - w * smooth_sign(c, w) / G * z
    elif law == "lugre_majorant":
        rate = w - majorant(c, w) / G * z
    elif law == "elastoplastic":
        rate = w - (dupont(c, z, G) if w * z > 0 else 0.0) * abs(w) / G * z
    elif law == "elastoplastic_sobczyk":
        rate = smooth_sign(c, w) ** 2 * w - dupont(c, z, G) * w * smooth_sign(c, w) / G * z
    elif law == "elastoplastic_majorant":
        rate = w - share(c, z, G) * majorant(c, w) / G * z
    else:
        raise KeyError(law)
    damping = c["sigma_1"] * (exp(-((w / c["v_d"]) ** 2)) if c.get("v_d") else 1.0)
    return rate, c["sigma_0"] * z + damping * rate + c["sigma_2"] * w


def static(law, c, w):
    if law == "coulomb_viscous":
        return c["F_c"] * smooth_sign({"k_v": c.get("k_v", 1e6)}, w) + c["sigma_2"] * w
    if law == "stribeck":
        sign = smooth_sign(c, w) if "k_v" in c else np.sign(w)
        return float(sign * stribeck_level(c, w) + c["sigma_2"] * w)
    if law == "makkar":
        return c["g1"] * (tanh(c["g2"] * w) - tanh(c["g3"] * w)) + c["g4"] * tanh(c["g5"] * w) + c["g6"] * w
    if law == "stribeck_tanh":
        return tanh(c["k_v"] * w) * stribeck_level(c, w) + c["sigma_2"] * w
    raise KeyError(law)


STATIC = ("coulomb_viscous", "stribeck", "stribeck_tanh", "makkar")


def friction(law, c, w, z):
    if callable(law):  # a function of the speed
        return 0.0, law(w)
    return (0.0, static(law, c, w)) if law in STATIC else bristles(law, c, w, z)


def steady(law, c, w):
    """The force at a held speed."""
    if law in STATIC:
        return static(law, c, w)
    top = 20 * max(c["F_s"], c["F_c"]) / c["sigma_0"]
    z = brentq(lambda z: bristles(law, c, w, z)[0], 0.0, copysign(top, w), xtol=1e-22, rtol=1e-15)
    return bristles(law, c, w, z)[1]


def constants(table):
    return {**table.get("parameters", {}), **{n: x for n, x in table.items() if n not in ("name", "parameters")}}


# -- signals: from a time in the piece that began at ``now`` to (r, dr/dt, d2r/dt2) ------------------------------------


class Signal:
    def __init__(self, table):
        self.kind, self.table = table["kind"], table
        if self.kind == "step":
            self.knots, self.values = [table["time"], table["time"]], [0.0, table["value"]]
        elif self.kind in ("ramp", "sine"):
            self.knots, self.values = [], []
        else:
            self.knots, self.values = list(table["t"]), list(table["value"])
        if self.kind == "spline":
            rest = [(n, 0.0) for n in (1, 2, 3)]
            self.poly = PPoly.from_spline(make_interp_spline(self.knots, self.values, k=7, bc_type=(rest, rest)))

    def turns(self, t_end):
        """Where the rate changes its sign inside of a piece."""
        if self.kind == "sine":
            w, phase = 2 * pi * self.table["frequency"], self.table.get("phase", 0.0)
            n = np.arange(-50, int(w * t_end / pi) + 50)
            return [t for t in ((n + 0.5) * pi - phase) / w if 0 < t < t_end]
        if self.kind == "spline":
            return [float(t) for t in self.poly.derivative().roots(extrapolate=False) if 0 < t < t_end]
        return []

    def piece(self, now):
        k, table = self.kind, self.table
        if k == "ramp":
            return lambda t: (table["rate"] * t, table["rate"], 0.0)
        if k == "sine":
            w, a, p = 2 * pi * table["frequency"], table["amplitude"], table.get("phase", 0.0)
            o = table.get("offset", 0.0)
            return lambda t: (o + a * sin(w * t + p), a * w * cos(w * t + p), -a * w * w * sin(w * t + p))
        begun = sum(x <= now + 1e-12 for x in self.knots)
        if begun in (0, len(self.knots)):
            held = self.values[0 if not begun else -1]
            return lambda t: (held, 0.0, 0.0)
        a, b = self.knots[begun - 1 : begun + 1]
        y, rise = self.values[begun - 1], self.values[begun] - self.values[begun - 1]
        if k == "points":
            return lambda t: (y + rise * (t - a) / (b - a), rise / (b - a), 0.0)
        poly = self.poly if k == "spline" else PPoly(
            rise * np.array([-20.0, 70.0, -84.0, 35.0, 0, 0, 0, y / rise if rise else 0.0])[:, None]
            / (b - a) ** np.arange(7.0, -1, -1)[:, None], [a, b],
        )  # fmt: skip
        if k == "point_to_point" and not rise:
            return lambda t: (y, 0.0, 0.0)
        i = int(np.searchsorted(poly.x, (a + b) / 2) - 1)
        c = [np.polynomial.Polynomial(poly.c[::-1, i]).deriv(n).coef[::-1].tolist() for n in range(3)]
        origin = float(poly.x[i])

        def value(t):
            results = []
            for row in c:
                total = 0.0
                for number in row:
                    total = total * (t - origin) + number
                results.append(total)
            return tuple(results)

        return value
