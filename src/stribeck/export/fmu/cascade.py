"""The cascade controller as an FMU: measurements in, valve voltage out, one sample a communication step."""

from __future__ import annotations

from typing import Unpack

from stribeck.export.c.cascade import INPUTS, OUTPUTS, ControllerCode
from stribeck.export.fmu.description import Description, Details, Variable, parameter
from stribeck.export.request import Request


def described(request: Request) -> tuple[Description, dict[str, object]]:
    """The FMU, and what the templates need beside."""
    cascade = ControllerCode(request)
    name, about = cascade.name, cascade.about()
    return Description(name, name, request.fmi, about, _variables(cascade), step=cascade.period), cascade.context()


def _variables(cascade: ControllerCode) -> list[Variable]:
    found = [Variable(0, "time", "s", "time", "independent", "continuous", "m->time", settable=False)]

    def add(
        name: str, unit: str, meaning: str, causality: str, variability: str, c: str, **rest: Unpack[Details]
    ) -> None:
        found.append(Variable(len(found), name, unit, meaning, causality, variability, c, **rest))

    for each in INPUTS:
        start = cascade.scenario.initial.get(each.name, 0.0)
        add(each.name, each.unit, f"measured {each.meaning}", "input", "continuous", f"m->in.{each.name}", start=start)
    known = tuple(range(1, len(found)))
    for each in OUTPUTS:
        held: Details = {"start": 0.0, "settable": False, "calculated_from": known}
        add(each.name, each.unit, each.meaning, "output", "discrete", f"m->out.{each.name}", **held)
    for each, start in cascade.states:
        add(each.name, each.unit, each.meaning, "local", "discrete", f"m->s.{each.name}", start=start)
    for group, constants in cascade.constants.items():
        for name, (constant, value) in constants.items():
            full = f"{group}.{name}"
            found.append(parameter(len(found), full, constant, f"m->p.{full}", value))
    return found
