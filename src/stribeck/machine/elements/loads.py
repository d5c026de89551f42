"""Forces on a body from outside."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from pydantic import Field

from stribeck.constants import Column
from stribeck.expressions.graph import wrap
from stribeck.expressions.ops import Value, cos, sin
from stribeck.machine.element import NONE, BodyName, Element, Own, force_unit
from stribeck.machine.elements.waves import same_length, sum_of_waves
from stribeck.machine.signal import SignalTable
from stribeck.machine.table import Problem, quantity

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.machine import Elements


class Load(Element, family=True):
    """A force on a body that depends on its motion, on a signal, or on states of its own.

    A load of your own overrides ``force`` (and ``rates``, with ``states``). Its energy counts as put in, unless it is
    ``conservative`` and says what it stores.
    """

    section, positional = "loads", ("name", "on")
    conservative: ClassVar[bool] = False
    by_position_alone: ClassVar[bool] = False
    on: BodyName = Field(description="the body")

    @classmethod
    def follow(cls, name: str, on: str, signal: Any, gain: float | None = None) -> Follower:
        """The signal is the force, N or N m, times ``gain``."""
        return Follower(name=name, on=on, signal=signal, gain=gain)

    @classmethod
    def pendulum(cls, name: str, on: str, amplitude: float, phase: float = 0.0) -> Pendulum:
        """-amplitude sin(y + phase)."""
        more = {"phase": phase} if phase else {}
        return Pendulum(name=name, on=on, amplitude=amplitude, **more)  # type: ignore[arg-type]

    @classmethod
    def ripple(cls, name: str, on: str, amplitude: Any, waves: Any, phase: Any = None) -> Ripple:
        """Sum of amplitude sin(waves y + phase)."""
        return Ripple(name=name, on=on, amplitude=amplitude, waves=waves, phase=phase)

    def force(self, r: Value, y: Value, v: Value, x: Own = NONE) -> Value:
        """The force on the body, N or N m; ``r`` is the signal where the load has one."""
        raise NotImplementedError

    def rates(self, r: Value, y: Value, v: Value, x: Own) -> Own:
        """The time derivatives of its own states."""
        return NONE

    def stored_energy(self, y: Value) -> Value:
        """The energy that a conservative load stores, J."""
        return 0.0 * y

    def shown(self, low: float, high: float) -> tuple[float, float]:
        """Of a force by the position alone: the stretch of positions that shows it, where some of ``low`` to ``high`` were
        reached."""
        return low, high

    def equations(self, a: Assembly) -> None:
        """Push the body."""
        y, v = a.motion(self.on)
        signal = getattr(self, "signal", None)
        r = a.reference(signal).value if signal is not None else 0.0
        x = {s.name: a.state(self, s.name) for s in self.states}
        f = a.show(self.name_of("f"), self.force(r, y, v, x))
        a.rates |= {self.name_of(n): wrap(rate) for n, rate in self.rates(r, y, v, x).items()}
        a.push(self.on, f)
        if self.conservative:
            a.stored = a.stored + self.stored_energy(y)
        else:
            a.power_in = a.power_in + f * v

    def turning(self, m: Elements) -> bool:
        """As the body."""
        return m.bodies[self.on].turns

    def columns(self, m: Elements) -> list[Column]:
        """Its force."""
        return [Column(self.name_of("f"), force_unit(self.turning(m)), "force of the load")]

    def heading(self, m: Elements) -> str:
        """See :class:`Element`."""
        return f"Load {self.name}: {self.kind} on {self.on}."


class Follower(Load):
    """The signal is the force, times ``gain`` if given: the torque constant where a current was recorded."""

    kind: Literal["signal"] = "signal"
    gain: float | None = quantity("", "force per unit of the signal; 1 unless given", optional=True)
    signal: SignalTable = Field(description="the signal: a table with kind and its constants")

    def force(self, r: Value, y: Value, v: Value, x: Own = NONE) -> Value:
        """The signal times the gain."""
        return r if self.gain is None else self.gain * r


class Pendulum(Load):
    """The gravity torque of an arm: -amplitude sin(y + phase)."""

    conservative = by_position_alone = True
    kind: Literal["pendulum"] = "pendulum"
    amplitude: float = quantity("N", "largest force", rotary_unit="N m")
    phase: float = quantity("rad", "angle at y = 0, from hanging down", default=0.0)

    def force(self, r: Value, y: Value, v: Value, x: Own = NONE) -> Value:
        """-amplitude sin(y + phase)."""
        return -self.amplitude * sin(y + self.phase)

    def stored_energy(self, y: Value) -> Value:
        """amplitude (1 - cos(y + phase))."""
        return self.amplitude * (1 - cos(y + self.phase))

    def shown(self, low: float, high: float) -> tuple[float, float]:
        """At most a turn."""
        return low, min(high, low + math.tau)


class Ripple(Load):
    """A force that repeats with the position, such as a motor's cogging: sum of amplitude sin(waves y + phase)."""

    by_position_alone = True
    kind: Literal["ripple"] = "ripple"
    amplitude: tuple[float, ...] = quantity("N", "amplitude of a wave", rotary_unit="N m", many=True)
    waves: tuple[float, ...] = quantity("rad/m", "2 pi over a wave's length", rotary_unit="1", many=True)
    phase: tuple[float, ...] = quantity("rad", "phase of a wave at y = 0", default=0.0, many=True)

    def wrong(self) -> list[Problem]:
        """Lists of several lengths."""
        return same_length(self, "amplitude", "waves", "phase")

    def force(self, r: Value, y: Value, v: Value, x: Own = NONE) -> Value:
        """The sum of the waves."""
        return sum_of_waves(self, y)

    def shown(self, low: float, high: float) -> tuple[float, float]:
        """At most the longest of its waves."""
        return low, min(high, low + max((math.tau / abs(w) for w in self.waves if w), default=math.inf))
