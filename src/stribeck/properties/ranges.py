"""Ranges of a contact's constants in a machine file, over the whole run and for all positions and speeds."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from math import ceil, floor, pi, sin
from typing import Any

import numpy as np

from stribeck.arrays import Array
from stribeck.machine.elements.contacts import Contact, Factor, Raise, Weights
from stribeck.machine.elements.links import Link
from stribeck.machine.elements.loads import Follower, Pendulum, Ripple
from stribeck.machine.elements.motors import Motor
from stribeck.machine.machine import Elements
from stribeck.properties.prover.region import ExactRange
from stribeck.properties.worst import Varied
from stribeck.waveforms import Curve, PointsSignal, Signal, SineSignal, SumSignal

Ends = tuple[Fraction | None, Fraction | None]  # None: no bound
_SLACK = Fraction(1, 2**49)  # of a piece's size: exceeds its rounding
_BITS = 200  # of a curve's extremes: their error is far below a float's
_ONE: ExactRange = (Fraction(1), Fraction(1))
OPEN: Ends = (None, None)


def of_signal(signal: Signal, t_end: float) -> tuple[Fraction, Fraction]:
    """Bounds of a signal on [0, t_end]: exact for straight pieces, with outward rounding for sines and curves."""
    if isinstance(signal, SumSignal):
        every = [of_signal(part, t_end) for part in signal.parts]
        return sum((x for x, _ in every), Fraction(0)), sum((x for _, x in every), Fraction(0))
    if isinstance(signal, SineSignal):
        return _of_sine(signal, t_end)
    if isinstance(signal, Curve):
        starts = [start for start, _ in signal.pieces if start <= t_end]
        bounds = [_of_polynomial(x, end) for (_, x), end in zip(signal.pieces, [*starts[1:], t_end], strict=False)]
        return min(low for low, _ in bounds), max(high for _, high in bounds)
    if isinstance(signal, PointsSignal):
        return _of_points(np.asarray(signal.t, float), np.asarray(signal.value, float), t_end)
    s = signal.segments
    first = max(int(np.searchsorted(s.start, 0.0, side="right")) - 1, 0)
    last = max(int(np.searchsorted(s.start, t_end, side="right")), first + 1)
    start, value, slope = (x[first:last] for x in (s.start, s.value, s.slope))
    begin, end = np.maximum(start, 0.0), np.append(start[1:], max(t_end, float(start[-1])))
    ends = np.concatenate([value + slope * (begin - start), value + slope * (end - start)])
    slack = _SLACK * Fraction(float(np.max(abs(value)) + np.max(abs(slope * (end - start)))))
    if not slope.any():
        slack = Fraction(0)
    return Fraction(float(ends.min())) - slack, Fraction(float(ends.max())) + slack


def _of_points(t: Array, value: Array, t_end: float) -> tuple[Fraction, Fraction]:
    """The least and the largest value of the points within the run, and at its ends."""
    inside = value[(t >= 0) & (t <= t_end)]
    extremes = [Fraction(float(x)) for x in (inside.min(), inside.max())] if inside.size else []
    for cut in (0.0, t_end):
        i = int(np.searchsorted(t, cut, side="right"))
        if 0 < i < len(t):
            a, b = (Fraction(float(x)) for x in (value[i - 1], value[i]))
            share = (Fraction(cut) - Fraction(float(t[i - 1]))) / (Fraction(float(t[i])) - Fraction(float(t[i - 1])))
            extremes.append(a + share * (b - a))
        else:
            extremes.append(Fraction(float(value[max(i - 1, 0)])))
    return min(extremes), max(extremes)


def _of_sine(signal: SineSignal, t_end: float) -> tuple[Fraction, Fraction]:
    """Bounds of a sine; its crests count if the run, rounded outward, may contain them."""
    p = signal.values
    middle, size = Fraction(p["offset"]), abs(Fraction(p["amplitude"]))
    first = p["phase"] / (2 * pi) + (0.5 if p["amplitude"] < 0 else 0.0)
    ends = sorted((first, first + p["frequency"] * t_end))  # in periods
    slack = 1e-14 * (1 + abs(ends[0]) + abs(ends[1]))
    at_ends = [sin(2 * pi * x) for x in ends]

    def passed(place: float) -> bool:
        return floor(ends[1] + slack - place) >= ceil(ends[0] - slack - place)

    low = -1.0 if passed(0.75) else max(min(at_ends) - 10 * slack, -1.0)
    high = 1.0 if passed(0.25) else min(max(at_ends) + 10 * slack, 1.0)
    return middle + size * Fraction(low), middle + size * Fraction(high)


def _of_polynomial(values: Mapping[str, float], end: float) -> tuple[Fraction, Fraction]:
    """Bounds of a polynomial of order seven from its start to ``end``: its values there and where its derivative is 0."""
    from flint import acb, arb, arb_poly, ctx, fmpq, fmpq_poly

    length = max(Fraction(end) - Fraction(values["start"]), Fraction(0))
    coefficients = [Fraction(values[f"c{n}"]) * length**n for n in range(8)]
    polynomial = fmpq_poly([fmpq(c.numerator, c.denominator) for c in coefficients])  # of the share of the length
    with ctx.workprec(_BITS):
        roots: Any = polynomial.derivative().complex_roots()  # with their multiplicities
        flat = [acb(root) for root, _ in roots]
        inside = [x.real for x in flat if x.imag == 0 and not (x.real < 0 or x.real > 1)]
        extremes = [arb_poly(polynomial)(x) for x in (arb(0), arb(1), *inside)]
        lows, highs = zip(*((x.lower().man_exp(), x.upper().man_exp()) for x in extremes), strict=True)
    return min(_dyadic(*x) for x in lows), max(_dyadic(*x) for x in highs)


def _dyadic(mantissa: int, exponent: int) -> Fraction:
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def of_force(machine: Elements, name: str, t_end: float, stated: Mapping[str, float]) -> Ends:
    """Bounds of the force of a link, load or motor for every motion; ``stated``: bounds that the user vouches for."""
    if name in stated:
        return -Fraction(stated[name]), Fraction(stated[name])
    system, values = machine.system, machine.values
    for load in system.loads:
        if load.name == name:
            if isinstance(load, Follower):
                ends = of_signal(machine.signals[next(load.signals())], t_end)
                gain = Fraction(values.get((load.path, "gain"), 1.0))
                return min(gain * x for x in ends), max(gain * x for x in ends)
            if type(load) not in (Pendulum, Ripple):
                return OPEN
            given = [x for (path, n), x in values.items() if path == load.path and n.startswith("amplitude")]
            size = sum((abs(Fraction(x)) for x in given), Fraction(0))
            return -size, size
    for link in system.links:
        if link.name == name:
            still = type(link) is Link and not values[link.path, "stiffness"] and not values.get((link.path, "damping"))
            return (Fraction(0), Fraction(0)) if still else OPEN
    for motor in system.motors:
        if motor.name == name:
            return _of_motor(machine, motor)
    return OPEN


def _of_motor(machine: Elements, motor: Motor) -> Ends:
    """Bounds of the torque of a motor with ideal current control: the controller's limit."""
    for each in machine.system.controllers:
        if each.on == motor.name and each.limit is not None and motor.voltage is None:
            limit = Fraction(machine.values[each.path, "limit"])
            return -limit, limit
    return OPEN


