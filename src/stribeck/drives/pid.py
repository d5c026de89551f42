"""PID position control."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant
from stribeck.drives.base import Column, Drive
from stribeck.expressions.ops import Value, where


class PidDrive(Drive):
    """A PID controller whose derivative acts on the measured velocity (the paper's Fig. 8)."""

    kind, meaning = "pid", "the signal is the setpoint of a PID position controller, m"
    signal = Column("r", "m", "setpoint")
    constants: ClassVar[dict[str, Constant]] = {
        "K_p": Constant("N/m", "proportional gain"),
        "K_i": Constant("N/(m s)", "integral gain"),
        "K_d": Constant("N s/m", "derivative gain"),
    }
    states = (Column("I", "m s", "integral of y - r"),)
    columns = (Column("u", "N", "force of the controller on the body"),)

    @staticmethod
    def force(p: SimpleNamespace, r: Value, y: Value, v: Value, x: tuple[Value, ...]) -> Value:
        """u = -K_p (y - r) - K_i I - K_d v."""
        return -p.K_p * (y - r) - p.K_i * x[0] - p.K_d * v

    @staticmethod
    def rates(p: SimpleNamespace, r: Value, y: Value, v: Value, x: tuple[Value, ...]) -> tuple[Value, ...]:
        """dI/dt = y - r."""
        return (y - r,)

    @staticmethod
    def state_scales(p: SimpleNamespace, length: float, force: float) -> tuple[float, ...]:
        """The integral that makes the friction force, or a length for a second without integral gain."""
        gain = abs(p.K_i)
        return (where(gain > 0, force / where(gain > 0, gain, 1.0), length),)
