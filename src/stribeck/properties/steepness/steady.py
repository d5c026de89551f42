"""Tolerances that the law's steady state answers: creep under a constant load, and friction at a speed.

Held at v, a law's z tends to q g(v), where q depends on k_v v alone. Its inverse gives k_v.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, pi, sqrt, tan

import numpy as np

from stribeck.expressions.ops import Value
from stribeck.laws.base import Law
from stribeck.laws.terms import g
from stribeck.properties.steepness.search import (
    FORMULA,
    STEADY,
    Requirement,
    Tolerance,
    counterpart,
    family,
    smallest,
    unit,
)

# Relative, of a k_v found by a root: it costs nothing, and agrees with the formulas to all digits shown
_ACCURACY = 1e-10


def inverse(law: Law, q: float) -> tuple[float | None, str]:
    """k_v |v| at which the steady deflection is q g(v), and the formula; None where there is no closed form."""
    if law.name == "lugre_sobczyk":
        return (0.0 if q <= 0 else tan(pi * q / 2) if q < 1 else inf), "k_v = tan(pi q/2)/v"
    if law.name == "lugre_arctan":
        return tan(pi / (2 * q)) if q > 1 else inf, "k_v = tan(pi/(2 q))/v"
    if law.name == "lugre_majorant" and law.choices["smooth_abs"] == "sqrt":
        return (0.0 if q <= 0 else q / sqrt(1 - q * q) if q < 1 else inf), "k_v = q/sqrt(1 - q^2)/v"
    return None, ""


def _carries(law: Law, v: Value, load: float) -> Value:
    """True where steady friction at v is the load or more: at the z that carries it, z still grows."""
    return law.rate(v, (load - law.p.sigma_2 * v) / law.p.sigma_0) >= 0


@dataclass(frozen=True)
class Creep(Tolerance):
    """The speed in m/s under a load held at a share of F_s."""

    tolerance: float
    share: float

    def measure(self, law: Law) -> float:
        """The slowest speed at which steady friction carries the load."""
        load = self.share * law.p.F_s
        v = np.geomspace(1e-12, 1e4, 321) / law.p.k_v
        for _ in range(6):
            carries = _carries(law, v, load)
            first = int(carries.argmax())
            if not carries.any() or first == 0:
                return 0.0 if carries.any() else inf
            v = np.linspace(v[first - 1], v[first], 321)
        return float(v[-1])

    def need(self, law: Law) -> Requirement:
        """A formula, or the k_v at which friction at the tolerated speed is the load."""
        name = f"creep under {self.share:g} F_s"
        v, load = self.tolerance, self.share * law.p.F_s
        if law.name == "lugre_arctan":
            return Requirement(
                name, v, unit(law, "m/s"), 0.0, 0.0, FORMULA, "z has no bound: it does not creep below F_s"
            )
        if "z_ba" in law.constants() and load <= law.p.sigma_0 * law.p.z_ba:
            detail = "the load is below sigma_0 z_ba: it does not creep"
            return Requirement(name, v, unit(law, "m/s"), 0.0, 0.0, FORMULA, detail)
        sliding = law.p.sigma_0 * g(law.p, v) + law.p.sigma_2 * v
        if not load < sliding:
            detail = f"at {v:g} {unit(law, 'm/s')} sliding friction itself, {sliding:.4g} {unit(law, 'N')}, is below the load"
            return Requirement(name, v, unit(law, "m/s"), None, None, FORMULA, detail)
        x, formula = inverse(law, (load - law.p.sigma_2 * v) / (law.p.sigma_0 * g(law.p, v)))
        if x is not None:
            detail = f"{formula}, q = (share F_s - sigma_2 v)/(sigma_0 g(v)), v the tolerated speed"
            return self._requirement(law, name, x / v, FORMULA, detail)
        # carried at the tolerated speed: then the creep is slower
        k_v, _ = smallest(lambda k: 0.0 if _carries(law.replace(k_v=k), v, load) else inf, 0.0, 1 / v, _ACCURACY)
        return self._requirement(law, name, k_v, STEADY, "at the tolerated speed, steady friction equals the load")

    def _requirement(self, law: Law, name: str, k_v: float | None, method: str, detail: str) -> Requirement:
        achieved = self.measure(law.replace(k_v=k_v)) if k_v else None
        return Requirement(name, self.tolerance, unit(law, "m/s"), k_v, achieved, method, detail, self.curve(law, k_v))


@dataclass(frozen=True)
class SteadyError(Tolerance):
    """The error of the friction force at a speed that is held, as a share of the exact law's force."""

    tolerance: float
    speed: float

    def measure(self, law: Law) -> float:
        """From both laws' steady states."""
        force = float(counterpart(law, family(law)).steady_force(self.speed))
        return abs(float(law.steady_force(self.speed)) - force) / force

    def need(self, law: Law) -> Requirement:
        """A formula, or a root of the steady force."""
        name = f"error of steady friction at {self.speed:g} {unit(law, 'm/s')}"
        bristles = law.p.sigma_0 * g(law.p, self.speed)
        allowed = self.tolerance * (bristles + law.p.sigma_2 * self.speed) / bristles  # of g
        x, formula = inverse(law, 1 + allowed if law.name == "lugre_arctan" else 1 - allowed)
        if x is not None:
            sign = "+" if law.name == "lugre_arctan" else "-"
            k_v: float | None = x / self.speed
            method, detail = FORMULA, f"{formula}, q = 1 {sign} error (1 + sigma_2 v/(sigma_0 g(v)))"
        else:
            method, detail = STEADY, "steady friction differs by the tolerance"
            k_v, _ = smallest(lambda k: self.measure(law.replace(k_v=k)), self.tolerance, 1 / self.speed, _ACCURACY)
        achieved = self.measure(law.replace(k_v=k_v)) if k_v else None
        return Requirement(name, self.tolerance, "", k_v, achieved, method, detail, self.curve(law, k_v))
