"""What the cut-off of the motion does to a fit: one that rounds off ramps and reversals is raised."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.data.filters import ASTRAY, HIGHEST, SETTLED, low_pass
from stribeck.identify.log import ENOUGH_ROWS

_RAISE = 2.5  # from one cut-off that is tried to the next: a filter's bias goes with its square, and falls to a sixth
_CLEARLY = 0.92  # of what is missed with the lower cut-off: less is worth a higher one
_AS_GOOD = 1.05  # of the least that is missed
_NO_WORSE = 1.03  # of what a lower cut-off misses over all frequencies, where noise of the acceleration shows
_SHARE = 6  # of the longest run, the most that its start is: five sixths are compared
_SLOWED, _REST = 0.1, 0.1  # of a period, in which less than this share of the fastest speed is rest
_BAND = 2.5  # lowest cut-offs, in which the force is compared: above, its own noise hides what the filter does
_BENDS = (0, 1 / 128, 1 / 64, 1 / 32, 1 / 16, *np.linspace(1 / 8, 1, 8))  # of the free curve: closest where it turns
OF_REGRESSION = (2e-4, 3e-3)  # of the largest speed and acceleration: noise that biases nothing
# Of the largest speed: noise that a simulation averages out. The acceleration keeps its cut-off.
OF_SIMULATION = (1e-3,)
RAISED = 4.0  # times at most: the filter's bias is then a sixteenth
_WORTH_RAISING = 1.7  # times at least: less changes little but where a record begins and ends
LONGEST_LOOK = 1 << 18  # samples from which a spectrum or a noise is taken: 64 segments of the spectrum, known to 12 %
FEW_ROWS = 400  # that are compared: fewer do not show a bend of the curve

Run = tuple[Array, Array]


def by_effect(runs: Sequence[Run], position: bool, cutoff: float, step: float) -> float:
    """The cut-off, raised where a plain regression of the force misses clearly less with a higher one.

    The force is compared in one band whatever the cut-off, so that only what the filter does to the motion makes the difference:
    noise of the speed and the acceleration above, rounded ramps and reversals below. Noise that a coarse scale's acceleration has
    above that band is seen over all frequencies, so that none is taken that misses more there than a lower one. The reverse says
    nothing: a controller's force follows the noise of what it measures.

    Args:
        runs: measured motion and force of each.
        position: the motion is a position, not a speed.
        cutoff: Hz, the lowest to be tried; ``step``: between samples, s.
    """
    tried = [cutoff]
    while tried[-1] * _RAISE < HIGHEST / step:
        tried.append(tried[-1] * _RAISE)
    longest, period = max((len(f) for _, f in runs), default=0), 1 / (cutoff * step)
    edge = int(np.clip(longest // _SHARE, ASTRAY * period, SETTLED * period))
    chosen = _some([r for r in runs if len(r[1]) >= 4 * edge + 2])
    inside = [slice(edge, len(f) - _end(x, position, cutoff, step)) for x, f in chosen]
    if len(tried) < 2 or sum(rows.stop - rows.start for rows in inside) < FEW_ROWS:
        return cutoff
    band = min(_BAND * cutoff, HIGHEST / step)
    missed = [_missed(chosen, inside, position, c, band, step) for c in tried]
    over_all = [_missed(chosen, inside, position, c, None, step) for c in tried]
    able = [i for i, m in enumerate(over_all) if m <= _NO_WORSE * min(over_all[: i + 1])]
    least = min(missed[i] for i in able)
    if least > _CLEARLY * missed[0]:
        return cutoff
    return tried[next(i for i in able if missed[i] <= _AS_GOOD * least)]


def quiet(
    motion: Array, position: bool, floor: float, cutoff: float, step: float, shares: Sequence[float] = OF_REGRESSION
) -> float:
    """The cut-off, up to four times as high while the noise of the speed and of the acceleration is little.

    A filter at the edge of the spectrum still rounds off what lies below it: the speed near a reversal, where friction turns, is
    off by some tenths of a percent of the largest.

    Args:
        motion: what was measured of a run, ``position``: and not a speed.
        floor: the power spectral density of its noise; ``cutoff``: Hz, so far; ``step``: between samples, s.
        shares: of the largest speed, and of the largest acceleration unless it is filtered by itself, that noise may be.
    """
    smooth = low_pass(motion[:LONGEST_LOOK], cutoff, step)
    edge = min(round(1 / (cutoff * step)), len(smooth) // 4)  # where the filter makes acceleration of its own
    smooth = smooth[edge : len(smooth) - edge]
    highest = min(RAISED * cutoff, HIGHEST / step)
    for order, share in zip((1, 2) if position else (0, 1), shares, strict=False):
        largest = float(np.max(abs(np.diff(smooth, order)))) / step**order
        power = 2 * order + 1  # the noise's variance: floor (2 pi)^(2 order) f^power / power
        allowed = power * (share * largest) ** 2 / ((2 * np.pi) ** (2 * order) * max(floor, 1e-300))
        highest = min(highest, float(allowed ** (1 / power)))
    return float(highest if highest > _WORTH_RAISING * cutoff else cutoff)


def _some(runs: Sequence[Run]) -> list[Run]:
    """Runs evenly out of all, of few enough rows together."""
    every, selection = max(sum(len(f) for _, f in runs) // ENOUGH_ROWS, 1), []
    for motion, force in runs[::every]:
        selection.append((motion[:ENOUGH_ROWS], force[:ENOUGH_ROWS]))
    return selection


def _end(motion: Array, position: bool, cutoff: float, step: float) -> int:
    """The rows to leave out at the end of a run: none where it comes to rest there, and the ramp before is worth a look."""
    few = max(round(_SLOWED / (cutoff * step)), 1)
    speed = abs(motion[few:] - motion[:-few]) / few if position else abs(motion)
    at_end = speed[-1] if position else abs(motion[-few:].mean())
    return round(ASTRAY / (cutoff * step)) if at_end > _REST * float(speed.max()) else 0


def _missed(
    runs: Sequence[Run], inside: Sequence[slice], position: bool, cutoff: float, band: float | None, step: float
) -> float:
    """What a regression on acceleration, a free odd curve of the speed and a constant misses of the force in a band (Hz; None
    for all frequencies); beside a measured position also a weight's and a spring's share, which may be most of it."""
    motions = []
    for motion, _ in runs:
        x = low_pass(motion, cutoff, step)
        v = np.gradient(x, step) if position else x
        place = (x - x[0], np.sin(x), np.cos(x)) if position else ()
        motions.append((v, np.gradient(v, step), *place))
    speeds = np.abs(np.concatenate([v[rows] for (v, *_), rows in zip(motions, inside, strict=True)]))
    knots = np.unique(np.quantile(speeds, _BENDS))
    matrix, force = [], []
    for (v, *rest), (_, f), rows in zip(motions, runs, inside, strict=True):
        bends = [np.interp(abs(v), knots, unit) * np.sign(v) for unit in np.eye(len(knots))]
        passed = [(low_pass(x, band, step) if band else x)[rows] for x in (*rest, *bends, f)]
        matrix.append(np.column_stack([*passed[:-1], np.ones(len(passed[0]))]))
        force.append(passed[-1])
    columns, target = np.concatenate(matrix), np.concatenate(force)
    size = np.maximum(np.sqrt(np.mean(columns**2, axis=0)), 1e-300)
    coefficients = np.linalg.lstsq(columns / size, target, rcond=1e-9)[0]
    return float(np.linalg.norm(target - columns / size @ coefficients))
