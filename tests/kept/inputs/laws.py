"""Laws as users write them."""

from stribeck.constants import Constant
from stribeck.expressions.ops import sqrt
from stribeck.laws import BristleLaw, Claims
from stribeck.laws.terms import g


class Rooted(BristleLaw):
    """LuGre with |v| replaced by sqrt(v^2 + 1/k_v^2)."""

    source = "an example of the guide"
    claims = Claims(unique=True, bounded=True, smooth=True, passive=False, drift_free=False)
    k_v = Constant("s/m", "steepness of the smooth |v|", above=0, example=1e6)

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1 / p.k_v**2) / g(p, v) * z


class Lopsided(BristleLaw):
    """LuGre that pulls to one side."""

    symmetric = False

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + 0.1 * p.F_c
