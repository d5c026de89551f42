"""Motions that would determine a parameter, and by how much its interval would shrink with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.features.guess import Sizes
from stribeck.identify.features.what_to_measure import presliding_length
from stribeck.identify.log import Log
from stribeck.identify.models.dynamic_problem import VelocityProblem

_SAMPLES = 40  # in a cycle of a loop, and in a stroke to one side
_RATES = (1.0, 10.0)  # of loops: slow, and as fast as the record's largest speed allows at most
_SIZES = (0.5, 1.0, 2.0, 5.0)  # of loops, in lengths of presliding
_SPEEDS = 10


def motion(name: str, length: float, sizes: Sizes) -> tuple[float, Array] | None:
    """The step (s) and the velocities of the motion that is advised for a parameter; None where there is none.

    ``length``: of presliding, m. Loops are sines of that size for the bristles; for the others strokes at speeds evenly
    spaced in the logarithm, up to the record's largest.
    """
    cycle = np.sin(2 * np.pi * np.arange(_SAMPLES) / _SAMPLES)
    if name in ("sigma_0", "sigma_1", "z_ba"):
        slow = 0.01 * sizes.fast if name == "sigma_0" else 0.1 * sizes.fast
        period = 2 * np.pi * max(_SIZES) * length / slow  # the largest loop is that fast
        speed = np.concatenate([np.pi * size * length / period * np.tile(cycle, 3) for size in _SIZES])
        return period / _SAMPLES, speed
    if name in ("F_c", "F_s", "v_s", "sigma_2"):
        speeds = sizes.fast * np.geomspace(1e-3 if name in ("F_s", "v_s") else 0.1, 1.0, _SPEEDS)
        there = np.concatenate([np.full(_SAMPLES, v) for v in speeds])
        return 1e-3, np.concatenate([there, -there])
    return None


def narrower(
    problem: VelocityProblem, values: dict[str, float], inner: Array, names: list[str], name: str, noise: float,
    sizes: Sizes,
) -> float | None:  # fmt: skip
    """By what factor the advised motion, added to the record, narrows the interval of a coordinate: from its Fisher
    information, at a force noise of ``noise`` N. ``inner``: the covariance of ``names`` now. None where nobody can say."""
    length = presliding_length(values, sizes)
    found = motion(name, length, sizes)
    own = [i for i, c in enumerate(problem.coordinates) if c.name in names]
    if found is None or noise <= 0 or not np.isfinite(inner).all():
        return None
    step, velocity = found
    time = step * np.arange(len(velocity), dtype=float)
    log = Log(
        time=time, position=step * np.cumsum(velocity), velocity=velocity, acceleration=np.gradient(velocity, step),
        force=np.ones(len(time)), run=np.zeros(len(time), np.int32), step=step,
    )  # fmt: skip
    coordinates = [replace(problem.coordinates[i], rows=None) for i in own]
    if any(c.name not in values for c in coordinates) or problem.levels or set(problem.body) - {"mass", "offset"}:
        return None
    other = VelocityProblem(log, problem.law, coordinates, problem.fixed, problem.tied, (*problem.body,))
    slopes = other.sensitivities(other.point(values))
    if slopes is None:
        return None
    order = [names.index(c.name) for c in coordinates]
    k = [c.name for c in coordinates].index(name)
    now = inner[np.ix_(order, order)]
    size = np.sqrt(np.diag(now))
    if not (size > 0).all():
        return None
    information = np.linalg.pinv(now / np.outer(size, size)) + (slopes * size).T @ (slopes * size) / noise**2
    after = np.linalg.pinv(information)[k, k]
    return float(np.sqrt(1.0 / after)) if after > 0 else None
