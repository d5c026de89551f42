"""Laws that are another at single points, on lines, along curves, beyond what floats hold, or where two sides are equal."""

from stribeck.expressions.ops import both, cos, either, exp, sign, sin, sqrt, where
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, added, rate


def equal(a, b):
    """a = b, as two comparisons."""
    return both(a <= b, b <= a)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushesAtOneSpeed(p, v, z, dz_dt):
    """h = -1e4 N at v = 1 m/s exactly: held there F v < 0 for ever: B3, not passive. B0; F jumps at v = 1."""
    return where(equal(v, 1.0), -1e4, 0.0)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushesAtRootTwo(p, v, z, dz_dt):
    """h = -1e4 N where v^2 = 2, at a speed that no float is; v = sqrt 2 held: B3, not passive. B0."""
    return where(equal(v * v, 2.0), -1e4 * sign(v), 0.0)


@rate("unique -bounded -smooth -passive -drift_free", Lopsided)
def LoosensAtRootTwo(p, v, z):
    """No decay where v^2 = 2: held there z = v t: not bounded; Lipschitz in z at each v, so unique; B2 (z is not
    restricted): not passive. |v|."""
    return v - where(equal(v * v, 2.0), 0.0, abs(v)) / g(p, v) * z


@added("unique bounded -smooth passive -drift_free", Lopsided)
def PushesAtOneDeflection(p, v, z, dz_dt):
    """h = -10 sgn v N at z = Z/2 exactly. No v != 0 rests there (g >= 1e-5 > Z/2), so z is at Z/2 with v != 0 for no
    time, and with v = 0 F v = 0: the energy is LuGre's, B1: passive. F jumps. B0."""
    return where(equal(z, 0.75e-5), -10.0 * sign(v), 0.0)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushesAtOneSteadyDeflection(p, v, z, dz_dt):
    """The same at z = 1.2e-5, which is g(v) at some v > 0 (it falls from 1.5e-5 to 1e-5): held there z stays and F v
    = (1.2 + 100 v - 10) v < 0, v < 2e-3: B3, not passive. B0."""
    return where(equal(z, 1.2e-5), -10.0 * sign(v), 0.0)


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


@rate("unique bounded -smooth -passive -drift_free", Lopsided, values_changed={"sigma_1": 0.0})
def JumpsTogether(p, v, z):
    """f = LuGre's - 0.2 |v| sgn(z - Z/3): falls with z for each v, so two solutions never part; across Z/3, where |r| <=
    0.5, it keeps the sign of v, so one exists: unique. f sgn z is LuGre's - 0.2 |v| at |z| >= Z: bounded. Jumps. sigma_1 =
    0: slowly, for 0 < z < Z/3, unwinding gives back sigma_0 z/(0.8 + r), winding costs sigma_0 z/(1.2 - r): to and fro on
    r < 0.2 draws: not passive."""
    return v - abs(v) / g(p, v) * z - 0.2 * abs(v) * sign(z - 0.5e-5)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushesOnALine(p, v, z, dz_dt):
    """h = -1e4 sgn v where |z - v T| < 1e-13 m, T = 1e-3 s. z(t) can stay on the line: T dv/dt = f. From z = 0.1e-5 to
    0.5e-5, v from 1e-3 to 5e-3, the way is over 4e-6 m and draws 4e-2 J; slowly back costs less than 1e-5 J: not passive.
    No held speed meets the line for more than 2e-13 m. B0."""
    return where(abs(z - v * 1e-3) < 1e-13, -1e4 * sign(v), 0.0)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def BrakesOnALine(p, v, z, dz_dt):
    """The same with +1e4 sgn v: h v >= 0: B1, passive."""
    return where(abs(z - v * 1e-3) < 1e-13, 1e4 * sign(v), 0.0)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushesAboveTheFloats(p, v, z, dz_dt):
    """sigma_2 is -200 where |v| > 1e310 m/s, a speed that no float is: held there F v < 0: B3, not passive. B0."""
    return where(abs(v) * 1e-300 > 1e10, -300.0 * v, 0.0)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def ThirdOfAThird(p, v, z, dz_dt):
    """1/3 in floats is less than a third: F_c (1/3) 3 < F_c over the real numbers, not in floats: h = -10 sgn v always:
    F v < 0 while sliding slowly: B3, not passive. B0."""
    return where(p.F_c * (1 / 3) * 3.0 < p.F_c, -10.0 * sign(v), 0.0)


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


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def SharpResonance(p, v, z, dz_dt):
    """h = -500 v e/((|v| - 1)^2 + e), e = 1e-20: -500 N at 1 m/s, 1e-10 m/s wide: held there F = 1 + 100 - 500 < 0: B3,
    not passive. B0."""
    return -500.0 * v * 1e-20 / ((abs(v) - 1.0) ** 2 + 1e-20)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def SharpBrake(p, v, z, dz_dt):
    """The same with +500: h v >= 0: B1, passive."""
    return 500.0 * v * 1e-20 / ((abs(v) - 1.0) ** 2 + 1e-20)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PoleAtRootTwo(p, v, z, dz_dt):
    """h = v/(v^2 - 2): no value at v = sqrt 2, so F is not C1; at v just below it F v -> -inf, held: B3, not passive. f is
    LuGre's: B0."""
    return v / (v * v - 2.0)


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


@added("unique bounded -smooth passive -drift_free", Lopsided)
def EitherOfEqual(p, v, z, dz_dt):
    """h = -10 sgn v where z < 0.5e-5 and z >= 0.5e-5 at once, or v < 0 and v >= 0: nowhere: LuGre. B0, B1."""
    nowhere = either(both(z < 0.5e-5, z >= 0.5e-5), both(v < 0, v >= 0))
    return where(nowhere, -10.0 * sign(v), 0.0)
