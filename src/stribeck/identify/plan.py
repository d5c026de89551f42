"""Measurement plan: tests within a rig's limits of stroke, speed and force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import POSITIVE, show
from stribeck.errors import InputError, arg

# Tests of each kind: sizes and speeds by factors of 2.5, rates of a ramp by 10.
_LOOPS, _SPEEDS, _RATES = 4, 8, 3
_CYCLES = 3  # of a loop: the first begins in another state than it ends
_SLOWEST = 1e-3  # of the speed limit: Stribeck velocities are some thousandths of it
_PUSH = 0.9  # of the force limit, so that no drive saturates
SMALLEST, _LARGEST = 1e-12, 1e12  # in SI units: no rig is beyond, and squares and ratios are numbers


@dataclass(frozen=True)
class Limits:
    """Limits of a rig: stroke (m), speed (m/s) and force (N).

    The deflection at break-away (m), F_c/sigma_0, may be given if it is roughly known.
    """

    stroke: float
    speed: float
    force: float
    deflection: float | None = None

    def __post_init__(self) -> None:
        given = {"stroke": self.stroke, "speed": self.speed, "force": self.force}
        given |= {} if self.deflection is None else {"deflection": self.deflection}
        wrong = [f"{arg(f'plan.{name}')}: {show(x)}: {text}" for name, x in given.items() if (text := _problem(x))]
        if not wrong and self.deflection is not None and self.deflection > 0.1 * self.stroke:
            wrong = [
                f"{arg('plan.deflection')}: {self.deflection}: must be at most a tenth of the stroke ({self.stroke})"
            ]
        if wrong:
            raise InputError(wrong)


def _problem(x: float) -> str | None:
    within = f"must be from {SMALLEST:g} to {_LARGEST:g}"
    return POSITIVE.problem(x) or (None if SMALLEST <= x <= _LARGEST else within)


@dataclass(frozen=True)
class Test:
    """A test: what it identifies, and its numbers in SI units; None where a number has no part in it.

    ``motion`` tests set the velocity: ``amplitude`` is the way there and back, ``speed`` the largest speed and
    ``duration`` one of ``repeats`` cycles. ``force`` tests raise the force from rest at ``force_rate``.
    """

    __test__ = False  # not one of pytest's

    kind: str
    identifies: str
    control: str
    amplitude: float | None
    speed: float | None
    force_rate: float | None
    duration: float
    repeats: int

    def velocity(self, step: float) -> Array:
        """The velocity of a motion test, m/s, at every ``step`` s; it starts and ends at rest, without a jolt.

        Loops are sines of time. Strokes hold the speed between soft ramps, there and back.
        """
        assert self.speed is not None
        count = max(round(self.duration / step), 16)
        phase = np.arange(count) / count
        if self.kind == "presliding loop":
            loops = self.speed * np.tile(np.sin(2 * np.pi * phase), self.repeats)
            return loops * _soft(np.arange(len(loops)) / count, self.repeats, 0.5)
        ramp = 0.6 if self.kind == "constant speed" else 1.0
        half = _soft(2 * phase % 1, 1.0, ramp / 2)
        return np.tile(self.speed * np.where(phase < 0.5, 1.0, -1.0) * half, self.repeats)


def _soft(x: Array, end: float, ramp: float) -> Array:
    """1 between 0 and ``end``, with ramps of raised cosines that are ``ramp`` long."""
    near = np.clip(np.minimum(x, end - x) / ramp, 0, 1)
    return np.asarray((1 - np.cos(np.pi * near)) / 2)


def program(limits: Limits) -> list[Test]:
    """The tests for a rig: loops for sigma_0 and sigma_1, and strokes for F_c, F_s, v_s and sigma_2.

    Force ramps give the break-away force, and accelerations the mass.
    """
    return [*_loops(limits), *_strokes(limits), *_ramps(limits), _accelerate(limits)]


def _loops(limits: Limits) -> list[Test]:
    """From well inside the elastic range to sliding."""
    if limits.deflection is None:
        sizes = limits.stroke * np.geomspace(1e-6, 1e-2, 2 * _LOOPS + 1)
        identifies = "sigma_0: keep the loops in which the force levels off at the ends, and the next two smaller ones"
    else:
        sizes = limits.deflection * np.geomspace(0.5, 8, _LOOPS)
        identifies = "sigma_0; sigma_1 if the loop is fast"
    slow, fast = 0.5, 20.0
    tests = []
    for size in sizes.tolist():
        for rate in (slow, fast):
            speed = np.pi * rate * size  # y = size/2 (1 - cos(2 pi rate t))
            if speed <= limits.speed:
                tests.append(Test("presliding loop", identifies, "motion", size, float(speed), None, 1 / rate, _CYCLES))
    return tests


def _strokes(limits: Limits) -> list[Test]:
    tests = []
    for speed in (limits.speed * np.geomspace(_SLOWEST, 1, _SPEEDS)).tolist():
        half = min(0.9 * limits.stroke / (0.7 * speed), 0.5)  # s; the ramps take three tenths of the way
        identifies = "F_c and sigma_2" if speed > 0.1 * limits.speed else "F_s and v_s"
        tests.append(Test("constant speed", identifies, "motion", 0.7 * speed * half, speed, None, 2 * half, 2))
    return tests


def _ramps(limits: Limits) -> list[Test]:
    push = _PUSH * limits.force
    return [
        Test("force ramp", "break-away force; F_s and sigma_1", "force", None, None, push / time, time, _CYCLES)
        for time in np.geomspace(0.1, 10, _RATES).tolist()
    ]


def _accelerate(limits: Limits) -> Test:
    half = min(0.9 * limits.stroke / (0.5 * limits.speed), 0.5)
    identifies = "mass: shorten the move until the force is near its limit"
    way = 0.5 * limits.speed * half
    return Test("acceleration", identifies, "motion", way, limits.speed, None, 2 * half, 3)


def motion(tests: Sequence[Test], step: float) -> tuple[Array, Array]:
    """The motion tests one after the other with rests between: times and velocity."""
    rest = np.zeros(max(round(0.02 / step), 2))
    parts = [part for test in tests if test.control == "motion" for part in (test.velocity(step), rest)]
    v = np.concatenate([*parts, np.zeros(1)])
    return step * np.arange(len(v), dtype=float), v
