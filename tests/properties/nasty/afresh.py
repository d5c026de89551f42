"""Laws written without sight of the prover: floors, stiffness that depends on speed, slips of the pen."""

from stribeck.expressions.ops import both, cos, exp, floor, sign, sin, sqrt, tanh, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, Springy, WithForce, added, deflection, friction, rate


class _Majorant(WithForce):
    """The sqrt majorant with k_v = 1e6 and a force h added: S' = sigma_0 z + h gives D = that of the majorant + h z
    m/g."""

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-12) / g(p, v) * z


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def FloorPushes(p, v, z, dz_dt):
    """h = -200 floor(v): held at v = 1, F = 1 + 100 - 200 < 0: B3, not passive. B0; the steps are in F."""
    return -200.0 * floor(v)


@added("unique bounded -smooth passive -drift_free")
def StaircaseSpring(p, v, z, dz_dt):
    """h = 0.1 sgn(z) floor(10 |u|): h z >= 0: B4, passive. B0."""
    return 0.1 * sign(z) * floor(10 * abs(deflection(p, z)))


@added("unique bounded smooth passive -drift_free", _Majorant)
def FloorNeverReached(p, v, z, dz_dt):
    """h = -floor(0.5 + 0.4 sin(v/v_s)) is 0 for every v: RootMajorant."""
    return -floor(0.5 + 0.4 * sin(v / p.v_s))


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def FloorMakesAWindow(p, v, z, dz_dt):
    """floor(x) - floor(x - 1e-6), x = v/v_s, is 1 for x in [k, k + 1e-6) with k whole, else 0; h = -10 N times that:
    held at v = 5 v_s, F = 1 + 0.5 - 10 < 0: B3, not passive. B0."""
    x = v / p.v_s
    return -10.0 * (floor(x) - floor(x - 1e-6))


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def Sawtooth(p, v, z, dz_dt):
    """sigma_0 z + h is a sawtooth in [0, 0.15) N for z < 0 too: z (sigma_0 z + h) < 0 between the teeth's feet there:
    B4, not passive. B0."""
    return -0.1 * p.F_s * floor(10 * deflection(p, z))


@rate("unique bounded -smooth passive -drift_free", WithForce, natural=True)
def HessSoomBackwards(p, v, z):
    """g = (F_s - (F_s - F_c) v^2/(v^2 + v_s^2))/sigma_0 falls from Z to 1e-5: B0, B1: passive."""
    steady = (p.F_s - (p.F_s - p.F_c) * v**2 / (v**2 + p.v_s**2)) / p.sigma_0
    return v - abs(v) * z / steady


class Makkar(BristleLaw):
    """Makkar et al. 2005, beside LuGre's z, which the force does not use: F = 0.5 (tanh(1000 v) - tanh(100 v)) +
    tanh(1000 v) + 100 v has the sign of v: passive with S = 0. f is LuGre's: B0."""

    truth = "unique bounded -smooth passive -drift_free"
    natural = True
    v_d = None
    dz_dt = staticmethod(WithForce.dz_dt)

    @staticmethod
    def stored_energy(p, z):
        return 0.0 * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return (p.F_s - p.F_c) * (tanh(1000 * v) - tanh(100 * v)) + p.F_c * tanh(1000 * v) + p.sigma_2 * v


@friction("unique bounded -smooth -passive -drift_free", Makkar)
def MakkarMistyped(p, v, z, dz_dt):
    """The two tanh exchanged, and 0.3 N of Coulomb friction: at v = 0.002, F = tanh(0.2) - tanh(2) + 0.3 tanh(0.2)...
    < 0 (0.197 - 0.964 + 0.3 * 0.964 + 0.2 = -0.28): held there it draws energy for ever: not passive."""
    return tanh(100 * v) - tanh(1000 * v) + 0.3 * tanh(1000 * v) + p.sigma_2 * v


@rate("unique bounded -smooth passive -drift_free", Springy, natural=True)
def BoucWenCubed(p, v, z):
    """Bouc-Wen, n = 3, beta = gamma = 0.5: f/v = 1 - |u|^3 for v z > 0, 1 else. C1 in z, inward or 0 for |u| >= 1:
    unique, bounded. sigma_0 z v - sigma_0 z f = sigma_0 |z v| |u|^3 or 0: passive. df/dv jumps at v = 0."""
    u = deflection(p, z)
    return v - 0.5 * abs(v) * u * abs(u) ** 2 - 0.5 * v * abs(u) ** 3


