"""The interface between a system's equations and the code generator and solvers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from stribeck.arrays import Array
from stribeck.constants import Column, Constant
from stribeck.expressions.graph import Expr, symbol
from stribeck.expressions.names import Names
from stribeck.waveforms.pieces import STRAIGHT

Events = tuple[str, str, str, str]
Watched = tuple[str, Events]
SLIP_AND_STICK: Events = ("slip", "stick", "slip", "stick")


@dataclass(frozen=True)
class Watch:
    """A quantity that causes an event when its magnitude passes a level.

    ``events`` are the events' names when the value rises through +level, falls through +level, falls through -level (its
    magnitude rises), and rises through -level.
    """

    element: str
    value: Expr
    events: Events


@dataclass(frozen=True)
class Sample:
    """A sampled controller at its instants: its output from then on, and its memory afterwards.

    Both are expressions of the states, the signals, ``memory.NAME`` and ``noise`` (a standard normal number).
    """

    name: str
    timing: str  # the table with its period and delay
    output: Expr
    memory: dict[str, Expr]


class Equations(ABC):
    """A system for the code generator; hashable, and equal to another with the same equations."""

    piece_fields: ClassVar[tuple[str, ...]] = STRAIGHT  # the numbers that change at each breakpoint of the signals

    @property
    def by_element(self) -> bool:
        """Whether events are reported by the element's name, which a single body does not have."""
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
        """Owner and name of each run-time constant."""

    @property
    @abstractmethod
    def heading(self) -> tuple[str, ...]:
        """A description of the system in a few lines."""

    @abstractmethod
    def constant(self, owner: str, name: str) -> Constant:
        """The declaration of a run-time constant."""

    @abstractmethod
    def rates(self, called: Names | None = None) -> list[Expr]:
        """The time derivatives of the states. Here and below, names of intermediate results are added to ``called``."""

    def field(self, owner: str, name: str) -> str:
        """The name of a run-time constant in the generated code."""
        return name

    @property
    def watched(self) -> tuple[Watched, ...]:
        """Element and events of each watched quantity (see :class:`Watch`)."""
        return (("", SLIP_AND_STICK),) if any(state.name == "v" for state in self.states) else ()

    def watches(self, called: Names | None = None) -> list[Watch]:
        """The watched quantities, in the same order."""
        return [Watch(name, symbol("v"), events) for name, events in self.watched]

    def forces(self, called: Names | None = None) -> list[Expr]:
        """The friction forces, whose promised accuracy the solver ensures."""
        return []

    @property
    def memory(self) -> dict[str, tuple[str, ...]]:
        """Names of the stored values of each sampled controller, by its name."""
        return {}

    @property
    def held(self) -> tuple[str, ...]:
        """Names of the outputs that sampled controllers hold, ``segment.NAME`` in the equations."""
        return ()

    @property
    def shown(self) -> tuple[str, ...]:
        """Names of the controllers' stored values that are columns, ``memory.NAME`` in the equations; they come first."""
        return ()

    def samples(self, called: Names | None = None) -> list[Sample]:
        """The sampled controllers at their instants, in the order of :attr:`held`."""
        return []

    def ended(self, values: Mapping[tuple[str, str], float], t: float, x: Array) -> str | None:
        """Why the equations end in the state x, if they do."""
        return None

    def moved_energy(self) -> Expr | None:
        """The energy that changes when a signal jumps, whose change is added to the state ``E_in``."""
        return None
