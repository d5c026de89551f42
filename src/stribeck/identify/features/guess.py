"""Initial values of a law's constants from a log, and their search ranges."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.log import STILL, Log, size_ratio, stretches
from stribeck.laws.base import Law

_REVERSALS_LOOKED_AT = 200  # of a run: their upper quartile is then known to 3 % of their number
RISE = 0.3  # of the friction level: a smaller rise is noise or inertia
_FEWEST_AT_REST = 8  # samples: a quarter at the edges is left out
HIGHEST_V_S = 0.5  # of the fastest speed: with a larger v_s, the curve cannot be separated from viscous friction
# Values of v_s on the grid, over the fastest speed: nine values are a factor of 2 apart.
_BENDS, _PLACES = (1e-3, HIGHEST_V_S), 9
# Width of the smooth sign, over the fastest speed; and over v_s, so that it does not hide the Stribeck effect.
_SIGN, _WITHIN = 0.01, 0.3
_TYPICAL_BREAK_AWAY = 1e-4  # of the travel, for a log without reversals: 10 um of an axis of 0.1 m


@dataclass(frozen=True)
class Guess:
    """An initial value, and the bounds of the search."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Sizes:
    """Scales of a log.

    Attributes:
        force: friction level, N.
        fast: largest speed, m/s.
        stiffness: at rest and after reversals, N/m.
        travel: range of the position, m.
        step: between samples, s.
    """

    force: float
    fast: float
    stiffness: float
    travel: float = 0.0
    step: float = 0.0


def sizes_of(log: Log) -> Sizes:
    """The scales of a log of a body driven against friction."""
    speed, force = abs(log.velocity), log.force
    fast = float(np.max(speed, initial=0.0))
    moving = speed > 0.02 * fast
    ahead, back = force[moving & (log.velocity > 0)], force[moving & (log.velocity < 0)]
    offset = float(np.median(ahead) + np.median(back)) / 2 if len(ahead) and len(back) else 0.0
    level = float(np.quantile(abs(force - offset), 0.9))
    return Sizes(level, fast, _stiffness(log, level), float(np.ptp(log.position)), log.step)


def _reversals(v: Array) -> list[tuple[int, int]]:
    """First and last row of the motion between a reversal or rest of a run and the next one."""
    turns = np.flatnonzero(np.diff(np.sign(v)) != 0).tolist()
    return list(zip(turns, [*turns[1:], len(v) - 1], strict=True)) if turns else []


def _stiffness(log: Log, level: float) -> float:
    """The stiffness of the contact in presliding: the upper quartile over stretches of rest and reversals."""
    every = rises(log, level, _REVERSALS_LOOKED_AT)
    slopes = [*_at_rest(log, level), *(rise / way for samples, rise, way in every if way > 0 and samples)]
    if not slopes:
        return level / max(_TYPICAL_BREAK_AWAY * float(np.ptp(log.position)), 1e-12)
    return float(np.quantile(slopes, 0.75))  # after some reversals the contact slides at once


def _at_rest(log: Log, level: float) -> list[float]:
    """Force over displacement by least squares, in each stretch of rest with a large change of force."""
    fast = float(np.max(abs(log.velocity)))
    slopes = []
    for rows in log.runs():
        v, y, f = log.velocity[rows], log.position[rows], log.force[rows]
        for first, last in stretches(abs(v) < STILL * fast)[:_REVERSALS_LOOKED_AT].tolist():
            margin = (last - first) // 8
            inside = slice(first + margin, last - margin)
            if inside.stop - inside.start < _FEWEST_AT_REST or np.ptp(f[inside]) < RISE * level:
                continue
            way, push = y[inside] - y[inside].mean(), f[inside] - f[inside].mean()
            if (both := float(way @ push)) > 0:
                slopes.append(float(push @ push) / both)
    return slopes


def rises(log: Log, level: float, most: int) -> Iterator[tuple[int, float, float]]:
    """Samples, force and displacement in the first half of each large rise of the force after a reversal.

    Args:
        most: largest number of reversals per run.
    """
    for rows in log.runs():
        y, f = log.position[rows], log.force[rows]
        for first, last in _reversals(log.velocity[rows])[:most]:
            rise = abs(f[first : last + 1] - f[first])
            if len(rise) > 4 and rise.max() > RISE * level:
                half = int(np.argmax(rise >= rise.max() / 2))
                yield half, float(rise[half]), float(abs(y[first + half] - y[first]))


def steady_curve(
    v: Array, beside: Sequence[Array], force: Array, tried: Array | None = None
) -> tuple[Array, dict[str, float], float]:
    """A Stribeck curve, and coefficients of other force columns, by least squares on a grid of v_s.

    Args:
        v: velocity, m/s.
        beside: columns of the other forces.
        force: sum of friction and the other forces, N.
        tried: values of v_s for a curve with an exact sign; without them, some for initial values.

    Returns:
        The other columns' coefficients, the curve's constants, and norm(residual)/norm(force).
    """
    fast = float(np.max(abs(v), initial=1e-300))
    curves = []
    for v_s in np.geomspace(*_BENDS, _PLACES) * fast if tried is None else tried:
        sign = np.sign(v) if tried is not None else np.tanh(v / min(_SIGN * fast, _WITHIN * v_s))
        columns = np.column_stack([*beside, sign, np.exp(-((v / v_s) ** 2)) * sign, v])
        size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
        x, *_ = np.linalg.lstsq(columns / size, force, rcond=1e-9)
        left = force - columns / size @ x
        *of_beside, F_c, bend, sigma_2 = x / size
        curves.append(
            (size_ratio(left, force), of_beside, {"F_c": F_c, "F_s": F_c + bend, "v_s": v_s, "sigma_2": sigma_2})
        )
    falling = [each for each in curves if each[2]["F_s"] > each[2]["F_c"] > 0]
    left_over, of_beside, values = min(falling or curves, key=lambda each: each[0])
    values["F_s"] = max(values["F_s"], values["F_c"])  # F_s >= F_c in every law
    return np.array(of_beside), {n: float(x) for n, x in values.items()}, left_over


def ranges(law: type[Law], sizes: Sizes, curve: Mapping[str, float]) -> dict[str, Guess]:
    """An initial value and bounds for each constant that a fit may estimate; ``curve``: of :func:`steady_curve`."""
    f, fast, k = sizes.force, sizes.fast, sizes.stiffness

    def rough(name: str, low: float, high: float) -> Guess:
        return Guess(min(max(curve[name], 2 * low), high / 2), low, high)

    known = {
        "sigma_0": Guess(k, k / 200, k * 200),
        "sigma_1": Guess(k * sizes.step, k * sizes.step / 300, k * sizes.step * 300),  # else invisible
        "sigma_2": rough("sigma_2", 1e-4 * f / fast, 10 * f / fast),
        "F_c": rough("F_c", 0.03 * f, 6 * f),
        "F_s": rough("F_s", 0.05 * f, 10 * f),
        "v_s": rough("v_s", 3e-5 * fast, HIGHEST_V_S * fast),  # about 3e-3 of the fastest speed in guides and gears
    }
    for name, constant in law.constants().items():
        if name not in known:
            value = constant.example or constant.default or 1.0
            known[name] = Guess(value, value / 1000, value * 1000)
    return known
