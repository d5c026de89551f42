"""``--target mjwarp``: joint friction for MuJoCo Warp, a callback with one Warp kernel."""

from __future__ import annotations

from stribeck.export.learning.common import warp_file
from stribeck.export.request import Request, Target

TARGET = Target("mjwarp", "learning.mjwarp", "joint friction for MuJoCo Warp", folder=False, loads=True)


def files(request: Request) -> dict[str, str]:
    """The Python file."""
    return {f"{request.name}_mjwarp.py": warp_file(request, "mjwarp.txt")}