@rate("unique bounded -smooth passive -drift_free", Springy, natural=True)
def DahlThreeHalves(p, v, z):
    """Dahl, exponent 3/2: f = v phi, phi = sgn(1 - r)|1 - r|^1.5, r = u sgn v: C1 in z, f falls with z: unique. 0 or
    inward at Z: bounded. phi <= 1 for z v > 0, >= 1 for z v < 0: D >= 0: passive."""
    r = deflection(p, z) * sign(v)
    return v * sign(1 - r) * abs(1 - r) ** 1.5


@rate("unique bounded -smooth passive -drift_free", Springy, natural=True)
def DahlCubed(p, v, z):
    """Dahl, exponent 3: phi = (1 - r)^3, as DahlThreeHalves."""
    return v * (1 - deflection(p, z) * sign(v)) ** 3


@friction("unique bounded -smooth passive -drift_free", WithForce)
def DampedUnloading(p, v, z, dz_dt):
    """sigma_1 counts only where z v < 0, where f v = v^2 (1 - r) >= 0: F v - W' f = sigma_0 z^2 |v|/g + 100 v^2 +
    [that] >= 0: passive. B0."""
    return p.sigma_0 * z + where(z * v < 0, p.sigma_1, 0.0) * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth -passive -drift_free", WithForce)
def NegativeUnloadingDamping(p, v, z, dz_dt):
    """-300 f where z v < 0: unwinding from Z to 0 at -V costs the integral of (100/(1 - r) - 300) V |dz| + O(1), 1 -
    r >= 1: below -200 V Z, without limit: not passive. B0."""
    return p.sigma_0 * z - where(z * v < 0, 300.0, 0.0) * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth passive -drift_free", WithForce, natural=True, values_changed={"sigma_2": 0.0})
def RationalDamping(p, v, z, dz_dt):
    """sigma_1/(1 + (v/v_s)^2), sigma_2 = 0: |v| sigma_1(v) <= 100 * 0.0005 = 0.05 N, so F v - W' f >= |v| (g_N r^2 -
    0.05 (r - 1)) >= 0 for 1 < r <= 1.5 (g_N r^2 > 1), and each term is >= 0 for r <= 1: passive. B0."""
    return p.sigma_0 * z + p.sigma_1 / (1 + (v / p.v_s) ** 2) * dz_dt + p.sigma_2 * v


@rate("unique bounded -smooth -passive -drift_free", WithForce)
def CubicDecay(p, v, z):
    """f = v - |v| (z/g)^3 falls with z: unique; inward at Z >= g: bounded. At large v, g = 1e-5, r = z/g from 1.5 to
    1.3 (r^3 > 2): unwinding forwards draws the integral of v (100 r^3 - 200)/(r^3 - 1) |dz| - O(1), without limit in
    v: not passive."""
    return v - abs(v) * (z / g(p, v)) ** 3


class CubicDecayLittleDamping(CubicDecay):
    """sigma_1 = 10: v^2 (10 (1 - r^3) + 100) >= v^2 (110 - 33.75) and g_N |v| r^4 >= 0: passive."""

    truth = "unique bounded -smooth passive -drift_free"
    values_changed = {"sigma_1": 10.0}


@rate("unique -bounded -smooth -passive -drift_free", WithForce)
def ForgotTheAbs(p, v, z):
    """f = v (1 - |z|/g): for v < 0, z > g it rises without end (|f| <= c |v| (1 + |z|): unique): z passes Z from g <
    z <= Z at large |v|: not bounded. At |z| > 2 g, v < 0, F v = -sigma_0 z |v| + v^2 (200 - 100 |z|/g) < 0 for ever:
    not passive. |z|: not smooth."""
    return v - v * abs(z) / g(p, v)


@rate("unique bounded -smooth passive -drift_free", Springy, natural=True)
def TanhSaturation(p, v, z):
    """f = v - |v| tanh(u)/tanh(1): Lipschitz in z; 0 or inward at Z; D = 100 v^2 + sigma_0 z |v| tanh(u)/tanh(1):
    passive."""
    return v - abs(v) * tanh(deflection(p, z)) / tanh(1.0)


