"""The same functions in other spellings, and smooth functions that do not look it."""

from stribeck.expressions.ops import both, clip, cos, either, exp, log, sign, sin, sqrt, tanh, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from tests.properties.nasty.base import added, rate


@rate("unique bounded -smooth passive -drift_free")
def AbsAsRoot(p, v, z):
    """sqrt(v^2) = |v|: LuGre: B0, B1."""
    return v - sqrt(v**2) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def AbsAsPower(p, v, z):
    """(v^2)^0.5 = |v|: LuGre: B0, B1."""
    return v - (v**2) ** 0.5 / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def AbsAsRootPlusZero(p, v, z):
    """sqrt(v^2 + 0): LuGre: B0, B1."""
    return v - sqrt(v**2 + 0) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def AbsAsRootPlusRoundedZero(p, v, z):
    """sqrt(v^2 + c) with c = (v + 1) - v - 1 = 0: LuGre: B0, B1; in floats c is noise of either sign."""
    return v - sqrt(v**2 + ((v + 1) - v - 1)) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def AbsAsMaximum(p, v, z):
    """where(v > -v, v, -v) = |v|: LuGre: B0, B1."""
    return v - where(v > -v, v, -v) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def AbsAsClip(p, v, z):
    """clip(v, 0, inf) + clip(-v, 0, inf) = |v|, with a literal infinity: LuGre: B0, B1."""
    size = clip(v, 0.0, float("inf")) + clip(-v, 0.0, float("inf"))
    return v - size / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def ClipToInfinity(p, v, z):
    """clip(z, -inf, inf) = z: LuGre: B0, B1."""
    return v - abs(v) / g(p, v) * clip(z, float("-inf"), float("inf"))


@rate("unique bounded -smooth passive -drift_free", natural=True)
def SignTimesV(p, v, z):
    """v (1 - sgn(v) z/g): LuGre: B0, B1."""
    return v * (1 - sign(v) * z / g(p, v))


@rate("unique bounded -smooth passive -drift_free", natural=True)
def OverOneDenominator(p, v, z):
    """(g v - |v| z)/g: LuGre: B0, B1."""
    return (g(p, v) * v - abs(v) * z) / g(p, v)


@rate("unique bounded -smooth passive -drift_free")
def SignInFront(p, v, z):
    """sgn(v) (|v| - v z/g): LuGre: B0, B1."""
    return sign(v) * (abs(v) - v * z / g(p, v))


@rate("unique bounded -smooth passive -drift_free", natural=True)
def ByCases(p, v, z):
    """v - v z/g for v >= 0, v + v z/g else: LuGre: B0, B1."""
    return where(v >= 0, v - v * z / g(p, v), v + v * z / g(p, v))


@rate("unique bounded -smooth passive -drift_free")
def AbsOfTheProduct(p, v, z):
    """v - |v z|/g sgn z: LuGre (|v z| sgn z = |v| z): B0, B1."""
    return v - abs(v * z) * sign(z) / g(p, v)


@rate("unique -bounded -smooth -passive -drift_free")
def AbsZ(p, v, z):
    """v (1 - |z|/g): for v z < 0 too: unwinding slows down. Lipschitz; at Z v (1 - Z/g): outward (v < 0, z = Z, g
    < Z: f > 0): not bounded. For z > g, v < 0: f > 0, F v = (sigma_0 z + 100 f + 100 v) v; held at v = -1e-2 (g =
    1e-5) z rises for ever from Z. The body moves back against sigma_0 z + 100 v (2 - |z|/g): energy is drawn as
    long as that is > 0, which it is (both terms): not passive. df/dv = 1 - |z|/g at v = 0 (g'(0) = 0) is
    continuous in v, but |z| has a kink: not smooth."""
    return v * (1 - abs(z) / g(p, v))


@rate("unique bounded -smooth -passive -drift_free")
def AbsZByCoulomb(p, v, z):
    """v (1 - |z|/Z): at |z| = Z f = 0, f is Lipschitz in z: bounded. At z = Z, v < 0, z stays and F v = 1.5 v +
    100 v^2 < 0 for small |v|: not passive. Kink at z = 0."""
    return v * (1 - abs(z) * p.sigma_0 / p.F_s)


@rate("unique -bounded smooth -passive -drift_free")
def SmoothSquare(p, v, z):
    """f = v - v |v| sgn(v) z/(g v_s) - ... : v |v| sgn v = v^2: f = v - v^2 z/(g v_s) for real numbers, g smooth:
    smooth. v^2/v_s < |v| for |v| < v_s: held z -> g v_s/v, without limit: not bounded. B2 at large v with more
    than |v|: r' = z v/(g v_s) unlimited: a pulse from z > 0 has F v -> -100 v^3 z/(g v_s), f -> -v^2 z/(g v_s):
    draws 100 v each metre: not passive."""
    return v - v * abs(v) * sign(v) / p.v_s / g(p, v) * z


