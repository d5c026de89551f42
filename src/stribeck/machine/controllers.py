"""Controllers: from a signal and what is measured to a force, or to the torque that a motor is asked for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant
from stribeck.drives.pid import Pid
from stribeck.expressions.ops import Value
from stribeck.laws.form import Form
from stribeck.machine.element import Element, State
from stribeck.signals.pieces import Reference

Own = tuple[Value, ...]


class ControllerElement(Element):
    """A controller: its unlimited output from the reference, the measured motion and its own states.

    A controller of one's own overrides ``output`` (and ``rates``, with ``states``). The limit, the stop of its integrals
    at the limit, the feedforward, the friction compensation and the sampling are common to all.
    """

    integrals: ClassVar[tuple[str, ...]] = ()  # the states that stop where the limit is exceeded
    limit = Constant("N", "limit of the output", above=0, optional=True, rotary_unit="N m")

    @classmethod
    def states_of(cls, form: Form) -> tuple[State, ...]:
        """The states in that form of the equations."""
        return cls.states

    @staticmethod
    def output(p: SimpleNamespace, r: Reference, y: Value, v: Value, x: Own) -> Value:
        """The output without its limit, N or N m."""
        raise NotImplementedError

    @staticmethod
    def state_scales(p: SimpleNamespace, length: float, force: float) -> tuple[float, ...]:
        """Natural magnitudes of the controller's own states, for the default tolerances."""
        return ()


class PidController(ControllerElement):
    """u = -K_p (y - r) - K_i I - K_d v, dI/dt = y - r."""

    kind = "pid"
    K_p = Constant("N/m", "proportional gain", rotary_unit="N m/rad")
    K_i = Constant("N/(m s)", "integral gain", default=0.0, rotary_unit="N m/(rad s)")
    K_d = Constant("N s/m", "derivative gain", default=0.0, rotary_unit="N m s/rad")
    states = (State("I", "m s", "integral of y - r"),)
    integrals = ("I",)

    @staticmethod
    def output(p: SimpleNamespace, r: Reference, y: Value, v: Value, x: Own) -> Value:
        """-K_p (y - r) - K_i I - K_d v."""
        return Pid.force(p, r.value, y, v, x)

    @staticmethod
    def rates(p: SimpleNamespace, r: Reference, y: Value, v: Value, x: Own) -> tuple[Value, ...]:
        """dI/dt."""
        return Pid.rates(p, r.value, y, v, x)

    @staticmethod
    def state_scales(p: SimpleNamespace, length: float, force: float) -> tuple[float, ...]:
        """The integral that makes the friction force, or a length for a second."""
        return (force / abs(p.K_i) if p.K_i else length,)


class Cascade(ControllerElement):
    """Position over speed: v_r = K_p (r - y) + dr/dt, u = K_v (v_r - v) + (K_v/T_i) I, dI/dt = v_r - v."""

    kind = "cascade"
    K_p = Constant("1/s", "gain of the position loop")
    K_v = Constant("N s/m", "gain of the speed loop", rotary_unit="N m s/rad")
    T_i = Constant("s", "integral time of the speed loop", above=0, optional=True)
    states = (State("I", "m", "integral of the speed's error"),)
    integrals = ("I",)

    @classmethod
    def states_of(cls, form: Form) -> tuple[State, ...]:
        """Without T_i there is no integral."""
        return cls.states if "T_i" in form else ()

    @staticmethod
    def _error(p: SimpleNamespace, r: Reference, y: Value, v: Value) -> Value:
        return p.K_p * (r.value - y) + r.rate - v

    @classmethod
    def output(cls, p: SimpleNamespace, r: Reference, y: Value, v: Value, x: Own) -> Value:
        """K_v (v_r - v) + (K_v/T_i) I."""
        u = p.K_v * cls._error(p, r, y, v)
        return u if p.T_i is None else u + p.K_v / p.T_i * x[0]

    @classmethod
    def rates(cls, p: SimpleNamespace, r: Reference, y: Value, v: Value, x: Own) -> tuple[Value, ...]:
        """dI/dt."""
        return () if p.T_i is None else (cls._error(p, r, y, v),)

    @staticmethod
    def state_scales(p: SimpleNamespace, length: float, force: float) -> tuple[float, ...]:
        """The integral that makes the friction force, or a length."""
        return () if p.T_i is None else (force * p.T_i / abs(p.K_v) if p.K_v else length,)


KINDS: dict[str, type[ControllerElement]] = {controller.kind: controller for controller in (PidController, Cascade)}

Controller = ControllerElement  # its first name, which elements of users may import
