"""The constants of a law for its equations, and the natural scales that follow from them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import SimpleNamespace

from stribeck.expressions.ops import Value

OnTerm = Callable[[str, str, tuple[Value, ...], Value], Value]


@dataclass(frozen=True)
class Scales:
    """Natural scales of a law with given constants; the default tolerances are proportional to them."""

    length: float
    speed: float
    force: float


class Constants(SimpleNamespace):
    """A law's constants by name: numbers (symbols, arrays), words, and None for an optional one that is off.

    Args:
        values: the constants.
        on_term: called with each named term of the equations (its name, its LaTeX, its arguments and value); its result
            replaces the term. Code generation collects names with it, and rendering separates definitions.
    """

    __slots__ = ("_on_term",)
    _on_term: OnTerm | None

    def __init__(self, values: Mapping[str, Value] | None = None, on_term: OnTerm | None = None) -> None:
        super().__init__(**(values or {}))
        object.__setattr__(self, "_on_term", on_term)

    def __reduce__(self) -> tuple[object, ...]:
        """Copies and pickles hold the constants only."""
        return Constants, (vars(self),)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: the constants of a law do not change; replaced() makes others")

    @property
    def numbers(self) -> dict[str, Value]:
        """The numeric constants that are on."""
        return {name: x for name, x in vars(self).items() if x is not None and not isinstance(x, str)}

    @property
    def words(self) -> dict[str, str]:
        """The choices."""
        return {name: x for name, x in vars(self).items() if isinstance(x, str)}

    def replaced(self, values: Mapping[str, Value]) -> Constants:
        """The constants with some replaced."""
        return Constants({**vars(self), **values}, self._on_term)


def observer_of(p: SimpleNamespace) -> OnTerm | None:
    """The function that is called with the terms of equations that take the constants ``p``."""
    return p._on_term if isinstance(p, Constants) else None
