"""The cost of a steepness: the stiffness of the equations, and the largest step of an explicit method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.laws.base import Law
from stribeck.properties.steepness.search import DERIVATIVE, Requirement, Tolerance, smallest, unit


@dataclass(frozen=True)
class Cost:
    """The price of a steepness.

    Attributes:
        v_max: up to this speed, m/s.
        stiffness: the largest |d(dz/dt)/dz| for |v| <= v_max and |z| <= F_s/sigma_0, 1/s.
        largest_step: the largest stable step of explicit Euler for the bristle at a held speed, s.
        body_stiffness: the largest magnitude of an eigenvalue of body and bristle together, 1/s; None without a mass.
        bend: the speed 1/k_v within which the smooth |v| differs from |v|, m/s.
        force_bend: the largest |d^2 F/dv^2| there, N s^2/m^2: how fast the damping that a controller sees changes.
    """

    v_max: float
    stiffness: float
    largest_step: float
    body_stiffness: float | None
    bend: float
    force_bend: float


def _grid(law: Law, v_max: float) -> tuple[Array, Array]:
    k_v, bound = law.p.k_v, law.p.F_s / law.p.sigma_0
    v = np.unique(np.concatenate([[0.0], np.geomspace(1e-4, 1e4, 161) / k_v, np.geomspace(1e-9, 1.0, 161) * v_max]))
    v = v[v <= v_max]
    return np.concatenate([-v[::-1], v])[:, None], np.linspace(-bound, bound, 81)[None, :]


def stiffness(law: Law, v_max: float) -> float:
    """The largest |d(dz/dt)/dz| on a grid of |v| <= v_max, |z| <= F_s/sigma_0, 1/s."""
    return float(np.max(np.abs(law.jacobian(*_grid(law, v_max))[1])))


def cost(law: Law, k_v: float, v_max: float, mass: float | None) -> Cost:
    """The price of a steepness, from the law's own derivatives on a grid."""
    law = law.replace(k_v=k_v)
    v, z = _grid(law, v_max)
    rate_v, rate_z = law.jacobian(v, z)
    largest = float(np.max(np.abs(rate_z)))
    together = None
    if mass is not None:
        # dF/dv and dF/dz, from dF/dt = dF/dv dv/dt + dF/dz dz/dt
        force_v = law.force_rate(v, z, 1.0) - law.force_rate(v, z, 0.0)
        h = 1e-6 * law.p.F_s / law.p.sigma_0
        force_z = (law.force(v, z + h) - law.force(v, z - h)) / (2 * h)
        matrices = np.stack([np.stack([-force_v, -force_z], -1) / mass, np.stack([rate_v, rate_z], -1)], -2)
        together = float(np.max(np.abs(np.linalg.eigvals(matrices))))
    near = np.linspace(-3, 3, 601)[:, None] / k_v
    slopes = law.force_rate(near, z, 1.0) - law.force_rate(near, z, 0.0)
    bend = float(np.max(np.abs(np.diff(slopes, axis=0)))) / float(near[1, 0] - near[0, 0])
    return Cost(v_max, largest, 2 / largest, together, 1 / k_v, bend)


@dataclass(frozen=True)
class SampleTime(Tolerance):
    """The step of a target, s: explicit Euler of the bristle is to be stable with it up to v_max."""

    tolerance: float
    v_max: float

    def measure(self, law: Law) -> float:
        """The stiffness, 1/s, which must not exceed 2/step."""
        return stiffness(law, self.v_max)

    def need(self, law: Law) -> Requirement:
        """A root of the stiffness, if sliding itself allows the step."""
        name = f"explicit step, |v| <= {self.v_max:g} {unit(law, 'm/s')}"
        limit, steep = 2 / self.tolerance, 1e12 / self.v_max
        k_v, detail = None, "2/largest |d(dz/dt)/dz|"
        if self.measure(law.replace(k_v=steep)) <= limit:
            k_v, _ = smallest(lambda k: self.measure(law.replace(k_v=k)), limit, 1e3 / self.v_max, 1e-9)
        achieved = 2 / self.measure(law.replace(k_v=k_v or steep))
        if k_v is None:
            detail = (
                f"sliding at v_max asks for a step below {achieved:.3g} s, whatever k_v is: take an exact (zero-order "
                "hold) or implicit step, which is stable at any"
            )
        return Requirement(name, self.tolerance, "s", k_v, achieved, DERIVATIVE, detail)
