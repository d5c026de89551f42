"""Proof of passivity for damping that falls with speed and is small, for every z and history of the level."""

from __future__ import annotations

from fractions import Fraction
from itertools import chain
from math import exp, floor

from stribeck.arrays import Array
from stribeck.laws.base import Law
from stribeck.laws.terms import m_0
from stribeck.properties.certificate import Certificate
from stribeck.properties.claims import ClaimProver, every
from stribeck.properties.model import SIGNS, Model
from stribeck.properties.plain import Json

METHOD = (
    "sigma_1 (v_d/sqrt(2 e) + m(0)) <= 4 F_min, the lowest friction level, where dz/dt = v - q z with "
    "0 <= F_min q <= sigma_0 (|v| + m(0)): the dissipated power is never negative, for every z, with the elastic energy as "
    "storage S"
)
_FINER = (
    "a^2 (|v| + m(0)) <= 4 F_min (a + sigma_2) for every v, with a = sigma_1 exp(-(v/v_d)^2) and F_min the lowest friction "
    "level, where dz/dt = v - q z with 0 <= F_min q <= sigma_0 (|v| + m(0)): the dissipated power is never negative, for "
    "every z, with the elastic energy as storage S"
)
_NEEDED = ("sigma_0", "sigma_1", "sigma_2", "v_d", "F_c", "F_s")
_ROUNDING = Fraction(1, 2**44)  # exceeds the rounding of m(0)
_BEYOND = 1e3  # of the bound: beyond it all motion is plastic, and v is small compared with q z
_KNOTS, _DIGITS = 4000, 30  # of the finer condition: their number, and binary digits of each


def small_enough(sigma_1: Fraction, v_d: Fraction, above: Fraction, least: Fraction) -> bool:
    """Whether sigma_1 (v_d/sqrt(2 e) + m(0)) <= 4 N, by interval arithmetic; ``above`` is m(0), ``least`` N."""
    from flint import arb, ctx

    with ctx.workprec(256):
        ball = [arb(x.numerator) / arb(x.denominator) for x in (sigma_1, v_d, above, least)]
        return bool(ball[0] * (ball[1] / (2 * arb(1).exp()).sqrt() + ball[2]) <= 4 * ball[3])


def knots(
    sigma_1: Fraction, sigma_2: Fraction, v_d: Fraction, above: Fraction, least: Fraction
) -> list[Fraction] | None:
    """Shares 0 = x_0 < x_1 < ... of v_d that prove a^2 (|v| + m(0)) <= 4 N (a + sigma_2); None if there are none, or too many.

    Between two of them, a at the first and |v| at the second are bounds. Beyond the last, a |v| falls.
    With a = sigma_1 exp(-x^2): sigma_1 (v_d x + m(0)) <= 4 N (1 + (sigma_2/sigma_1) exp(x^2)) exp(x^2).
    """
    if not sigma_1 or not v_d:
        return None
    s, d, m, share = (float(x) for x in (sigma_1, v_d, above, sigma_2 / sigma_1))
    shares = [Fraction(0)]
    while len(shares) < _KNOTS:
        x = float(shares[-1])
        if x >= 1 and s * (d * x + m) * exp(-x * x) <= 4 * float(least) * (1 - 1e-9):
            return shares
        there = 4 * float(least) * exp(x * x) * (1 + share * exp(x * x)) * (1 - 1e-12)
        end = Fraction(floor(min((there / s - m) / d, x + 1) * 2**_DIGITS), 2**_DIGITS)
        if end <= shares[-1]:
            return None
        shares.append(end)
    return None


def unwinding(law: Law, v: Array, reach: float) -> Array:
    """q of dz/dt = v - q z beyond ``reach``, with fully plastic motion."""
    z = _BEYOND * reach
    return (v - law.rate(v, z)) / z


def excess(law: Law) -> Fraction:
    """m(0) of a law with a majorant of |v|, rounded up; otherwise 0."""
    return Fraction(float(m_0(law.p))) * (1 + _ROUNDING) if "smooth_abs" in law.choices else Fraction(0)


def method(certificate: Certificate) -> str:
    """The method of the certificate, in words."""
    return _FINER if "knots" in certificate.data else METHOD


def suffices(law: Law | None) -> bool:
    """Whether the condition holds for a law with v_d, such as the law of the worst level."""
    if law is None:
        return False
    sigma_1, v_d, *newtons = (Fraction(law.p.numbers[n]) for n in ("sigma_1", "v_d", "F_c", "F_s"))
    return small_enough(sigma_1, v_d, excess(law), min(newtons))


def prove(model: Model, claims: ClaimProver) -> Certificate | None:
    """The certificate, or None if the condition does not hold or the law has another form."""
    if any(model.law.values.get(n) is None for n in _NEEDED):
        return None
    k, sigma_1, sigma_2, v_d = (model.values[f"c_{n}"] for n in _NEEDED[:4])
    least, above = min(model.values["c_F_c"], model.values["c_F_s"]), excess(model.law)
    data: dict[str, Json] = {"k": k, "s": sigma_1, "d": v_d, "c": sigma_2, "N": least, "above": above}
    if not suffices(model.law):
        if (places := knots(sigma_1, sigma_2, v_d, above, least)) is None:
            return None
        data["knots"] = places
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
