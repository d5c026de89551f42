"""The interval for the slope of a storage function, by sampling; it shows which laws are passive, and up to which speed.

Let dz/dt = f(z, v). A storage function S(z) exists if and only if two conditions hold (docs/explanation/theory.md).
First, L <= S' <= U at every z that can be driven both ways. Second, F v >= 0 at every f = 0.

- L(z) = sup of F v/f over the v with f < 0: the energy returned per meter of unwinding.
- U(z) = inf of F v/f over the v with f > 0: the energy needed per meter of winding up.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from stribeck.arrays import Array
from stribeck.laws.base import Law

_SLOWEST, _FASTEST = 1e-7, 1e16  # range of samples, over the law's smallest and largest natural speed
_PER_DECADE = 5  # samples in a decade: factors of a law change over about one, and extremes are refined
_ZOOMS, _ZOOM_POINTS = 7, 7  # of the refinement: each zoom narrows the step to 2.5/6, all seven to 0.2 %
_CANCELS = 1e-10  # of its terms: a smaller dz/dt is noise
_NEGATIVE = 1e-9  # of |L| + |U|: rounding may make U smaller than L by this
_ENDLESS = 500.0  # ratio of energies at speeds of ratio 1000, if they are proportional
_SIDES = np.array([-1.0, 1.0])[:, None, None]  # dz/dt < 0, for L, and > 0, for U
_APART = 1e-7  # relative error of the largest speed
_FAR = 1e4  # natural lengths to examine if z has no bound


def own_speeds(law: Law) -> list[float]:
    """The natural speeds of a law's constants, m/s, at which its equations change character."""
    scales, speeds = law.scales(law.p), [law.scales(law.p).speed]
    for name, constant in law.constants().items():
        value = law.values.get(name)
        if value and value > 0:
            by_unit = {"m/s": value, "s/m": 1 / value, "N s/m": scales.force / value}
            speeds += [by_unit[constant.unit]] if constant.unit in by_unit else []
    return sorted(x for x in speeds if 1e-150 < x < 1e150)


