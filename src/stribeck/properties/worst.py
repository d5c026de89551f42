"""Laws at the worst values of constants that vary.

A proof about them holds for every history of the constants (docs/explanation/theory.md, "A level that varies").
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import SimpleNamespace

from stribeck import laws
from stribeck.constants import Constant
from stribeck.errors import InputError
from stribeck.expressions.ops import Value
from stribeck.laws.base import Claims, Law
from stribeck.laws.lugre import LuGre, LuGreMajorant
from stribeck.properties.plain import Json
from stribeck.properties.prover.region import ExactRange, down, up

EXACT, MAJORANT = ("lugre", "elastoplastic", "lugre_arctan"), ("lugre_majorant", "elastoplastic_majorant")
DAHL = "dahl"
BRISTLES = (*EXACT, *MAJORANT, DAHL, "lugre_sobczyk", "elastoplastic_sobczyk")
_SMALLEST = ("sigma_2", "k_v", "F_c", "delta")  # the worst of these is the smallest, of the others the largest


class LowestLevel(LuGre):
    """A law with the smallest g of the range at every speed, by the smallest F_c and F_s; z is within ``reach``."""

    name = "lowest_level"
    source = "Stribeck, docs/explanation/theory.md, A level that varies"
    claims = Claims(unique=True, bounded=True)
    reach = Constant("m", "the largest |z|", above=0)

    @staticmethod
    def z_bound(p: SimpleNamespace) -> Value:
        """At the highest level."""
        return p.reach


class LowestLevelMajorant(LuGreMajorant):
    """The same with a smooth majorant of |v|."""

    name = "lowest_level_majorant"
    source = LowestLevel.source
    claims = LowestLevel.claims
    reach = LowestLevel.reach
    z_bound = staticmethod(LowestLevel.z_bound)


def _end(ends: ExactRange) -> Fraction:
    """The upper end of a bounded range."""
    assert ends[1] is not None
    return ends[1]


@dataclass(frozen=True)
class Varied:
    """A law whose constants vary in any way within ranges; constants without a range are fixed.

    Attributes:
        law: with its nominal constants.
        ranges: exact ranges of constants, by name.
    """

    law: Law
    ranges: Mapping[str, ExactRange]

    @classmethod
    def by_level(cls, law: Law, low: float, high: float) -> Varied:
        """F_c and F_s together, between ``low`` and ``high`` times their values."""
        nominal = {n: Fraction(x) for n, x in law.p.numbers.items() if n in ("F_c", "F_s")}
        return cls(law, {n: (Fraction(low) * x, Fraction(high) * x) for n, x in nominal.items()})

    @property
    def varies(self) -> bool:
        """Whether any constant varies."""
        return any(low != high for low, high in self.ranges.values())

    def range(self, name: str) -> ExactRange:
        """The range of a constant."""
        if name in self.ranges:
            return self.ranges[name]
        value = Fraction(self.law.p.numbers[name])
        return value, value

    @property
    def newtons(self) -> ExactRange:
        """The range of sigma_0 g over all speeds and times: from the smallest to the largest of F_c and F_s."""
        names = [n for n in ("F_c", "F_s") if self.law.values.get(n) is not None]
        lows, highs = zip(*(self.range(n) for n in names), strict=True)
        return min(lows), None if None in highs else max(highs)

    def with_ends(self, ends: Mapping[str, int], most: Fraction | None = None) -> Law:
        """The law with some constants at the low (-1) or the high (1) end of their ranges.

        An open end is ``most`` times the nominal value, or the lower end if that is more.

        Raises:
            InputError: the law does not allow these constants.
        """
        moved = {}
        for name, side in ends.items():
            low, high = self.range(name)
            end = low if side < 0 else high
            if end is None:
                end = (most or 1) * max(low, Fraction(self.law.p.numbers[name]))
            moved[name] = float(end) if low == high else up(end) if side < 0 else down(end)
        return type(self.law)({**self.law.machine, **self.law.values, **self.law.choices, **moved}, self.law.rotary)

    def extreme(self, side: int, most: Fraction | None = None, least: Sequence[str] = ()) -> Law:
        """The law at the low (-1) or high (1) end of its level.

        The other constants have the values at which energy is drawn most easily; those in ``least`` have their smallest.
        """
        small = (*_SMALLEST, *least)
        return self.with_ends({n: side if n in ("F_c", "F_s") else -1 if n in small else 1 for n in self.ranges}, most)

    def worst(self, any_z: bool = False) -> Law | None:
        """The law of the worst level, with the lowest Stribeck curve and constants rounded to the safe side.

        None if it is unknown or has no bound. With ``any_z``, z is not restricted.
        """
        name, known = type(self.law).name, laws.builtin()
        if name == DAHL and known[name] is type(self.law):  # F v - W' f = sigma_0^2 |v| z^2/F_c: one F_c decides
            return self.extreme(-1) if any_z else self.highest()
        if name not in (*EXACT, *MAJORANT) or known[name] is not type(self.law):
            return None
        low, high = self.newtons
        if low <= 0 or (not any_z and (high is None or name == "lugre_arctan")):
            return None
        values: dict[str, Json] = {n: self._worst(n) for n in ("sigma_0", "sigma_1", "sigma_2")}
        values["v_s"] = down(self.range("v_s")[0])
        values |= {"F_c": down(low), "F_s": down(low) if "delta" in self.ranges else down(self.range("F_s")[0])}
        values["F_s"] = max(values["F_s"], values["F_c"])
        values |= {n: self._worst(n) for n in ("v_d",) if self.law.values.get(n) is not None}
        values |= {n: self.law.values.get(n) for n in ("delta",) if n not in self.ranges}
        if name in MAJORANT:
            values |= {"k_v": self._worst("k_v"), "smooth_abs": self.law.choices["smooth_abs"]}
        if name == "lugre_arctan":
            values["k_v"] = up(_end(self.range("k_v")))
        cls: type[Law] = known[{"elastoplastic": "lugre", "elastoplastic_majorant": "lugre_majorant"}.get(name, name)]
        if not any_z:
            cls = LowestLevelMajorant if name in MAJORANT else LowestLevel
            values["reach"] = up(_end(self.newtons) / self.range("sigma_0")[0])
        try:
            return cls(values, self.law.rotary)
        except InputError:
            return None  # a constant underflows or overflows

    def _worst(self, name: str) -> float:
        low, high = self.range(name)
        return down(low) if name in _SMALLEST else up(high) if high is not None else math.inf

    def highest(self) -> Law | None:
        """The law with the largest possible g, whose bound of z holds at all levels."""
        name, (_, high) = type(self.law).name, self.newtons
        if high is None or laws.builtin().get(name) is not type(self.law) or name == "lugre_arctan":
            return None
        base = {"elastoplastic": "lugre", "elastoplastic_majorant": "lugre_majorant"}.get(name, name)
        cls = laws.builtin()[base]
        values = {n: x for n, x in {**self.law.values, **self.law.choices}.items() if n in cls.constants()}
        values |= {n: up(high) for n in ("F_c", "F_s") if n in cls.constants()}
        values |= {n: self._worst(n) for n in ("k_v",) if n in self.ranges and n in cls.constants()}
        return cls(values, self.law.rotary)

    def to_dict(self) -> dict[str, list[float | None]]:
        """The ranges as plain data: the lower and the upper end, None for no bound."""
        return {n: [float(low), None if high is None else float(high)] for n, (low, high) in self.ranges.items()}

    def exactly(self) -> dict[str, list[str]]:
        """The ranges of all values in a proof, as text of rational numbers."""
        names = list(self.law.p.numbers)
        return {n: [str(x) if x is not None else "inf" for x in self.range(n)] for n in names}
