"""From a measured log to a law's parameters."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from stribeck.identify.actuator import fit_machine, read_logs
    from stribeck.identify.actuator.mujoco_joints import from_mujoco

_PLACES = {
    "fit_machine": "stribeck.identify.actuator", "read_logs": "stribeck.identify.actuator",
    "from_mujoco": "stribeck.identify.actuator.mujoco_joints",
}  # fmt: skip
__all__ = ["fit_machine", "from_mujoco", "read_logs"]


def __getattr__(name: str) -> object:
    """The names that need SciPy, when they are asked for."""
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_PLACES[name]), name)
