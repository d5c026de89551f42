"""What the code generator and the solvers need of a system, whatever it is made of."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from stribeck.arrays import Array
from stribeck.constants import Column, Constant
from stribeck.expressions.graph import Expr, symbol
from stribeck.expressions.names import Names
from stribeck.signals.pieces import STRAIGHT

Events = tuple[str, str, str, str]
Watched = tuple[str, Events]
SLIP_AND_STICK: Events = ("slip", "stick", "slip", "stick")


@dataclass(frozen=True)
class Watch:
    """A quantity whose passing of a level is an event: \\|value\\| rises through it, or falls.

    ``events`` names what happens: where the value rises through +level, falls through +level, falls through -level
    (its magnitude rises), and rises through -level.
    """

    element: str
    value: Expr
    events: Events


@dataclass(frozen=True)
class Sample:
    """What a sampled controller does at its instants: the output from then on, and its memory afterwards.

    Both are expressions of the states, the signals, ``memory.NAME`` and ``noise`` (a standard normal number).
    """

    name: str
    timing: str  # the table that has its period and delay
    output: Expr
    memory: dict[str, Expr]


class Equations(ABC):
    """What a system is to the code generator; hashable, and equal to another with the same equations."""

    piece_fields: ClassVar[tuple[str, ...]] = STRAIGHT  # the numbers that change from breakpoint to breakpoint

    @property
    def by_element(self) -> bool:
        """Whether events are told by the element's name; a single body has none."""
        return True

    @property
    @abstractmethod
    def states(self) -> tuple[Column, ...]:
        """The states in the order in which they are integrated."""

    @property
    @abstractmethod
    def columns(self) -> tuple[Column, ...]:
        """The columns of the output after t."""

    @property
    @abstractmethod
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """(group, name) of each run-time constant."""

    @property
    @abstractmethod
    def heading(self) -> tuple[str, ...]:
        """What the system is, in a few lines."""

    @abstractmethod
    def constant(self, owner: str, name: str) -> Constant:
        """The declaration of a run-time constant."""

    @abstractmethod
    def rates(self, called: Names | None = None) -> list[Expr]:
        """The time derivatives of the states; ``called`` takes the names of intermediate results, here and below."""

    def field(self, owner: str, name: str) -> str:
        """What a run-time constant is called in the generated code."""
        return name

    @property
    def watched(self) -> tuple[Watched, ...]:
        """What events are told by: the element's name, and what happens (see :class:`Watch`)."""
        return (("", SLIP_AND_STICK),) if any(state.name == "v" for state in self.states) else ()

    def watches(self, called: Names | None = None) -> list[Watch]:
        """The same with the quantities."""
        return [Watch(name, symbol("v"), events) for name, events in self.watched]

    def forces(self, called: Names | None = None) -> list[Expr]:
        """The friction forces: their accuracy is promised, and so looked after by the solver."""
        return []

    @property
    def memory(self) -> dict[str, tuple[str, ...]]:
        """What each sampled controller remembers, by its name."""
        return {}

    @property
    def held(self) -> tuple[str, ...]:
        """What stays from one output of a sampled controller to the next, as ``segment.NAME`` in the equations."""
        return ()

    @property
    def shown(self) -> tuple[str, ...]:
        """What of the controllers' memory the output shows, as ``memory.NAME``: the first of it."""
        return ()

    def samples(self, called: Names | None = None) -> list[Sample]:
        """What the sampled controllers do at their instants, in the order of :attr:`held`."""
        return []

    def ended(self, values: Mapping[tuple[str, str], float], t: float, x: Array) -> str | None:
        """Why the equations end in the state x, where they say so."""
        return None

    def moved_energy(self) -> Expr | None:
        """The energy that changes where a signal jumps, which then is put in (state ``E_in``)."""
        return None
