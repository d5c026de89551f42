"""``--target newton``: joint friction for Newton, one Warp kernel."""

from __future__ import annotations

from functools import partial

from stribeck.exports.joints import joints
from stribeck.exports.request import Part, Target

TARGET = Target(
    "newton", "joint friction for Newton", {"law": Part(partial(joints, "newton"))}, folder=False, loads=True
)