@rate("unique -bounded smooth passive -drift_free", WithForce, natural=True)
def RambergOsgood(p, v, z):
    """f = v/(1 + u^4): |f| <= |v| and Lipschitz in z: unique; held, z passes every bound: not bounded. Rational:
    smooth. S' = sigma_0 z (1 + u^4): F v - S' f = sigma_1 f v + sigma_2 v^2 >= 0 for every z: passive."""
    return v / (1 + deflection(p, z) ** 4)


@added("unique bounded smooth passive -drift_free", _Majorant)
def RootOfASquaredDifference(p, v, z, dz_dt):
    """h = 10 (sqrt((v - |v|)^2) - (|v| - v)) is 0: RootMajorant."""
    return 10.0 * (sqrt((v - abs(v)) ** 2) - (abs(v) - v))


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def CosineHidesAWindow(p, v, z, dz_dt):
    """h = -0.001 N for cos u > 1 - 1e-12 and z > 0, so for 0 < u < 1.4e-6, where sigma_0 z < 3e-6 N (and far beyond
    Z): B4, not passive. B0."""
    return where(both(cos(deflection(p, z)) > 1 - 1e-12, z > 0), -1e-3, 0.0)


@friction("unique bounded -smooth -passive -drift_free", Lopsided)
def UnloadsStiffer(p, v, z, dz_dt):
    """F = sigma_0 z (1 where f > 0, 2 else) + sigma_2 v: 0 -> a -> 0, ever slower, costs the integral of sigma_0 z
    (1/(1 - r) - 2/(1 + r)) dz, near -sigma_0 a^2/2 for small a: not passive. B0."""
    return where(dz_dt > 0, 1.0, 2.0) * p.sigma_0 * z + p.sigma_2 * v


@friction("unique bounded -smooth passive -drift_free", WithForce)
def LoadsStiffer(p, v, z, dz_dt):
    """F = sigma_0 z (2 where z f > 0, 1 else) + sigma_2 v. W = sigma_0 z^2/2: where z f > 0 also z v > 0 and f/v <=
    1, so 2 sigma_0 z v - sigma_0 z f >= 0; elsewhere sigma_0 z (v - f) = sigma_0 z^2 |v|/g >= 0: passive. B0."""
    return where(z * dz_dt > 0, 2.0, 1.0) * p.sigma_0 * z + p.sigma_2 * v


@rate("unique bounded -smooth -passive -drift_free", Springy, symmetric=False)
def Ratchet(p, v, z):
    """f = v (1 - u) for v > 0, 0 for v < 0: inward or 0 at |z| = Z: bounded; Lipschitz. With z = Z held back slowly,
    F v = -1.5 |v| + 100 v^2 < 0 for ever: not passive."""
    return where(v > 0, v * (1 - deflection(p, z)), 0.0)


@friction("unique bounded -smooth -passive -drift_free", Lopsided)
def FreeWheel(p, v, z, dz_dt):
    """No force at all for v <= 0: z goes back to -a for nothing, and from -a to 0 at small v > 0 it gives the
    integral of sigma_0 |z|/(1 + |r|): not passive. B0."""
    return where(v > 0, p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v, 0.0)


@rate("unique -bounded -smooth -passive -drift_free", WithForce)
def BumpAboveTheBound(p, v, z):
    """g = G (1 + 2.4 x/(1 + x)^2), x = (v/v_s)^2, G = 1e-5: 1.6 G > Z at v = v_s: held there z passes Z: not bounded.
    For large |v| g -> G: B2, not passive."""
    x = (v / p.v_s) ** 2
    return v - abs(v) * z / (p.F_c / p.sigma_0 * (1 + 2.4 * x / (1 + x) ** 2))


@rate("unique bounded -smooth passive -drift_free", WithForce)
def BumpWithinTheBound(p, v, z):
    """g = G (1 + 1.8 x/(1 + x)^2) <= 1.45 G < Z = 1.5 G: bounded; r <= 1.5 and g_N >= 1: B1, passive."""
    x = (v / p.v_s) ** 2
    return v - abs(v) * z / (p.F_c / p.sigma_0 * (1 + 1.8 * x / (1 + x) ** 2))


@rate("unique bounded -smooth passive -drift_free", WithForce)
def HugeShift(p, v, z):
    """|(v + 1e12) - 1e12| = |v|: LuGre, though floats see a staircase of 1e-4 m/s."""
    return v - abs((v + 1e12) - 1e12) / g(p, v) * z


