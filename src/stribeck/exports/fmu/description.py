"""The XML files of an FMU."""

from __future__ import annotations

import re
import uuid
from collections import Counter
from dataclasses import dataclass, field

from stribeck.constants import Constant
from stribeck.exports.c.ccode import render
from stribeck.version import __version__

_BASE = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "m": {"m": 1},
    "s": {"s": 1},
    "kg": {"kg": 1},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "W": {"kg": 1, "m": 2, "s": -3},
    "A": {"A": 1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "ohm": {"kg": 1, "m": 2, "s": -3, "A": -2},
    "H": {"kg": 1, "m": 2, "s": -2, "A": -2},
    "K": {"K": 1},
    "Hz": {"s": -1},
    "rad": {"rad": 1},
}


@dataclass(frozen=True)
class Variable:
    """A variable of the FMU: its reference, what it is, and the C expression that reads and writes it."""

    reference: int
    name: str
    unit: str
    meaning: str
    causality: str
    variability: str
    c: str
    start: float | None = None
    minimum: float | None = None
    nominal: float | None = None
    derivative_of: int | None = None
    settable: bool = True
    calculated_from: tuple[int, ...] = ()

    @property
    def initial(self) -> str | None:
        """How its value at the start is known."""
        if self.causality in ("input", "independent"):
            return None
        return "exact" if self.start is not None else "calculated"


class Variables(list[Variable]):
    """The variables of an FMU, each at the place of its reference; the time is the first."""

    def __init__(self) -> None:
        self.add("time", "s", "time", "independent", "m->time", settable=False)

    def add(
        self, name: str, unit: str, meaning: str, causality: str, c: str, *, discrete: bool = False, start: float | None = None,
        nominal: float | None = None, minimum: float | None = None, derivative_of: int | None = None, settable: bool = True,
        calculated_from: tuple[int, ...] = (),
    ) -> int:  # fmt: skip
        """Add a variable and return its reference."""
        variability = "tunable" if causality == "parameter" else "discrete" if discrete else "continuous"
        self.append(
            Variable(
                len(self), name, "" if unit == "1" else unit, meaning, causality, variability, c, start, minimum, nominal,
                derivative_of, settable, calculated_from,
            )
        )  # fmt: skip
        return len(self) - 1

    def add_constant(self, name: str, constant: Constant, c: str, value: float) -> None:
        """Add a constant that may be turned between the steps."""
        least = constant.above if constant.above is not None else constant.at_least
        meaning = f"{constant.meaning}, {constant.allowed}"
        self.add(name, constant.unit, meaning, "parameter", c, start=value, minimum=least)


@dataclass(frozen=True)
class Description:
    """An FMU.

    Attributes:
        prefix: of its names in C.
        model: its model identifier.
        fmi: version of FMI, 2 or 3.
        about: lines of its header.
        variables: all of them.
        states: the continuous states among them.
        exchange: whether it supports model exchange beside co-simulation.
        events: whether it has events.
        slopes: whether it gives directional derivatives.
        t_end, step, rtol: end (s), step (s) and tolerance of its default experiment.
    """

    prefix: str
    model: str
    fmi: int
    about: list[str]
    variables: list[Variable]
    states: list[Variable] = field(default_factory=list)
    exchange: bool = False
    events: bool = False
    slopes: bool = True
    t_end: float = 1.0
    step: float | None = None
    rtol: float = 1e-6

    @property
    def derivatives(self) -> list[Variable]:
        """The rates of the states."""
        return [v for v in self.variables if v.derivative_of is not None]

    @property
    def token(self) -> str:
        """The token that an importer must present to instantiate the FMU; it is unique to the model."""
        words = [self.model, str(self.fmi), *self.about, *(v.name for v in self.variables)]
        identifier = uuid.uuid5(uuid.NAMESPACE_URL, "\n".join(words))
        return f"{{{identifier}}}" if self.fmi == 2 else str(identifier)

    def values(self) -> dict[str, object]:
        """Its values for the templates."""
        return {
            "P": self.prefix, "model": self.model, "fmi": self.fmi, "about": self.about, "variables": self.variables,
            "derivatives": self.derivatives, "states": self.states, "exchange": self.exchange, "token": self.token,
            **({"events": True} if self.events else {}),
        }  # fmt: skip


def model_description(fmu: Description) -> str:
    """modelDescription.xml."""
    outputs = [v for v in fmu.variables if v.causality == "output"]
    units = sorted({v.unit for v in fmu.variables} - {""})
    return render(
        "fmu.xml", fmi=fmu.fmi, model=fmu.model, token=fmu.token, about_lines=fmu.about, version=__version__,
        exchange=fmu.exchange, slopes=fmu.slopes, t_end=fmu.t_end, rtol=fmu.rtol, step=fmu.step, variables=fmu.variables,
        units={unit: dimensions(unit) for unit in units}, outputs=outputs, derivatives=fmu.derivatives,
        unknowns=[v for v in (*outputs, *fmu.derivatives) if v.start is None],
    )  # fmt: skip


def dimensions(unit: str) -> dict[str, int] | None:
    """A unit such as 'N s/m' or 'm/s^2' as powers of the SI's; None where a word is not known."""
    powers: Counter[str] = Counter()
    for i, part in enumerate(unit.split("/")):
        for word in part.replace("(", " ").replace(")", " ").split():
            base_unit = re.fullmatch(r"([A-Za-z]+)(?:\^(\d+))?", word)
            if word == "1":
                continue
            if not base_unit or base_unit[1] not in _BASE:
                return None
            for name, power in _BASE[base_unit[1]].items():
                powers[name] += (1 if i == 0 else -1) * power * int(base_unit[2] or 1)
    return dict(powers)