class _Root(BristleLaw):
    """A smooth law, passive with MILD (sqrt majorant of theory.md), to which aliases are added."""

    v_d = None

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-12) / g(p, v) * z

    @classmethod
    def friction(cls, p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + cls.h(p, v, z)


@added("unique bounded smooth passive -drift_free", _Root)
def RootOfFourthPower(p, v, z):
    """h = 10 v sqrt(v^4) = 10 v^3: smooth, h v >= 0: passive; else as RootMajorant: unique, bounded, leaks."""
    return 10 * v * sqrt(v**4)


@added("unique bounded smooth passive -drift_free", _Root)
def AbsTimesV(p, v, z):
    """h = 10 v |v|: its derivative 20 |v| is continuous: smooth; h v >= 0: passive."""
    return 10 * v * abs(v)


@added("unique bounded smooth passive -drift_free", _Root)
def SignTimesSquare(p, v, z):
    """h = 10 sgn(v) v^2 = 10 v |v|: smooth, passive."""
    return 10 * sign(v) * v**2


@added("unique bounded smooth passive -drift_free", _Root)
def PowerOneAndAHalf(p, v, z):
    """h = 10 v (v^2)^0.25 = 10 sgn(v) |v|^1.5: derivative 15 |v|^0.5, continuous: smooth; passive."""
    return 10 * v * (v**2) ** 0.25


@added("unique bounded -smooth passive -drift_free", _Root)
def PowerThreeQuarters(p, v, z):
    """h = 10 sgn(v) |v|^0.75: its derivative is infinite at v = 0: not smooth. h v >= 0: passive."""
    return 10 * sign(v) * abs(v) ** 0.75


@added("unique bounded smooth passive -drift_free", _Root)
def AbsSquared(p, v, z):
    """h = 10 v |v|^2 = 10 v^3: smooth, passive."""
    return 10 * v * abs(v) ** 2


@added("unique bounded smooth passive -drift_free", _Root)
def KinkThatCancels(p, v, z):
    """h = |v| - sqrt(v^2) = 0: smooth, passive: RootMajorant itself."""
    return 1e3 * (abs(v) - sqrt(v**2))


@added("unique bounded smooth passive -drift_free", _Root)
def StepThatCancels(p, v, z):
    """h = where(v > 1, v, 1) - clip(v, 1, inf) = 0: smooth, passive."""
    return where(v > 1, v, 1.0) - clip(v, 1.0, float("inf"))


@added("unique bounded smooth passive -drift_free", _Root)
def CasesThatAgree(p, v, z):
    """h = v where v > 0, v else by other words: 10 v everywhere: smooth, passive."""
    return where(v > 0, 10 * v, 5 * v + 5 * v)


@added("unique bounded smooth passive -drift_free", _Root)
def CubicSpline(p, v, z):
    """h = 10 (v - 1)^2 for v > 1, -10 (v + 1)^2 for v < -1, else 0: C1: smooth; h v >= 0: passive."""
    return where(v > 1, 10 * (v - 1) ** 2, where(v < -1, -10 * (v + 1) ** 2, 0.0))


@added("unique bounded -smooth passive -drift_free", _Root, symmetric=False)
def SplineWithAKink(p, v, z):
    """As CubicSpline with 1e-9 |v - 1| for v > 1: its derivative jumps by 1e-9 at v = 1: not smooth. h v >= 0:
    passive."""
    return where(v > 1, 1e-9 * (v - 1), 0.0)


@added("unique bounded -smooth passive -drift_free", _Root, symmetric=False)
def TinyJump(p, v, z):
    """h = 1e-200 v where v > 1e-3: jumps by 1e-203: not smooth. h v >= 0: passive."""
    return where(v > 1e-3, 1e-200 * v, 0.0)


@added("unique bounded -smooth ?passive -drift_free", _Root, symmetric=False)
def TinyKinkInZ(p, v, z):
    """h = 1e-30 |z - Z/3|: a kink at z = Z/3: not smooth. h = 1e-30 * 1e-5 at z = 0-, so sigma_0 z + h > 0 there,
    of the wrong sign. But S' need not be B4's: the law is dissipative by its leak and viscous friction? At z in
    (-5e-41, 0) slow cycles draw up to 1e-35 N against r^2 of 1e-71: as B4 but for the leak m(0)/g z, which is
    smaller still at speeds >> 1e-6. Not derived."""
    return 1e-30 * abs(z - 0.5e-5)


@added("unique bounded smooth passive -drift_free", _Root)
def TanhByExp(p, v, z):
    """h = 0.2 (e^x - e^-x)/(e^x + e^-x), x = 1e3 v, = 0.2 tanh x: smooth, h v >= 0: passive."""
    x = 1e3 * v
    return 0.2 * (exp(x) - exp(-x)) / (exp(x) + exp(-x))


@added("unique bounded smooth passive -drift_free", _Root)
def LogOfExp(p, v, z):
    """h = 20 log(exp(v)) = 20 v: smooth, passive."""
    return 20 * log(exp(v))


@added("unique bounded smooth passive -drift_free", _Root)
def SineAndCosine(p, v, z):
    """h = 10 v (sin^2 z + cos^2 z) = 10 v: smooth, passive."""
    return 10 * v * (sin(1e6 * z) ** 2 + cos(1e6 * z) ** 2)


@added("unique bounded smooth passive -drift_free", _Root)
def NeverTrue(p, v, z):
    """h = -1e3 sgn v where v > 1 and v < -1, or v^2 < 0: never: h = 0: smooth, passive."""
    return where(either(both(v > 1, v < -1), v**2 < 0), -1e3 * sign(v), 0.0)


@added("unique bounded smooth passive -drift_free", _Root)
def AlwaysTrue(p, v, z):
    """h = 0 where |v| >= 0 or z > 0: always: smooth, passive."""
    return where(either(abs(v) >= 0, z > 0), 0.0, -1e3 * sign(v))


@added("unique bounded smooth passive -drift_free", _Root)
def NoiseInTheForce(p, v, z):
    """h = 1e20 ((v + 0.1) - v - 0.1) = 0 for real numbers, some 1e3 N of rounding in floats: smooth, passive."""
    return 1e20 * ((v + 0.1) - v - 0.1)


@added("unique bounded smooth passive -drift_free", _Root)
def NoiseOfARoot(p, v, z):
    """h = 1e16 (sqrt(v^2 + 1)^2 - v^2 - 1) = 0 for real numbers: smooth, passive."""
    return 1e16 * (sqrt(v**2 + 1) ** 2 - v**2 - 1)


class NoiseInTheRate(BristleLaw):
    """f = v + 1e10 ((z + 1) - z - 1) = v for real numbers: unique, smooth, drift_free, passive (D = 200 v^2), not
    bounded."""

    truth = "unique -bounded smooth passive drift_free"

    @staticmethod
    def z_elastic(p):
        return p.F_c / p.sigma_0

    @staticmethod
    def dz_dt(p, v, z):
        return v + 1e10 * ((z + 1) - z - 1)


@added("unique bounded smooth -passive -drift_free", _Root, symmetric=False)
def NoiseThatHidesALoss(p, v, z):
    """h = -1e17 ((v + 1e-17) - v) = -1 N for real numbers, 0 in floats at |v| > 1: at z = g, v > 0 held, F = g_N
    + ... > 0, but backwards as well: F v = |v| (g_N + 100 |v| + 1): dissipates. Slow to and fro on z in (0,
    1e-6): sigma_0 z - 1 < 0 there: as B4 at |v| between 1e-4 and 1e-3, where the leak is 1 % or less: not
    passive. h constant: smooth."""
    return -1e17 * ((v + 1e-17) - v)


@added("unique bounded smooth passive -drift_free", _Root, values_changed={"sigma_1": 0.0})
def PeriodicBrake(p, v, z):
    """h = 0.01 sin(1e3 v): smooth. Root with sigma_1 = 0: D = 100 v^2 + m sigma_0 z^2/g + h v, |h v| <= 10 v^2:
    passive."""
    return 0.01 * sin(1e3 * v)


@added("unique bounded smooth -passive -drift_free", _Root)
def PeriodicPush(p, v, z):
    """h = 5 sin(1e3 v): held at v = 1.5 pi e-3, F = 1 + 0.47 - 5 < 0: B3, not passive. Smooth."""
    return 5 * sin(1e3 * v)


@added("unique bounded smooth -passive -drift_free", _Root, symmetric=False)
def FastPeriodicPush(p, v, z):
    """h = 200 sin(1e6 v) tanh(v): at v = 1 + O(1e-6) with sin = -1, F = 1 + 100 - 152 < 0: B3, not passive.
    Smooth."""
    return 200 * sin(1e6 * v) * tanh(v)
