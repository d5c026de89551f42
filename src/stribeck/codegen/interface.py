"""What the code generator and the solvers need of a system, whatever it is made of."""

from __future__ import annotations

from typing import Protocol

from stribeck.constants import Constant
from stribeck.drives.base import Column
from stribeck.expressions.graph import Expr


class Equations(Protocol):
    """What a system is to the code generator; hashable, and equal to another with the same equations."""

    @property
    def states(self) -> tuple[Column, ...]:
        """The states in the order in which they are integrated."""
        ...

    @property
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """(group, name) of each run-time constant."""
        ...

    @property
    def heading(self) -> tuple[str, ...]:
        """What the system is, in a few lines."""
        ...

    def constant(self, owner: str, name: str) -> Constant:
        """The declaration of a run-time constant."""
        ...

    def rates(self) -> list[Expr]:
        """The time derivatives of the states."""
        ...
