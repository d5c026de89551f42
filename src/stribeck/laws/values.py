"""The constants of a law, as its equations take them, and the magnitudes that follow from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace

from stribeck.expressions.ops import Value

OnTerm = Callable[[str, str, tuple[Value, ...], Value], Value]


@dataclass(frozen=True)
class Scales:
    """Natural magnitudes of a law with given constants; the default tolerances are proportional to them."""

    length: float
    speed: float
    force: float


class Constants(SimpleNamespace):
    """A law's constants by name: numbers (symbols, arrays), words, and None for an optional one that is off.

    Args:
        values: the constants.
        on_term: called with each named term of the equations (its name, its LaTeX, its arguments and value); its result
            replaces the term. A build of code collects names so, and rendering keeps definitions apart.
    """

    __slots__ = ("_on_term",)
    _on_term: OnTerm | None

    def __init__(self, values: Mapping[str, Value] | None = None, on_term: OnTerm | None = None) -> None:
        super().__init__(**(values or {}))
        object.__setattr__(self, "_on_term", on_term)

    def __reduce__(self) -> tuple[object, ...]:
        """Copies and pickles hold the constants alone."""
        return Constants, (vars(self),)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: the constants of a law do not change; replaced() makes others")

    @property
    def numbers(self) -> dict[str, Value]:
        """The constants that are on and no words."""
        return {name: x for name, x in vars(self).items() if x is not None and not isinstance(x, str)}

    @property
    def words(self) -> dict[str, str]:
        """The choices."""
        return {name: x for name, x in vars(self).items() if isinstance(x, str)}

    def replaced(self, values: Mapping[str, Value]) -> Constants:
        """The same with others in the place of some."""
        return Constants({**vars(self), **values}, self._on_term)


def observer_of(p: SimpleNamespace) -> OnTerm | None:
    """What is called with the terms of equations that take the constants ``p``."""
    return p._on_term if isinstance(p, Constants) else None
