"""Terms that hide: below the ulp of what they are added to, in windows at irrational places, in saturated functions, in
pi as a float, behind nested conditions and chains of min and max."""

from stribeck.expressions.ops import atan, both, cos, either, exp, larger, pi, sign, sin, smaller, sqrt, tanh, where
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, added, deflection, rate

MATH_PI = 3.141592653589793  # the float, a little below pi


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushBelowTheUlp(p, v, z, dz_dt):
    """h = -1e-18 sgn v, which no sum with 1 N shows. To and fro on |z| <= a, ever slower, draws 4e-18 a and costs
    (4/3) sigma_0 a^3/g at most: with a = 1e-16 m 4e-34 J against 1.4e-38: not passive. B0; F jumps."""
    return -1e-18 * sign(v)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushAtAnIrrationalDeflection(p, v, z, dz_dt):
    """h = -10 N where |z - Z/pi| < 1e-12 Z: sigma_0 z + h < 0 there: B4, not passive. B0."""
    return where(abs(deflection(p, z) - 1 / pi) < 1e-12, -10.0, 0.0)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def BrakeAtAnIrrationalDeflection(p, v, z, dz_dt):
    """h = +10 N in the same place, z > 0: B4, passive. B0."""
    return where(abs(deflection(p, z) - 1 / pi) < 1e-12, 10.0, 0.0)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushBelowASquare(p, v, z, dz_dt):
    """h = -10 N where z^2 < Z^2/2 and 2 z^2 > 0.999 Z^2, z > 0: seams at irrational z; B4, not passive. B0."""
    u = deflection(p, z)
    inside = both(2 * u * u < 1, 2 * u * u > 0.999)
    return where(both(inside, u > 0), -10.0, 0.0)


@rate("unique -bounded smooth -passive -drift_free", Lopsided)
def SaturatesWhereFloatsAreOne(p, v, z):
    """The decay of |v| (2/pi) atan(1e20 |v|), below |v|. At v = 1e-15 m/s z settles at g (1 + 6.4e-6), and g > Z
    (1 - 1e-24): not bounded. LuGre's f but for 1e-20 at large v: B2, not passive. Smooth: v atan(k v) is odd times
    odd, but g and |v| atan(k |v|) = v atan(k v) are analytic: smooth."""
    return v - abs(v) * (2 / pi) * atan(1e20 * abs(v)) / g(p, v) * z


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushesUntilTheAtanSaturates(p, v, z, dz_dt):
    """h = -2 (1 - (2/pi) atan(1e30 |v|)) sgn v: held at 1e-32 m/s F = 1.5 - 2 (1 - 0.0064) < 0: B3, not passive. B0;
    F jumps by 4 N at v = 0."""
    return -2.0 * (1 - (2 / pi) * atan(1e30 * abs(v))) * sign(v)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def BrakesUntilTheAtanSaturates(p, v, z, dz_dt):
    """h = +2 (1 - (2/pi) atan(1e30 |v|)) sgn v: atan < pi/2, so h v >= 0: B1, passive. B0."""
    return 2.0 * (1 - (2 / pi) * atan(1e30 * abs(v))) * sign(v)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def FloatPiPushes(p, v, z, dz_dt):
    """h = (1 - (2/3.14159...) atan(1e40 |v|)) sgn v with the float below pi: -3.9e-17 N beyond 1.6e-24 m/s. To and fro
    on |z| <= a = 1e-16 m at v = 1e-20 draws 1.6e-32 J and costs 4 a (200 v + sigma_0 a^2/g) = 4e-34 J: not passive.
    B0; F jumps."""
    return (1 - (2 / MATH_PI) * atan(1e40 * abs(v))) * sign(v)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def TanhPushesWhenSlow(p, v, z, dz_dt):
    """h = -2 (1 - tanh(1e25 |v|)) sgn v: held at 1e-27 m/s F = 1.5 - 1.98 < 0: B3, not passive. B0."""
    return -2.0 * (1 - tanh(1e25 * abs(v))) * sign(v)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def ExpWindowAtRest(p, v, z, dz_dt):
    """h = -10 sgn v where exp(-(v/v_s)^2) > 0.999999: held at 1e-6 m/s F = 1.5 - 10 < 0: B3, not passive. B0."""
    return where(exp(-((v / p.v_s) ** 2)) > 0.999999, -10.0 * sign(v), 0.0)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def AtanWindowBeyondTheBound(p, v, z, dz_dt):
    """h = -1e6 sgn v where atan(|z|/Z) > pi/4, that is beyond Z, which z within Z never meets: B0, B1: passive."""
    return where(atan(abs(deflection(p, z))) > pi / 4, -1e6 * sign(v), 0.0)


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


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def NestedConditionsThatMeet(p, v, z, dz_dt):
    """h = -1e6 sgn v where v > 1 and, in it, either v < 1.0000001 or (v > 2 and v < 1): held at 1.00000005 m/s F v < 0:
    B3, not passive. B0."""
    inner = either(v < 1.0000001, both(v > 2, v < 1))
    return where(v > 1, where(inner, -1e6, 0.0), 0.0)


