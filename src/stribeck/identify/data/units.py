"""Units of a log's columns and their factors to SI."""

from __future__ import annotations

import math

from stribeck.errors import InputError, nearest

_PREFIXES = {"": 1.0, "k": 1e3, "M": 1e6, "c": 1e-2, "m": 1e-3, "u": 1e-6, "µ": 1e-6, "n": 1e-9}
_LENGTH = {f"{p}m": f for p, f in _PREFIXES.items()} | {"in": 0.0254, "inch": 0.0254, "ft": 0.3048}
_ANGLE = {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180, "rev": 2 * math.pi}
_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
_TORQUE = {f"{p}N{gap}m": f for p, f in _PREFIXES.items() for gap in (" ", "", "*", ".")}
_FORCE = {f"{p}N": f for p, f in _PREFIXES.items()} | {"lbf": 4.4482216152605, "kgf": 9.80665} | _TORQUE
_PRESSURE = {f"{p}Pa": f for p, f in _PREFIXES.items()} | {"bar": 1e5, "mbar": 100.0, "psi": 6894.757293168}
_SPEED = {f"{a}/{t}": x / y for a, x in (_LENGTH | _ANGLE).items() for t, y in _TIME.items()} | {"rpm": math.pi / 30}
_ACCELERATION = {
    f"{a}/{t}{square}": x / y**2
    for a, x in (_LENGTH | _ANGLE).items()
    for t, y in _TIME.items()
    for square in ("^2", "2", "²")
} | {"g": 9.80665}
_DRIVE = {f"{p}{u}": f for p, f in _PREFIXES.items() for u in ("A", "V")}  # a current or a voltage, with a gain

_KNOWN: dict[str, dict[str, float]] = {
    "time": _TIME,
    "position": _LENGTH | _ANGLE,
    "velocity": _SPEED,
    "acceleration": _ACCELERATION,
    "force": _FORCE | _DRIVE,
    "load": _FORCE,
    "pressure": _PRESSURE,
    "command": _LENGTH | _ANGLE,
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
        raise InputError(f"--unit: '{column}={unit}': no unit of {role}{guess}")
    return known[unit]


def is_drive(unit: str) -> bool:
    """True for a current or a voltage, which a gain turns into a force."""
    return unit in _DRIVE
