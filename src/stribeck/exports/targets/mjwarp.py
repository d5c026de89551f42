"""``--target mjwarp``: joint friction for MuJoCo Warp, a callback with one Warp kernel."""

from __future__ import annotations

from functools import partial

from stribeck.exports.joints import joints
from stribeck.exports.request import Part, Target

TARGET = Target(
    "mjwarp", "joint friction for MuJoCo Warp", {"law": Part(partial(joints, "mjwarp"))}, folder=False, loads=True
)
