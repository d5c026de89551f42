"""A law's force at held speeds as columns: which constants it is linear in, and which it does not show at all."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from stribeck.arrays import Array
from stribeck.laws.base import Law

_FORCE_LIKE = ("N", "N s/m")  # constants of these units may multiply
_GRID = 4001


class Sliding:
    """The steady force of a law as a function of speed.

    Args:
        law: the law.
        values: constants that are given, by name; those that are missing get example values where none matter.
        typical: rough values of the rest.
    """

    def __init__(self, law: type[Law], values: Mapping[str, float], typical: Mapping[str, float]) -> None:
        self.law, self.given = law, dict(values)
        optional = {n for n, c in law.constants().items() if c.optional}
        self.base = {n: v for n, v in {**typical, **values}.items() if n not in optional or n in values}
        self.base = {n: v for n, v in self.base.items() if n in law.constants()}

    def force(self, values: Mapping[str, float], v: Array) -> Array:
        """The steady force; not finite where the law has none."""
        return np.asarray(self.law({**self.base, **values}).steady_force(v))

    def table(self, shape: Mapping[str, float], fastest: float, names: Sequence[str]) -> tuple[Array, dict[str, Array]]:
        """Speeds, and what each (linear) constant multiplies there; straight lines between them are some 3e-6 off.

        Without names the force itself, under the name "".
        """
        half = np.geomspace(1e-9 * fastest, 1.001 * fastest, _GRID)
        speeds = np.concatenate([-half[::-1], [0.0], half])
        return speeds, self.columns(shape, speeds, names) if names else {"": self.force(shape, speeds)}

    def _probe(self) -> Array:
        level, viscous = self.base.get("F_c", 0.0), self.base.get("sigma_2", 0.0)
        even = level / viscous if level > 0 and viscous > 0 else 0.03  # where both friction levels are alike, m/s
        fastest = 3 * self.base["v_s"] if "v_s" in self.base else even
        one_side = np.geomspace(1e-4 * fastest, 10 * fastest, 40)
        return np.concatenate([-one_side[::-1], one_side])

    @cached_property
    def linear(self) -> tuple[str, ...]:
        """The constants that the steady force is linear in."""
        probe, names = (
            self._probe(),
            [n for n, c in self.law.constants().items() if c.unit in _FORCE_LIKE and n in self.seen],
        )
        columns = self.columns({}, probe, names)
        bumped = {n: 1.3 * self.base[n] for n in names}
        whole = self.force(bumped, probe)
        told = np.sum([bumped[n] * columns[n] for n in names], axis=0) if names else np.zeros(len(probe))
        there = np.isfinite(told) & np.isfinite(whole)  # a law of the user's own may be for one direction
        told, whole = told[there], whole[there]
        size = np.max(abs(whole), initial=0.0)
        return tuple(names) if np.allclose(told, whole, rtol=1e-6, atol=1e-9 * size) else ()

    @cached_property
    def seen(self) -> tuple[str, ...]:
        """The constants that the steady force depends on at all, by more than a thousandth for a tenth's change."""
        probe = self._probe()
        first = self.force({}, probe)
        there = np.isfinite(first)
        probe, first = probe[there], first[there]
        size = np.max(abs(first), initial=0.0)
        found = []
        for name, value in self.base.items():
            moved = self.force({name: 1.1 * value}, probe) if name != "F_c" else self.force({name: 0.95 * value}, probe)
            if not there.any() or not np.max(abs(moved - first), initial=0.0) <= 1e-3 * size:
                found.append(name)
        return tuple(found)

    def columns(self, shape: Mapping[str, float], v: Array, names: Sequence[str]) -> dict[str, Array]:
        """The derivative of the steady force by each of the (linear) constants."""
        base = {n: self.base[n] for n in names}
        start = self.force({**shape, **base}, v)
        found = {}
        for name, value in base.items():
            change = -0.1 * value if name == "F_c" else 0.5 * value or 1.0  # F_c stays below F_s
            with np.errstate(invalid="ignore"):  # inf less inf
                found[name] = (self.force({**shape, **base, name: value + change}, v) - start) / change
        return found