@dataclass(frozen=True)
class Storage:
    """The storage interval of a law with |v| <= v_max; ``reach`` bounds |z|, or is None.

    Attributes:
        per_decade: sampled speeds in a decade.
    """

    law: Law
    v_max: float | None = None
    reach: float | None = None
    per_decade: int = _PER_DECADE

    @cached_property
    def largest(self) -> float:
        """The largest |z| to examine, m: reachable from 0 and within the bound."""
        far = self.reach if self.reach is not None else _FAR * self.law.scales(self.law.p).length
        with np.errstate(all="ignore"):
            z = abs(self.law.steady_deflection(self.v))
        driven = float(np.max(z, initial=0.0, where=np.isfinite(z)))
        return min(far, driven) if driven > 0 else far

    @cached_property
    def v(self) -> Array:
        """The sampled speeds of both signs."""
        law_speeds = own_speeds(self.law)
        low, high = np.log10(law_speeds[0] * _SLOWEST), np.log10(law_speeds[-1] * _FASTEST)
        if self.v_max is not None:
            high = np.log10(self.v_max)
            low = min(low, high - 6)
        u = np.logspace(low, high, max(int(self.per_decade * (high - low)), 2))
        if self.v_max is not None:
            u[-1] = self.v_max
        return np.concatenate([-u[::-1], u])

    @cached_property
    def z(self) -> Array:
        """Sampled deflections, dense near 0 and near the end."""
        near = np.logspace(-6, np.log10(0.5), 24)
        if self.reach is None:
            share = np.logspace(-6, 0, 60) / 1.0001
        else:
            share = np.concatenate(
                [near, np.linspace(0.5, 0.98, 24)[1:-1], 1 - np.logspace(-9, np.log10(0.02), 24)[::-1]]
            )
        z = self.largest * share
        return z if self._odd else np.concatenate([-z[::-1], z])

    @property
    def _odd(self) -> bool:
        """Whether the law is odd, so that one sign of z suffices; a law's declaration is tested."""
        v, z = self.v[::7, None], self.largest * np.array([0.03, 0.5, 0.97])
        rates, forces = (
            function(np.stack([v, -v]), np.stack([z, -z])[:, None]) for function in (self.law.rate, self.law.force)
        )
        return self.law.symmetric and np.array_equal(rates[0], -rates[1]) and np.array_equal(forces[0], -forces[1])

    def slopes(self, v: Array, z: Array, raw: bool = False) -> tuple[Array, Array]:
        """dz/dt, and F v / (dz/dt) in J/m, with v along the first axis.

        dz/dt is 0 if it is noise. A quotient that overflows is 0, or unchanged with ``raw``.
        """
        law = self.law
        signs = np.array([1.0, -1.0, 0.0]).reshape(3, *(1,) * max(np.ndim(v), np.ndim(z)))
        with np.errstate(all="ignore"):
            f, *others = law.rate(v, signs * z)
            f = np.where(abs(f) > _CANCELS * np.maximum(*np.abs(others)), f, 0.0)
            energy = law.force_with(v, z, f) * v / f
        return f, energy if raw else np.where(np.isfinite(energy), energy, 0.0)

    def interval(self, z: ArrayLike) -> tuple[Array, Array]:
        """L(z) and U(z) in J/m; -inf if no speed unwinds, inf if none winds up."""
        low, high, _, _ = self.extremes(z)
        return low, high

    def extremes(self, z: ArrayLike) -> tuple[Array, Array, Array, Array]:
        """L and U, and their speeds: the sampled ones, refined between their neighbors."""
        z, top, lanes = np.atleast_1d(np.asarray(z, float)), abs(self.v[-1]), np.arange(2)[:, None]
        columns = np.arange(len(z))

        def largest(v: Array) -> tuple[Array, NDArray[np.int64]]:
            """The largest value over v (second axis) of L and of -U (first axis), and its index."""
            f, energy = self.slopes(v, z, raw=True)
            value = np.where((_SIDES * f > 0) & np.isfinite(energy), -_SIDES * energy, -np.inf)
            index = value.argmax(axis=1)
            return value[lanes, index, columns], index

        best, index = largest(self.v[:, None])
        v, step = self.v[index], np.log(abs(self.v[-1] / self.v[-2]))
        for _ in range(_ZOOMS):
            around = np.clip(v[:, None] * np.exp(step * np.linspace(-1, 1, _ZOOM_POINTS))[:, None], -top, top)
            value, index = largest(around)
            v = np.where(value > best, around[lanes, index, columns], v)
            best = np.maximum(best, value)
            step *= 2.5 / (_ZOOM_POINTS - 1)
        return best[0], -best[1], v[0], v[1]

    def shortfall(self, z: Array) -> Array:
        """(U - L)/(|U| + |L|), from -1 to 1; 1 if one of them is infinite."""
        low, high = self.interval(z)
        with np.errstate(all="ignore"):
            share = (high - low) / (abs(high) + abs(low))
        return np.where(np.isfinite(low) & np.isfinite(high), np.nan_to_num(share, nan=0.0), 1.0)

    @cached_property
    def worst(self) -> tuple[float, float]:
        """The smallest shortfall, and its z."""
        z = self.z
        value = self.shortfall(z)
        i = int(value.argmin())
        worst, place = float(value[i]), float(z[i])
        lower = np.minimum(value[:-2], value[2:]) - value[1:-1]  # below both neighbors
        deep = 4 * np.maximum(
            abs(np.diff(value))[:-1], abs(np.diff(value))[1:]
        )  # exceeds a possible further fall of a dip
        dips = 1 + np.flatnonzero((lower >= 0) & (value[1:-1] <= deep))
        if worst < -_NEGATIVE or not len(dips):
            return worst, place
        left, right, lanes = z[dips - 1], z[dips + 1], np.arange(len(dips))
        for _ in range(7):
            points = left + (right - left) * np.linspace(0, 1, 7)[:, None]
            value = self.shortfall(points.ravel()).reshape(points.shape)
            j = np.clip(value.argmin(axis=0), 1, 5)
            left, right = points[j - 1, lanes], points[j + 1, lanes]
            i = int(value.argmin())
            if value.flat[i] < worst:
                worst, place = float(value.flat[i]), float(points.flat[i])
        return worst, place

    @cached_property
    def sliding(self) -> tuple[float, float]:
        """The smallest power of steady sliding over its terms, and its speed."""
        v = self.v
        with np.errstate(all="ignore"):
            z = self.law.steady_deflection(v)
            power = self.law.force(v, z) * np.sign(v)
            size = abs(self.law.force(v, 0 * z)) + abs(self.law.force(0 * v, z))
            share = np.where(np.isfinite(power) & (size > 0), power / size, 1.0)
        i = int(share.argmin())
        return float(share[i]), float(v[i])

    @cached_property
    def endless(self) -> int:
        """The side on which energy from unwinding at the bound grows with speed without limit, or 0."""
        if self.v_max is not None or self.reach is None:
            return 0
        v = self.v[[0, -1]][:, None] * np.array([1.0, 1e-3])
        for side in (1, -1):
            f, energy = self.slopes(v.reshape(-1, 1), np.array([side * self.reach]))
            given = np.where(side * f[:, 0] < 0, side * energy[:, 0], 0.0).reshape(2, 2)  # by sign and by speed
            scale = abs(self.law.force(0.0, self.reach))
            if np.any((given[:, 0] > _ENDLESS * given[:, 1]) & (given[:, 0] > _ENDLESS * scale)):
                return side
        return 0

    @property
    def room(self) -> float:
        """The margin for a storage function in the samples, from -1 to 1; one exists if it is not negative."""
        return -1.0 if self.endless else min(self.worst[0], self.sliding[0]) + _NEGATIVE

    @property
    def exists(self) -> bool:
        """Whether a storage function exists for the samples."""
        return self.room >= 0


def largest_speed(law: Law, reach: float | None) -> float | None:
    """The largest v_max in m/s for which a storage function exists; None for no limit, 0 if there is none."""

    def room(v_max: float | None) -> float:
        return Storage(law, v_max, reach).room

    if room(None) >= 0:
        return None
    speeds = own_speeds(law)
    low, high = speeds[0] * _SLOWEST, speeds[-1] * _FASTEST
    if room(low) < 0:
        return 0.0
    while high / low > 1 + _APART:
        middle = float(np.sqrt(low) * np.sqrt(high))
        low, high = (middle, high) if room(middle) >= 0 else (low, middle)
    return low
