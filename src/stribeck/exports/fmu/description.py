"""The XML files of an FMU."""

from __future__ import annotations

import re
import uuid
from collections import Counter
from dataclasses import dataclass, field
from xml.etree import ElementTree as ET

from stribeck.constants import Constant
from stribeck.errors import printable
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
    fmi, model, variables = fmu.fmi, fmu.model, fmu.variables
    key = "instantiationToken" if fmi == 3 else "guid"
    root = ET.Element("fmiModelDescription", {
        "fmiVersion": f"{fmi}.0", "modelName": model, key: fmu.token,
        "description": fmu.about[0], "version": __version__, "license": "Apache-2.0",
        "generationTool": f"stribeck {__version__}", "variableNamingConvention": "structured",
        **({"numberOfEventIndicators": "0"} if fmi == 2 else {}),
    })  # fmt: skip
    state = "FMUState" if fmi == 3 else "FMUstate"
    directional = "providesDirectionalDerivatives" if fmi == 3 else "providesDirectionalDerivative"
    common = {
        "modelIdentifier": model,
        f"canGetAndSet{state}": "true",
        f"canSerialize{state}": "true",
    }
    if fmu.exchange and fmu.slopes:
        common[directional] = "true"
        if fmi == 3:
            common["providesAdjointDerivatives"] = "true"
    for kind, more in (("ModelExchange", {}), ("CoSimulation", {"canHandleVariableCommunicationStepSize": "true"})):
        if kind == "ModelExchange" and not fmu.exchange:
            continue
        element = ET.SubElement(root, kind, common | more)
        if fmi == 2:
            ET.SubElement(ET.SubElement(element, "SourceFiles"), "File", {"name": "fmu.c"})
    _units(root, {v.unit for v in variables})
    categories = ET.SubElement(root, "LogCategories")
    ET.SubElement(categories, "Category", {"name": "logStatusError", "description": "errors"})
    default = {"startTime": "0", "stopTime": repr(fmu.t_end), "tolerance": repr(fmu.rtol)}
    step = {} if fmu.step is None else {"stepSize": repr(fmu.step)}
    ET.SubElement(root, "DefaultExperiment", default | step)
    element = ET.SubElement(root, "ModelVariables")
    for variable in variables:
        _variable(element, fmi, variable)
    _structure(ET.SubElement(root, "ModelStructure"), fmu)
    return _text(root)


def build_description(model: str) -> str:
    """buildDescription.xml of FMI 3.0."""
    root = ET.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    configuration = ET.SubElement(root, "BuildConfiguration", {"modelIdentifier": model})
    files = ET.SubElement(configuration, "SourceFileSet", {"language": "C99"})
    ET.SubElement(files, "SourceFile", {"name": "fmu.c"})
    ET.SubElement(configuration, "Library", {"name": "m"})
    return _text(root)


def _text(root: ET.Element) -> str:
    for element in root.iter():  # XML has no control characters
        element.attrib.update({name: printable(text) for name, text in element.attrib.items()})
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _units(root: ET.Element, units: set[str]) -> None:
    element = ET.SubElement(root, "UnitDefinitions")
    for unit in sorted(units - {""}):
        powers = dimensions(unit)
        each = ET.SubElement(element, "Unit", {"name": unit})
        if powers is not None:
            ET.SubElement(each, "BaseUnit", {name: str(power) for name, power in powers.items() if power})


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


def _initial(variable: Variable) -> str | None:
    if variable.causality in ("input", "independent"):
        return None
    return "exact" if variable.start is not None else "calculated"


def _real(variable: Variable) -> dict[str, str]:
    attributes = {"unit": variable.unit} if variable.unit else {}
    if variable.nominal is not None:
        attributes["nominal"] = repr(float(variable.nominal))
    if variable.minimum is not None:
        attributes["min"] = repr(float(variable.minimum))
    if variable.start is not None:
        attributes["start"] = repr(float(variable.start))
    return attributes


def _about(variable: Variable) -> dict[str, str]:
    attributes = {"name": variable.name, "valueReference": str(variable.reference), "description": variable.meaning}
    attributes |= {"causality": variable.causality, "variability": variable.variability}
    if initial := _initial(variable):
        attributes["initial"] = initial
    return attributes


def _variable(root: ET.Element, fmi: int, variable: Variable) -> None:
    about, real = _about(variable), _real(variable)
    if variable.derivative_of is not None:
        real["derivative"] = str(variable.derivative_of + (fmi == 2))  # FMI 2 counts from 1
    if fmi == 3:
        ET.SubElement(root, "Float64", about | real)
    else:
        ET.SubElement(ET.SubElement(root, "ScalarVariable", about), "Real", real)


def _structure(root: ET.Element, fmu: Description) -> None:
    """Outputs, derivatives of states, and what is unknown at the start; FMI 2 lists each kind apart and counts from 1."""
    outputs, derivatives = [v for v in fmu.variables if v.causality == "output"], fmu.derivatives
    unknowns = [v for v in (*outputs, *derivatives) if v.start is None]
    tags = {"Output": "Outputs", "ContinuousStateDerivative": "Derivatives", "InitialUnknown": "InitialUnknowns"}
    for (tag, listed), rows in zip(tags.items(), (outputs, derivatives, unknowns), strict=True):
        parent = ET.SubElement(root, listed) if fmu.fmi == 2 and rows else root
        for variable in rows:
            attributes = {"index" if fmu.fmi == 2 else "valueReference": str(variable.reference + (fmu.fmi == 2))}
            if tag != "InitialUnknown":
                depends_on = variable.calculated_from or (variable.reference,)
                attributes["dependencies"] = " ".join(str(r + (fmu.fmi == 2)) for r in depends_on)
            ET.SubElement(parent, "Unknown" if fmu.fmi == 2 else tag, attributes)
