"""Joint friction as Warp kernels, one thread a machine, for the engines that run on Warp."""

from __future__ import annotations

from stribeck.exports.c.ccode import render
from stribeck.exports.python.written import Written
from stribeck.exports.request import Content, Request


def joints(tool: str, request: Request) -> Content:
    """The Python file with joint friction for an engine of learning, which computes in single precision."""
    about, law = request.in_docstring(), request.law
    content = render(f"{tool}.txt", eq=Written(law), about=about, inputs=law.inputs, start=request.z)
    return {f"{request.name}_{tool}.py": content}
