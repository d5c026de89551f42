"""Continuous differentiability of dz/dt in (v, z)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from stribeck.expressions.graph import Expr
from stribeck.expressions.intervals import Evaluator, point
from stribeck.properties.model import U
from stribeck.properties.seams import Quadrants, Seam, W, solved
from stribeck.properties.verdicts import Verdict, undecided

_METHOD = (
    "exact algebra: dz/dt is built of analytic functions, and where its cases meet, values and first derivatives agree"
)
_BROKEN = "one-sided derivatives of dz/dt that differ, from the equations by interval arithmetic"


def decide(quadrants: Quadrants) -> Verdict:
    """C1: every seam joins values and derivatives; or not: a point where the one-sided derivatives differ."""
    bad = _bad(quadrants)
    if not bad and quadrants.regular and quadrants.at_rest():
        evidence = {"cases_that_meet": len(quadrants.seams())}
        return Verdict(True, _METHOD, evidence, again=lambda: not _bad(quadrants) and quadrants.at_rest())
    for seam in bad:
        for found in _differences(quadrants, seam):
            return found
    if not quadrants.regular:
        return undecided("a divisor, root, logarithm or power may be singular somewhere")
    where = bad[0].text if bad else "v = 0 or z = 0"
    return undecided(f"could not show that the cases of dz/dt meet smoothly where {where}")


def _bad(quadrants: Quadrants) -> list[Seam]:
    return [seam for seam in quadrants.seams() if not quadrants.meet(seam, 1)]


def _differences(quadrants: Quadrants, seam: Seam) -> Iterator[Verdict]:
    """Points of a seam where a first derivative certainly differs between the two sides."""
    law = quadrants.model.law
    scales = law.scales(law.p)
    for share_v in (1.0, 0.3, 3.0, 0.01):
        for share_z in (0.5, 0.9, 0.7, 0.3):
            guess: dict[Expr, float] = {U: share_v * scales.speed, W: share_z * scales.length}
            place = _place(quadrants, seam, guess)
            if place is None:
                continue
            for name, (a, b) in zip(("v", "z"), quadrants.slopes(seam), strict=True):
                inputs = {**quadrants.model.constants, "u": point(place[U]), "w": point(place[W])}
                right, left = Evaluator([a, b])(inputs)
                apart = (right.low > left.high) | (right.high < left.low)
                if np.all(apart) and np.all(np.isfinite([right.low, right.high, left.low, left.high])):
                    yield _verdict(seam, name, place, float(right.low), float(left.low), (a, b), quadrants)


def _verdict(
    seam: Seam, name: str, place: dict[Expr, float], right: float, left: float, forms: tuple[Expr, Expr], q: Quadrants
) -> Verdict:
    v, z = place[U] * seam.quadrant[0], place[W] * seam.quadrant[1]
    sides = {"v = 0": (v == 0, seam.quadrant[0]), "z = 0": (z == 0, seam.quadrant[1])}
    swap = sides.get(seam.text, (False, 1))[1] < 0
    unit = "" if name == "v" else " in 1/s"
    evidence = {
        "v": v, "z": z, "where": seam.text, "derivative": f"of dz/dt by {name}{unit}",
        "from_below": right if swap else left, "from_above": left if swap else right,
    }  # fmt: skip

    def again() -> bool:
        inputs = {**q.model.constants, "u": point(place[U]), "w": point(place[W])}
        above, below = Evaluator(forms)(inputs)
        return bool(np.all((above.low > below.high) | (above.high < below.low)))

    return Verdict(False, _BROKEN, evidence, again=again)


def _place(quadrants: Quadrants, seam: Seam, guess: dict[Expr, float]) -> dict[Expr, float] | None:
    """A point of the seam near the guess."""
    if seam.text in ("v = 0", "z = 0"):
        return {**guess, **dict.fromkeys(seam.there, 0.0)}
    for there in solved(seam.there):
        ((x, value),) = there.items()
        inputs = {**quadrants.model.constants, "u": point(guess[U]), "w": point(guess[W])}
        found = float(Evaluator([value])(inputs)[0].low)
        if np.isfinite(found) and found > 0:
            return {**guess, x: found}
    return None
