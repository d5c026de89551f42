"""How far each constant of a law can move before the verdict on passivity changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from stribeck.errors import InputError
from stribeck.laws.base import Law
from stribeck.properties.storage import Storage, own_speeds, reach_of, require_storage

_FACTORS = (1.1, 2.0, 10.0, 1e2, 1e4, 1e6)
_SPEEDS = (1e-6, 1e6)  # of the law's own: where v_d is looked for
_CLOSE = 1e-10


@dataclass(frozen=True)
class Margin:
    """A constant's range, around its value, in which the verdict on passivity stays: None where no end was found.

    ``low`` and ``high`` are the last values at which it stays, to 1e-10 of themselves.
    """

    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Margins:
    """Margins by constant; ``passive`` is the verdict now, by sampling. ``largest_v_d`` is the largest v_d with which a
    set that is not passive becomes so; None where there is none, or none is needed."""

    passive: bool
    constants: dict[str, Margin]
    largest_v_d: float | None


def margins(law: Law, v_max: float | None = None, bounded: bool | None = None) -> Margins:
    """The ranges of the constants in which the verdict on passivity stays, by bisection with the storage interval as
    sampled (not with a formula).

    Args:
        law: a law with z.
        v_max: passivity is asked for \\|v\\| <= v_max, m/s.
        bounded: whether z has its bound; what the law claims unless given.

    Raises:
        InputError: a law without z, or v_max is no positive number.
    """
    require_storage(law, v_max)
    reached = law.guarantees()["bounded"] if bounded is None else bounded

    def passes(name: str, value: float) -> bool | None:
        try:
            moved = type(law)({**law.machine, **law.values, **law.choices, name: value})
        except InputError:
            return None
        return Storage(moved, v_max, reach_of(moved, reached)).exists

    now = Storage(law, v_max, reach_of(law, reached)).exists
    found = {}
    for name, value in law.values.items():
        if value:
            test: Callable[[float], bool | None] = lambda x, name=name: passes(name, x)  # type: ignore[misc]  # noqa: E731
            found[name] = Margin(value, _end(test, value, now, -1), _end(test, value, now, 1))
    remedy = None
    if not now and "v_d" in law.constants() and law.values["v_d"] is None:
        remedy = _largest_v_d(law, lambda x: passes("v_d", x))
    return Margins(now, found, remedy)


def _end(passes: Callable[[float], bool | None], value: float, now: bool, direction: int) -> float | None:
    """The last value on one side where the verdict is as it is now; None where it does not change for any that are
    allowed, up to a factor of a million."""
    inside = value
    for factor in _FACTORS:
        outside = value * factor**direction
        verdict = passes(outside)
        if verdict is None:  # F_s below F_c, say: look just before values become impossible
            outside = _bisect(lambda x: passes(x) is not None, inside, outside, True)
            verdict = passes(outside)
            return None if verdict == now else _bisect(passes, inside, outside, now)
        if verdict != now:
            return _bisect(passes, inside, outside, now)
        inside = outside
    return None


def _bisect(passes: Callable[[float], bool | None], inside: float, outside: float, now: bool) -> float:
    while abs(outside / inside - 1) > _CLOSE:
        ratio = outside / inside
        middle = inside * float(np.sqrt(ratio)) if not 0.9 < ratio < 1.1 else 0.5 * (inside + outside)
        if middle in (inside, outside):
            break
        inside, outside = (middle, outside) if passes(middle) == now else (inside, middle)
    return inside


def _largest_v_d(law: Law, passes: Callable[[float], bool | None]) -> float | None:
    own = own_speeds(law)
    low, high = own[0] * _SPEEDS[0], own[-1] * _SPEEDS[1]
    return _bisect(passes, low, high, True) if passes(low) else None
