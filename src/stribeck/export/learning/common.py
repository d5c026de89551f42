"""What the files for learning simulators share."""

from __future__ import annotations

from stribeck.export.python.warp import text
from stribeck.export.request import Request


def header(request: Request) -> str:
    """What every export says about itself, fit for a docstring."""
    return "\n".join(request.about()).replace("\\", "\\\\").replace('"""', "'''")


def warp_file(request: Request, template: str) -> str:
    """A file for an engine on Warp; engines of learning compute in single precision."""
    return text(request.law, "float32", template, about=header(request), inputs=request.law.inputs)
