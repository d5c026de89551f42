"""The equations of a sampled controller at each sampling instant: read, estimate the motion, step the states."""

from __future__ import annotations

from stribeck.constants import Constant
from stribeck.expressions.ops import Value, both, either, exp, where

Motion = tuple[Value, Value, Value]  # position, velocity and acceleration

PERIOD = Constant("s", "time between two samples", above=0)


def phi_1(x: Value) -> Value:
    """(e^x - 1)/x, by its series near 0, where the difference loses digits."""
    series: Value = 1.0
    for n in range(9, 1, -1):
        series = 1 + series * x / n
    small = abs(x) < 0.1
    return where(small, series, (exp(x) - 1) / where(small, 1.0, x))


def tracked(before: Motion, reading: Value, bandwidth: Value, period: Value) -> Motion:
    """Position, velocity and acceleration after another reading: a critically damped g-h-k filter.

    All poles lie at q = exp(-bandwidth period). The gains are 1 - q^3, 1.5 (1 - q^2)(1 - q)/period and
    (1 - q)^3/period^2 (Brookner, Tracking and Kalman Filtering Made Easy, 1998, section 1.3).
    """
    q = exp(-bandwidth * period)
    y, v, a = before
    y, v = y + period * v + period * period / 2 * a, v + period * a
    off = reading - y
    g, h, k = 1 - q**3, 1.5 * (1 - q * q) * (1 - q) / period, (1 - q) ** 3 / (period * period)
    return y + g * off, v + h * off, a + k * off


def turned(u: Value, extreme: Value, way: Value, count: Value, swing: Value) -> tuple[Value, Value, Value]:
    """Count the reversals of a sequence by more than ``swing``.

    Returns the last extreme, the direction since (0: none yet) and the count.
    """
    far, on = abs(u - extreme) > swing, (u - extreme) * way > 0
    new, moves = where(u > extreme, 1.0, -1.0), either(on, far)
    return where(moves, u, extreme), where(moves, new, way), count + where(both(far, (u - extreme) * way < 0), 1.0, 0.0)
