"""What moves the body: each kind of drive with its constants and equations."""

from __future__ import annotations

from stribeck.drives.base import Drive
from stribeck.drives.force import Force
from stribeck.drives.pid import Pid
from stribeck.drives.spring import Spring
from stribeck.drives.velocity import Velocity

__all__ = ["KINDS", "Drive"]

KINDS: dict[str, type[Drive]] = {drive.kind: drive for drive in (Force, Spring, Pid, Velocity)}
