"""The form of equations: optional constants that are on, and choices."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Form:
    """Constants that change the equations and not only their values.

    Attributes:
        on: the optional constants that are given.
        choices: (constant, word) for words other than the first.
        counts: (constant, length) for constants that are lists, as in elements of machines.
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
