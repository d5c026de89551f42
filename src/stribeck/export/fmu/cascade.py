"""The cascade controller as an FMU: measurements in, valve voltage out, one sample a communication step."""

from __future__ import annotations

from typing import Any

from stribeck.export.c.cascade import INPUTS, OUTPUTS, ControllerCode
from stribeck.export.fmu.description import Variable, parameter, token
from stribeck.export.request import Request


def context(request: Request) -> dict[str, Any]:
    """What the templates of the C and of the description need."""
    cascade = ControllerCode(request)
    values, variables = cascade.context(), _variables(cascade)
    about, model = cascade.about(), cascade.name
    return values | {
        "fmi": request.fmi, "model": model, "variables": variables, "derivatives": [], "exchange": False, "states": [],
        "token": token(model, request.fmi, about, variables),
    }  # fmt: skip


def _variables(cascade: ControllerCode) -> list[Variable]:
    found = [Variable(0, "time", "s", "time", "independent", "continuous", "m->time", settable=False)]

    def add(name: str, unit: str, meaning: str, causality: str, variability: str, c: str, **rest: Any) -> None:
        found.append(Variable(len(found), name, unit, meaning, causality, variability, c, **rest))

    for each in INPUTS:
        start = cascade.scenario.initial.get(each.name, 0.0)
        add(each.name, each.unit, f"measured {each.meaning}", "input", "continuous", f"m->in.{each.name}", start=start)
    known = tuple(range(1, len(found)))
    for each in OUTPUTS:
        held = {"start": 0.0, "settable": False, "calculated_from": known}
        add(each.name, each.unit, each.meaning, "output", "discrete", f"m->out.{each.name}", **held)
    for each, start in cascade.states:
        add(each.name, each.unit, each.meaning, "local", "discrete", f"m->s.{each.name}", start=start)
    for group, constants in cascade.constants.items():
        for name, (constant, value) in constants.items():
            full = f"{group}.{name}"
            found.append(parameter(len(found), full, constant, f"m->p.{full}", value))
    return found
