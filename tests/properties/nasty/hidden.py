"""Terms that hide: below the ulp of what they are added to, in windows at irrational places, in saturated functions, in
pi as a float, behind nested conditions and chains of min and max."""

from stribeck.expressions.ops import atan, both, either, larger, pi, sign, smaller, sqrt, where
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, added, deflection


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushAtAnIrrationalDeflection(p, v, z, dz_dt):
    """h = -10 N where |z - Z/pi| < 1e-12 Z: sigma_0 z + h < 0 there: B4, not passive. B0."""
    return where(abs(deflection(p, z) - 1 / pi) < 1e-12, -10.0, 0.0)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def AtanWindowWithinTheBound(p, v, z, dz_dt):
    """h = -1e6 sgn v where atan(|z|/Z) > pi/4 - 1e-9: held slowly z -> g within 2e-9 of Z: at 1e-9 m/s Z - g < 1e-12 Z:
    F = 1.5 - 1e6 < 0: B3, not passive. B0."""
    return where(atan(abs(deflection(p, z))) > pi / 4 - 1e-9, -1e6 * sign(v), 0.0)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def ThirteenthOfManyWindows(p, v, z, dz_dt):
    """h = +1 N in each of twenty windows of z > 0, but -1.5 N in the thirteenth, 0.65 Z < z < 0.66 Z, where sigma_0 z < 1
    N: B4, not passive. B0."""
    u, total = deflection(p, z), 0.0
    for n in range(20):
        inside = both(u > 0.05 * n, u < 0.05 * n + 0.01)
        total = where(inside, -1.5 if n == 13 else 1.0, total)
    return total


@added("unique bounded -smooth passive -drift_free", Lopsided)
def NestedConditionsThatNeverMeet(p, v, z, dz_dt):
    """h = -1e6 sgn v where v > 1 and, in it, v < 1, or z > 0 and, in it, z + |z| <= 0: nowhere: B0, B1: passive."""
    push = -1e6 * sign(v)
    first = where(v > 1, where(v < 1, push, 0.0), 0.0)
    return first + where(z > 0, where(z + abs(z) <= 0, push, 0.0), 0.0)


class _Chained(Lopsided):
    """dz/dt = v - |v| z/c with c a chain of min and max of g."""

    @classmethod
    def dz_dt(cls, p, v, z):
        return v - abs(v) / cls.chain(p, g(p, v)) * z


class ChainOfEqualEnds(_Chained):
    """c = max(min(g, Z), min(Z, g)) + 0 (max(g, Z) - max(Z, g)) = g: B0, B1: passive."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def chain(p, steady):
        top = p.F_s / p.sigma_0
        rest = larger(steady, top) - larger(top, steady)
        return larger(smaller(steady, top), smaller(top, steady)) + rest


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def EvenSpring(p, v, z, dz_dt):
    """The spring is sigma_0 sqrt(z^2) = sigma_0 |z|: z (sigma_0 z + h) = sigma_0 z |z| < 0 for z < 0: B4, not passive.
    B0; |z|."""
    return p.sigma_0 * sqrt(z**2) - p.sigma_0 * z


@added("unique bounded -smooth passive -drift_free", Lopsided)
def ConditionsWithoutEnd(p, v, z, dz_dt):
    """h = 100 v where v > 0 and z < inf, or z > inf, or (v < -inf and z > 0): for v > 0: h v >= 0: B1, passive. B0."""
    endless = float("inf")
    never = either(z > endless, both(v < -endless, z > 0))
    return where(either(both(v > 0, z < endless), never), 100.0 * v, 0.0)