def _size(ends: Ends) -> ExactRange:
    """Bounds of |f|."""
    low, high = ends
    least = Fraction(0)
    if low is not None and low > 0:
        least = low
    elif high is not None and high < 0:
        least = -high
    return least, None if low is None or high is None else max(abs(low), abs(high))


def _weighted(machine: Elements, level: Raise, path: str, t_end: float, stated: Mapping[str, float]) -> Ends:
    low: Fraction | None = Fraction(0)
    high: Fraction | None = Fraction(0)
    for source in level.weights:
        weighted = isinstance(level.force, Weights)
        weight = Fraction(machine.values[path, f"weight_{source}"]) if weighted else Fraction(1)
        a, b = of_force(machine, source, t_end, stated) if weight else (Fraction(0), Fraction(0))
        a, b = (a, b) if weight > 0 else (b, a)
        low = None if low is None or a is None else low + weight * a
        high = None if high is None or b is None else high + weight * b
    return low, high


def _factor(machine: Elements, factor: Factor, path: str, t_end: float) -> tuple[Fraction, Fraction]:
    if factor.signal is not None:
        return of_signal(next(x for use, x in machine.signals.items() if use.path == f"{path}.signal"), t_end)
    count = len(factor.waves or ())
    size = sum((abs(Fraction(machine.values[path, f"amplitude_{i}"])) for i in range(count)), Fraction(0))
    return 1 - size, 1 + size


def _times(a: ExactRange, b: ExactRange) -> ExactRange:
    return a[0] * b[0], None if a[1] is None or b[1] is None else a[1] * b[1]


def of_contact(machine: Elements, contact: Contact, t_end: float, stated: Mapping[str, float]) -> Varied:
    """The contact's law with the ranges of its constants under factors and loads."""
    law = machine.laws[contact.law_path]
    factors = {
        constant: _factor(machine, x, f"{contact.path}.factors.{constant}", t_end)
        for constant, x in contact.factors.items()
    }
    ranges: dict[str, ExactRange] = {}
    for name, value in law.values.items():
        if value is None:
            continue
        now = _times((Fraction(value), Fraction(value)), factors.get(name, _ONE))
        if name in ("F_c", "F_s"):
            now = _times(_raised(machine, contact, name, now, t_end, stated), factors.get("level", _ONE))
        if name in factors or now[0] != value or now[1] != value:
            ranges[name] = now
    return Varied(law, ranges)


def _raised(
    machine: Elements, contact: Contact, name: str, now: ExactRange, t_end: float, stated: Mapping[str, float]
) -> ExactRange:
    for i, level in enumerate(contact.loads):
        path = f"{contact.path}.loads.{i}"
        gain = Fraction(machine.values.get((path, name), 0.0))
        if gain:
            least, most = _size(_weighted(machine, level, path, t_end, stated))
            if level.against is not None:
                least, most = Fraction(0), None if most is None else most * most
            now = now[0] + gain * least, None if now[1] is None or most is None else now[1] + gain * most
    return now
