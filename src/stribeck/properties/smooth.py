"""Continuous differentiability of dz/dt, and of F, in (v, z)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise, product

import numpy as np

from stribeck.expressions.graph import Expr, derivative, ordered
from stribeck.expressions.intervals import EVERYTHING, Box, Range
from stribeck.properties.certificate import Certificate, Claim
from stribeck.properties.claims import ClaimProver
from stribeck.properties.model import SIGNS, Model, U, W, depends, divided
from stribeck.properties.plain import Json
from stribeck.properties.prover.search import Budget, Spent
from stribeck.properties.switching import Joints, SwitchingSurface, present, switching_surfaces
from stribeck.properties.verdicts import Verdict, proved, undecided

_METHOD = (
    "dz/dt and F consist of functions that are smooth on the ranges of their arguments; where cases meet, values and first "
    "derivatives agree exactly"
)
_BROKEN = "one-sided derivatives of {} differ (bounds by interval arithmetic)"
_TORN = "values of {} on the two sides of a case differ (bounds by interval arithmetic)"
_APART = 1e-9  # of their size: a smaller difference may be rounding of a constant, and is no kink
# Of a law's natural speed or length: this near an axis, one-sided derivatives equal those on it, up to _APART
_TINY = 1e-12
_LOOKS, _CROSSING = 240.0, 4.0  # work of a search for kinks, and of one search for a crossing
_NAMES = ("dz/dt", "F")


def decide(model: Model, claims: ClaimProver) -> Verdict:
    """C1, if values and derivatives agree at every switching surface; not C1, if one-sided derivatives differ at a point."""
    proofs: list[Claim] = []
    reason = ""
    for name, expr in zip(_NAMES, (model.rate, model.power_force), strict=True):
        shown = _smooth(model, claims, expr)
        if isinstance(shown, str):
            reason = reason or shown.format(name)
            if (verdict := _kink(model, name, expr)) is not None:
                return verdict
        else:
            proofs += shown
    if reason:
        return undecided(reason)
    certificate = Certificate("smooth", "switching", proofs, {"of": ["dz_dt", "force"]})
    return proved(model, certificate, _METHOD, {"cases_that_meet": sum(c.about == "switching" for c in proofs)})


def _smooth(model: Model, claims: ClaimProver, expr: Expr) -> list[Claim] | str:
    joints = Joints(model, claims, expr)
    proofs: list[Claim] = []
    for s, t in product(SIGNS, SIGNS):
        form = model.form_of(expr, s, t)
        for node in ordered([form]):
            for part, relation in _delicate(model, node):
                claim = claims.divisor((s, t), part, relation, present(part))
                if claim is None:
                    return f"a {node.op} in {{}} may be singular somewhere"
                proofs.append(claim)
        for surface in switching_surfaces(form, (s, t)):
            shown = joints.at_condition(surface, 1)
            if shown is None:
                return f"could not show that the cases of {{}} meet smoothly where {surface.text}"
            proofs += shown
    for axis, side in product("vz", SIGNS):
        shown = joints.at_axis(axis, side, 1)
        if shown is None:
            return f"could not show that the cases of {{}} meet smoothly where {axis} = 0"
        proofs += shown
    return proofs


def _delicate(model: Model, node: Expr) -> Iterator[tuple[Expr, str]]:
    """The expressions that must not vanish or must be positive."""
    if node.op == "div":
        part, relation = node.args[1], "!=0"
    elif node.op in ("sqrt", "log"):
        part, relation = node.args[0], ">0"
    elif node.op == "pow":
        part, power = node.args
        low: Range = Box(model.inputs)(power) if not depends(power, U, W) else (0.0, 0.0)
        relation = ">=0" if low[0] > 1 else ">0"
    else:
        return
    if depends(part, U, W) or (part.op != "constant" and relation != ">=0"):
        yield part, relation


# -- kinks -------------------------------------------------------------------------------------------------------------


def _kink(model: Model, name: str, expr: Expr) -> Verdict | None:
    """A point where a first derivative, or the value, certainly differs between the two sides."""
    try:
        return next(_kinks(model, name, expr, Budget(_LOOKS)), None)
    except Spent:
        return None


def _kinks(model: Model, name: str, expr: Expr, work: Budget) -> Iterator[Verdict]:
    scales = model.law.scales(model.law.p)
    places = [
        (a * scales.speed, b * scales.length) for a in (1.0, 0.3, 3.0, 0.01) for b in (0.5, 0.9, 0.7, 0.3, 0.97, 0.997)
    ]
    for (speed, length), s, t in product(places, SIGNS, SIGNS):
        work.take()
        yield from _at_axis(model, name, expr, "v", t, length, speed)
        yield from _at_axis(model, name, expr, "z", s, speed, length)
        form = model.form_of(expr, s, t)
        for surface in switching_surfaces(form, (s, t)):
            yield from _at_surface(model, name, surface, (speed, length), work)


def _at_axis(
    model: Model, name: str, expr: Expr, axis: str, side: int, other: float, reach: float
) -> Iterator[Verdict]:
    """A difference between both sides of v = 0 (or z = 0), at one value of the other variable."""
    here, there = (U, W) if axis == "v" else (W, U)
    sides = [(t, side) if axis == "v" else (side, t) for t in SIGNS]
    point = (0.0, other * side) if axis == "v" else (other * side, 0.0)
    box = {**model.inputs, str(here.value): (0.0, reach * _TINY), str(there.value): _from(other)}
    forms = [model.form_of(expr, *each) for each in sides]
    if Box(box)(model.form_of(expr, 0, side) if axis == "v" else model.form_of(expr, side, 0)) == (0.0, 0.0):
        # 0 at v = 0: the quotients (f(v) - 0)/v for all small v of either sign, where derivatives have no finite range
        quotients = [divided(f, here) for f in forms]
        above, below = (
            _signed(_range(q, box) if q is not None else EVERYTHING, here, each)
            for q, each in zip(quotients, sides, strict=True)
        )
        if _apart(above, below):
            yield _verdict(name, f"{axis} = 0", point, here, above, below)
    for by in (here, there, None):
        above, below = (_slope(f, by, each, box) for f, each in zip(forms, sides, strict=True))
        if _apart(above, below):
            yield _verdict(name, f"{axis} = 0", point, by, above, below)


def _at_surface(
    model: Model, name: str, surface: SwitchingSurface, guess: tuple[float, float], work: Budget
) -> Iterator[Verdict]:
    """A difference between both sides of a switching surface, at one value of either variable."""
    difference, sides = surface.condition.args[0] - surface.condition.args[1], surface.sides
    for x, y, given in ((W, U, guess[0]), (U, W, guess[1])):
        if not depends(difference, x):
            continue
        work.take(_CROSSING)
        place = _crossing(model, difference, x, y, given, guess[1] if x is W else guess[0])
        if place is None:
            continue
        box = {**model.inputs, str(x.value): place, str(y.value): _from(given)}
        middle = 0.5 * (place[0] + place[1])
        u, w = (given, middle) if x is W else (middle, given)
        rising = _slope(difference, x, sides, box)[0] > 0  # the condition then holds below
        for by in (U, W, None):
            a, b = (_slope(f, by, sides, box) for f in (surface.if_true, surface.if_false))
            if _apart(a, b):
                above, below = (b, a) if rising else (a, b)
                yield _verdict(name, surface.text, (u * sides[0], w * sides[1]), by, above, below)


def _slope(form: Expr, by: Expr | None, sides: tuple[int, int], box: dict[str, Range]) -> Range:
    """The range of the derivative by v (``by`` U) or z (W), or of the value, of a form for v and z of these signs."""
    slope = _range(form, box, by)
    return slope if by is None else _signed(slope, by, sides)


def _signed(slope: Range, by: Expr, sides: tuple[int, int]) -> Range:
    """A derivative by u = |v| (or w = |z|) as one by v (or z)."""
    return slope if sides[0 if by is U else 1] > 0 else (-slope[1], -slope[0])


def _crossing(model: Model, difference: Expr, x: Expr, y: Expr, given: float, guess: float) -> Range | None:
    """A small interval of x in which a condition certainly switches, with a monotonic difference."""
    beside = {**model.inputs, str(y.value): _from(given)}

    def value(place: float) -> Range:
        return Box({**beside, str(x.value): (place, place)})(difference)  # type: ignore[no-any-return]

    hints = model.prover.hints
    known = np.array([float(a) for a in (hints.speeds if x is U else hints.lengths)])
    points = np.sort(np.concatenate([guess * np.geomspace(1e-4, 1e4, 161), known * 0.9, known * 1.1]))
    signs = {place: sign for place in points.tolist() if (sign := _sign(value(place)))}
    for low, high in pairwise(signs):
        if signs[low] == signs[high]:
            continue
        first = signs[low]
        while high - low > 1e-13 * high:
            middle = 0.5 * (low + high)
            sign = _sign(value(middle))
            if sign == 0 or not low < middle < high:
                break
            low, high = (middle, high) if sign == first else (low, middle)
        slope = _range(difference, {**beside, str(x.value): (low, high)}, x)
        if high - low <= 1e-6 * high and (slope[0] > 0 or slope[1] < 0):
            return low, high
    return None


def _sign(x: Range) -> int:
    return 1 if x[0] > 0 else -1 if x[1] < 0 else 0


def _from(x: float) -> Range:
    """A place as a range with an inside: on a line alone a case may hold that holds nowhere beside it."""
    return x, math.nextafter(x, math.inf)


def _range(expr: Expr, box: dict[str, Range], by: Expr | None = None) -> Range:
    """The range of an expression, or of its derivative; all numbers if a case of the expression is undecided in the box."""
    evaluated = Box(box)
    value: Range = evaluated(expr)
    unsettled = any(n.op in ("lt", "le") and evaluated.known[n] is None for n in ordered([expr]))
    return EVERYTHING if unsettled else value if by is None else evaluated(derivative(expr, by))


def _apart(a: Range, b: Range) -> bool:
    """Whether two ranges differ by more than rounding; never if one has no end, as no gap exceeds its size."""
    gap = max(a[0] - b[1], b[0] - a[1])
    return gap > _APART * max(abs(a[0]), abs(a[1]), abs(b[0]), abs(b[1]))


def _verdict(name: str, where: str, point: tuple[float, float], by: Expr | None, above: Range, below: Range) -> Verdict:
    what = "value" if by is None else f"derivative of {name} by {'v' if by is U else 'z'}"
    evidence: dict[str, Json] = {
        "of": name, "v": point[0], "z": point[1], "where": where,
        "derivative": what if by is not None else f"value of {name}",
        "from_below": 0.5 * (below[0] + below[1]), "from_above": 0.5 * (above[0] + above[1]),
        "enclosed": {"from_below": list(below), "from_above": list(above)},
    }  # fmt: skip
    return Verdict(False, (_BROKEN if by is not None else _TORN).format(name), evidence)
