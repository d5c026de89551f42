"""``--target newton``: joint friction for Newton, one Warp kernel."""

from __future__ import annotations

from functools import partial

from stribeck.exports.python import warp
from stribeck.exports.request import Part, Target

TARGET = Target(
    "newton", "joint friction for Newton", {"law": Part(partial(warp.joints, "newton"))}, folder=False, loads=True
)
