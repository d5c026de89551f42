"""A law as a Python object: shown, compared, changed, and turned into the table of a file."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import ClassVar, Self

from stribeck.constants import Constant
from stribeck.expressions.ops import Value
from stribeck.laws.form import Form
from stribeck.laws.values import Constants


class AsObject:
    """What makes a law an object of its own rather than a table of numbers."""

    name: ClassVar[str]
    p: Constants
    machine: dict[str, float]
    rotary: bool
    constants: Callable[[], dict[str, Constant]]

    @property
    def form(self) -> Form:
        """Of the equations."""
        raise NotImplementedError

    @property
    def _numbers(self) -> dict[str, Value]:
        """Every constant that is on; the machine's parameters, also those that the law does not use, first."""
        return {**self.machine, **self.p.numbers, **self.p.words}

    def __setattr__(self, name: str, value: object) -> None:
        # rotary is set last; and again by the reader of a scenario, which learns later whether it turns
        if "rotary" in vars(self) and name != "rotary":
            raise AttributeError(f"{name}: a law does not change; replace({name}=VALUE) makes another")
        object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        inside = "".join(f", {name}={x!r}" for name, x in self._numbers.items())
        return f"law({self.name!r}{inside}{', rotary=True' if self.rotary else ''})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, AsObject):
            return NotImplemented
        same = type(self) is type(other) and self.rotary == other.rotary
        return same and self._numbers == other._numbers

    def __hash__(self) -> int:
        return hash((type(self), self.rotary, *vars(self.p).items()))

    def replace(self, **constants: float | str | None) -> Self:
        """The same law with other values of some constants: ``law.replace(F_s=2.0)``; None turns an optional one off.

        Raises:
            InputError: an unknown constant or a bad value; one line for each problem.
        """
        return type(self)({**self._numbers, **constants}, self.rotary)  # type: ignore[call-arg]

    def of_motion(self, rotary: bool) -> Self:
        """The same law in a machine that turns, or in one that does not: its units are others, its numbers are not."""
        return self if self.rotary == rotary else type(self)(self._numbers, rotary)  # type: ignore[call-arg]

    def to_dict(self) -> dict[str, object]:
        """The table ``[law]`` of a scenario (``[contacts.NAME.law]`` of a machine) that describes this law."""
        table: dict[str, object] = importlib.import_module("stribeck.laws").table(self)
        return table

    def _repr_html_(self) -> str:
        """For notebooks: the equations and the constants."""
        from html import escape

        rows = importlib.import_module("stribeck.laws.render").equations(type(self), self.form)
        lines = "".join(f"<div style='margin-left:1.5em'><i>{escape(row.text)}</i></div>" for row in rows)
        declared = {name: c.of_motion(self.rotary) for name, c in self.constants().items()}
        cells = "".join(
            f"<tr><td>{escape(name)}</td><td>{x if isinstance(x, str) else f'{x:g}'}</td>"
            f"<td>{escape(declared[name].unit)}</td><td style='text-align:left'>{escape(declared[name].meaning)}</td></tr>"
            for name, x in self._numbers.items()
            if name in declared
        )
        return f"<b>{escape(self.name)}</b>{lines}<table>{cells}</table>"
