"""A law's steady friction as columns: coefficients that multiply, shapes that bend. Only this file knows the laws' constants."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.identify.core.states import Estimate, one_sided
from stribeck.identify.features.guess import HALF
from stribeck.laws.base import Law

REACHED = 0.5  # of v_s: exp(-1/4) = 78 % of the rise; a slower speed must have been seen for F_s to have an upper bound
BENT, FLAT = 100.0, 2.0  # k_v times the slowest and fastest speed: tanh is 1 to rounding; tanh bends over all speeds
IMPOSSIBLE, WRONG, ODD = 100.0, 4.0, 2.0  # factors on the squared residual: never, hardly ever, rarely reported
HIGHEST = 3.0  # times the largest force: a level above it is balanced by another one
STEP = 0.02  # of a shape's logarithm, for its slopes: their error is its square
SPEEDS = 25  # at which the highest level of a curve is looked for, over three decades: a third apart
ANCHORED = 0.1  # of the level: the least coefficient with which slopes by a shape are taken; of 0 they are 0
MOST_FORCE = 1e100  # N: squares of what is more overflow
TABLE = 4001  # speeds of either sign in a table of a steady force: half a percent apart over nine decades
_FORCE_LIKE = ("N", "N s/m")  # constants of these units may multiply
APART = 1.5  # F_s by F_c, where a law's dependences are looked at: levels that are equal show nothing of v_s
ROUGH = 5.0  # times a law's example value, up and down: the range of a shape without a unit of speed


class SteadyCurve(ABC):
    """The friction of a law at constant speeds.

    Attributes:
        law: its name; ``given``: constants that are given.
        names: coefficients of its columns; ``shapes``: constants that bend them.
        sigma_2: whether viscous friction is beside it, as a column of the body.
    """

    def __init__(self, law: str, given: Mapping[str, float], free: Sequence[str]) -> None:
        self.law, self.given, self.free = law, dict(given), tuple(free)
        self.names: tuple[str, ...] = ()
        self.shapes: tuple[str, ...] = ()
        self.sigma_2 = True
        self.bounds: dict[str, tuple[float, float]] = {}  # of shapes, as the user gives them

    inertia, positive = ("mass", "sigma_2"), ("mass",)  # of the body: what is never 0; what is never below

    @abstractmethod
    def columns(self, v: Array, shape: Mapping[str, float]) -> dict[str, Array]:
        """The columns of the coefficients."""

    @abstractmethod
    def known(self, v: Array, shape: Mapping[str, float]) -> Array | None:
        """The given part of the force, or None."""

    def constants(
        self, c: Mapping[str, float], shape: Mapping[str, float], bends: Array, speeds: Array
    ) -> dict[str, float]:
        """The law's fitted constants from coefficients; ``bends``: what forms add to the level at ``speeds``."""
        return {**c, **shape}

    def sign(self, v: Array, shape: Mapping[str, float]) -> Array:
        """The direction of the friction."""
        return np.sign(v)

    def least(self, name: str) -> float:
        """The least value that the law allows a constant; -inf for what is none of its constants."""
        constant = laws.find(self.law).constants().get(name)
        bounds = () if constant is None else (constant.above, constant.at_least)
        return float(max((x for x in bounds if x is not None), default=-np.inf))

    def coulomb(self, value: Mapping[str, float], otherwise: float) -> float:
        """The Coulomb level among estimates."""
        return value.get("F_c", otherwise)

    def speeds(self, fast: float) -> Array:
        """At which the level is looked at for its highest value."""
        return fast * np.geomspace(1e-3, 1.0, SPEEDS)

    def force(self, v: Array, shape: Mapping[str, float], c: Mapping[str, float]) -> Array:
        """The friction, without what is viscous."""
        known = self.known(v, shape)
        out = np.zeros(len(v)) if known is None else known
        return np.asarray(sum((c[n] * x for n, x in self.columns(v, shape).items()), out))

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
        constants, search_ranges = laws.find(self.law).constants(), {}
        for n in self.shapes:
            unit, middle = constants[n].unit, float(constants[n].example or constants[n].default or 1.0)
            by_unit = {"m/s": (slow, HALF * fast), "s/m": (FLAT / fast, BENT / slow)}
            search_ranges[n] = self.bounds.get(n) or by_unit.get(unit, (middle / ROUGH, middle * ROUGH))
        return search_ranges

    def fault(self, x: Mapping[str, Array], fast: float, largest: float) -> Array:
        """A factor on the squared residual of coefficients that cannot be."""
        out = np.ones(len(next(iter(x.values()))))
        size = np.full(len(out), largest)
        if self.names:
            heights = np.array([x[n] for n in self.names])
            size = abs(heights[0])
            out = np.where((heights[0] < 0) | (np.max(abs(heights), axis=0) > HIGHEST * largest), IMPOSSIBLE, out)
        for n in self.names[1:]:
            out = np.where(x[n] < 0, out * WRONG, out)
        if "sigma_2" in x:
            out = np.where(x["sigma_2"] * fast < -0.02 * size, out * ODD, out)
        return np.where(x["mass"] < 0, out * 1.2, out) if "mass" in x else out

    def possible(self, c: Sequence[float], largest: float) -> bool:
        """Whether a law has such coefficients."""
        return not len(c) or (c[0] > 0 and max(map(abs, c)) <= HIGHEST * largest)

    def anchored(self, c: Sequence[float], least: float = ANCHORED) -> dict[str, float]:
        """Coefficients with which slopes are taken: none of them 0."""
        return {n: max(x, least * max(c[0], 1e-9)) for n, x in zip(self.names, c, strict=False)}

    def judged(self, estimates: dict[str, Estimate], slow: Estimate, slowest: float) -> dict[str, Estimate]:
        """Estimates as they are reported; ``slow``: the level at the slowest speed seen."""
        return estimates


