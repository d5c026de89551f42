"""``--target newton``: joint friction for Newton, one Warp kernel."""

from __future__ import annotations

from stribeck.exports.python import warp
from stribeck.exports.request import Content, Part, Request, Target


def files(request: Request) -> Content:
    """The Python file; engines of learning compute in single precision."""
    text = warp.text(
        request.law, "float32", "newton.txt", about=request.in_docstring(), inputs=request.law.inputs, start=request.z
    )
    return {f"{request.name}_newton.py": text}


TARGET = Target("newton", "joint friction for Newton", {"law": Part(files)}, folder=False, loads=True)
