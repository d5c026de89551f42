"""Existence and uniqueness of z(t) for every piecewise continuous v(t)."""

from __future__ import annotations

from time import monotonic
from typing import Any

import numpy as np

from stribeck.expressions.boxes import grid
from stribeck.expressions.graph import derivative
from stribeck.expressions.intervals import Evaluator, Interval
from stribeck.properties import replay
from stribeck.properties.elastic import speed_edges
from stribeck.properties.model import over_u, reciprocal
from stribeck.properties.seams import Quadrants, W
from stribeck.properties.storage import own_speeds
from stribeck.properties.verdicts import Verdict, later, undecided

_METHOD = (
    "dz/dt is continuous (exact algebra where its cases meet) and Lipschitz in z, uniformly over bounded v: "
    "its derivative by z is bounded on boxes that cover {} (interval arithmetic)"
)
_ROUNDS = 4


def decide(quadrants: Quadrants, reach: float | None, deadline: float) -> Verdict:
    """Lipschitz for all z, or within the bound that z keeps."""
    seams = quadrants.seams()
    torn = [seam for seam in seams if not quadrants.meet(seam, 0)]
    if not torn and quadrants.at_rest():
        length = reach if reach is not None else quadrants.model.law.scales(quadrants.model.law.p).length
        everywhere = [0.0, length, 4 * length, np.inf]
        for edges, words in (
            (everywhere, "all v and z"),
            ([0.0, length], "all v and |z| <= Z, which z does not leave"),
        ):
            if (words == "all v and z" or reach is not None) and (bound := _lipschitz(quadrants, edges, deadline)):
                evidence = {"lipschitz": {"at_rest": bound[0], "per_speed": bound[1]}, "seams": len(seams)}
                return Verdict(True, _METHOD.format(words), evidence, again=lambda e=edges: _again(quadrants, e))  # type: ignore[misc]
    if (escape := _escape(quadrants)) is not None:
        return escape
    if torn:
        return undecided(f"dz/dt may jump where {torn[0].text}")
    return undecided("no bound on the derivative of dz/dt by z was found")


def _again(quadrants: Quadrants, edges: list[float]) -> bool:
    whole = all(quadrants.meet(seam, 0) for seam in quadrants.seams())
    return whole and _lipschitz(quadrants, edges, later()) is not None


def _lipschitz(quadrants: Quadrants, w_edges: list[float], deadline: float) -> tuple[float, float] | None:
    """(a, b) with |d(dz/dt)/dz| <= a + b |v|, in 1/s and 1/m; None where no bound is found."""
    at_rest = per_speed = 0.0
    for form in quadrants.form.values():
        slope = derivative(form, W)
        evaluate = Evaluator([slope, over_u(slope)])
        low, high = grid([speed_edges(quadrants.model, None), w_edges])
        for _ in range(_ROUNDS):
            u = Interval(low[0], high[0])
            plain, by_speed = (
                np.broadcast_to(np.maximum(abs(x.low), abs(x.high)), low.shape[1:])
                for x in evaluate({**quadrants.domain, "u": u, "t": reciprocal(u), "w": Interval(low[1], high[1])})
            )
            good = np.isfinite(plain) | np.isfinite(by_speed)
            if good.all():
                break
            middle = np.where(np.isinf(high), 8 * np.maximum(low, 1e-300), 0.5 * (low + high))[:, ~good]
            low, high = _quartered(low, high, ~good, middle)
            if monotonic() > deadline:
                return None
        else:
            return None
        at_rest = max(at_rest, float(np.max(plain, where=np.isfinite(plain), initial=0.0)))
        per_speed = max(per_speed, float(np.max(by_speed, where=~np.isfinite(plain), initial=0.0)))
    return at_rest, per_speed


def _quartered(low: Any, high: Any, bad: Any, middle: Any) -> tuple[Any, Any]:
    lows, highs = [low[:, ~bad]], [high[:, ~bad]]
    for first in (True, False):
        for second in (True, False):
            upper = np.array([[not first], [not second]])
            lows.append(np.where(upper, middle, low[:, bad]))
            highs.append(np.where(upper, high[:, bad], middle))
    return np.hstack(lows), np.hstack(highs)


def _escape(quadrants: Quadrants) -> Verdict | None:
    """A held speed that takes z to infinity in finite time: dz/dt grows faster than z."""
    law = quadrants.model.law
    length = law.scales(law.p).length
    for v in (x * side for x in own_speeds(law) for side in (1, -1)):
        for side in (1, -1):
            z = side * length * np.logspace(0, 12, 4000)
            with np.errstate(all="ignore"):
                outward = side * law.rate(v, z)
                power = np.log(outward[-1] / outward[2000]) / np.log(z[-1] / z[2000])
            if not (np.all(outward > 0) and np.isfinite(power) and power > 1.02):
                continue
            time = float(np.trapezoid(1 / outward, abs(z)))
            drive, end = replay.velocity_drive([v], [2 * time])
            tables = replay.scenario_of(law, "unique", drive, end, {"initial": {"z": float(z[0])}})
            evidence = {"v": v, "z_start": float(z[0]), "escape_time": time, "growth": f"dz/dt ~ |z|^{power:.3g}"}
            return Verdict(False, "a held speed takes z to infinity in finite time (quadrature)", evidence, tables)
    return None
