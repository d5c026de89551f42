"""``--target mujoco_plugin``: the controller as an actuator plugin of MuJoCo, in C."""

from __future__ import annotations

import math

from stribeck.exports.c.ccode import pair, render
from stribeck.exports.controller.block import Block
from stribeck.exports.controller.c import context
from stribeck.exports.request import Content, Part, Target


def files(block: Block) -> Content:
    """The block in C, the plugin around it, and a model that uses it."""
    machine, sampling = block.scenario.elements, f"{block.controller.path}.sampling"
    delay = machine.values.get((sampling, "delay"), 0.0)
    heavy = machine.leader(block.controller.body).heavy
    values = context(block) | {
        "delay": delay, "resolution": machine.values.get((sampling, "resolution"), 0.0),
        "joint": "hinge" if block.rotary else "slide",
        "queue": math.ceil(delay / block.step) + 2, "mass": 1.0 if heavy is None else heavy,
        "rate": "r_rate" in {c.name for c in block.inputs}, "second": "r_second" in {c.name for c in block.inputs},
    }  # fmt: skip
    return {
        f"{block.name}_mujoco.c": render("mujoco_plugin.c", **values),
        **pair(block.name, "block", values),
        f"{block.name}.xml": render("mujoco_plugin.xml", **values),
    }


def notes(block: Block) -> list[str]:
    """Notes about differences from the file: the plugin's encoder has no noise."""
    return block.notes(carried=("delay", "resolution"))


TARGET = Target("mujoco_plugin", "an actuator plugin of MuJoCo, in C", {"controller": Part(files, notes)})
