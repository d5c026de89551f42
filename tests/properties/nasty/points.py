"""Laws that are another at single points, on lines, along curves, beyond what floats hold, or where two sides are equal."""

from stribeck.expressions.ops import both, cos, exp, sign, sin, sqrt, where
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, added, rate


def equal(a, b):
    """a = b, as two comparisons."""
    return both(a <= b, b <= a)


@rate("-unique bounded -smooth -passive -drift_free", Lopsided)
def StuckAtOneDeflection(p, v, z):
    """f = 0 at z = Z/2 for every v, LuGre's else: z(t) that comes there may stay or go on, as one instant does not
    count: not unique. Staying, F v = (0.75 + 100 v) v < 0 for v = -1e-3: not passive. Inward beyond Z: bounded."""
    return where(equal(z, 0.75e-5), 0.0, v - abs(v) / g(p, v) * z)


@rate("-unique bounded -smooth -passive -drift_free", Lopsided, values_changed={"sigma_1": 0.0})
def JumpsApart(p, v, z):
    """f = v + 0.5 |v| sgn(z - Z/3) less a decay from 0.9 Z on. From z = Z/3 with v = t sin(1/t)-like, whose integral is
    small beside that of |v|, one z(t) stays above and one below: not unique. At |z| >= Z: decay 2 |v| or more, inward:
    bounded. f jumps in z; sigma_1 = 0, and D = 100 v^2 + ... - 0.5 sigma_0 z |v| sgn(...): with v > 0 from 0.4 Z to 0.5 Z
    and back f = 1.5 v, 0.5 |v|: winding costs W's rise/1.5, unwinding draws W's rise/0.5: not passive."""
    ramp = where(abs(z) > 1.35e-5, (abs(z) - 1.35e-5) / 1.5e-6, 0.0)
    return v + 0.5 * abs(v) * sign(z - 0.5e-5) - 2.0 * abs(v) * ramp * sign(z)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def BrakesOnALine(p, v, z, dz_dt):
    """The same with +1e4 sgn v: h v >= 0: B1, passive."""
    return where(abs(z - v * 1e-3) < 1e-13, 1e4 * sign(v), 0.0)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def Pythagoras(p, v, z, dz_dt):
    """h = -10 sgn v where sin^2 + cos^2 of v/v_s is above 1, which it is nowhere, but by rounding: LuGre. B0, B1."""
    x = v / p.v_s
    return where(sin(x) ** 2 + cos(x) ** 2 > 1.0, -10.0 * sign(v), 0.0)


@rate("unique -bounded -smooth -passive -drift_free", Lopsided)
def TangentAtRest(p, v, z):
    """f = LuGre's where exp(v) > 1 + v, everywhere but at v = 0; there f = z/1000 s: z grows at rest for nothing: not
    bounded, and unwinding draws: not passive. Lipschitz. f jumps at v = 0."""
    return where(exp(v) > 1 + v, v - abs(v) / g(p, v) * z, 1e-3 * z)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def OneOfTwoGaussians(p, v, z, dz_dt):
    """h = -300 v exp(x - 800) exp(800 - x), x = (v/v_s)^2: -300 v for real numbers, 0 times inf in floats: F v < 0 at
    large v: B3, not passive. B0."""
    x = (v / p.v_s) ** 2
    return -300.0 * v * exp(x - 800.0) * exp(800.0 - x)


class KinkAcross(Lopsided):
    """sqrt majorant with h = 1e-3 max(v (1 - z/1e-5), 0): kinks at v = 0 and at z = 1e-5, not where they cross: not smooth.
    h v >= 0 for v > 0, z < 1e-5; for z > 1e-5 h > 0 at v < 0, h v >= -0.5e-3 v^2 within Z: D >= the majorant's with sigma_2
    less by 0.5e-3, where LuGre's condition holds too: passive. Bounded, unique by the majorant."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-14) / g(p, v) * z

    @staticmethod
    def h(p, v, z, dz_dt):
        x = v * (1 - z / 1e-5)
        return 1e-3 * where(x > 0, x, 0.0)


@added("unique bounded smooth passive -drift_free", KinkAcross)
def SquareAcross(p, v, z, dz_dt):
    """With max(...)^2 v in its place: C1: smooth. h v >= 0: S' = sigma_0 z, as the majorant: passive."""
    x = v * (1 - z / 1e-5)
    return 1e-3 * v * where(x > 0, x, 0.0) ** 2