@friction("unique bounded -smooth -passive -drift_free", WithForce)
def StiffensWithSpeed(p, v, z, dz_dt):
    """F = sigma_0 z (1 + 0.5 tanh(|v|/v_s)): wound slowly to a small a, unwound fast: costs the integral of sigma_0
    z/(1 - r), gives nearly 1.5 sigma_0 z/(1 + r): not passive. B0."""
    return p.sigma_0 * z * (1 + 0.5 * tanh(abs(v) / p.v_s))


@friction("unique bounded -smooth -passive -drift_free", WithForce)
def SoftensWithSpeed(p, v, z, dz_dt):
    """F = sigma_0 z (1 - 0.5 tanh(|v|/v_s)): wound fast, unwound slowly: not passive. B0."""
    return p.sigma_0 * z * (1 - 0.5 * tanh(abs(v) / p.v_s))


@added("unique bounded -smooth passive -drift_free")
def ZeroTimesHuge(p, v, z, dz_dt):
    """h = 0 * exp(1e6 v^2) is 0 for every v, though floats say nan from 0.03 m/s: LuGre with B1."""
    return 0.0 * exp(1e6 * v**2)


@added("unique bounded -smooth passive -drift_free")
def StaircaseDrag(p, v, z, dz_dt):
    """h = 0.01 N sgn(v) for each whole mm/s that |v| is above, 40 of them: h v >= 0: B1, passive. B0."""
    drag = 0.0
    for k in range(1, 41):
        drag = drag + where(abs(v) > 1e-3 * k, 0.01 * sign(v), 0.0)
    return drag


@added("unique bounded -smooth ?passive -drift_free")
def ManyWaves(p, v, z, dz_dt):
    """h = 0.01 N times the sum of sin(k v/v_s), k <= 12: of either sign; whether what it gives outweighs the viscous
    loss is not derived. B0."""
    total = 0.0
    for k in range(1, 13):
        total = total + 0.01 * sin(k * v / p.v_s)
    return total


@rate("unique -bounded -smooth passive -drift_free", WithForce)
def SelfLubricating(p, v, z):
    """f = v - |v| z/(G (1 + u^2)), G = 1e-5: the share z/(G (1 + u^2)) is at most Z/(2 G) = 0.75 < 1: z rises without
    end: not bounded. Its size <= 0.75 for every z: F v - W' f = sigma_0 z^2 |v|/(G (1 + u^2)) + 100 v^2 (2 - share)
    >= 0: passive. Lipschitz."""
    return v - abs(v) * z / (p.F_c / p.sigma_0 * (1 + deflection(p, z) ** 2))


@added("unique bounded smooth passive -drift_free", _Majorant)
def BarelySmooth(p, v, z, dz_dt):
    """h = 0.01 u |u|^1e-9: its derivative 0.01 (1 + 1e-9) |u|^1e-9 is continuous, 0 at 0: smooth. h z >= 0:
    passive."""
    u = deflection(p, z)
    return 0.01 * u * abs(u) ** 1e-9


@added("unique bounded -smooth passive -drift_free", _Majorant)
def BarelyNotSmooth(p, v, z, dz_dt):
    """h = 0.01 sgn(u) |u|^(1 - 1e-9): infinite slope at 0: not smooth. h z >= 0: passive."""
    u = deflection(p, z)
    return 0.01 * sign(u) * abs(u) ** (1 - 1e-9)


@added("unique bounded smooth passive -drift_free", _Majorant, symmetric=False)
def SmoothStep(p, v, z, dz_dt):
    """h = 0.01 (3 u^2 - 2 u^3) on [0, 1], 0 below, 0.01 above: C1. h z >= 0: passive."""
    u = deflection(p, z)
    return 0.01 * where(u < 0, 0.0, where(u < 1, 3 * u**2 - 2 * u**3, 1.0))


@added("unique bounded -smooth passive -drift_free", _Majorant, symmetric=False)
def SmoothStepMistyped(p, v, z, dz_dt):
    """3 u^2 - 2.0000001 u^3 meets 1 with a jump of 1e-9 N at u = 1: not smooth. h z >= 0: passive."""
    u = deflection(p, z)
    return 0.01 * where(u < 0, 0.0, where(u < 1, 3 * u**2 - 2.0000001 * u**3, 1.0))


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def Preload(p, v, z, dz_dt):
    """h = 0.1 N: sigma_0 z + h < 0 for no z > 0, but z (sigma_0 z + h) < 0 for -1e-6 < z < 0: B4, not passive. B0."""
    return 0.1
