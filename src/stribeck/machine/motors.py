"""Motors: from a voltage, or a wanted current, to a torque."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.constants import Constant
from stribeck.expressions.ops import Value, clip
from stribeck.machine.element import Element


class MotorElement(Element):
    """A DC motor: L di/dt = V - R i - K v, torque K i; without L the current follows at once."""

    kind = "motor"
    K = Constant("N/A", "force by current, and voltage by speed", above=0, rotary_unit="N m/A")
    R = Constant("ohm", "resistance of the winding", above=0)
    L = Constant("H", "inductance of the winding", above=0, optional=True)
    voltage = Constant("V", "limit of the voltage", above=0, optional=True)
    current_time = Constant("s", "time constant of the current loop", above=0, default=1e-3)

    @staticmethod
    def limited(p: SimpleNamespace, V: Value) -> Value:
        """The voltage within its limit."""
        return V if p.voltage is None else clip(V, -p.voltage, p.voltage)

    @classmethod
    def with_inductance(
        cls, p: SimpleNamespace, wanted: Value, V: Value, v: Value, i: Value
    ) -> tuple[Value, Value, Value]:
        """Current, voltage and di/dt; ``wanted`` is the current that a controller asks for, or None where V is given."""
        if wanted is not None:
            V = p.R * wanted + p.K * v + p.L * (wanted - i) / p.current_time
        V = cls.limited(p, V)
        return i, V, (V - p.R * i - p.K * v) / p.L

    @classmethod
    def without_inductance(cls, p: SimpleNamespace, wanted: Value, V: Value, v: Value) -> tuple[Value, Value]:
        """Current and voltage."""
        if wanted is None:
            V = cls.limited(p, V)
            return (V - p.K * v) / p.R, V
        i = wanted if p.voltage is None else clip(wanted, (-p.voltage - p.K * v) / p.R, (p.voltage - p.K * v) / p.R)
        return i, p.R * i + p.K * v