class StribeckCurve(SteadyCurve):
    """Coulomb's level, with a Stribeck rise or without, and a sign that is exact or smooth.

    Columns are F_c and the rise F_s - F_c, as these hardly correlate; F_s itself if F_c is given.
    """

    def __init__(self, law: str, given: Mapping[str, float], free: Sequence[str]) -> None:
        super().__init__(law, given, free)
        kind = laws.find(law)
        self.rises, self.smooth = "F_s" in kind.uses, "k_v" in free or "k_v" in given or kind.name == "stribeck_tanh"
        self.tanh = kind.name == "stribeck_tanh"
        wanted = [
            *(["v_s"] if self.rises else []),
            *(["k_v"] if self.smooth else []),
            *(n for n in free if n == "delta"),
        ]
        self.shapes = tuple(n for n in dict.fromkeys(wanted) if n not in given)
        self.names = tuple(self.columns(np.ones(1), dict.fromkeys(self.shapes, 1.0)))

    def sign(self, v: Array, shape: Mapping[str, float]) -> Array:
        """Exact, or smooth as the law has it."""
        if not self.smooth:
            return np.sign(v)
        steep = {**self.given, **shape}["k_v"] * v
        return np.asarray(np.tanh(steep) if self.tanh else 2 / np.pi * np.arctan(steep))

    def _rise(self, v: Array, shape: Mapping[str, float]) -> Array:
        have = {**self.given, **shape}
        share = abs(v / have["v_s"])
        return np.asarray(np.exp(-(share**2 if "delta" not in have else share ** have["delta"])))

    def columns(self, v: Array, shape: Mapping[str, float]) -> dict[str, Array]:
        """The columns of F_c and the rise."""
        sign = self.sign(v, shape)
        if not self.rises:
            return {} if "F_c" in self.given else {"F_c": sign}
        bump, held = sign * self._rise(v, shape), {"F_c", "F_s"} & self.given.keys()
        if held:
            return {} if len(held) == 2 else {"F_s": bump} if "F_c" in held else {"F_c": sign - bump}
        return {"F_c": sign, "rise": bump}

    def known(self, v: Array, shape: Mapping[str, float]) -> Array | None:
        """The force of given levels."""
        if not {"F_c", "F_s"} & self.given.keys():
            return None
        sign = self.sign(v, shape)
        bump = sign * self._rise(v, shape) if self.rises else 0.0
        return np.asarray(self.given.get("F_c", 0.0) * (sign - bump) + self.given.get("F_s", 0.0) * bump)

    def constants(
        self, c: Mapping[str, float], shape: Mapping[str, float], bends: Array, speeds: Array
    ) -> dict[str, float]:
        """F_s is the highest level of the curve with its bends: where the speed tends to 0."""
        out = {n: c[n] for n in ("F_c", "F_s") if n in c}
        if "rise" in c:
            level = c["F_c"] + c["rise"] * self._rise(speeds, shape) + bends
            out["F_s"] = max(float(level.max()), 0.0)
        return out | dict(shape)

    def judged(self, estimates: dict[str, Estimate], slow: Estimate, slowest: float) -> dict[str, Estimate]:
        """No speed was seen that is slow beside v_s: F_s is at least the level there and F_c, v_s at most what it may be."""
        if not {"F_s", "v_s"} <= estimates.keys() or slowest <= REACHED * estimates["v_s"].value:
            return estimates
        levels = [slow, estimates["F_c"]] if "F_c" in estimates else [slow]  # never below F_c
        F_s, v_s = one_sided(estimates["F_s"], estimates["v_s"], levels)
        return estimates | {"F_s": F_s, "v_s": v_s}


