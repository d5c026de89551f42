"""``--target fmu``: the block as an FMU for co-simulation; a communication step is a sample."""

from __future__ import annotations

from stribeck.exports.controller.block import Block
from stribeck.exports.controller.c import context
from stribeck.exports.fmu.archive import packed
from stribeck.exports.fmu.description import Description, Variables


def files(block: Block) -> dict[str, str | bytes]:
    """The archive, under the name of the block."""
    description = Description(
        block.name, block.name, block.options.fmi, block.about(), variables_of(block), step=block.step or None,
    )  # fmt: skip
    return packed("block", "fmu_block", description, context(block))


def variables_of(block: Block) -> Variables:
    """Time, inputs, outputs, states and constants; the sample time is the communication step."""
    variables = Variables()
    for each in block.inputs:
        variables.add(each.name, each.unit, each.meaning, "input", f"m->in.{each.name}", start=0.0)
    known = tuple(range(1, len(variables)))
    for each in block.outputs:
        variables.add(
            each.name, each.unit, each.meaning, "output", f"m->out.{each.name}", discrete=True, start=0.0, settable=False,
            calculated_from=known,
        )  # fmt: skip
    for each in block.states:
        variables.add(
            f"state.{each.name}", each.unit, each.meaning, "local", f"m->s.{each.name}", discrete=True, start=0.0
        )
    for name, (constant, value, _) in block.constants.items():
        if name != "period":
            variables.add_constant(name, constant, f"m->p.{name}", value)
    return variables
