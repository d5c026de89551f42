"""``--target fmu``: the block as an FMU for co-simulation; a communication step is a sample."""

from __future__ import annotations

from typing import Unpack

from stribeck.exports.controller.block import Block
from stribeck.exports.controller.c import context
from stribeck.exports.fmu.archive import packed
from stribeck.exports.fmu.description import Description, Details, Variable, parameter


def files(block: Block) -> dict[str, str | bytes]:
    """The archive, under the name of the block."""
    description = Description(
        block.name, block.name, block.options.fmi, block.about(), variables_of(block), step=block.step or None,
        everywhere=block.options.everywhere,
    )  # fmt: skip
    return packed("block", "fmu_block", description, context(block))


def variables_of(block: Block) -> list[Variable]:
    """Time, inputs, outputs, states and constants; the sample time is the communication step."""
    variables = [Variable(0, "time", "s", "time", "independent", "continuous", "m->time", settable=False)]

    def add(
        name: str, unit: str, meaning: str, causality: str, variability: str, c: str, **rest: Unpack[Details]
    ) -> None:
        unit = "" if unit == "1" else unit
        variables.append(Variable(len(variables), name, unit, meaning, causality, variability, c, **rest))

    for each in block.inputs:
        add(each.name, each.unit, each.meaning, "input", "continuous", f"m->in.{each.name}", start=0.0)
    known = tuple(range(1, len(variables)))
    for each in block.outputs:
        held: Details = {"start": 0.0, "settable": False, "calculated_from": known}
        add(each.name, each.unit, each.meaning, "output", "discrete", f"m->out.{each.name}", **held)
    for each in block.states:
        add(f"state.{each.name}", each.unit, each.meaning, "local", "discrete", f"m->s.{each.name}", start=0.0)
    for name, (constant, value, _) in block.constants.items():
        if name != "period":
            variables.append(parameter(len(variables), name, constant, f"m->p.{name}", value))
    return variables
