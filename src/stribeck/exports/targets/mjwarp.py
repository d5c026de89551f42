"""``--target mjwarp``: joint friction for MuJoCo Warp, a callback with one Warp kernel."""

from __future__ import annotations

from stribeck.exports.python import warp
from stribeck.exports.request import Content, Part, Request, Target


def files(request: Request) -> Content:
    """The Python file; engines of learning compute in single precision."""
    text = warp.text(
        request.law, "float32", "mjwarp.txt", about=request.in_docstring(), inputs=request.law.inputs, start=request.z
    )
    return {f"{request.name}_mjwarp.py": text}


TARGET = Target("mjwarp", "joint friction for MuJoCo Warp", {"law": Part(files)}, folder=False, loads=True)
