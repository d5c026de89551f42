"""The steady friction of laws that are linear in their levels, as columns: coefficients that multiply, shapes that bend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.identify.core.library import IMPOSSIBLE, STEEP, UNNOTICED
from stribeck.identify.features.guess import HIGHEST_V_S

LAWS = ("coulomb_viscous", "stribeck", "stribeck_tanh")  # that have columns; other laws are fitted by simulation
REACHED = 0.5  # of v_s: exp(-1/4) = 78 % of the rise; a slower speed must have been seen for F_s to have an upper bound
BENT, FLAT = 100.0, 2.0  # k_v times the slowest and fastest speed: tanh is 1 to rounding; tanh bends over all speeds
EXPONENTS = (0.4, 10.0)  # of the Stribeck curve: five times less and more than 2
HIGHEST_LEVEL = 3.0  # times the largest force: a level above it is balanced by another one
STEP = 0.02  # of a shape's logarithm, for its slopes: their error is its square
SPEEDS = 25  # at which the highest level of a curve is looked for, over three decades: a third apart
ANCHORED = 0.1  # of the level: the least coefficient with which slopes by a shape are taken; of 0 they are 0


class SteadyCurve:
    """Coulomb's level, with a Stribeck rise or without, and a sign that is exact or smooth; viscous friction is beside it.

    Columns are F_c and the rise F_s - F_c, as these hardly correlate.

    Attributes:
        law: its name; ``given``: constants that are given; ``free``: constants with a default that are fitted.
        names: coefficients of its columns; ``shapes``: constants that bend them.
    """

    def __init__(self, law: str, given: Mapping[str, float], free: Sequence[str]) -> None:
        self.law, self.given, self.free = law, dict(given), tuple(free)
        kind = laws.find(law)
        self.tanh, self.rises = kind.name == "stribeck_tanh", "F_s" in kind.uses
        self.smooth = self.tanh or "k_v" in free or "k_v" in given
        wanted = {"v_s": self.rises, "k_v": self.smooth, "delta": "delta" in free}
        self.shapes = tuple(n for n, there in wanted.items() if there and n not in given)
        self.names = tuple(self.columns(np.ones(1), dict.fromkeys(self.shapes, 1.0)))

    def sign(self, v: Array, shape: Mapping[str, float]) -> Array:
        """The direction of the friction, exact, or smooth as the law has it."""
        if not self.smooth:
            return np.sign(v)
        steep = {**self.given, **shape}["k_v"] * v
        return np.asarray(np.tanh(steep) if self.tanh else 2 / np.pi * np.arctan(steep))

    def rise(self, v: Array, shape: Mapping[str, float]) -> Array:
        """The Stribeck rise at a speed, from 1 at rest."""
        have = {**self.given, **shape}
        share = abs(v / have["v_s"])
        return np.asarray(np.exp(-(share**2 if "delta" not in have else share ** have["delta"])))

    def columns(self, v: Array, shape: Mapping[str, float]) -> dict[str, Array]:
        """The columns of the coefficients."""
        sign = self.sign(v, shape)
        return {"F_c": sign} | ({"rise": sign * self.rise(v, shape)} if self.rises else {})

    def force(self, v: Array, shape: Mapping[str, float], c: Mapping[str, float]) -> Array:
        """The friction, without what is viscous."""
        return np.asarray(sum(c[n] * x for n, x in self.columns(v, shape).items()))

    def slopes(self, v: Array, shape: Mapping[str, float], c: Mapping[str, float]) -> list[Array]:
        """Of the friction by the logarithm of each shape."""
        out = []
        for n in shape:
            up, down = ({**shape, n: shape[n] * float(np.exp(e))} for e in (STEP, -STEP))
            out.append((self.force(v, up, c) - self.force(v, down, c)) / (2 * STEP))
        return out

    def ranges(self, v: Array) -> dict[str, tuple[float, float]]:
        """Between which values the shapes are searched: what the record's speeds can show."""
        v = np.sort(abs(v[v != 0]))
        fast, slow = float(v[-1]), max(float(v[len(v) // 100]), 1e-3 * float(v[-1]))
        every = {"v_s": (slow, HIGHEST_V_S * fast), "k_v": (FLAT / fast, BENT / slow), "delta": EXPONENTS}
        return {n: every[n] for n in self.shapes}

    def constants(self, c: Mapping[str, float], shape: Mapping[str, float], bends: Array, v: Array) -> dict[str, float]:
        """The law's fitted constants from coefficients. F_s is the highest level of the curve with its bends.

        Args:
            bends: what forms add to the level at ``v``.
        """
        out = {"F_c": c["F_c"]}
        if self.rises:
            out["F_s"] = max(float((c["F_c"] + c["rise"] * self.rise(v, shape) + bends).max()), 0.0)
        return out | dict(shape)

    def least(self, name: str) -> float:
        """The least value that the law allows a constant; -inf for what is none of its constants."""
        constant = laws.find(self.law).constants().get(name)
        bounds = () if constant is None else (constant.above, constant.at_least)
        return float(max((x for x in bounds if x is not None), default=-np.inf))

    def fault(self, x: Mapping[str, Array], fast: float, largest: float) -> Array:
        """A factor on the squared residual of coefficients that cannot be."""
        heights = np.array([x[n] for n in self.names])
        size = abs(heights[0])
        out = np.where((heights[0] < 0) | (np.max(abs(heights), axis=0) > HIGHEST_LEVEL * largest), IMPOSSIBLE, 1.0)
        below = [x["rise"]] if self.rises else []
        below += [x["mass"]] if "mass" in x else []
        below += [x["sigma_2"] * fast + UNNOTICED * size] if "sigma_2" in x else []
        for y in below:
            out = np.where(y < 0, out * STEEP, out)
        return out

    def possible(self, c: Sequence[float], largest: float) -> bool:
        """Whether a law has such coefficients."""
        return c[0] > 0 and max(map(abs, c)) <= HIGHEST_LEVEL * largest

    def anchored(self, c: Sequence[float]) -> dict[str, float]:
        """Coefficients with which slopes are taken: none of them 0."""
        return {n: max(x, ANCHORED * max(c[0], 1e-9)) for n, x in zip(self.names, c, strict=False)}
