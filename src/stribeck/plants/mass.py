"""A single body on a surface."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant
from stribeck.expressions.ops import Value
from stribeck.plants.base import Own, Plant


class Mass(Plant):
    """A rigid body that a drive pushes and friction holds back."""

    kind, meaning = "mass", "a single body"
    constants: ClassVar[dict[str, Constant]] = {
        "mass": Constant("kg", "mass of the body", above=0, rotary_unit="kg m^2")
    }

    @staticmethod
    def net_force(u: Value, F: Value) -> Value:
        """What accelerates the body, N: the drive's force u less the friction force F."""
        return u - F

    @staticmethod
    def acceleration(p: SimpleNamespace, u: Value, F: Value, x: Own = ()) -> Value:
        """dv/dt in m/s^2 under the drive's force u and the friction force F, N."""
        return Mass.net_force(u, F) / p.mass

    @staticmethod
    def stored_energy(p: SimpleNamespace, y: Value, v: Value, x: Own) -> Value:
        """Kinetic energy, J."""
        return p.mass * v**2 / 2

    @staticmethod
    def inertia(p: SimpleNamespace) -> Value:
        """The mass; None where none is given, as a drive that sets the velocity needs none."""
        return getattr(p, "mass", None)
