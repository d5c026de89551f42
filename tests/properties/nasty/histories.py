"""Laws that fail for some histories only, one-sided slopes, singular or removable points, and rates inside the force."""

from stribeck.expressions.ops import sign, sqrt, where
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, Springy, added, deflection, rate


@rate("-unique bounded -smooth ?passive -drift_free", Springy, symmetric=False)
def RootRisesAtOneDeflection(p, v, z):
    """f = v - |v| (2 u - sgn(u - 1/2) |u - 1/2|^(1/2)/2): f rises at u = 1/2 like a root of the distance, f there is v -
    |v| = 0 for v > 0: held, z = Z/2 stays or leaves (dw/dt = +w^(1/2) v/(2 Z)): not unique. At u = 1: 1 - 2 + 0.354 < 0,
    for v < 0 v (1 + 1.65): inward, at u = -1: v > 0: 1 + 2 - 0.61 > 0 outward? -sgn(z) f = f there > 0, that is towards
    0: inward; v < 0: v (1 - 2 + 0.61) > 0: inward: outside Z likewise: bounded. Passive is not derived."""
    u = deflection(p, z)
    return v - abs(v) * (2 * u - 0.5 * sign(u - 0.5) * abs(u - 0.5) ** 0.5)


@rate("-unique ?bounded -smooth ?passive -drift_free", Springy, symmetric=False)
def JumpsToTheOtherSide(p, v, z):
    """f = v - |v| z/g, less |v| where z > Z/2: v > 0 at z = Z/2: before f = v/4 or more, behind f < 0, at Z/2 itself f =
    v (1 - Z/(2 g)) > 0: z can neither stay nor go: no solution: not unique. Inward at Z: bounded is vacuous there, not
    derived; passive likewise."""
    return v - abs(v) / g(p, v) * z - where(deflection(p, z) > 0.5, 1.0, 0.0) * abs(v)


class _Smooth(Lopsided):
    """The sqrt majorant with k_v = 1e6."""

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-12) / g(p, v) * z


@added("unique bounded -smooth passive -drift_free", _Smooth)
def KinkBelowTheUlp(p, v, z, dz_dt):
    """h = 1e-17 |v|: a kink at v = 0: not smooth. At u -> 0+, v < 0 it draws 1e-17 |v|; the majorant leaks m(0) = 1e-6:
    D = v^2 (sigma_1 (1 - z m/(v g)) + sigma_2) + g_N m r^2 ... + h v, at z -> 0 200 v^2 - 1e-17 v^2 > 0: D >= (100 + 50
    - 1e-17) v^2 + ... as |h v| = 1e-17 v^2: passive as the majorant is (sigma_1 m(0) = 1e-4 <= F_s)."""
    return 1e-17 * abs(v)


@added("unique bounded smooth passive -drift_free", _Smooth)
def PowersOfOddSizes(p, v, z, dz_dt):
    """h = |v|^1.5 sgn v + z |z| sigma_0/Z + |v|^1.0000001 v: each C1 (exponents of |v| above 1, z |z|): smooth. h v >= 0
    for the first and third, z h >= 0 for the second, which S takes up: passive."""
    cubic = abs(v) ** 1.0000001 * v
    return abs(v) ** 1.5 * sign(v) + p.sigma_0 * deflection(p, z) * abs(z) + cubic


@added("unique bounded ?smooth ?passive -drift_free", Lopsided, values_changed={"F_c": 1.5})
def AllDivided(p, v, z, dz_dt):
    """F_c = F_s: h = (F_s - F_c)/(F_s - F_c) N: 0/0, no force at all: nothing is derived but f's, LuGre's with g = Z: B0,
    with -z/g apart from 0: not elastic."""
    return (p.F_s - p.F_c) / (p.F_s - p.F_c)
