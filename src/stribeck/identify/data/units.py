"""Units of a log's columns and their factors to SI."""

from __future__ import annotations

import re
from collections.abc import Mapping

from stribeck.constants import show
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
_COUNT = re.compile(r"counts(?=$|/)")
_PART = re.compile(r"rev/(\d+)(?=$|/)")  # of a turn: rev/2000, rev/2000/s


def known_units(role: str) -> Mapping[str, float]:
    """The units of a role and their factors to SI."""
    return _KNOWN[role]


def with_counts(units: Mapping[str, str], counts: float | None) -> dict[str, str]:
    """The units of columns, with an encoder's ``counts`` as fractions of a turn: ``rev/2000``.

    Raises:
        InputError: counts a turn are missing, unused, or not a whole number above 0.
    """
    counted = {column for column, unit in units.items() if _COUNT.match(unit)}
    if counts is None:
        if counted:
            raise InputError(
                [f"{arg('counts')}: must be given, the counts of a turn, as {c!r} is in counts" for c in counted]
            )
        return dict(units)
    if not (counts > 0 and counts == int(counts)):
        raise InputError(f"{arg('counts')}: {show(counts)}: must be a whole number above 0, the counts of a turn")
    if not counted:
        raise InputError(f"{arg('counts')}: {show(counts)}: no column is in counts ({arg('units')})")
    return {column: _COUNT.sub(f"rev/{int(counts)}", unit) for column, unit in units.items()}


def factor(role: str, column: str, unit: str) -> float:
    """The factor from ``unit`` to SI.

    Raises:
        InputError: no such unit, or a unit of another quantity.
    """
    known = _KNOWN[role]
    if (part := _PART.match(unit)) and int(part[1]) > 0 and (whole := f"rev{unit[part.end() :]}") in known:
        return known[whole] / int(part[1])
    if _COUNT.match(unit):
        raise InputError(
            f"{arg('units')}: '{column}={unit}': must be rev/N, of N counts a turn, or stand with {arg('counts')}"
        )
    if unit not in known:
        common = [u for u in known if len(u) < 6][:9]
        guess = nearest(unit, known) or f"; known for {role}: {', '.join(common)}, ..."
        raise InputError(f"{arg('units')}: '{column}={unit}': no unit of {role}{guess}")
    return known[unit]


def is_rotary(unit: str) -> bool:
    """True for a unit of an angle or of its rate."""
    return unit == "rpm" or unit.partition("/")[0] in ANGLE


def is_drive(unit: str) -> bool:
    """True for a unit of current or voltage, which needs a gain to force."""
    return unit in DRIVE
