"""The motions that are advised for a parameter, as records of their own."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stribeck.arrays import Array
from stribeck.identify.features.guess import Sizes
from stribeck.identify.features.what_to_measure import Reach
from stribeck.identify.log import Log

_SAMPLES = 40  # in a cycle of a loop
_HELD = 100  # in a stroke to one side
_CYCLES, _LOOPS, _SPEEDS = 3, 4, 10
_SETTLED = 5.0  # lengths of presliding in a stroke, behind which the force has settled
_SLOW_STROKE = 0.1  # of the largest speed
_STROKES = {
    "F_c": ("middle", "fast"), "F_s": ("slowest", "middle"), "v_s": ("slowest", "fast"), "sigma_2": ("third", "fast"),
    "offset": ("middle", "fast"), "sigma_2_by_direction": ("third", "fast"), "drag": ("third", "fast"),
    "thinning": ("slowest", "fast"), "k_v": ("slowest", "middle"), "F_c_by_direction": ("slowest", "middle"),
}  # fmt: skip
_ALONG = ("stiffness", "gravity_sin", "gravity_cos", "ripple_sin", "ripple_cos", "ripple_waves")


def advised(name: str, at: Reach, sizes: Sizes, middle: float, mass: float, strokes_apart: bool) -> Log | None:
    """The motion that is advised for a parameter; None where there is none that a program can play.

    Sines of four sizes for the bristles; strokes at ten speeds, evenly in the logarithm, to both sides; slow strokes over the
    travel; a sine whose inertia is what the advice says. Its force is not known: ones.

    Args:
        middle: of the travel, m.
        mass: kg, for a sine of the acceleration.
        strokes_apart: each stroke as a run of its own.
    """
    if name in ("sigma_0", "sigma_1", "z_ba"):
        speeds = (at.loop,) if name == "sigma_0" else (at.loop, at.loop_fast)
        return _sines([(at.large, v) for v in speeds], middle)
    if name in _STROKES:
        first, last = ({"third": at.fast / 3}.get(n) or getattr(at, n) for n in _STROKES[name])
        there = np.geomspace(min(first, 0.9 * last), last, _SPEEDS).tolist()
        way, both = _SETTLED * at.large / 5, [*there, *(-v for v in there)]
        return _strokes(both, [0.0] * len(both), way, sizes, middle, strokes_apart)
    if name in _ALONG and sizes.travel > 0:
        v = _SLOW_STROKE * sizes.fast
        return _strokes([v, -v], [-0.5, 0.5], sizes.travel, sizes, middle, strokes_apart, 4 * _HELD)
    if name == "mass" and mass > 0:
        acceleration, v = at.half / mass, 0.5 * sizes.fast
        return _sines([(2 * v**2 / acceleration, v)], middle, (1.0,))
    return None


def _sines(largest: Sequence[tuple[float, float]], middle: float, shares: Sequence[float] = ()) -> Log:
    """Sines of position, three cycles each: of the largest total way (m) and speed (m/s) and in proportion to it."""
    shares = shares or np.geomspace(0.1, 1.0, _LOOPS).tolist()
    phase = 2 * np.pi * np.arange(_CYCLES * _SAMPLES) / _SAMPLES
    time, columns = [0.0], []
    for way, speed in largest:
        rate = 2 * speed / way  # rad/s
        for share in shares:
            time += (time[-1] + np.arange(1, len(phase) + 1) * 2 * np.pi / _SAMPLES / rate).tolist()
            wave = 0.5 * way * share * np.array([1 - np.cos(phase), rate * np.sin(phase), rate**2 * np.cos(phase)])
            columns.append(wave)
    position, velocity, acceleration = np.concatenate(columns, axis=1)
    return _log(np.array(time[:-1]), middle + position, velocity, acceleration, np.zeros(len(position), np.int32))


def _strokes(
    speeds: Sequence[float], starts: Sequence[float], way: float, sizes: Sizes, middle: float, apart: bool,
    samples: int = _HELD,
) -> Log:  # fmt: skip
    """Strokes of constant speed, of a way at least, which begin at a share of it from the middle."""
    step = [max(sizes.step, way / abs(v) / samples) for v in speeds]
    own = [np.arange(1, samples + 1) * x for x in step]
    before = np.cumsum([0.0, *(t[-1] for t in own[:-1])])
    time = np.concatenate([b + t for b, t in zip(before, own, strict=True)])
    velocity = np.repeat(np.asarray(speeds, float), samples)
    moved = np.concatenate([way * s + v * t for v, t, s in zip(speeds, own, starts, strict=True)])
    run = np.repeat(np.arange(len(own), dtype=np.int32) * int(apart), samples)
    return _log(time, middle + moved, velocity, np.zeros(len(time)), run)


def _log(time: Array, position: Array, velocity: Array, acceleration: Array, run: NDArray[np.int32]) -> Log:
    step = float(np.median(np.diff(time)))
    return Log(time, position, velocity, acceleration, np.ones(len(time)), run, step=step)
