"""``--target c``: C99 for a drive's firmware."""

from __future__ import annotations

from stribeck.exports.c import c99
from stribeck.exports.c.ccode import pair, render
from stribeck.exports.controller import c as sampled
from stribeck.exports.controller.block import Block
from stribeck.exports.machine.model import MachineModel
from stribeck.exports.request import Content, Part, Target


def _machine(model: MachineModel) -> Content:
    """The machine with its solver, and a program that runs it."""
    values = model.context()
    return {**pair(model.name, "machine", values), f"{model.name}_run.c": render("machine_run.c", **values)}


_LAW, _BLOCK = Part(c99.files, c99.notes), Part(sampled.files, Block.notes)
TARGET = Target(
    "c", "C99 for a drive's firmware",
    {
        "law": _LAW, "body": _LAW, "observer": _LAW, "machine": Part(_machine, MachineModel.notes),
        "controller": _BLOCK, "compensator": _BLOCK,
    },
    self_test=True, loads=True,
)  # fmt: skip
