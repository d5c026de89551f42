"""Damping that falls with speed, so small that no z and no history of the level can draw energy (docs/theory.md, `v_d`)."""

from __future__ import annotations

from fractions import Fraction
from itertools import chain

from stribeck.laws.base import Law
from stribeck.laws.terms import m_0
from stribeck.properties.certificate import Certificate
from stribeck.properties.claims import ClaimProver, every
from stribeck.properties.model import SIGNS, Model
from stribeck.properties.plain import Json

METHOD = (
    "sigma_1 (v_d/sqrt(2 e) + m(0)) <= 4 N, where dz/dt = v - q z with 0 <= N q <= sigma_0 (|v| + m(0)): the power lost is "
    "nowhere negative, for every z, with the elastic energy as storage S"
)
_NEEDED = ("sigma_0", "sigma_1", "sigma_2", "v_d", "F_c", "F_s")
_ROUNDING = Fraction(1, 2**44)  # more than that of m(0)


def small_enough(sigma_1: Fraction, v_d: Fraction, above: Fraction, least: Fraction) -> bool:
    """Whether sigma_1 (v_d/sqrt(2 e) + m(0)) <= 4 N, by arithmetic that encloses; ``above`` is m(0), ``least`` N."""
    from flint import arb, ctx

    with ctx.workprec(256):
        ball = [arb(x.numerator) / arb(x.denominator) for x in (sigma_1, v_d, above, least)]
        return bool(ball[0] * (ball[1] / (2 * arb(1).exp()).sqrt() + ball[2]) <= 4 * ball[3])


def excess(law: Law) -> Fraction:
    """m(0) of a law with a majorant of |v|, rounded up; 0 of one without."""
    return Fraction(float(m_0(law.p))) * (1 + _ROUNDING) if "smooth_abs" in law.choices else Fraction(0)


def suffices(law: Law | None) -> bool:
    """Whether the condition holds for a law with v_d, such as the one that stands for the worst of all levels."""
    if law is None or any(law.values.get(n) is None for n in _NEEDED):
        return False
    sigma_1, v_d, *newtons = (Fraction(law.p.numbers[n]) for n in ("sigma_1", "v_d", "F_c", "F_s"))
    return small_enough(sigma_1, v_d, excess(law), min(newtons))


def prove(model: Model, claims: ClaimProver) -> Certificate | None:
    """The certificate; None where the condition does not hold, or the law is of another form."""
    if not suffices(model.law):
        return None
    k, sigma_1, sigma_2, v_d = (model.values[f"c_{n}"] for n in _NEEDED[:4])
    least, above = min(model.values["c_F_c"], model.values["c_F_s"]), excess(model.law)
    data: dict[str, Json] = {"k": k, "s": sigma_1, "d": v_d, "c": sigma_2, "N": least, "above": above}
    sides = [(s, t) for t in SIGNS for s in (0, *SIGNS)]
    if not all(claims.force_form(s, t, data) for s in (0, *SIGNS) for t in (0, *SIGNS)):
        return None
    shown = every(
        chain(
            (claims.follows(s) for s in (0, *SIGNS)),
            (claims.decays(s, t) for s, t in sides),
            (claims.exceeds(s, t, data) for s, t in sides),
        )
    )
    return Certificate("passive", "damped", shown, data) if shown is not None else None
