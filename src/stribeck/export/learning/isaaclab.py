"""``--target isaaclab``: an explicit actuator with joint friction for IsaacLab, in PyTorch."""

from __future__ import annotations

import inspect
import re

from stribeck.export.c.ccode import render
from stribeck.export.learning.common import header
from stribeck.export.python import stepping
from stribeck.export.python.written import Written
from stribeck.export.request import Request, Target

_ANNOTATIONS = re.compile(
    r": (ModuleType|Value|Callable\[\.\.\., Value\])(?=[,)\n])| -> [\w\[\]., ]+(?=:$)", re.MULTILINE
)
TARGET = Target("isaaclab", "learning.isaaclab", "an actuator for IsaacLab", folder=False, loads=True)


def files(request: Request) -> dict[str, str]:
    """The Python file; its step is the text of :mod:`stribeck.export.python.stepping`."""
    parts = (stepping.loop, stepping.settled, stepping.balance, stepping.solved)
    text = _ANNOTATIONS.sub("", "\n\n".join(inspect.getsource(part) for part in parts).rstrip())
    text = text.replace("xp, ", "").replace("xp.", "torch.")
    content = render(
        "isaaclab.txt", about=header(request), eq=Written(request.law), stepping=text, inputs=request.law.inputs
    )
    return {f"{request.name}_isaaclab.py": content}
