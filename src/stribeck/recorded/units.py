"""Units of recorded numbers and their factors to SI."""

from __future__ import annotations

import math

_MICRO = ("u", "µ", "\u03bc")  # the letter, the micro sign, the Greek letter that text editors make of it
_PREFIXES = {"": 1.0, "k": 1e3, "M": 1e6, "c": 1e-2, "m": 1e-3, "n": 1e-9} | dict.fromkeys(_MICRO, 1e-6)
LENGTH = {f"{p}m": f for p, f in _PREFIXES.items()} | {"in": 0.0254, "inch": 0.0254, "ft": 0.3048}
ANGLE = {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180, "rev": 2 * math.pi}
TIME = {"s": 1.0, "ms": 1e-3, "ns": 1e-9, "min": 60.0, "h": 3600.0} | {f"{micro}s": 1e-6 for micro in _MICRO}
TORQUE = {f"{p}N{gap}m": f for p, f in _PREFIXES.items() for gap in (" ", "", "*", ".")}
FORCE = {f"{p}N": f for p, f in _PREFIXES.items()} | {"lbf": 4.4482216152605, "kgf": 9.80665} | TORQUE
PRESSURE = {f"{p}Pa": f for p, f in _PREFIXES.items()} | {"bar": 1e5, "mbar": 100.0, "psi": 6894.757293168}
SPEED = {f"{a}/{t}": x / y for a, x in (LENGTH | ANGLE).items() for t, y in TIME.items()} | {"rpm": math.pi / 30}
ACCELERATION = {
    f"{a}/{t}{square}": x / y**2
    for a, x in (LENGTH | ANGLE).items()
    for t, y in TIME.items()
    for square in ("^2", "2", "²")
} | {"g": 9.80665}
DRIVE = {f"{p}{u}": f for p, f in _PREFIXES.items() for u in ("A", "V")}  # a current or a voltage, with a gain
_OF = ((LENGTH, "m"), (ANGLE, "rad"), (TORQUE, "N m"), (FORCE, "N"), (PRESSURE, "Pa"), (TIME, "s"))


def si_unit(unit: str) -> str:
    """The SI unit of a unit's factor: ``rad/s`` for ``rpm``; empty for an unknown unit."""
    if unit in ("rpm", "g"):
        return "rad/s" if unit == "rpm" else "m/s^2"
    if "/" in unit:
        above, _, below = unit.partition("/")
        return f"{si_unit(above)}/s" + ("" if below in TIME else "^2")
    return next((si for table, si in _OF if unit in table), unit[-1:] if unit in DRIVE else "")
