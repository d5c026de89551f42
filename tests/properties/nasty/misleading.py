"""What a law says of itself may be wrong: its symmetry, its scales, its stored energy, its claims, its bound."""

from stribeck.constants import Constant
from stribeck.expressions.ops import pi, sqrt, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lugre, Root


class KinkForNegativeZOnly(Root):
    """sqrt majorant with h = 0 for z > -Z/2 and 0.1 (z + Z/2) 1e5 below: a kink at z = -Z/2, said to be
    symmetric: not smooth. h z >= 0 and S' = sigma_0 z + h: D as the majorant's, plus h z m/g >= 0: passive. Else
    as RootMajorant."""

    truth = "unique bounded -smooth passive -drift_free"
    v_d = None

    @staticmethod
    def friction(p, v, z, dz_dt):
        half = -0.5 * p.F_s / p.sigma_0
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + where(z > half, 0.0, 1e4 * (z - half))


class IrrationalBound(Lugre):
    """LuGre with z_bound = Z (pi/3)^(1/2) > Z: inward there: bounded. r <= 1.54: 100 (1 - 1.54) + 100 > 0:
    passive. B0."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def z_bound(p):
        return p.F_s / p.sigma_0 * (pi / 3) ** 0.5


class OptionalTerm(Lugre):
    """A constant that is off: h = -k v^3 only with k: LuGre: B0, B1."""

    truth = "unique bounded -smooth passive -drift_free"
    v_d = None
    k = Constant("N s^3/m^3", "a term that is off", above=0, optional=True)

    @staticmethod
    def friction(p, v, z, dz_dt):
        force = p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v
        return force if p.k is None else force - p.k * v**3


class ChosenTerm(BristleLaw):
    """A choice, set to its first word: m = sqrt(v^2 + 1e-12), theory.md's majorant: smooth, bounded, passive;
    leaks."""

    truth = "unique bounded smooth passive -drift_free"
    kind = Constant("", "which |v|", choices=("smooth", "exact"))

    @staticmethod
    def dz_dt(p, v, z):
        m = sqrt(v**2 + 1e-12) if p.kind == "smooth" else abs(v)
        return v - m / g(p, v) * z


class SoftSign(Root):
    """sqrt majorant with h = v/(|v| + 1e-6): its derivative 1e-6/(|v| + 1e-6)^2 is continuous: smooth. h v >= 0:
    passive."""

    truth = "unique bounded smooth passive -drift_free"
    v_d = None

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + v / (abs(v) + 1e-6)


class WallOutside(Lugre):
    """F = sigma_0 z/(1 - u^2/1.21) + ...: h = sigma_0 z (1/(1 - u^2/1.21) - 1), z h >= 0 within Z: B4, passive.
    Singular at 1.1 Z; |v|. B0."""

    truth = "unique bounded -smooth passive -drift_free"
    v_d = None

    @staticmethod
    def friction(p, v, z, dz_dt):
        u = z * p.sigma_0 / p.F_s
        return p.sigma_0 * z / (1 - u**2 / 1.21) + p.sigma_1 * dz_dt + p.sigma_2 * v
