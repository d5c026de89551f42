"""Declarations of constants: unit, meaning and allowed range, written once for laws, elements and signals.

Validation, the JSON Schema, the listings and the documentation use these declarations.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from numbers import Real
from pathlib import Path

from stribeck.errors import InputError, arg, nearest


@dataclass(frozen=True)
class Constant:
    """A number that an equation uses, or a word that selects its form.

    ``above`` is an exclusive bound and ``at_least`` an inclusive one. A constant with a ``default`` may be left out. An
    ``optional`` one is off (None) unless given, and the equation then has another form. A constant with ``choices`` is one
    of these words, the first unless given. The magnitude is at most ``largest`` and at least its inverse, if that is given.
    """

    unit: str
    meaning: str
    above: float | None = None
    at_least: float | None = None
    default: float | None = None
    optional: bool = False
    rotary_unit: str | None = None
    example: float | None = None  # a realistic value, for documentation and tests
    choices: tuple[str, ...] = ()
    largest: float | None = None

    def of_motion(self, rotary: bool) -> Constant:
        """The declaration with unit and words for a linear or a rotary machine."""
        return replace(self, unit=self.unit_for(True), meaning=rotary_words(self.meaning)) if rotary else self

    def unit_for(self, rotary: bool) -> str:
        """The unit, for a linear or a rotary machine."""
        return (self.rotary_unit or rotary_unit(self.unit)) if rotary else self.unit

    @property
    def allowed(self) -> str:
        """The allowed values, in words."""
        if self.choices:
            return f"one of {', '.join(self.choices)}"
        if self.above is not None:
            return f"a finite number > {self.above:g}"
        return "a finite number" if self.at_least is None else f"a finite number >= {self.at_least:g}"

    @property
    def allowed_node(self) -> dict[str, object]:
        """The allowed values as a node of a JSON Schema."""
        if self.choices:
            return {"enum": list(self.choices)}
        bounds = {"exclusiveMinimum": self.above, "minimum": self.at_least}
        return {"type": "number", **{key: x for key, x in bounds.items() if x is not None}}

    @property
    def required(self) -> bool:
        """Whether a value must be given."""
        return self.default is None and not self.optional and not self.choices

    def problem(self, value: object) -> str | None:
        """The mistake in a value, in words; None if it is valid."""
        if self.choices:
            if isinstance(value, str):
                return None if value in self.choices else f"must be {self.allowed}{nearest(value, self.choices)}"
            return f"must be {self.allowed}, not {kind_of(value)}"
        if isinstance(value, bool) or not isinstance(value, Real):
            return f"must be {self.allowed}, not {kind_of(value)}"
        try:
            number = float(value)
        except OverflowError:
            number = math.inf
        ok = math.isfinite(number)
        ok = ok and (self.above is None or number > self.above)
        ok = ok and (self.at_least is None or number >= self.at_least)
        if not ok:
            return f"must be {self.allowed}"
        if self.largest is None or 1 / self.largest <= abs(number) <= self.largest:
            return None
        return f"must be a finite number from {1 / self.largest:g} to {self.largest:g}, or the negative of one"


POSITIVE = Constant("", "", above=0)


def which_controller(given: str | None, known: Sequence[str]) -> str:
    """The name of the chosen controller of a machine: the only one unless it is given.

    Raises:
        InputError: if there are several and none is given, or none has that name.
    """
    if given is None and len(known) > 1:
        raise InputError(f"{arg('controller')}: missing: must be given (one of {', '.join(known)})")
    if given is not None and given not in known:
        guess = nearest(given, known) or f" (there is {', '.join(known)})"
        raise InputError(f"{arg('controller')}: {show(given)}: no such controller{guess}")
    return given or known[0]


def require_positive(name: str, value: object, unit: str = "") -> None:
    """Check that an argument is a finite number > 0.

    Raises:
        InputError: if it is not.
    """
    if text := POSITIVE.problem(value):
        raise InputError(f"{arg(name)}: {show(value)}: {text}{f', in {unit}' if unit else ''}")


_ROTARY = {
    "m": "rad", "m/s": "rad/s", "m/s^2": "rad/s^2", "m/s^3": "rad/s^3", "m s": "rad s", "N": "N m", "N/s": "N m/s",
    "N/m": "N m/rad", "N s/m": "N m s/rad", "N s^2/m^2": "N m s^2/rad^2",
    "N/(m s)": "N m/(rad s)", "s/m": "s/rad", "kg": "kg m^2", "1/m": "1/rad",
}  # fmt: skip


def rotary_unit(unit: str) -> str:
    """The unit of a rotary machine for that of a linear one: N m for N, rad for m, kg m^2 for kg."""
    return _ROTARY.get(unit, unit)


_ROTARY_WORDS = {
    "position": "angle", "velocity": "angular velocity", "force": "torque", "displacement": "angle", "speed": "angular speed",
    "mass": "moment of inertia",
}  # fmt: skip


def rotary_words(text: str) -> str:
    """A text with the words of a rotary machine for those of a linear one: torque for force, angle for position."""
    return re.sub(rf"\b({'|'.join(_ROTARY_WORDS)})\b", lambda match: _ROTARY_WORDS[match[1]], text)


DECIDED = {True: "yes", False: "no", None: "undecided"}  # a verdict in one word


def path_of(given: object, name: str) -> Path:
    """The path that an argument of this name is.

    Raises:
        InputError: it is no text and no path.
    """
    if not isinstance(given, str | os.PathLike):
        raise InputError(f"{arg(name)}: {show(given)}: must be a path, not {kind_of(given)}")
    return Path(given)


def kind_of(value: object) -> str:
    """The type of a value in a file, in plain words."""
    names = {bool: "a true/false value", str: "text", list: "a list", dict: "a table", type(None): "nothing"}
    if isinstance(value, Real) and not isinstance(value, bool):
        return "a number"
    return names.get(type(value), f"a {type(value).__name__}")


def show(value: object) -> str:
    """A value as text for a message of one line."""
    if isinstance(value, str):
        text = repr(value)
    elif isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, list | tuple):
        inside = ", ".join(show(x) for x in value) if len(value) <= 4 else ""
        text = f"[{inside}]" if len(inside) <= 40 and len(value) <= 4 else f"a list of {len(value)}"
    elif isinstance(value, dict):
        text = f"a table with {', '.join(map(str, value))}" if value else "an empty table"
    elif isinstance(value, int) and abs(value) >= 10**20:
        text = f"a whole number of {math.floor(math.log10(abs(value))) + 1} digits"
    else:
        text = str(value)
    return text if len(text) <= 80 else f"{text[:77]}..."


@dataclass(frozen=True)
class Column:
    """A column of the output: its name, unit and meaning."""

    name: str
    unit: str
    meaning: str

    def of_motion(self, rotary: bool) -> Column:
        """The column with unit and words for a linear or a rotary machine: torque in N m for force in N."""
        return Column(self.name, rotary_unit(self.unit), rotary_words(self.meaning)) if rotary else self
