"""What most of the laws here begin with."""

from stribeck.laws import BristleLaw
from stribeck.laws.terms import g


class WithForce(BristleLaw):
    """LuGre with a force h added."""

    v_d = None

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z

    @staticmethod
    def h(p, v, z, dz_dt):
        return 0.0

    @classmethod
    def friction(cls, p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + cls.h(p, v, z, dz_dt)


class Lopsided(WithForce):
    """The same where h need not be odd."""

    symmetric = False
