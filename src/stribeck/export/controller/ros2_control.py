"""``--target ros2_control``: a package with the controller as a plugin of ros2_control."""

from __future__ import annotations

from stribeck.export.c.ccode import pair, render
from stribeck.export.controller.block import Block
from stribeck.export.controller.c import context
from stribeck.export.request import Target

TARGET = Target("ros2_control", "controller.ros2_control", "a controller plugin of ros2_control", ("controller",))


def files(block: Block) -> dict[str, str | bytes]:
    """A package: build files, the plugin's class, and the block in C."""
    words = [part.capitalize() for part in block.name.split("_") if part]
    values = context(block) | {
        "cls": "".join(words), "rate": "r_rate" in {c.name for c in block.inputs},
        "second": "r_second" in {c.name for c in block.inputs},
    }  # fmt: skip
    name = block.name
    return {
        "package.xml": render("ros2_package.xml", **values),
        "CMakeLists.txt": render("ros2_CMakeLists.txt", **values),
        "plugin.xml": render("ros2_plugin.xml", **values),
        "controllers.yaml": render("ros2_controllers.yaml", **values),
        f"{name}_controller.cpp": render("ros2_controller.cpp", **values),
        **pair(name, "block", values),
    }
