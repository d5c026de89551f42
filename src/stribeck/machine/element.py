"""What an element of a machine is: constants, states of its own, and equations written once, like a law's.

An element is a class. Its constants are class attributes, its equations static methods over the operations of
:mod:`stribeck.expressions.ops`; ``p`` holds the constants by name. From them come the compiled equations, the output,
the energy and the validation of the file. docs/adding-an-element.md shows a whole one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import ClassVar

from stribeck.constants import Constant
from stribeck.expressions.ops import Value
from stribeck.laws.form import Form


@dataclass(frozen=True)
class State:
    """A state of an element: its name, its unit and meaning, and where it starts."""

    name: str
    unit: str
    meaning: str
    start: float = 0.0


@dataclass(frozen=True)
class Many:
    """Constants that come as lists of equal length, such as the amplitudes of a ripple: what each number is."""

    constant: Constant

    def one(self, i: int) -> Constant:
        """The declaration of the i-th number."""
        return replace(self.constant, meaning=f"{self.constant.meaning}, number {i + 1}")


class Element:
    """The base of links, loads, motors and controllers."""

    kind: ClassVar[str] = ""
    states: ClassVar[tuple[State, ...]] = ()

    @classmethod
    def constants(cls) -> dict[str, Constant]:
        """Every constant that is a number, by name."""
        return {name: x for name, x in cls._declared().items() if isinstance(x, Constant)}

    @classmethod
    def lists(cls) -> dict[str, Many]:
        """Every constant that is a list, by name."""
        return {name: x for name, x in cls._declared().items() if isinstance(x, Many)}

    @classmethod
    def _declared(cls) -> dict[str, object]:
        names = dict.fromkeys(name for base in reversed(cls.__mro__) for name in vars(base))
        return {name: getattr(cls, name) for name in names}

    @classmethod
    def numbers(cls, form: Form) -> dict[str, Constant]:
        """The run-time constants in that form of the equations."""
        found = {n: c for n, c in cls.constants().items() if not c.optional or n in form}
        for name, count in form.counts:
            found |= {f"{name}_{i}": cls.lists()[name].one(i) for i in range(count)}
        return found

    @classmethod
    def symbolic(cls, make: Callable[[str], Value], form: Form) -> SimpleNamespace:
        """The constants made by name; optional ones that are off are None, lists are tuples."""
        made: dict[str, object] = {n: None for n, c in cls.constants().items() if c.optional and n not in form}
        made |= dict.fromkeys(cls.lists(), ())
        for name, count in form.counts:
            made[name] = tuple(make(f"{name}_{i}") for i in range(count))
        return SimpleNamespace(**made, **{n: make(n) for n, c in cls.constants().items() if n not in made})

    @classmethod
    def form_of(cls, values: dict[str, object]) -> Form:
        """The form of the equations for given values."""
        on = tuple(n for n, c in cls.constants().items() if c.optional and values.get(n) is not None)
        return Form(on, counts=tuple((n, len(x)) for n in cls.lists() if isinstance(x := values[n], list | tuple)))

    @staticmethod
    def rates(p: SimpleNamespace, *arguments: Value) -> tuple[Value, ...]:
        """The time derivatives of the element's own states, from what its force is made of."""
        return ()
