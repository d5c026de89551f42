"""``--target isaaclab``: an explicit actuator with joint friction for IsaacLab, in PyTorch."""

from __future__ import annotations

import inspect

from stribeck.exports.c.ccode import render
from stribeck.exports.python import stepping
from stribeck.exports.python.written import Written
from stribeck.exports.request import Content, Part, Request, Target


def files(request: Request) -> Content:
    """The Python file; its step is the text of :mod:`stribeck.exports.python.stepping`."""
    parts = (stepping.loop, stepping.settled, stepping.balance, stepping.solved)
    text = "\n\n".join(inspect.getsource(part) for part in parts).rstrip()
    content = render(
        "isaaclab.txt", about=request.in_docstring(), name=request.name, module=request.module, eq=Written(request.law),
        stepping=text, inputs=request.law.inputs, start=request.z,
    )  # fmt: skip
    return {f"{request.name}_isaaclab.py": content}


TARGET = Target("isaaclab", "an actuator for IsaacLab", {"law": Part(files)}, folder=False, loads=True)
