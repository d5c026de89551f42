"""The LuGre law and its smooth versions."""

from __future__ import annotations

from math import e
from types import SimpleNamespace

from stribeck.expressions.ops import Value, both, either
from stribeck.laws.base import BristleLaw, Claims
from stribeck.laws.terms import K_V, S_1, S_2, SMOOTH_ABS, g, m, m_0


def _damped(p: SimpleNamespace, above: Value = 0.0) -> Value:
    """sigma_1(v) (|v| + above) <= 4 F_c for all v: passive whatever sigma_2 is, if m <= |v| + above."""
    return p.sigma_1 * (p.v_d / (2 * e) ** 0.5 + above) <= 4 * p.F_c  # (2 e)^-1/2: the maximum of x exp(-x^2)


def passive_as_lugre(p: SimpleNamespace) -> Value:
    """LuGre's condition, necessary and sufficient (Barabanov & Ortega 2000). With v_d it is sufficient; so is a small v_d."""
    constant = p.sigma_2 * p.F_c >= p.sigma_1 * (p.F_s - p.F_c)
    return constant if p.v_d is None else either(constant, _damped(p))


def passive_as_majorant(p: SimpleNamespace) -> Value:
    """LuGre's condition, sufficient if k_v is so large that m - |v| <= F_s/sigma_1. With v_d, a small v_d is sufficient too."""
    constant = both(p.sigma_2 * p.F_c >= p.sigma_1 * (p.F_s - p.F_c), p.sigma_1 * m_0(p) <= p.F_s)
    return constant if p.v_d is None else either(constant, _damped(p, m_0(p)))


def passive_as_arctan(p: SimpleNamespace) -> Value:
    """Without bristle damping, as z is not bounded; or with a small v_d."""
    return p.sigma_1 <= 0 if p.v_d is None else _damped(p)


def smooth_curve(p: SimpleNamespace) -> Value:
    """delta above 1: then the Stribeck curve has a derivative at rest."""
    return True if p.delta is None else p.delta > 1


class LuGre(BristleLaw):
    """The LuGre law: presliding, Stribeck effect, hysteresis, varying break-away; |v| has no derivative at v = 0."""

    name = "lugre"
    source = "Canudas de Wit, Olsson, Astrom, Lischinsky, IEEE TAC 40(3):419-425, 1995; the paper's eqs 1-3"
    claims = Claims(unique=True, bounded=True, smooth=False, passive=passive_as_lugre, drift_free=False)

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        return v - abs(v) / g(p, v) * z


class LuGreArctan(BristleLaw):
    """The first smooth version of LuGre, |v| replaced by v S_0(v); z is not bounded."""

    name = "lugre_arctan"
    source = (
        "Guenther, Perondi, DePieri, Valdiero, J. Braz. Soc. Mech. Sci. Eng. 28(1):48-57, 2006; the paper's eqs 4-6"
    )
    claims = Claims(unique=True, bounded=False, smooth=True, passive=passive_as_arctan, drift_free=False)
    k_v = K_V

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        return v - S_2(p, v) / g(p, v) * z


class LuGreSobczyk(BristleLaw):
    """Sobczyk's smooth LuGre law: bounded, but not passive for any parameters; creeps under a constant load."""

    name = "lugre_sobczyk"
    source = "Sobczyk, Perondi, Cunha, A continuous approximation of the LuGre friction model, eqs 7-9"
    claims = Claims(unique=True, bounded=True, smooth=True, passive=False, drift_free=False)
    k_v = K_V

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        return S_1(p, v) * v - S_2(p, v) / g(p, v) * z


class LuGreMajorant(BristleLaw):
    """LuGre with |v| replaced by a smooth majorant m(v) >= |v|: bounded, passive when LuGre is, closest to LuGre."""

    name = "lugre_majorant"
    source = "Stribeck, docs/explanation/theory.md"
    claims = Claims(unique=True, bounded=True, smooth=smooth_curve, passive=passive_as_majorant, drift_free=False)
    k_v = K_V
    smooth_abs = SMOOTH_ABS

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        return v - m(p, v) / g(p, v) * z
