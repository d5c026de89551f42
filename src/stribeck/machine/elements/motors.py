"""Motors: from a voltage, or a wanted current, to a torque."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from pydantic import Field

from stribeck.constants import Column
from stribeck.expressions.graph import ZERO, wrap
from stribeck.expressions.ops import Value, clip
from stribeck.laws.base import Scales
from stribeck.machine.element import BodyName, Element, State, force_unit
from stribeck.machine.signal import SignalTable
from stribeck.machine.table import Loc, quantity

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.machine import Elements
    from stribeck.machine.reading import Draft


class Motor(Element, family=True):
    """A DC motor: L di/dt = V - R i - K v, torque K i; without L the current follows at once."""

    section, plain, positional = "motors", "motor", ("name", "on")
    kind: str = Field("motor", exclude=True)
    on: BodyName = Field(description="the body")
    K: float = quantity("N/A", "force per current, equal to voltage per speed", above=0, rotary_unit="N m/A")
    R: float = quantity("ohm", "resistance of the winding", above=0)
    L: float | None = quantity("H", "inductance of the winding", above=0, optional=True)
    voltage: float | None = quantity("V", "limit of the voltage", above=0, optional=True)
    current_time: float = quantity("s", "time constant of the current loop", above=0, default=1e-3)
    signal: SignalTable | None = Field(None, description="the voltage, if no controller commands a current")

    def own_states(self, m: Elements) -> tuple[State, ...]:
        """The current, with an inductance."""
        return () if self.L is None else (State("i", "A", "current"),)

    def limited(self, V: Value) -> Value:
        """The voltage within its limit."""
        return V if self.voltage is None else clip(V, -self.voltage, self.voltage)

    def with_inductance(self, wanted: Value, V: Value, v: Value, i: Value) -> tuple[Value, Value, Value]:
        """Current, voltage and di/dt; ``wanted`` is the current that a controller asks for, or None where V is given."""
        if wanted is not None:
            V = self.R * wanted + self.K * v + self.L * (wanted - i) / self.current_time
        V = self.limited(V)
        return i, V, (V - self.R * i - self.K * v) / self.L

    def without_inductance(self, wanted: Value, V: Value, v: Value) -> tuple[Value, Value]:
        """Current and voltage."""
        if wanted is None:
            V = self.limited(V)
            return (V - self.K * v) / self.R, V
        i = wanted
        if self.voltage is not None:
            i = clip(wanted, (-self.voltage - self.K * v) / self.R, (self.voltage - self.K * v) / self.R)
        return i, self.R * i + self.K * v

    def equations(self, a: Assembly) -> None:
        """Drive the body."""
        v = a.motion(self.on)[1]
        asks = a.system.controller_of(self.name)
        wanted, V = None, ZERO
        if asks is not None:
            wanted = a.k[asks.name_of("u")] / self.K
        else:
            V = wrap(a.reference(self.signal).value)
        if self.L is not None:
            i, V, rate = self.with_inductance(wanted, V, v, a.state(self, "i"))
            a.rates[self.name_of("i")] = wrap(rate)
        else:
            i, V = self.without_inductance(wanted, V, v)
        a.show(self.name_of("V"), V)
        i = a.show(self.name_of("i"), i)
        torque = a.show(self.name_of("torque"), self.K * i)
        a.push(self.on, torque)
        a.power_in = a.power_in + torque * v

    def natural(self, scales: Mapping[str, Scales], m: Elements) -> dict[str, Value]:
        """The current that makes the friction force."""
        return {self.name_of("i"): scales[self.on].force / self.K}

    def turning(self, m: Elements) -> bool:
        """As the body."""
        return m.bodies[self.on].turns

    def columns(self, m: Elements) -> list[Column]:
        """Current, voltage and torque."""
        torque = Column(self.name_of("torque"), force_unit(self.turning(m)), "torque of the motor")
        return [Column(self.name_of("i"), "A", "current"), Column(self.name_of("V"), "V", "voltage"), torque]

    def heading(self, m: Elements) -> str:
        """See :class:`Element`."""
        return f"Motor {self.name} on {self.on}."

    def wiring(self, m: Draft) -> list[tuple[Loc, str]]:
        """A voltage, or a controller, and not both."""
        by = next((x.name for x in m.machine.controllers.values() if x.on == self.name), None)
        named, asked = {*m.names["bodies"], *m.names["motors"]}, m.raw("controllers", "on")
        elsewhere = all(isinstance(on, str) and on in named for on in asked)  # else that is reported
        if self.signal is None and by is None and elsewhere and self.name not in asked:
            return [(("signal",), "missing: must be given (the voltage), or a controller must be on the motor")]
        if self.signal is not None and by is not None:
            return [(("signal",), f"a signal: must be left out: controllers.{by} drives the motor")]
        return m.not_on_driven(self.on)