class _Chained(Lopsided):
    """dz/dt = v - |v| z/c with c a chain of min and max of g."""

    @classmethod
    def dz_dt(cls, p, v, z):
        return v - abs(v) / cls.chain(p, g(p, v)) * z


class ChainThatIsG(_Chained):
    """c = min(max(min(g, 2 Z), F_c/sigma_0), max(g, 1e-9)) = g: B0, B1: passive."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def chain(p, steady):
        top, bottom = p.F_s / p.sigma_0, p.F_c / p.sigma_0
        return smaller(larger(smaller(steady, 2 * top), bottom), larger(steady, 1e-9))


class ChainAHairTooLong(_Chained):
    """c = max(g, Z (1 + 1e-9)) = Z (1 + 1e-9): z settles there: not bounded. B2: r > 2 for large z: not passive.
    |v|."""

    truth = "unique -bounded -smooth -passive -drift_free"

    @staticmethod
    def chain(p, steady):
        return larger(steady, p.F_s / p.sigma_0 * (1 + 1e-9))


class ChainOfEqualEnds(_Chained):
    """c = max(min(g, Z), min(Z, g)) + 0 (max(g, Z) - max(Z, g)) = g: B0, B1: passive."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def chain(p, steady):
        top = p.F_s / p.sigma_0
        rest = larger(steady, top) - larger(top, steady)
        return larger(smaller(steady, top), smaller(top, steady)) + rest


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def SineOfHugeDeflection(p, v, z, dz_dt):
    """h = -3 sin(1e12 u), u = z/Z: sigma_0 z + h < 0 at u = 1.5e-12, where sin > 0.99: B4, not passive. B0; analytic but
    for |v|."""
    return -3.0 * sin(1e12 * deflection(p, z))


@rate("unique bounded -smooth passive -drift_free", Lopsided)
def SinesThatCancel(p, v, z):
    """The decay times sin^2 + cos^2 of z/Z, which is 1: LuGre: B0, B1: passive."""
    u = deflection(p, z)
    return v - abs(v) / g(p, v) * z * (sin(u) ** 2 + cos(u) ** 2)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def SinesThatNearlyCancel(p, v, z, dz_dt):
    """F's spring times sin^2 + cos^2 of z/Z less 1 + 1e-12: z (sigma_0 z + h) = -1e-12 sigma_0 z^2 < 0: B4, not passive.
    B0."""
    u = deflection(p, z)
    return -p.sigma_0 * z + p.sigma_0 * z * (sin(u) ** 2 + cos(u) ** 2 - (1 + 1e-12))


@added("unique bounded -smooth passive -drift_free", Lopsided)
def HugeSumsThatCancel(p, v, z, dz_dt):
    """F's spring is sigma_0 ((z + 1e30) - 1e30) = sigma_0 z over the real numbers: B0, B1: passive."""
    return p.sigma_0 * ((z + 1e30) - 1e30) - p.sigma_0 * z


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
