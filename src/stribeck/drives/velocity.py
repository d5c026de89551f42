"""A prescribed velocity, as on a friction test rig."""

from __future__ import annotations

from stribeck.drives.base import Column, Drive


class Velocity(Drive):
    """The signal is the velocity; the mass plays no part."""

    kind, meaning = "velocity", "the signal is the velocity of the body, m/s"
    signal = Column("v", "m/s", "velocity")
    sets_velocity = True
