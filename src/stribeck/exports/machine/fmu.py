"""``--part machine --target fmu``: the machine as an FMU for model exchange, and for co-simulation with its solver."""

from __future__ import annotations

import re

from stribeck.exports.fmu.archive import packed
from stribeck.exports.fmu.description import Description, Variables
from stribeck.exports.machine.model import MachineModel


def files(model: MachineModel) -> dict[str, str | bytes]:
    """The archive, under the name of the model."""
    variables = variables_of(model)
    states = [v for v in variables if v.nominal is not None]
    scenario = model.scenario
    description = Description(
        model.name, model.name, model.options.fmi, model.about(), variables, states, exchange=True, events=True, slopes=False,
        t_end=float(scenario.end), step=float(scenario.output.step),
        rtol=float(scenario.solve.rtol),
    )  # fmt: skip
    return packed("machine", "fmu_machine", description, model.context())


def variables_of(model: MachineModel) -> Variables:
    """Time, an input for each signal, the states and their rates, the columns of the output, and every constant."""
    variables = Variables()
    for place, each in model.inputs.items():
        variables.add(_structured(each.name), each.unit, each.meaning, "input", f"m->s.constants[{place}]", start=0.0)
    states, first, nominal = model.machine.states, len(variables), model.scenario.elements.natural
    shown = {column.name: column for column in model.columns}
    for i, state in enumerate(states):
        column = shown.get(state.name, state)
        role = "output" if state.name in shown else "local"
        variables.add(
            _structured(state.name), column.unit, column.meaning, role, f"m->s.x[{i}]", start=model.start[state.name],
            nominal=nominal[state.name],
        )  # fmt: skip
    known = tuple(range(1, len(variables))) or (0,)
    for i, state in enumerate(states):
        name = _structured(f"der({state.name})")
        variables.add(
            name, _rate(state.unit), f"rate of {state.name}", "local", f"m->rate[{i}]", derivative_of=first + i,
            settable=False, calculated_from=known,
        )  # fmt: skip
    for i, column in enumerate(model.columns):
        if column.name not in model.start:
            name = _structured(column.name)
            variables.add(
                name, column.unit, column.meaning, "output", f"m->o[{i}]", settable=False, calculated_from=known
            )
    for i, constant in enumerate(model.parameters):
        if i not in model.inputs:
            name = _structured(constant.path)
            variables.add_constant(name, constant.constant, f"m->s.constants[{i}]", constant.value)
    return variables


def _structured(name: str) -> str:
    """A path as FMI's structured names want it: an entry of a list is an index, counted from 1."""
    return re.sub(r"\.(\d+)(?=\.|$)", lambda index: f"[{int(index[1]) + 1}]", name)


def _rate(unit: str) -> str:
    """The unit of a rate."""
    return {"": "", "1": "1/s", "m/s": "m/s^2", "rad/s": "rad/s^2", "J": "J/s"}.get(unit, f"{unit}/s")
