"""The elasto-plastic laws: purely elastic below z_ba, so that a held or dithered load does not make them drift."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.constants import Constant
from stribeck.expressions.ops import Value, clip, pi, sin, where
from stribeck.laws.base import STATIC_ABOVE_COULOMB, BristleLaw, Claims, Relation
from stribeck.laws.lugre import passive_as_lugre, passive_as_majorant, smooth_curve
from stribeck.laws.terms import K_V, S_1, S_2, SMOOTH_ABS, g, m, term

Z_BA = Constant(
    "m", "break-away deflection, below which the contact is elastic", above=0, rotary_unit="rad", example=7e-6
)
BREAK_AWAY = Relation("z_ba", "less than F_c/sigma_0", lambda p: p.z_ba * p.sigma_0 < p.F_c, ("z_ba", "F_c", "sigma_0"))


@term("\\alpha_0")
def alpha_0(p: SimpleNamespace, v: Value, z: Value) -> Value:
    """Share of plastic motion (Dupont et al. 2000), without the rule on signs."""
    middle, width = (g(p, v) + p.z_ba) / 2, g(p, v) - p.z_ba
    rising = 0.5 + 0.5 * sin(pi * (abs(z) - middle) / width)
    return where(abs(z) <= p.z_ba, 0.0, where(abs(z) < g(p, v), rising, 1.0))


@term("\\alpha")
def alpha(p: SimpleNamespace, v: Value, z: Value) -> Value:
    """Share of plastic motion (Dupont et al. 2000): none while v and z have different signs."""
    return where(v * z <= 0, 0.0, alpha_0(p, v, z))


@term("s")
def s(p: SimpleNamespace, v: Value, z: Value) -> Value:
    """Position of |z| between z_ba (0) and g(v) (1)."""
    return clip((abs(z) - p.z_ba) / (g(p, v) - p.z_ba), 0.0, 1.0)


@term("a")
def a(p: SimpleNamespace, v: Value, z: Value) -> Value:
    """Share of plastic motion: the quintic smoothstep of s."""
    return s(p, v, z) ** 3 * (10 - 15 * s(p, v, z) + 6 * s(p, v, z) ** 2)


class _ElastoPlastic(BristleLaw):
    """Base of the three elasto-plastic laws."""

    z_ba = Z_BA
    relations = (*STATIC_ABOVE_COULOMB, BREAK_AWAY)

    @staticmethod
    def z_elastic(p: SimpleNamespace) -> Value:
        """z_ba."""
        return p.z_ba


class ElastoPlastic(_ElastoPlastic):
    """The elasto-plastic law: LuGre that does not drift below sigma_0 z_ba; |v| has no derivative at v = 0."""

    name = "elastoplastic"
    source = "Dupont, Armstrong, Hayward, Proc. ACC 2000, 1072-1077; Liu et al., Mech. Sci. 6:15, 2015"
    claims = Claims(unique=True, bounded=True, smooth=False, passive=passive_as_lugre, drift_free=True)

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        return v - alpha(p, v, z) * abs(v) / g(p, v) * z


class ElastoPlasticSobczyk(_ElastoPlastic):
    """The smooth elasto-plastic law of Sobczyk's Remark 1; it drifts, and it is not passive."""

    name = "elastoplastic_sobczyk"
    source = "Sobczyk, Perondi, Cunha, A continuous approximation of the LuGre friction model, Remark 1"
    claims = Claims(unique=True, bounded=True, smooth=True, passive=False, drift_free=False)
    k_v = K_V

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        return S_1(p, v) * v - alpha_0(p, v, z) * S_2(p, v) / g(p, v) * z


class ElastoPlasticMajorant(_ElastoPlastic):
    """The smooth elasto-plastic law: bounded, passive when LuGre is, free of drift below sigma_0 z_ba."""

    name = "elastoplastic_majorant"
    source = "Stribeck, docs/explanation/theory.md"
    claims = Claims(unique=True, bounded=True, smooth=smooth_curve, passive=passive_as_majorant, drift_free=True)
    k_v = K_V
    smooth_abs = SMOOTH_ABS

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        return v - a(p, v, z) * m(p, v) / g(p, v) * z
