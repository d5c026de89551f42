"""Units of a log's columns and their factors to SI."""

from __future__ import annotations

from stribeck.errors import InputError, arg, nearest
from stribeck.recorded.units import ACCELERATION, ANGLE, DRIVE, FORCE, LENGTH, PRESSURE, SPEED, TIME

_KNOWN: dict[str, dict[str, float]] = {
    "time": TIME,
    "position": LENGTH | ANGLE,
    "velocity": SPEED,
    "acceleration": ACCELERATION,
    "force": FORCE | DRIVE,
    "load": FORCE,
    "pressure": PRESSURE,
    "command": LENGTH | ANGLE,
    "run": {},
}
ROLES = tuple(_KNOWN)


def factor(role: str, column: str, unit: str) -> float:
    """What a column in ``unit`` is multiplied by to be in SI.

    Raises:
        InputError: no such unit, or one that does not measure this.
    """
    known = _KNOWN[role]
    if unit not in known:
        common = [u for u in known if len(u) < 6][:9]
        guess = nearest(unit, known) or f"; known for {role}: {', '.join(common)}, ..."
        raise InputError(f"{arg('units')}: '{column}={unit}': no unit of {role}{guess}")
    return known[unit]


def is_rotary(unit: str) -> bool:
    """True for an angle or its rate: the machine turns."""
    return unit == "rpm" or unit.partition("/")[0] in ANGLE


def is_drive(unit: str) -> bool:
    """True for a current or a voltage, which a gain turns into a force."""
    return unit in DRIVE
