"""A prescribed velocity, as on a friction test rig."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.drives.base import Action, Column, Drive, Motion
from stribeck.expressions.names import Names


class VelocityDrive(Drive):
    """The signal is the velocity; the mass plays no part."""

    kind, meaning = "velocity", "the signal is the velocity of the body, m/s"
    signal = Column("v", "m/s", "velocity")
    sets_velocity = True

    def act(self, p: SimpleNamespace, m: Motion, called: Names | None = None) -> Action:
        """Whatever force is needed."""
        return Action(m.F)
