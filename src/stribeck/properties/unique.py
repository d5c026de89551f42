"""Existence and uniqueness of z(t) for every piecewise continuous v(t)."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from stribeck.arrays import Array
from stribeck.expressions.graph import derivative
from stribeck.properties.certificate import Certificate, Claim
from stribeck.properties.claims import NULL, ClaimProver, every
from stribeck.properties.escape import escape
from stribeck.properties.model import SIGNS, Model, W, depends
from stribeck.properties.plain import Json
from stribeck.properties.storage import own_speeds
from stribeck.properties.switching import Joints, switching_surfaces
from stribeck.properties.verdicts import Verdict, proved, undecided

METHOD = (
    "dz/dt is continuous in z (its cases meet exactly) and Lipschitz in z, uniformly over bounded v (its derivative by z is "
    "bounded in each region)"
)
_POWERS = (1, 2, 4)  # of the speed, in the bound of the slope: laws grow like v; two more for users' laws
_SLACK = 128.0  # any bound suffices, and a loose one needs few regions
_LEAST = 5e-324  # the smallest float above 0, in place of a slope that is 0


def prove(
    model: Model, claims: ClaimProver, bounded: Certificate | None, within: Fraction | None = None
) -> Certificate | str:
    """The certificate, for all z or for |z| <= within; or the reason why there is none."""
    proof = _continuous(model, claims)
    if isinstance(proof, str):
        return proof
    w: tuple[Fraction, Fraction | None] = (NULL, within)
    for growth in _growths(model, within):
        with claims.at_most(claims.work.left / 2):  # leaves work for the next claim
            more = every(claims.lipschitz((s, t), w, growth, r) for s in (0, *SIGNS) for t in SIGNS for r in SIGNS)
        if more is None:
            continue
        at_0 = {**growth, **{n: growth[n] * growth["l"] for n in "ab"}}  # m/s; the slope's bound is in 1/s
        rest = every(claims.finite(s, at_0, sign) for s in (0, *SIGNS) for sign in SIGNS)
        if rest is None:
            return "dz/dt at z = 0 is not shown to be finite"
        hypotheses = {}
        if growth["m"] and within is None:
            if bounded is not None and bounded.theorem == "outside":
                hypotheses["bounded"] = bounded
            else:
                tame = every(claims.grows((s, t), growth) for s in (0, *SIGNS) for t in SIGNS)
                if tame is None:
                    continue
                rest += tame
        if within is not None and bounded is not None:
            hypotheses["bounded"] = bounded
        data = {"within": within} if within is not None else {}
        return Certificate("unique", "lipschitz", [*proof, *more, *rest], data, hypotheses)
    return "no bound on the derivative of dz/dt by z was found"


def _continuous(model: Model, claims: ClaimProver) -> list[Claim] | str:
    joints = Joints(model, claims, model.rate)
    proofs: list[Claim] = []
    for s in (0, *SIGNS):
        for t in SIGNS:
            for surface in switching_surfaces(model.form(s, t), (s, t)):
                if not depends(surface.condition.args[0] - surface.condition.args[1], W):
                    continue
                shown = joints.at_condition(surface, 0)
                if shown is None:
                    return f"dz/dt may jump where {surface.text}"
                proofs += shown
        shown = joints.at_axis("z", s, 0)
        if shown is None:
            return "dz/dt may jump at z = 0"
        proofs += shown
    return proofs


def _growths(model: Model, within: Fraction | None) -> Iterator[dict[str, Json]]:
    """Bounds (a + b u^k)(1 + (w/l)^m) of the derivative that agree with samples, the simplest first."""
    length = model.bound[1]
    u, w, slope, size = _samples(model, within)
    for m in (0, 1, 2, 3, 4, 6) if within is None else (0,):
        for k in _POWERS:
            value = np.maximum(slope / (1 + (w / float(length)) ** m), size / np.maximum(w + float(length), 0))
            if not np.all(np.isfinite(value)):
                return
            by_speed = value.max(axis=1)
            scale = u[len(u) // 2]
            slow = float(by_speed[u <= scale].max()) * 2
            with np.errstate(all="ignore"):
                fast = float((by_speed / (u / scale) ** k)[u >= scale].max()) * 2
            tail = by_speed[-1] / max(by_speed[-20], _LEAST) / (u[-1] / u[-20]) ** k
            steep = (
                slope[:, -1]
                / (1 + (w[-1] / float(length)) ** m)
                / np.maximum(slope[:, -20] / (1 + (w[-20] / float(length)) ** m), _LEAST)
            )
            if tail > 1.5 or (within is None and float(steep.max()) > 1.5 and slope[:, -1].max() > 0):
                continue
            natural = scale / float(
                length
            )  # LuGre's decay: if dz/dt is far flatter, a tight bound needs more regions without use
            size_of_slope = max(_SLACK * fast, _SLACK * slow, natural)
            a, b = Fraction(size_of_slope), Fraction(size_of_slope / scale**k)
            finite = Fraction(float(max(size[:, 0].max(), 1e-300)))
            a = max(a, finite / length if finite < 1e300 else a)
            yield {"a": a, "b": b, "k": k, "l": length, "m": m}


def _samples(model: Model, within: Fraction | None) -> tuple[Array, Array, Array, Array]:
    """|d(dz/dt)/dz| and |dz/dt| on a grid of speeds and deflections."""
    law_speeds, length = own_speeds(model.law), float(model.bound[1])
    u = np.geomspace(law_speeds[0] * 1e-4, law_speeds[-1] * 1e6, 61)
    top = float(within) if within is not None else length * 1e4
    w = np.concatenate([[0.0], np.geomspace(length * 1e-6, top, 60)])
    slope = size = np.zeros((len(u), len(w)))
    for s in SIGNS:
        for t in SIGNS:
            form = model.form(s, t)
            values = model.numeric([form, derivative(form, W)], u=u[:, None], w=w)
            first, second = (np.broadcast_to(abs(np.asarray(x)), size.shape) for x in values)
            size, slope = np.fmax(size, first), np.fmax(slope, second)
    return u, w, slope, size


def decide(model: Model, claims: ClaimProver, bounded: Certificate | None) -> Verdict:
    """Lipschitz for all z or within the bound of z, or a speed that takes z to infinity."""
    certificate = prove(model, claims, bounded)
    words = "all v and z"
    if isinstance(certificate, str) and bounded is not None:
        reason, words = certificate, "all v and |z| <= Z, which z does not leave"
        certificate = prove(model, claims, bounded, model.bound[1])
        certificate = reason if isinstance(certificate, str) else certificate
    if isinstance(certificate, Certificate):
        return proved(model, certificate, f"{METHOD}, for {words}", {"within": words})
    return escape(model) or undecided(certificate)
