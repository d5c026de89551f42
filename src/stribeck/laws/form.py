"""The form of equations: which optional constants are on, and which words are chosen."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Form:
    """What of the constants changes the equations and not only their numbers.

    Attributes:
        on: the optional constants that are given.
        choices: (constant, word) for words other than the first.
        counts: (constant, how many) for constants that are lists; elements of machines have such.
    """

    on: tuple[str, ...] = ()
    choices: tuple[tuple[str, str], ...] = ()
    counts: tuple[tuple[str, int], ...] = ()

    def __contains__(self, name: object) -> bool:
        """Whether an optional constant is on."""
        return name in self.on

    @property
    def words(self) -> tuple[str, ...]:
        """For people: ``("v_d", "smooth_abs=sqrt")``."""
        return (*self.on, *(f"{name}={word}" for name, word in self.choices), *(f"{n}*{k}" for n, k in self.counts))


USUAL = Form()
