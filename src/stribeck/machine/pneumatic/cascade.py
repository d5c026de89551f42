"""The equations of the cascade of the paper's section 5, with its printing errors put right (docs/explanation/servo.md).

``machine/elements/controllers/pressure_cascade.py`` is the controller made of them.
"""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.expressions.graph import Expr, derivative
from stribeck.expressions.ops import Value
from stribeck.machine.pneumatic.cylinder import Cylinder

Course = tuple[Expr, Expr, Expr]  # a desired position and its first two derivatives


def course(position: Expr, t: Expr) -> Course:
    """A desired position as a function of time, with its derivatives."""
    speed = derivative(position, t)
    return position, speed, derivative(speed, t)


def tracking_errors(c: SimpleNamespace, path: Course, y: Value, v: Value) -> tuple[Value, Value]:
    """The position error e (m) and s = de/dt + lambda e (m/s)."""
    e = y - path[0]
    return e, v - path[1] + getattr(c, "lambda") * e


def desired_pressure(c: SimpleNamespace, m: SimpleNamespace, path: Course, v: Value, s: Value, F_hat: Value) -> Value:
    """p_d, eq. 12; ``m`` is the plant as the controller knows it."""
    return (-c.K_D * s + m.mass * (path[2] - getattr(c, "lambda") * (v - path[1])) + F_hat) / m.area


def pressure_demand(
    c: SimpleNamespace, m: SimpleNamespace, y: Value, v: Value, p_1: Value, p_2: Value, s: Value, p_err: Value, dp_d: Value
) -> Value:  # fmt: skip
    """u_hat, eq. 13: what the valve is to add to the rate of p_1 - p_2, Pa/s."""
    return -Cylinder.unforced(m, y, v, p_1, p_2) - m.area / c.rho * s - c.K_p * p_err + dp_d


def energy(c: SimpleNamespace, mass: Value, s: Value, p_err: Value, z_err: Value) -> Value:
    """V in J, eq. 17; z_err is z_hat - z."""
    return (mass * s**2 + c.rho * p_err**2 + z_err**2 / c.K) / 2
