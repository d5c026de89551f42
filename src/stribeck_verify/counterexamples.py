"""A second look at what shows a *no*: the law's equations evaluated with 400 bits at points of what is stated.

It shares no code with what found it. It cannot prove the statement, which is about ranges, but contradicts one that is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from flint import arb, ctx

from stribeck_verify.expressions import Json

_BITS = 400  # 120 digits: a difference quotient over _TINY times _SHARE keeps more than half of them
_POINTS = 64  # samples of a stated motion: enough to catch a wrong statement; its proof is the enclosure
_NEAR = 1e-9  # of a place that is known to 1e-13
_TINY = 1e-30  # of a natural scale, beside an axis
_SHARE = 1e-6  # of the distance from the place: steps of difference quotients

Ball = Any  # flint's arb
Function = Callable[[Ball, Ball], Ball]
_OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": lambda a, b: a + b, "sub": lambda a, b: a - b, "mul": lambda a, b: a * b, "div": lambda a, b: a / b,
    "pow": lambda a, b: a**b, "neg": lambda a: -a, "abs": abs, "sign": arb.sgn, "floor": arb.floor,
    "exp": arb.exp, "log": arb.log, "sqrt": arb.sqrt, "sin": arb.sin, "cos": arb.cos, "atan": arb.atan, "tanh": arb.tanh,
    "lt": lambda a, b: a < b, "le": lambda a, b: a <= b, "both": lambda a, b: a and b, "either": lambda a, b: a or b,
}  # fmt: skip


def confirmed(law: Mapping[str, Json], name: str, evidence: Mapping[str, Json]) -> bool | None:
    """Whether the points agree with what the evidence states; None where it states nothing that can be looked at.

    Args:
        law: its equations as plain data (:mod:`stribeck_verify.equations`).
        name: of the property that it lacks.
        evidence: what ``stribeck check --json`` gives for it.
    """
    looks = {"bounded": _outward, "unique": _escapes, "drift_free": _departs, "smooth": _differs}
    if name not in looks:
        return None

    def rate(v: Ball, z: Ball) -> Ball:
        return evaluate(law, "dz_dt", v=v, z=z)

    def force(v: Ball, z: Ball) -> Ball:
        return evaluate(law, "force", v=v, z=z, dz_dt=rate(v, z))

    with ctx.workprec(_BITS):
        try:
            return looks[name](law, evidence, force if evidence.get("of") == "F" else rate)
        except (KeyError, TypeError, ValueError, ZeroDivisionError):
            return None


def evaluate(law: Mapping[str, Json], what: str, **at: Ball) -> Ball:
    """One of a law's trees at a point."""
    known = {n: arb(x) for n, x in law["constants"].items()} | {"pi": arb.pi()} | at
    done: dict[int, Ball] = {}

    def value(x: Json) -> Ball:
        if isinstance(x, str):
            return known[x]
        if not isinstance(x, list):
            return arb(x)
        if id(x) not in done:
            op, *args = x
            done[id(x)] = (
                value(args[1 if value(args[0]) else 2]) if op == "where" else _OPERATIONS[op](*map(value, args))
            )
        return done[id(x)]

    return value(law[what])


def _between(start: float, end: float) -> list[Ball]:
    return [arb(start) + (arb(end) - arb(start)) * k / _POINTS for k in range(1, _POINTS + 1)]


def _outward(law: Mapping[str, Json], evidence: Mapping[str, Json], rate: Function) -> bool:
    """dz/dt is at least what is stated on the way, and the way leads past Z."""
    stated = evidence["enclosed"]
    way = 1 if stated["z_to"] > stated["z_from"] else -1
    past = abs(stated["z_to"]) > evaluate(law, "Z") and stated["dz_dt_at_least"] > 0
    v, least = arb(stated["v"]), arb(stated["dz_dt_at_least"])
    return bool(past and all(rate(v, z) * way >= least for z in _between(stated["z_from"], stated["z_to"])))


def _escapes(law: Mapping[str, Json], evidence: Mapping[str, Json], rate: Function) -> bool:
    """|dz/dt| is at least c |z|^power, outward, far out too."""
    start, v = arb(evidence["z_start"]), arb(evidence["v"])
    c, power = arb(evidence["enclosed"]["c"]), int(evidence["enclosed"]["power"])
    points = [start * arb(2) ** k for k in range(4 * _POINTS)]
    return power >= 2 and all(bool(rate(v, z) * start.sgn() >= c * abs(z) ** power) for z in points)


def _departs(law: Mapping[str, Json], evidence: Mapping[str, Json], rate: Function) -> bool | None:
    """dz/dt is not v near z = 0; None where it differs by less than 400 bits show."""
    stated = evidence["not_elastic"]
    v = arb(stated["v"])
    near = [arb(stated["z_to"]) * arb(2) ** -k for k in range(_POINTS)]
    if any(bool(rate(v, z) == v) for z in near):
        return False
    return True if all(bool(rate(v, z) != v) for z in near) else None


def _differs(law: Mapping[str, Json], evidence: Mapping[str, Json], of: Function) -> bool | None:
    """The value, or the derivative, on each side of the place is what is stated: nearer to its own side's than the other's."""
    place = [arb(evidence["v"]), arb(evidence["z"])]
    scales = law["scales"]["speed"], law["scales"]["length"]
    beside = [abs(x) * _NEAR if x != 0 else arb(size) * _TINY for x, size in zip(place, scales, strict=True)]
    by = {"by v": 0, "by z": 1}.get(str(evidence["derivative"])[-4:])

    def beside_place(moved: int, distance: Ball) -> Ball:
        """The value, or its difference quotient, at a distance from the place."""
        point = list(place)
        point[moved] = point[moved] + distance
        if by is None:
            return of(*point)
        step = (beside[by] if place[by] == 0 or by == moved else abs(place[by]) * _NEAR) * _SHARE
        ends = []
        for way in (-1, 1):
            end = list(point)
            end[by] = end[by] + way * step
            ends.append(of(*end))
        return (ends[1] - ends[0]) / (2 * step)

    below, above = (arb(evidence[n]) for n in ("from_below", "from_above"))
    gap = abs(above - below) / 4
    for moved in (0, 1):
        # along the line through two points, to the place itself: what changes on the way may be more than the gap
        extrapolated = [
            2 * beside_place(moved, side * beside[moved]) - beside_place(moved, 2 * side * beside[moved])
            for side in (-1, 1)
        ]
        for first, second in ((below, above), (above, below)):
            if bool(abs(extrapolated[0] - first) < gap) and bool(abs(extrapolated[1] - second) < gap):
                return True
    return False
