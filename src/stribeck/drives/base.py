"""What a drive is."""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant, rotary_unit, rotary_words
from stribeck.expressions.ops import Value


@dataclass(frozen=True)
class Column:
    """A column of the output: its name, unit and meaning."""

    name: str
    unit: str
    meaning: str

    def of_motion(self, rotary: bool) -> Column:
        """The column as a linear or a rotary machine has it: torque in N m for force in N."""
        return Column(self.name, rotary_unit(self.unit), rotary_words(self.meaning)) if rotary else self


class Drive:
    """A drive's equations: the force on the body from the signal, the motion and the drive's own states.

    In the equations ``r`` is the signal and ``x`` the drive's own states in the order of ``states``.
    """

    kind: ClassVar[str]
    meaning: ClassVar[str]
    signal: ClassVar[Column]  # what the signal is, and its column in the output
    constants: ClassVar[dict[str, Constant]] = {}
    states: ClassVar[tuple[Column, ...]] = ()
    columns: ClassVar[tuple[Column, ...]] = ()  # beside the signal and the states
    sets_velocity: ClassVar[bool] = False

    @staticmethod
    def force(p: SimpleNamespace, r: Value, y: Value, v: Value, x: tuple[Value, ...]) -> Value:
        """The force on the body, N."""
        raise NotImplementedError

    @staticmethod
    def rates(p: SimpleNamespace, r: Value, y: Value, v: Value, x: tuple[Value, ...]) -> tuple[Value, ...]:
        """The time derivatives of the drive's own states."""
        return ()

    @staticmethod
    def state_scales(p: SimpleNamespace, length: float, force: float) -> tuple[float, ...]:
        """Natural magnitudes of the drive's own states, for the default tolerances."""
        return ()
