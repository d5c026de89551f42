"""Forces on a body from outside."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant
from stribeck.expressions.ops import Value, cos, sin
from stribeck.machine.element import Element, Many

Own = tuple[Value, ...]


class LoadElement(Element):
    """A force on a body that depends on its motion, on a signal, or on states of its own.

    A load of one's own overrides ``force`` (and ``rates``, with ``states``); with ``follows_signal`` its table has a
    signal. The energy that it brings counts as put in, unless it is ``conservative`` and says what it stores.
    """

    follows_signal: ClassVar[bool] = False
    conservative: ClassVar[bool] = False

    @staticmethod
    def force(p: SimpleNamespace, r: Value, y: Value, v: Value, x: Own = ()) -> Value:
        """The force on the body, N or N m; ``r`` is the signal where the load has one."""
        raise NotImplementedError

    @staticmethod
    def stored_energy(p: SimpleNamespace, y: Value) -> Value:
        """The energy that a conservative load stores, J."""
        return 0.0 * y


class Follower(LoadElement):
    """The signal is the force, times ``gain`` if given: the torque constant where a current was recorded."""

    kind, follows_signal = "signal", True
    gain = Constant("", "force by the signal", optional=True, example=1.0)

    @staticmethod
    def force(p: SimpleNamespace, r: Value, y: Value, v: Value, x: Own = ()) -> Value:
        """The signal times the gain."""
        return r if p.gain is None else p.gain * r


class Pendulum(LoadElement):
    """What gravity does to an arm: -amplitude sin(y + phase)."""

    kind, conservative = "pendulum", True
    amplitude = Constant("N", "largest force", rotary_unit="N m")
    phase = Constant("rad", "angle at y = 0, from hanging down", default=0.0)

    @staticmethod
    def force(p: SimpleNamespace, r: Value, y: Value, v: Value, x: Own = ()) -> Value:
        """-amplitude sin(y + phase)."""
        return -p.amplitude * sin(y + p.phase)

    @staticmethod
    def stored_energy(p: SimpleNamespace, y: Value) -> Value:
        """amplitude (1 - cos(y + phase))."""
        return p.amplitude * (1 - cos(y + p.phase))


class Ripple(LoadElement):
    """A force that repeats with the position, such as a motor's cogging: sum of amplitude sin(waves y + phase)."""

    kind = "ripple"
    amplitude = Many(Constant("N", "amplitude of a wave", rotary_unit="N m"))
    waves = Many(Constant("rad/m", "2 pi over a wave's length", rotary_unit="1"))
    phase = Many(Constant("rad", "phase of a wave at y = 0", default=0.0))

    @staticmethod
    def force(p: SimpleNamespace, r: Value, y: Value, v: Value, x: Own = ()) -> Value:
        """The sum of the waves."""
        return sum_of_waves(p, y)


def sum_of_waves(p: SimpleNamespace, at: Value) -> Value:
    """Sum of amplitude_k sin(waves_k at + phase_k)."""
    total = 0.0
    for amplitude, waves, phase in zip(p.amplitude, p.waves, p.phase, strict=True):
        total = total + amplitude * sin(waves * at + phase)
    return total


KINDS: dict[str, type[LoadElement]] = {load.kind: load for load in (Follower, Pendulum, Ripple)}

Load = LoadElement  # its first name, which elements of users may import
