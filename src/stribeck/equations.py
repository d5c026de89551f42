"""What the code generator and the solvers need of a system, whatever it is made of."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from stribeck.constants import Constant
from stribeck.drives.base import Column
from stribeck.expressions.graph import Expr, symbol
from stribeck.signals.pieces import STRAIGHT


@dataclass(frozen=True)
class Watch:
    """A quantity whose passing of a level is an event: \\|value\\| rises through it, or falls.

    ``events`` names what happens: where the value rises through +level, falls through +level, falls through -level
    (its magnitude rises), and rises through -level.
    """

    element: str
    value: Expr
    events: tuple[str, str, str, str]


@dataclass(frozen=True)
class Sample:
    """What a sampled controller does at its instants: the output from then on, and its memory afterwards.

    Both are expressions of the states, the signals, ``memory.NAME`` and ``noise`` (a standard normal number).
    """

    name: str
    output: Expr
    memory: dict[str, Expr]
    delayed: bool = True


class Equations(ABC):
    """What a system is to the code generator; hashable, and equal to another with the same equations."""

    piece_fields: ClassVar[tuple[str, ...]] = STRAIGHT  # the numbers that change from breakpoint to breakpoint

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
    def rates(self) -> list[Expr]:
        """The time derivatives of the states."""

    def field(self, owner: str, name: str) -> str:
        """What a run-time constant is called in the generated code."""
        return name

    def watches(self) -> list[Watch]:
        """What events are told by."""
        if all(state.name != "v" for state in self.states):
            return []
        return [Watch("", symbol("v"), ("slip", "stick", "slip", "stick"))]

    @property
    def held(self) -> tuple[str, ...]:
        """What stays from one output of a sampled controller to the next, as ``segment.NAME`` in the equations."""
        return ()

    def samples(self) -> list[Sample]:
        """What the sampled controllers do at their instants, in the order of :attr:`held`."""
        return []

    def moved_energy(self) -> Expr | None:
        """The energy that changes where a signal jumps, which then is put in (state ``E_in``)."""
        return None
