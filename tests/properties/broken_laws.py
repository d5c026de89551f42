"""Laws that are wrong on purpose, and one that is right: what a check must catch, and must not."""

from stribeck.constants import Constant
from stribeck.expressions.ops import sqrt, tanh, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g

K_V = Constant("s/m", "steepness", above=0, example=1e7)


class NegativeDamping(BristleLaw):
    """The bristle damping has the wrong sign."""

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z - p.sigma_1 * dz_dt + p.sigma_2 * v


class WrongSign(BristleLaw):
    """z grows where it should relax."""

    @staticmethod
    def dz_dt(p, v, z):
        return v + abs(v) / g(p, v) * z


class ReversedSpring(NegativeDamping):
    """The spring pushes the wrong way."""

    @staticmethod
    def friction(p, v, z, dz_dt):
        return -p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v


class Below(BristleLaw):
    """m(v) = v tanh(k_v v) is below |v|."""

    k_v = K_V

    @staticmethod
    def dz_dt(p, v, z):
        return v - v * tanh(p.k_v * v) / g(p, v) * z


class BelowByAShare(BristleLaw):
    """m(v) = 0.9 |v|: z has a larger bound than F_s/sigma_0."""

    @staticmethod
    def dz_dt(p, v, z):
        return v - 0.9 * abs(v) / g(p, v) * z


class Jumps(BristleLaw):
    """dz/dt jumps at z = F_c/sigma_0."""

    @staticmethod
    def dz_dt(p, v, z):
        return v - where(z > p.F_c / p.sigma_0, 2.0, 1.0) * abs(v) / g(p, v) * z


class Escapes(BristleLaw):
    """z reaches infinity in finite time."""

    @staticmethod
    def dz_dt(p, v, z):
        return v + abs(v) * (z / g(p, v)) ** 3


class Root(BristleLaw):
    """LuGre with |v| replaced by sqrt(v^2 + 1/k_v^2), as in docs/howto/own-law.md: nothing is wrong with it."""

    k_v = K_V

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1 / p.k_v**2) / g(p, v) * z
