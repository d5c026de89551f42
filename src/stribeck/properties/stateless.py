"""Passivity of laws without an internal state z."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from stribeck.expressions.graph import ZERO, Expr, derivative, is_zero, ordered, substitute, symbol, symbols, wrap
from stribeck.laws.base import Law
from stribeck.properties.claims import NULL
from stribeck.properties.model import SIGNS, Model
from stribeck.properties.prover.search import Budget
from stribeck.properties.verdicts import Verdict, undecided
from stribeck.properties.worst import Varied

_WORK = 400  # regions: with one variable, a sixth of a whole check suffices
_STATIC = (
    "F v >= 0 for every {} and every history of its constants (F is affine in those that vary, each part with v's sign)"
)
# Speeds of the search for a counterexample: decades around the law's natural speed, eight a decade. Speeds that draw energy
# form an interval, so a finer grid finds smaller intervals.
_DECADES, _A_DECADE = 6, 8


def decide(varied: Varied, v_max: float | None, name: str) -> Verdict:
    """The verdict on a property of a law without z: on passivity, which needs no z; the others are undecided."""
    if name == "passive":
        return static_passive(varied, v_max)
    return undecided(f"law '{varied.law.name}' has no internal state z, to which the property refers")


def static_passive(varied: Varied, v_max: float | None = None) -> Verdict:
    """Whether F v >= 0, which makes a law without z passive.

    If F is affine in the varying constants, signs of polynomials decide: of the remainder and of each constant's factor. If
    all are >= 0, the law is passive for every history of the constants. If nothing varies, a speed with F v < 0 refutes it."""
    law, names = varied.law, list(varied.ranges)  # a fixed constant may differ from its nominal value
    cls = type("_WithBound", (type(law),), {"name": law.name, "z_bound": staticmethod(lambda p: wrap(1.0))})
    model = Model(cls({**law.machine, **law.values, **law.choices}, law.rotary))
    parts = _affine(model.power_force, [symbol(f"c_{n}") for n in names])
    if parts is None:
        return undecided(f"the law has no z, and is not affine in {', '.join(names)}, which vary")
    most, work = None if v_max is None else Fraction(v_max), Budget(_WORK)
    for part in parts:
        for s in SIGNS:
            power = model.form_of(part, s, 1) * s
            if not is_zero(power) and model.prover.show(power, ">=0", {"u": (NULL, most)}, work) is None:
                return (None if names else _driving(law, model, v_max)) or undecided("no proof that F v >= 0 was found")
    return Verdict(True, _STATIC.format("v" if v_max is None else "|v| <= v_max"), {})


def _driving(law: Law, model: Model, v_max: float | None) -> Verdict | None:
    """A speed at which the force drives, found in floats and proved by exact bounds, or None."""
    scale = float(law.scales(law.p).speed) if v_max is None else v_max
    speeds = scale * np.logspace(-_DECADES, 0.0 if v_max is not None else _DECADES, _A_DECADE * _DECADES + 1)
    for s in SIGNS:
        power = model.form_of(model.power_force, s, 1) * s
        for v in speeds[s * law.force(s * speeds) < 0]:
            at = Fraction(float(v))
            if model.prover.show(-power, ">0", {"u": (at, at)}, Budget(_WORK)) is not None:
                evidence = {"v": s * float(v), "F": float(law.force(s * float(v)))}
                return Verdict(False, "F v < 0 at a speed: a motion at this speed draws energy", evidence)
    return None


def _affine(force: Expr, by: list[Expr]) -> list[Expr] | None:
    """The force with some constants at 0, and its slope by each of them; None if it is not affine in them."""
    kinks = [node for node in ordered([force]) if node.op in ("lt", "le", "sign", "floor")]
    slopes = [derivative(force, each) for each in by]
    if {str(x.value) for x in by} & symbols([*kinks, *slopes]):
        return None
    return [*substitute([force], dict.fromkeys(by, ZERO)), *slopes]
