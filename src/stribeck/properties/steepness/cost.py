"""The cost of a steepness: the stiffness of the equations, and the largest step of an explicit method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.laws.base import Law


@dataclass(frozen=True)
class Cost:
    """The price of a steepness.

    Attributes:
        v_max: up to this speed, m/s.
        stiffness: the largest |d(dz/dt)/dz| for |v| <= v_max and |z| <= F_s/sigma_0, 1/s.
        largest_step: the largest stable step of explicit Euler for the bristle at a held speed, s.
        bend: the speed 1/k_v within which the smooth |v| differs from |v|, m/s.
        force_bend: the largest |d^2 F/dv^2| there, N s^2/m^2: how fast the damping that a controller sees changes.
    """

    v_max: float
    stiffness: float
    largest_step: float
    bend: float
    force_bend: float


def _grid(law: Law, v_max: float) -> tuple[Array, Array]:
    k_v, bound = law.p.k_v, law.p.F_s / law.p.sigma_0
    v = np.unique(np.concatenate([[0.0], np.geomspace(1e-4, 1e4, 161) / k_v, np.geomspace(1e-9, 1.0, 161) * v_max]))
    v = v[v <= v_max]
    return np.concatenate([-v[::-1], v])[:, None], np.linspace(-bound, bound, 81)[None, :]


def cost(law: Law, k_v: float, v_max: float) -> Cost:
    """The price of a steepness, from the law's own derivatives on a grid."""
    law = law.replace(k_v=k_v)
    v, z = _grid(law, v_max)
    largest = float(np.max(np.abs(law.jacobian(v, z)[1])))
    near = np.linspace(-3, 3, 601)[:, None] / k_v
    slopes = law.force_rate(near, z, 1.0) - law.force_rate(near, z, 0.0)
    bend = float(np.max(np.abs(np.diff(slopes, axis=0)))) / float(near[1, 0] - near[0, 0])
    return Cost(v_max, largest, 2 / largest, 1 / k_v, bend)
