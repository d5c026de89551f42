"""What a panel of a figure shows."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Panel:
    """One panel: a quantity against another, under a title of words.

    Attributes:
        y: the quantity drawn, for every solution.
        title: what it is, in words; ``also``: and what ``beside`` is.
        x: what it is drawn against.
        beside: quantities of the same unit drawn with it: a setpoint, a driving force.
        alone: draw ``beside`` only where there is one solution, as it differs from one to the other.
        near_rest: stretch the horizontal axis around 0, where it reaches far.
        log: a logarithmic vertical axis.
        settled: the vertical axis shows the second half of the time; a transient may leave it.
    """

    y: str
    title: str
    x: str = "t"
    also: str = ""
    beside: tuple[str, ...] = ()
    alone: bool = False
    near_rest: bool = False
    log: bool = False
    settled: bool = False


ENERGY = Panel("E_in", "energy put in", also=", dissipated, stored", beside=("E_dissipated", "E_stored"), alone=True)
