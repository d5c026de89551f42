"""A second look at what shows a *no*: the law's own functions evaluated with 400 bits at points of what is stated.

It shares no code with what found it. It cannot prove the statement, which is about ranges, but contradicts one that is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

from flint import arb, ctx

from stribeck.expressions import ops
from stribeck.laws.base import Law
from stribeck.properties.verify_certificate.expressions import Json

_BITS = 400
_POINTS = 64
_NEAR = 1e-9  # of a place that is known to 1e-13
_TINY = 1e-30  # of a natural scale, beside an axis
_SHARE = 1e-6  # of the distance from the place: steps of difference quotients

_table = SimpleNamespace(
    exp=arb.exp, log=arb.log, sqrt=arb.sqrt, sin=arb.sin, cos=arb.cos, atan=arb.atan, tanh=arb.tanh, sign=arb.sgn,
    floor=arb.floor, where=lambda c, a, b: arb(a) if c else arb(b), both=lambda a, b: a and b, either=lambda a, b: a or b,
)  # fmt: skip
ops.register("flint", _table)

Ball = Any  # flint's arb
Function = Callable[[Ball, Ball], Ball]


def confirmed(law: Law, name: str, evidence: Mapping[str, Json]) -> bool | None:
    """Whether the points agree with what the evidence states; None where it states nothing that can be looked at."""
    looks = {"bounded": _outward, "unique": _escapes, "drift_free": _departs, "smooth": _differs}
    if name not in looks:
        return None
    p = SimpleNamespace(**{n: x if x is None else arb(x) for n, x in law.values.items()}, **law.choices)

    def rate(v: Ball, z: Ball) -> Ball:
        return law.dz_dt(p, v, z)

    def force(v: Ball, z: Ball) -> Ball:
        return law.friction(p, v, z, rate(v, z))

    with ctx.workprec(_BITS):
        try:
            return looks[name](law, evidence, force if evidence.get("of") == "F" else rate)
        except (KeyError, TypeError, ValueError, ZeroDivisionError):
            return None


def _between(start: float, end: float) -> list[Ball]:
    return [arb(start) + (arb(end) - arb(start)) * k / _POINTS for k in range(1, _POINTS + 1)]


def _outward(law: Law, evidence: Mapping[str, Json], rate: Function) -> bool:
    """dz/dt is at least what is stated on the way, and the way leads past Z."""
    stated = evidence["enclosed"]
    way = 1 if stated["z_to"] > stated["z_from"] else -1
    past = abs(stated["z_to"]) > float(law.z_bound(law.p)) and stated["dz_dt_at_least"] > 0
    v, least = arb(stated["v"]), arb(stated["dz_dt_at_least"])
    return bool(past and all(rate(v, z) * way >= least for z in _between(stated["z_from"], stated["z_to"])))


def _escapes(law: Law, evidence: Mapping[str, Json], rate: Function) -> bool:
    """|dz/dt| is at least c |z|^power, outward, far out too."""
    start, v = arb(evidence["z_start"]), arb(evidence["v"])
    c, power = arb(evidence["enclosed"]["c"]), int(evidence["enclosed"]["power"])
    points = [start * arb(2) ** k for k in range(4 * _POINTS)]
    return power >= 2 and all(bool(rate(v, z) * start.sgn() >= c * abs(z) ** power) for z in points)


def _departs(law: Law, evidence: Mapping[str, Json], rate: Function) -> bool | None:
    """dz/dt is not v near z = 0; None where it differs by less than 400 bits show."""
    stated = evidence["not_elastic"]
    v = arb(stated["v"])
    near = [arb(stated["z_to"]) * arb(2) ** -k for k in range(_POINTS)]
    if any(bool(rate(v, z) == v) for z in near):
        return False
    return True if all(bool(rate(v, z) != v) for z in near) else None


def _differs(law: Law, evidence: Mapping[str, Json], of: Function) -> bool | None:
    """The value, or the derivative, beside the place is what is stated: nearer to its own side's than to the other's."""
    place = [arb(evidence["v"]), arb(evidence["z"])]
    scales = law.scales(law.p)
    beside = [
        abs(x) * _NEAR if x != 0 else arb(size) * _TINY
        for x, size in zip(place, (scales.speed, scales.length), strict=True)
    ]
    below, above = (arb(evidence[n]) for n in ("from_below", "from_above"))
    gap = abs(above - below) / 4
    by = {"by v": 0, "by z": 1}.get(str(evidence["derivative"])[-4:])
    for moved in (0, 1):
        found = []
        for side in (-1, 1):
            at = list(place)
            at[moved] = at[moved] + side * beside[moved]
            if by is None:
                found.append(of(*at))
                continue
            step = (beside[by] if place[by] == 0 or by == moved else abs(place[by]) * _NEAR) * _SHARE
            ends = []
            for way in (-1, 1):
                end = list(at)
                end[by] = end[by] + way * step
                ends.append(of(*end))
            found.append((ends[1] - ends[0]) / (2 * step))
        for first, second in ((below, above), (above, below)):
            if bool(abs(found[0] - first) < gap) and bool(abs(found[1] - second) < gap):
                return True
    return False
