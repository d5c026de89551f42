"""The interface between a machine's equations and the code generator: watched quantities, and samples of controllers."""

from __future__ import annotations

from dataclasses import dataclass

from stribeck.expressions.graph import Expr

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
