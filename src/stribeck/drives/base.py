"""What a drive is."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant, rotary_unit, rotary_words
from stribeck.expressions.graph import Expr, derivative
from stribeck.expressions.names import Names
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


FORCE = Column("u", "N", "force on the body")
Course = tuple[Expr, Expr, Expr, Expr]  # a desired position and its first three derivatives


def course(position: Expr, t: Expr) -> Course:
    """A desired position as a function of time, with its derivatives."""
    speed = derivative(position, t)
    acceleration = derivative(speed, t)
    return position, speed, acceleration, derivative(acceleration, t)


@dataclass(frozen=True)
class Motion:
    """What a drive may measure: the signal, the motion, the plant's own states and the drive's own, in their order.

    ``z`` is None under a law without bristles; ``p`` and ``law`` hold the constants of the plant and of the law.
    """

    r: Value
    y: Value
    v: Value
    plant: tuple[Value, ...] = ()
    own: tuple[Value, ...] = ()
    z: Value | None = None
    F: Value = 0.0
    acceleration: Value = 0.0
    p: SimpleNamespace = field(default_factory=SimpleNamespace)
    law: SimpleNamespace = field(default_factory=SimpleNamespace)


@dataclass(frozen=True)
class Action:
    """What a drive does: what the plant takes, the rates of the drive's own states, and what it adds to the output."""

    u: Value
    rates: tuple[Value, ...] = ()
    shown: dict[str, Value] = field(default_factory=dict)


@dataclass(frozen=True)
class Drive:
    """A drive's equations: the force on the body from the signal, the motion and the drive's own states.

    In the equations ``r`` is the signal and ``x`` the drive's own states in the order of ``states``. One that is more
    than a force overrides the methods that are no static ones.
    """

    kind: ClassVar[str]
    meaning: ClassVar[str]
    signal: ClassVar[Column]  # what the signal is, and its column in the output
    gives: ClassVar[Column] = FORCE  # what the plant takes
    constants: ClassVar[dict[str, Constant]] = {}
    states: ClassVar[tuple[Column, ...]] = ()
    columns: ClassVar[tuple[Column, ...]] = ()  # beside the signal and the states
    sets_velocity: ClassVar[bool] = False
    differentiates: ClassVar[bool] = False  # its equations need derivatives: evaluated through the graph only
    starts: ClassVar[dict[str, float]] = {}  # where its states begin, if not at 0
    no_energy: ClassVar[str] = ""  # why the output has no energy columns, where it has none

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

    # -- what a system asks ----------------------------------------------------------------------------------------

    @property
    def kept(self) -> tuple[Column, ...]:
        """The drive's own states, as integrated."""
        return self.states

    @property
    def tables(self) -> dict[str, dict[str, Constant]]:
        """The run-time constants by owner."""
        return {"drive": self.constants}

    @property
    def memory(self) -> tuple[str, ...]:
        """What a sampled controller remembers; none is one that is part of the differential equations."""
        return ()

    @property
    def shown(self) -> tuple[str, ...]:
        """What of its memory the output shows: the first of it."""
        return ()

    def sample(self, path: Course, m: Motion, called: Names) -> tuple[Value, dict[str, Value]]:
        """What a sampled controller puts out from then on, and its memory afterwards."""
        raise NotImplementedError

    @property
    def heading(self) -> tuple[str, ...]:
        """What it is, for the head of the generated code."""
        return (f"Drive: {self.kind}; {self.meaning}.",)

    def listed(self, motion: tuple[Column, ...], plant: tuple[Column, ...]) -> tuple[Column, ...]:
        """The columns of the output: the motion's (y, v, z, F), the drive's, and the plant's own states."""
        signal = () if self.sets_velocity else (self.signal,)
        return (*motion, *signal, *self.columns, *self.kept, *plant)

    def obeyed(self, plant: SimpleNamespace, p: SimpleNamespace) -> SimpleNamespace:
        """The plant's constants, with those of the drive's table ``p`` that the plant obeys."""
        return plant

    def act(self, p: SimpleNamespace, m: Motion, called: Names | None = None) -> Action:
        """What it does; ``p`` holds the constants of its table."""
        u = self.force(p, m.r, m.y, m.v, m.own)
        if called is not None:
            called.give(u, "u")
        return Action(u, self.rates(p, m.r, m.y, m.v, m.own))

    def scales(self, p: SimpleNamespace, length: float, force: float) -> dict[str, float]:
        """Natural magnitudes of the kept states by name."""
        return dict(zip((s.name for s in self.kept), self.state_scales(p, length, force), strict=True))
