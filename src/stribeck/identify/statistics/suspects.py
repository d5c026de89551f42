"""Friction that no term here is: what a residual is asked for beside the terms, so that intervals reach to where a law with it
would put the numbers.

A bend of the curve at low speed (a Stribeck bend, a smooth sign, a second contact); a level that lags behind the speed;
friction that builds up over a way behind a reversal (bristles, Maxwell slips, backlash; Al-Bender, Lampaert, Swevers, IEEE
Trans. Autom. Control 50(11):1883-1887, 2005); and friction that grows with what a gear transmits.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.log import Log
from stribeck.identify.models.terms import TERMS, column

_WIDTHS = (0.01, 0.03, 0.08, 0.2)  # of a speed
_BOTH_WAYS = 0.1  # of the fastest speed
_WAYS = (1e-3, 3e-3, 1e-2, 3e-2, 1e-1)  # of the way between reversals
BEND = "a bend of the curve"
LOADS = ("stiffness", "gravity_sin", "gravity_cos", "area")  # with which it is known better what is transmitted
BUILDS = "friction that builds up"
LAG = "friction that lags behind the speed"
LOAD = "friction that grows with the load"
UNSTEADY = (BUILDS, LAG)


def bends(log: Log, speed: float) -> dict[str, Array]:
    """Columns of a curve that is another below shares of a speed, which fades exponentially: the fastest speed, or that of a
    bend that is there."""
    v = log.velocity
    made = {share * speed: np.sign(v) * np.exp(-abs(v) / (share * speed)) for share in _WIDTHS}
    return {f"{BEND} below {width:.2g} m/s": x for width, x in made.items()}


def builds_up(log: Log) -> dict[str, Array]:
    """Columns of friction that is not yet built up behind a reversal, and fades exponentially over a way."""
    gone, between = _since_reversals(log)
    if between <= 0:
        return {}
    way = np.sign(log.velocity)
    made = {share * between: way * np.exp(-gone / (share * between)) for share in _WAYS}
    return {f"{BUILDS} over {width:.2g} m behind reversals": x for width, x in made.items()}


def by_load(log: Log, values: Mapping[str, float]) -> Array:
    """The column of friction that grows with what is transmitted: inertia and the body's terms that are no friction.

    Args:
        values: the terms' coefficients.
    """
    load = np.zeros(len(log))
    for name, term in TERMS.items():
        if values.get(name) and term.column is not None and not (term.level or term.friction):
            load += values[name] * column(name, log, values)
    return np.asarray(np.sign(log.velocity) * abs(load))


def _since_reversals(log: Log) -> tuple[Array, float]:
    """The way gone since the last reversal, infinite before the first; and the way between two that half of all way is made
    in, or in longer ones, as a body at rest jitters to and fro; 0 where there are none."""
    gone, between = np.full(len(log), np.inf), [0.0]
    for rows in log.runs():
        y, sign = log.position[rows], np.sign(log.velocity[rows])
        if not turns(log.velocity[rows]):
            continue
        moving = np.flatnonzero(sign)
        at = moving[1:][sign[moving[1:]] != sign[moving[:-1]]]
        if not len(at):
            continue
        last = at[np.searchsorted(at, np.arange(at[0], len(y)), side="right") - 1]
        gone[rows.start + at[0] : rows.stop] = abs(y[at[0] :] - y[last])
        between += abs(np.diff(y[at])).tolist()
    ways = np.sort(between)
    made = np.cumsum(ways)
    return gone, float(ways[np.searchsorted(made, 0.5 * made[-1])])


def turns(v: Array) -> bool:
    """Whether a body goes both ways, and not by noise alone."""
    fastest = float(np.max(abs(v)))
    return bool(v.min() < -_BOTH_WAYS * fastest and v.max() > _BOTH_WAYS * fastest)
