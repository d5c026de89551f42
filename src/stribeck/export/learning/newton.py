"""``--target newton``: joint friction for Newton, one Warp kernel."""

from __future__ import annotations

from stribeck.export.learning.common import warp_file
from stribeck.export.request import Request, Target

TARGET = Target("newton", "learning.newton", "joint friction for Newton", folder=False, loads=True)


def files(request: Request) -> dict[str, str]:
    """The Python file."""
    return {f"{request.name}_newton.py": warp_file(request, "newton.txt")}
