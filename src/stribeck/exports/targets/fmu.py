"""``--target fmu``: functional mock-up units for FMI 2.0 and 3.0."""

from __future__ import annotations

from stribeck.exports.controller import fmu as sampled
from stribeck.exports.controller.block import Block
from stribeck.exports.fmu import archive
from stribeck.exports.machine import fmu as machine
from stribeck.exports.machine.model import MachineModel
from stribeck.exports.request import Part, Target

_LAW, _BLOCK = Part(archive.files, archive.notes), Part(sampled.files, Block.notes)
TARGET = Target(
    "fmu", "an FMU for FMI 2.0 and 3.0",
    {
        "law": _LAW, "body": _LAW, "machine": Part(machine.files, MachineModel.notes), "controller": _BLOCK,
        "compensator": _BLOCK,
    },
    folder=False, loads=True,
)  # fmt: skip
