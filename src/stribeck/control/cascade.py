"""The cascade controller of the paper's section 5, with its printing errors put right (docs/servo.md)."""

from __future__ import annotations

from typing import Any, ClassVar

from stribeck.constants import Constant
from stribeck.drives.base import Column
from stribeck.expressions.ops import Value
from stribeck.plants.cylinder import Cylinder

Path = tuple[Value, Value, Value, Value]  # the desired position and its first three derivatives


class Cascade:
    """A tracking law for the piston that asks for a pressure difference, and one for the valve that provides it."""

    kind = "cascade"
    meaning = "the signal is the desired position of a pneumatic servo under cascade control, m"
    signal = Column("y_d", "m", "desired position")
    sets_velocity = False
    constants: ClassVar[dict[str, Constant]] = {
        "K_D": Constant("N s/m", "gain of the tracking error s", above=0, example=60.0),
        "K_p": Constant("1/s", "gain of the pressure error", above=0, example=60.0),
        "lambda": Constant("1/s", "s = de/dt + lambda e", above=0, example=20.0),
        "K": Constant("m/N", "gain of the friction observer", above=0, example=1e-5),
        "rho": Constant("m^3/Pa", "weight of the pressure error in the Lyapunov function", above=0, example=4e-10),
        "u_max": Constant("V", "limit of the valve voltage", above=0, example=10.0),
        "supply_droop": Constant(
            "Pa s/kg", "pressure that the supply loses by mass flow, unknown to the controller", at_least=0, optional=True
        ),
    }  # fmt: skip

    @staticmethod
    def errors(c: Any, path: Path, y: Value, v: Value) -> tuple[Value, Value]:
        """The position error e (m) and s = de/dt + lambda e (m/s)."""
        e = y - path[0]
        return e, v - path[1] + getattr(c, "lambda") * e

    @staticmethod
    def desired_pressure(c: Any, m: Any, path: Path, v: Value, s: Value, F_hat: Value) -> Value:
        """p_d, eq. 12; ``m`` is the plant as the controller knows it."""
        return (-c.K_D * s + m.mass * (path[2] - getattr(c, "lambda") * (v - path[1])) + F_hat) / m.area

    @staticmethod
    def pressure_demand(
        c: Any, m: Any, y: Value, v: Value, p_1: Value, p_2: Value, s: Value, p_err: Value, dp_d: Value
    ) -> Value:
        """u_hat, eq. 13: what the valve is to add to the rate of p_1 - p_2, Pa/s."""
        return -Cylinder.unforced(m, y, v, p_1, p_2) - m.area / c.rho * s - c.K_p * p_err + dp_d

    @staticmethod
    def energy(c: Any, mass: Value, s: Value, p_err: Value, z_err: Value) -> Value:
        """V in J, eq. 17; z_err is z_hat - z."""
        return (mass * s**2 + c.rho * p_err**2 + z_err**2 / c.K) / 2
