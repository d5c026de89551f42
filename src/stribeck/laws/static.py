"""Laws without internal state, for comparison and fitting."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.constants import Constant
from stribeck.expressions.ops import Value, larger, sign, smaller, tanh
from stribeck.laws.base import STATIC_ABOVE_COULOMB, Scales, StaticLaw
from stribeck.laws.terms import K_V, S_0, stribeck_level

_TIME = 1e-2  # s; a static law has no natural length: its scale is the distance at its natural speed in this time


class CoulombViscous(StaticLaw):
    """Coulomb and viscous friction with a smooth sign of steepness k_v."""

    name = "coulomb_viscous"
    source = "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30(7):1083-1138, 1994; S_0 from the paper's eq. 4"
    uses = ("F_c", "sigma_2")
    k_v = Constant(K_V.unit, K_V.meaning, above=0, default=1e6, rotary_unit=K_V.rotary_unit)

    @staticmethod
    def friction(p: SimpleNamespace, v: Value, z: Value, dz_dt: Value) -> Value:
        return p.F_c * S_0(p, v) + p.sigma_2 * v

    @staticmethod
    def scales(p: SimpleNamespace) -> Scales:
        """The speed 1/k_v, at which the smooth sign is 0.5."""
        return Scales(_TIME / p.k_v, 1 / p.k_v, p.F_c)


class Stribeck(StaticLaw):
    """The Stribeck curve; its sign is exact unless k_v is given, and a body sticks only with k_v."""

    name = "stribeck"
    source = "Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30(7):1083-1138, 1994"
    uses = ("F_c", "F_s", "v_s", "sigma_2")
    relations = STATIC_ABOVE_COULOMB
    delta = Constant("", "exponent of the Stribeck curve", above=0, default=2.0)
    k_v = Constant(K_V.unit, K_V.meaning, above=0, optional=True, rotary_unit=K_V.rotary_unit)

    @staticmethod
    def friction(p: SimpleNamespace, v: Value, z: Value, dz_dt: Value) -> Value:
        S = sign(v) if p.k_v is None else S_0(p, v)
        return S * stribeck_level(p, v) + p.sigma_2 * v

    @staticmethod
    def scales(p: SimpleNamespace) -> Scales:
        """The Stribeck velocity, or 1/k_v with the smooth sign."""
        speed = p.v_s if p.k_v is None else smaller(p.v_s, 1 / p.k_v)
        return Scales(_TIME * speed, speed, p.F_s)


class Makkar(StaticLaw):
    """A smooth static curve with Stribeck effect, Coulomb and viscous friction."""

    name = "makkar"
    source = "Makkar, Dixon, Sawyer, Hu, Proc. IEEE/ASME AIM 2005, 600-605"
    g1 = Constant("N", "height of the Stribeck peak", at_least=0, rotary_unit="N m", example=0.25)
    g2 = Constant("s/m", "steepness at rest", above=0, rotary_unit="s/rad", example=100.0)
    g3 = Constant("s/m", "decay of the Stribeck peak", at_least=0, rotary_unit="s/rad", example=10.0)
    g4 = Constant("N", "Coulomb friction", at_least=0, rotary_unit="N m", example=0.1)
    g5 = Constant("s/m", "steepness of Coulomb friction", above=0, rotary_unit="s/rad", example=100.0)
    g6 = Constant("N s/m", "viscous friction", at_least=0, rotary_unit="N m s/rad", example=0.01)

    @staticmethod
    def friction(p: SimpleNamespace, v: Value, z: Value, dz_dt: Value) -> Value:
        return p.g1 * (tanh(p.g2 * v) - tanh(p.g3 * v)) + p.g4 * tanh(p.g5 * v) + p.g6 * v

    @staticmethod
    def scales(p: SimpleNamespace) -> Scales:
        """The speed scale of the steeper tanh."""
        speed = 1 / larger(p.g2, p.g5)
        return Scales(_TIME * speed, speed, larger(larger(p.g1, p.g4), p.g6 * speed))


class StribeckTanh(StaticLaw):
    """The Stribeck curve with a hyperbolic tangent for its sign, as is common in regressions of measured friction."""

    name = "stribeck_tanh"
    source = "Andersson, Soderberg, Bjorklund, Tribology International 40(4):580-587, 2007"
    uses = ("F_c", "F_s", "v_s", "sigma_2")
    relations = STATIC_ABOVE_COULOMB
    k_v = Constant(
        K_V.unit, "steepness of the smooth sign tanh(k_v v)", above=0, rotary_unit=K_V.rotary_unit, example=100.0
    )
    delta = Constant("", "exponent of the Stribeck curve; 2 unless given", above=0, optional=True)

    @staticmethod
    def friction(p: SimpleNamespace, v: Value, z: Value, dz_dt: Value) -> Value:
        return tanh(p.k_v * v) * stribeck_level(p, v) + p.sigma_2 * v

    @staticmethod
    def scales(p: SimpleNamespace) -> Scales:
        """The Stribeck velocity, or 1/k_v if that is slower."""
        speed = smaller(p.v_s, 1 / p.k_v)
        return Scales(_TIME * speed, speed, p.F_s)
