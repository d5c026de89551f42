"""What a plant is: the body that friction holds back, and what stands between it and the drive."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant
from stribeck.drives.base import FORCE, Column
from stribeck.expressions.ops import Value

Own = tuple[Value, ...]


class Plant:
    """A plant's equations: from what the drive gives and the friction force F to the motion.

    In the equations ``p`` holds the constants, ``u`` is what the drive gives (:attr:`takes`), and ``x`` the plant's own
    states in the order of ``states``, beside y and v. docs/howto/own-element.md shows a whole one.
    """

    kind: ClassVar[str]
    meaning: ClassVar[str] = ""
    takes: ClassVar[Column] = FORCE  # what a drive must give to move it
    constants: ClassVar[dict[str, Constant]] = {}
    states: ClassVar[tuple[Column, ...]] = ()
    must_start: ClassVar[tuple[str, ...]] = ()  # the states whose start the file must give; 0 elsewhere
    straight: ClassVar[str] = ""  # why it cannot turn (``rotary = true``), where it cannot

    @staticmethod
    def acceleration(p: SimpleNamespace, u: Value, F: Value, x: Own = ()) -> Value:
        """dv/dt in m/s^2."""
        raise NotImplementedError

    @staticmethod
    def rates(p: SimpleNamespace, y: Value, v: Value, u: Value, F: Value, x: Own) -> Own:
        """The time derivatives of the plant's own states."""
        return ()

    @staticmethod
    def stored_energy(p: SimpleNamespace, y: Value, v: Value, x: Own) -> Value:
        """Kinetic and potential energy, J."""
        raise NotImplementedError

    @staticmethod
    def lost_power(p: SimpleNamespace, y: Value, v: Value, u: Value, x: Own) -> Value:
        """What is dissipated beside friction, W."""
        return 0.0

    @staticmethod
    def inertia(p: SimpleNamespace) -> Value:
        """The mass in kg that the drive moves without anything between, or None."""
        return None

    @staticmethod
    def inside(p: SimpleNamespace, y: Value) -> Value | None:
        """Where the equations hold, as a condition; None: everywhere. The solver stops where they end."""
        return None

    @staticmethod
    def ended(p: SimpleNamespace, t: float, y: float, v: float) -> str | None:
        """Why the equations ended there, in words."""
        return None

    @classmethod
    def state_scales(cls, p: SimpleNamespace, length: float, speed: float, force: float) -> tuple[float, ...]:
        """Natural magnitudes of the plant's own states, for the default tolerances: by their units unless overridden."""
        known = {"m": length, "m/s": speed, "N": force}
        return tuple(known.get(state.unit, 1.0) for state in cls.states)

    @staticmethod
    def problems(p: SimpleNamespace, initial: Mapping[str, float]) -> list[tuple[str, str]]:
        """(key of [plant], text) of what is wrong with valid constants and starts taken together."""
        return []
