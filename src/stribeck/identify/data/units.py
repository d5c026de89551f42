"""Units of a log's columns and their factors to SI."""

from __future__ import annotations

import re

from stribeck.errors import InputError, arg, nearest
from stribeck.recorded.units import ACCELERATION, ANGLE, DRIVE, FORCE, LENGTH, PRESSURE, SPEED, TIME

UNITS: dict[str, dict[str, float]] = {
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
ROLES = tuple(UNITS)
_COUNT = re.compile(r"counts(?=$|/)")
_PART = re.compile(r"rev/(\d+)(?=$|/)")  # of a turn: rev/2000, rev/2000/s


def factor(role: str, column: str, unit: str) -> float:
    """The factor from ``unit`` to SI.

    Raises:
        InputError: no such unit, or a unit of another quantity.
    """
    known = UNITS[role]
    if (part := _PART.match(unit)) and int(part[1]) > 0 and (whole := f"rev{unit[part.end() :]}") in known:
        return known[whole] / int(part[1])
    if _COUNT.match(unit):
        raise InputError(f"{arg('unit')}: '{column}={unit}': must be rev/N, of N counts a turn")
    if unit not in known:
        common = [u for u in known if len(u) < 6][:9]
        guess = nearest(unit, known) or f"; known for {role}: {', '.join(common)}, ..."
        raise InputError(f"{arg('unit')}: '{column}={unit}': no unit of {role}{guess}")
    return known[unit]


def is_rotary(unit: str) -> bool:
    """True for a unit of an angle or of its rate."""
    return unit == "rpm" or unit.partition("/")[0] in ANGLE


def is_drive(unit: str) -> bool:
    """True for a unit of current or voltage, which needs a gain to force."""
    return unit in DRIVE