class SlidingCurve(SteadyCurve):
    """Any law that is linear in some constants: its columns are the derivatives of its steady force."""

    def __init__(self, law: str, given: Mapping[str, float], free: Sequence[str]) -> None:
        super().__init__(law, given, free)
        self._kind, self.sigma_2 = laws.find(law), False
        constants = self._kind.constants()
        example = {n: c.example or c.default or 1.0 for n, c in constants.items() if not c.choices and not c.optional}
        self._base = {**example, **self.given}
        if {"F_c", "F_s"} <= example.keys():
            if "F_s" not in self.given:
                self._base["F_s"] = APART * self._base["F_c"]
            elif "F_c" not in self.given:
                self._base["F_c"] = self._base["F_s"] / APART
        usual = {n for n, c in constants.items() if (c.optional or c.default is not None) and n not in free}
        seen = self._seen()
        self._linear = self._linear_of(seen)
        wanted = [n for n in seen if n not in self.given and n not in usual]
        self.names = tuple(n for n in wanted if n in self._linear)
        self.shapes = tuple(n for n in wanted if n not in self.names)
        if not self.names:
            text = "has no linear constant, so that a static fit is impossible; must be fitted as 'dynamic'"
            raise InputError(f"{arg('law')}: {law!r}: {text}")

    def columns(self, v: Array, shape: Mapping[str, float]) -> dict[str, Array]:
        """The derivatives by the constants, from a table over the speeds."""
        speeds, table = self._table(v, shape)
        columns = {n: np.interp(v, speeds, table[n]) for n in self.names}
        if not all(np.all(abs(x) <= MOST_FORCE) for x in columns.values()):
            text = f"gives no force within 1e100 in size at the speeds of this record ({v.min():.3g} to {v.max():.3g})"
            raise InputError(f"law '{self._kind.name}': {text}")
        return columns

    def known(self, v: Array, shape: Mapping[str, float]) -> Array | None:
        """The columns of given constants."""
        held = [n for n in self._linear if n in self.given]
        if not held:
            return None
        speeds, table = self._table(v, shape)
        return np.asarray(sum(self.given[n] * np.interp(v, speeds, table[n]) for n in held))

    def _steady(self, values: Mapping[str, float], v: Array) -> Array:
        """The steady force; not finite where the law has none."""
        return np.asarray(self._kind({**self._base, **values}).steady_force(v))

    def _table(self, v: Array, shape: Mapping[str, float]) -> tuple[Array, dict[str, Array]]:
        """Speeds, and what each linear constant multiplies there; straight lines between them are some 3e-6 off."""
        fastest = max(float(np.max(abs(v))), 1e-12)
        half = np.geomspace(1e-9 * fastest, 1.001 * fastest, TABLE)
        speeds = np.concatenate([-half[::-1], [0.0], half])
        return speeds, self._slopes_by(self._linear, shape, speeds)

    def _slopes_by(self, names: Sequence[str], shape: Mapping[str, float], v: Array) -> dict[str, Array]:
        """The derivative of the steady force by each of the (linear) constants."""
        start, slopes = self._steady(shape, v), {}
        for name in names:
            value = self._base[name]
            change = -0.1 * value if name == "F_c" else 0.5 * value or 1.0  # F_c stays below F_s
            with np.errstate(invalid="ignore"):  # inf less inf
                slopes[name] = (self._steady({**shape, name: value + change}, v) - start) / change
        return slopes

    def _probe(self) -> Array:
        """Speeds at which the steady force shows what it depends on."""
        level, viscous = self._base.get("F_c", 0.0), self._base.get("sigma_2", 0.0)
        even = level / viscous if level > 0 and viscous > 0 else 0.03  # where both friction levels are alike, m/s
        fastest = 3 * self._base["v_s"] if "v_s" in self._base else even
        one_side = np.geomspace(1e-4 * fastest, 10 * fastest, 40)
        return np.concatenate([-one_side[::-1], one_side])

    def _seen(self) -> list[str]:
        """The constants that the steady force depends on at all: at some speed by more than a millionth for a tenth's change."""
        first = self._steady({}, self._probe())
        there = np.isfinite(first)
        probe, first = self._probe()[there], first[there]
        seen = []
        for name, value in self._base.items():
            moved = self._steady({name: (0.95 if name == "F_c" else 1.1) * value}, probe)
            if not there.any() or not np.all(abs(moved - first) <= 1e-6 * abs(first)):
                seen.append(name)
        return seen

    def _linear_of(self, seen: Sequence[str]) -> list[str]:
        """The constants that the steady force is linear in."""
        constants, probe = self._kind.constants(), self._probe()
        names = [n for n, c in constants.items() if c.unit in _FORCE_LIKE and n in seen]
        columns, bumped = self._slopes_by(names, {}, probe), {n: 1.3 * self._base[n] for n in names}
        whole = self._steady(bumped, probe)
        summed = np.sum([bumped[n] * columns[n] for n in names], axis=0) if names else np.zeros(len(probe))
        there = np.isfinite(summed) & np.isfinite(whole)  # a law of the user's own may be for one direction
        size = np.max(abs(whole[there]), initial=0.0)
        return names if np.allclose(summed[there], whole[there], rtol=1e-6, atol=1e-9 * size) else []


def curve_of(law: str, given: Mapping[str, float], free: Sequence[str] = ()) -> SteadyCurve:
    """The columns of a static law."""
    kind: type[Law] = laws.find(law)
    curve_class = StribeckCurve if kind.name in ("coulomb_viscous", "stribeck", "stribeck_tanh") else SlidingCurve
    return curve_class(law, given, free)
