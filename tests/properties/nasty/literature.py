"""Laws of the literature and common variants, as their users would write them."""

from stribeck.constants import Constant
from stribeck.expressions.ops import atan, clip, cos, exp, log, pi, sign, sqrt, tanh, where
from stribeck.laws import BristleLaw, Claims
from stribeck.laws.terms import g
from tests.properties.nasty.base import Springy, WithForce, friction, rate


def limited(p, v, z, steady):
    """LuGre's dz/dt with another steady deflection."""
    return v - abs(v) / steady * z


@rate("unique bounded -smooth passive -drift_free")
def Dahl1(p, v, z):
    """Dahl, exponent 1: f = v - |v| z/Z with F_s: Lipschitz, 0 or inward at Z. D = v^2 (200 - 100 r) + F_s |v|
    r^2 >= 0 with r = z sgn v/Z <= 1: passive. |v|: not smooth; f != v for z != 0."""
    return v * (1 - sign(v) * p.sigma_0 * z / p.F_s)


class Dahl2(BristleLaw):
    """Dahl, exponent 2: f = v phi, phi = (1 - r)|1 - r|, r = z sgn v/Z: C1 in z, inward where large: unique; 0 or
    inward at Z. With F = sigma_0 z: sigma_0 z v - W' f = sigma_0 z v (1 - phi) >= 0 as phi <= 1 for z v > 0 and
    phi >= 1 for z v < 0: passive. df/dv differs at v = 0 by the sign of z: not smooth."""

    truth = "unique bounded -smooth passive -drift_free"
    v_d = None

    @staticmethod
    def dz_dt(p, v, z):
        r = p.sigma_0 * z / p.F_s * sign(v)
        return v * abs(1 - r) * (1 - r)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z


class DahlHalf(BristleLaw):
    """Dahl, exponent 1/2: phi = sgn(1 - r) |1 - r|^(1/2), continuous, f not increasing in z for each v: solutions
    exist and do not part: unique, though not Lipschitz at r = 1. Inward or 0 at Z: bounded. Passive as Dahl2: phi
    <= 1 for z v > 0, >= 1 else."""

    truth = "unique bounded -smooth passive -drift_free"
    v_d = None

    @staticmethod
    def dz_dt(p, v, z):
        r = p.sigma_0 * z / p.F_s * sign(v)
        return v * sign(1 - r) * abs(1 - r) ** 0.5

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z


@rate("unique bounded -smooth passive -drift_free", Springy)
def BoucWen1(p, v, z):
    """Bouc-Wen, A = 1, n = 1, u = z/Z: f = v - 0.6 |v| u - 0.4 v |u|. Lipschitz. At Z: 0 for v > 0, 1.2 v for v <
    0: bounded. For z > 0 f/v is 1 - u for v > 0, 1 + 0.2 u for v < 0, so with F = sigma_0 z + sigma_2 v: D =
    sigma_2 v^2 + sigma_0 z v (1 - f/v) >= 0: passive. |v|: not smooth."""
    u = z * p.sigma_0 / p.F_s
    return v - 0.6 * abs(v) * u - 0.4 * v * abs(u)


@rate("unique bounded -smooth passive -drift_free", Springy)
def BoucWen2(p, v, z):
    """Bouc-Wen, n = 2: f = v - 0.5 |v| |u| u - 0.5 v u^2: v (1 - u^2) for v z > 0, v else. C1 in z, inward where
    large: unique; at Z 0 or inward: bounded. D as BoucWen1 with 1 - f/v = u^2 or 0: passive. df/dv jumps at v =
    0: not smooth. f/v = 1 - u^2 for v z > 0, 1 else."""
    u = z * p.sigma_0 / p.F_s
    return v - 0.5 * abs(v) * abs(u) * u - 0.5 * v * abs(u) ** 2


@rate("unique bounded -smooth passive -drift_free", Springy)
def BoucWenOneAndAHalf(p, v, z):
    """Bouc-Wen, n = 1.5, beta = 0.75, gamma = 0.25 (which add up to 1 in floats, as 0.7 and 0.3 do not): f/v = 1 -
    u^1.5 for v z > 0, 1 + 0.5 |u|^1.5 else. C1 in z;
    inward for |u| > 1 (v z > 0) and for v z < 0: unique, bounded. D >= 0 as BoucWen1: passive. Not smooth."""
    u = z * p.sigma_0 / p.F_s
    return v - 0.75 * abs(v) * abs(u) ** 0.5 * u - 0.25 * v * abs(u) ** 1.5


@rate("unique bounded -smooth passive -drift_free", Springy)
def BoucWenHalf(p, v, z):
    """Bouc-Wen, n = 1/2, beta = 0.75, gamma = 0.25: f/v is 1 - |u|^.5 for v z > 0, 1 + 0.5 |u|^.5 else; f does not
    increase with z for either sign of v: unique, though not Lipschitz at z = 0. Bounded and passive as
    BoucWen1."""
    u = z * p.sigma_0 / p.F_s
    return v - 0.75 * abs(v) * sign(u) * abs(u) ** 0.5 - 0.25 * v * abs(u) ** 0.5


@rate("unique bounded -smooth passive -drift_free", Springy)
def BoucWenSoft(p, v, z):
    """Bouc-Wen, n = 1, beta = 0.2, gamma = 0.8: for z > 0 f/v is 1 - u (v > 0), 1 - 0.6 u (v < 0). Lipschitz;
    inward at Z. W is no storage, but S' = sigma_0 z/(1 - 0.6 |u|) is: D/v = sigma_2 v + sigma_0 z (1 - (f/v)/(1 -
    0.6 |u|)), 0 or more in both cases: passive."""
    u = z * p.sigma_0 / p.F_s
    return v - 0.2 * abs(v) * u - 0.8 * v * abs(u)


@rate("unique -bounded -smooth -passive -drift_free", Springy)
def BoucWenGainsEnergy(p, v, z):
    """Bouc-Wen, n = 1, beta = -0.1, gamma = 0.6: for 0 < z f/v is 1 - 0.5 u (v > 0), 1 - 0.7 u (v < 0): a slow
    cycle 0 -> a -> 0 with F = sigma_0 z + 100 v costs sigma_0 z/(1 - 0.5 u), gives sigma_0 z/(1 - 0.7 u): not
    passive. At Z f = v/2 > 0 for v > 0: not bounded. Lipschitz. Not smooth."""
    u = z * p.sigma_0 / p.F_s
    return v + 0.1 * abs(v) * u - 0.6 * v * abs(u)


@rate("unique bounded -smooth passive -drift_free")
def HessSoom(p, v, z):
    """g = (F_c + (F_s - F_c)/(1 + (v/v_s)^2))/sigma_0 is within [1e-5, Z]: B0, and B1 as it stands: passive."""
    return limited(p, v, z, (p.F_c + (p.F_s - p.F_c) / (1 + (v / p.v_s) ** 2)) / p.sigma_0)


@rate("unique bounded -smooth passive -drift_free")
def Tustin(p, v, z):
    """g with exp(-|v|/v_s), within [1e-5, Z]: B0, B1: passive."""
    return limited(p, v, z, (p.F_c + (p.F_s - p.F_c) * exp(-abs(v) / p.v_s)) / p.sigma_0)


@rate("unique bounded -smooth -passive -drift_free", values_changed={"sigma_2": 49.0})
def TustinTooSteep(p, v, z):
    """Tustin's g with sigma_2 = 49: 50 of 100 (1 - r) + 49 at r = 1.5 leaves -1: a pulse at large v from Z draws
    without limit (f = -0.5 v, F v -> -v^2): not passive. B0."""
    return limited(p, v, z, (p.F_c + (p.F_s - p.F_c) * exp(-abs(v) / p.v_s)) / p.sigma_0)


@rate("unique bounded -smooth passive -drift_free")
def GeneralisedHalf(p, v, z):
    """g with exp(-|v/v_s|^0.5), within [1e-5, Z]: B0, B1: passive."""
    return limited(p, v, z, (p.F_c + (p.F_s - p.F_c) * exp(-(abs(v / p.v_s) ** 0.5))) / p.sigma_0)


class GeneralisedDelta(BristleLaw):
    """g with exp(-|v/v_s|^delta), delta a constant of 0.8: within [1e-5, Z]: B0, B1: passive."""

    truth = "unique bounded -smooth passive -drift_free"
    delta = Constant("", "exponent", above=0, default=0.8)

    @staticmethod
    def dz_dt(p, v, z):
        return limited(p, v, z, (p.F_c + (p.F_s - p.F_c) * exp(-(abs(v / p.v_s) ** p.delta))) / p.sigma_0)


@rate("unique bounded -smooth passive -drift_free")
def LorentzianPower(p, v, z):
    """g = (F_c + (F_s - F_c)/(1 + |v/v_s|^1.4))/sigma_0, within [1e-5, Z]: B0, B1: passive."""
    return limited(p, v, z, (p.F_c + (p.F_s - p.F_c) / (1 + abs(v / p.v_s) ** 1.4)) / p.sigma_0)


@rate("unique bounded -smooth passive -drift_free")
def SechStribeck(p, v, z):
    """g = (F_c + (F_s - F_c)/cosh(v/v_s))/sigma_0, cosh by exp, within [1e-5, Z]: B0, B1: passive."""
    cosh = (exp(v / p.v_s) + exp(-v / p.v_s)) / 2
    return limited(p, v, z, (p.F_c + (p.F_s - p.F_c) / cosh) / p.sigma_0)


@rate("unique bounded -smooth passive -drift_free")
def TanhStribeck(p, v, z):
    """g = (F_s - (F_s - F_c) tanh(|v|/v_s))/sigma_0, within [1e-5, Z]: B0, B1: passive."""
    return limited(p, v, z, (p.F_s - (p.F_s - p.F_c) * tanh(abs(v) / p.v_s)) / p.sigma_0)


@rate("unique bounded -smooth passive -drift_free", symmetric=False)
def Asymmetric(p, v, z):
    """Another Coulomb friction backwards: g in [1e-5, Z] for v > 0 and [0.8e-5, Z] for v <= 0; |v|/g is
    continuous. Inward at Z. r <= 1.875 backwards: 100 (1 - r) + 100 >= 12.5: D > 0: passive. B0 else."""
    F_c = where(v > 0, p.F_c, 0.8 * p.F_c)
    return limited(p, v, z, (F_c + (p.F_s - F_c) * exp(-((v / p.v_s) ** 2))) / p.sigma_0)


@friction("unique bounded -smooth passive -drift_free", WithForce)
def HardeningSpring(p, v, z, dz_dt):
    """F = sigma_0 z (1 + u^2) + sigma_1 f + sigma_2 v, u = z/Z: h = sigma_0 z u^2, z h >= 0: B4, passive. B0."""
    return p.sigma_0 * z * (1 + (z * p.sigma_0 / p.F_s) ** 2) + p.sigma_1 * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth passive -drift_free", WithForce)
def SofteningSpring(p, v, z, dz_dt):
    """F = sigma_0 z (1 - u^2/2) + ...: sigma_0 z + h has the sign of z within Z: B4, passive. B0."""
    return p.sigma_0 * z * (1 - (z * p.sigma_0 / p.F_s) ** 2 / 2) + p.sigma_1 * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth -passive -drift_free", WithForce)
def CollapsingSpring(p, v, z, dz_dt):
    """F = sigma_0 z (1 - 1.5 u^2) + ...: negative for u > 0.82: B4, not passive. B0."""
    return p.sigma_0 * z * (1 - 1.5 * (z * p.sigma_0 / p.F_s) ** 2) + p.sigma_1 * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth passive -drift_free", WithForce)
def DampingByDeflection(p, v, z, dz_dt):
    """sigma_1 (1 + u^2/2): D = v^2 (sigma_1 (1 + u^2/2)(1 - r) + 100) + g_N |v| r^2, the bracket least at u = 1,
    r = 1.5: 150 * -0.5 + 100 = 25 > 0: passive. B0."""
    return p.sigma_0 * z + p.sigma_1 * (1 + 0.5 * (z * p.sigma_0 / p.F_s) ** 2) * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth -passive -drift_free", WithForce)
def StrongDampingByDeflection(p, v, z, dz_dt):
    """sigma_1 (1 + 2 u^2): the bracket at u = 1, r = 1.5 is -150 + 100 < 0: a pulse at large v from near Z draws
    without limit: not passive. B0."""
    return p.sigma_0 * z + p.sigma_1 * (1 + 2 * (z * p.sigma_0 / p.F_s) ** 2) * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth passive -drift_free", WithForce, values_changed={"sigma_2": 0.0})
def DampingOverOnePlusV(p, v, z, dz_dt):
    """sigma_1/(1 + (v/v_s)^2), sigma_2 = 0, sigma_1 = 100: D/|v| = |v| s (1 - r) + g_N r^2 with |v| s <= 100
    v_s/2 = 0.05: >= 0.05 (1 - r) + r^2 > 0 for r > 1, and for r <= 1 no term is negative: passive. B0."""
    return p.sigma_0 * z + p.sigma_1 / (1 + (v / p.v_s) ** 2) * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth -passive -drift_free", WithForce)
def ShearThinning(p, v, z, dz_dt):
    """Viscous friction sigma_2 v/(1 + |v|): at large v 100 (1 - 1.5) + 0 < 0: a pulse from near Z draws without
    limit: not passive. B0."""
    return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v / (1 + abs(v))


@friction("unique bounded -smooth passive -drift_free", WithForce)
def QuadraticDrag(p, v, z, dz_dt):
    """h = 5 v |v|: h v >= 0: B1, passive. B0."""
    return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + 5 * v * abs(v)


@friction("unique bounded -smooth passive -drift_free", WithForce)
def EyringViscosity(p, v, z, dz_dt):
    """h = 2 asinh(v/v_0) by log, odd and rising: h v >= 0: B1, passive. B0."""
    return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + 2 * log(v / 0.01 + sqrt((v / 0.01) ** 2 + 1))


@friction("unique bounded -smooth passive -drift_free", WithForce)
def SinhViscosity(p, v, z, dz_dt):
    """h = exp(v) - exp(-v): h v >= 0: B1, passive. B0."""
    return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + exp(v) - exp(-v)


@friction("unique bounded -smooth passive -drift_free", WithForce)
def PowerLawViscosity(p, v, z, dz_dt):
    """h = 3 sgn v |v|^0.6: h v >= 0: B1, passive. B0."""
    return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + 3 * sign(v) * abs(v) ** 0.6


@rate("unique bounded -smooth passive -drift_free", values_changed={"sigma_1": 50.0})
def LeuvenLike(p, v, z):
    """f = v (1 - sgn(v z) (z/g)^2), sigma_1 = 50: r |r| up to 2.25: D/v^2 >= 50 (1 - 2.25) + 100 > 0, W's part
    sigma_0 |z| |v| r^2 >= 0: passive. C1 in z, inward where large: unique; (Z/g)^2 >= 1: bounded. df/dv jumps at
    v = 0."""
    return v * (1 - sign(v) * sign(z) * abs(z / g(p, v)) ** 2)


@rate("unique bounded -smooth -passive -drift_free")
def LeuvenLikeTooDamped(p, v, z):
    """LeuvenLike with sigma_1 = 100: 100 (1 - 2.25) + 100 = -25: a pulse at large v from near Z draws without
    limit: not passive."""
    return v - abs(v) * z * abs(z) / g(p, v) ** 2


@rate("unique -bounded smooth passive -drift_free")
def MaxwellElement(p, v, z):
    """f = v - z/1 s: z -> v at held v: not bounded. Linear: unique, smooth. D = 200 v^2 - 100 z v + 1e5 z^2, 1e4
    < 4 * 200 * 1e5: passive for every z."""
    return v - z


class Spring(BristleLaw):
    """f = v: unique, smooth, drift_free; z = y: not bounded. D = 200 v^2: passive."""

    truth = "unique -bounded smooth passive drift_free"

    @staticmethod
    def z_elastic(p):
        return p.F_c / p.sigma_0

    @staticmethod
    def dz_dt(p, v, z):
        return v


class StopOperator(BristleLaw):
    """Prandtl's element (Haessig and Friedland's reset integrator): f = v for |z| < Z, and at |z| >= Z only
    inwards. f does not increase with z: solutions do not part, and they exist (z stays at Z): unique. Bounded. f
    jumps at Z. D = 200 v^2, or at Z, f = 0, F v > 0: passive. drift_free."""

    truth = "unique bounded -smooth passive drift_free"

    @staticmethod
    def z_elastic(p):
        return p.F_c / p.sigma_0 / 2

    @staticmethod
    def dz_dt(p, v, z):
        Z = p.F_s / p.sigma_0
        return where(z * sign(v) >= Z, 0.0, v)


class SteppedElastoplastic(BristleLaw):
    """Elasto-plastic with a ramp: a = clip((|z| - z_b)/(g - z_b), 0, 1), z_b = 0.5e-5 < g: Lipschitz; a = 1 at Z:
    bounded; D is linear in a, 200 v^2 at a = 0 and B1 at a = 1: passive; f = v for |z| <= z_b. Kinks."""

    truth = "unique bounded -smooth passive drift_free"

    @staticmethod
    def z_elastic(p):
        return 0.5 * p.F_c / p.sigma_0

    @staticmethod
    def dz_dt(p, v, z):
        z_b = 0.5 * p.F_c / p.sigma_0
        return v - clip((abs(z) - z_b) / (g(p, v) - z_b), 0.0, 1.0) * abs(v) / g(p, v) * z


class CosineElastoplastic(SteppedElastoplastic):
    """SteppedElastoplastic with a = (1 - cos(pi s))/2 of the ramp s, in [0, 1]: Lipschitz, bounded, passive,
    drift_free alike; |v|."""

    truth = "unique bounded -smooth passive drift_free"

    @staticmethod
    def dz_dt(p, v, z):
        z_b = 0.5 * p.F_c / p.sigma_0
        s = clip((abs(z) - z_b) / (g(p, v) - z_b), 0.0, 1.0)
        return v - (1 - cos(pi * s)) / 2 * abs(v) / g(p, v) * z


@rate("unique -bounded smooth passive -drift_free", values_changed={"sigma_1": 0.0})
def TanhLuGre(p, v, z):
    """|v| replaced by v tanh(1e6 v) < |v|: held v takes z to g/tanh, past Z and without limit as v -> 0: not
    bounded. sigma_1 = 0: D = 100 v^2 + v tanh sigma_0 z^2/g >= 0 for every z: passive. Analytic: smooth,
    unique."""
    return v - v * tanh(1e6 * v) / g(p, v) * z


@rate("unique -bounded smooth -passive -drift_free")
def TanhLuGreDamped(p, v, z):
    """TanhLuGre with sigma_1 = 100: not bounded, so z is unrestricted: B2, not passive."""
    return v - v * tanh(1e6 * v) / g(p, v) * z


@rate("unique bounded smooth passive -drift_free")
def SoftPlusMajorant(p, v, z):
    """m = log(2 cosh(k v))/k >= |v|, m - |v| <= m(0) = 6.9e-7, sigma_1 m(0) <= F_s: smooth, bounded, passive by
    theory.md's proof, which uses only these; leaks."""
    return v - log(exp(1e6 * v) + exp(-1e6 * v)) / 1e6 / g(p, v) * z


@rate("unique bounded smooth passive -drift_free")
def RootMajorant(p, v, z):
    """m = sqrt(v^2 + 1e-12): theory.md's sqrt majorant, k_v = 1e6: smooth, bounded, passive, leaks."""
    return v - sqrt(v**2 + 1e-12) / g(p, v) * z


@rate("unique -bounded smooth -passive -drift_free")
def RootMinorant(p, v, z):
    """m = sqrt(v^2 + 1e-12) - 1e-6 < |v|: held z tends to g v/m, without limit as v -> 0: not bounded; B2 (m/|v|
    -> 1): not passive. Smooth."""
    return v - (sqrt(v**2 + 1e-12) - 1e-6) / g(p, v) * z


@rate("unique bounded smooth passive -drift_free")
def AtanSignWithSquare(p, v, z):
    """m = |v| (2/pi) atan(1e6 |v|) + 1e-6: x (1 - (2/pi) atan x) = (2/pi) x atan(1/x) <= 2/pi < 1: m >= |v|, m -
    |v| <= 1e-6 = m(0): as RootMajorant. v atan(k v) = |v| atan(k |v|) is analytic: smooth."""
    m = abs(v) * atan(1e6 * abs(v)) * 2 / pi + 1e-6
    return v - m / g(p, v) * z


@rate("unique -bounded -smooth -passive -drift_free")
def DeadZone(p, v, z):
    """Karnopp-like: f = v for |v| <= 1e-6, LuGre's beyond: held there z has no limit: not bounded; B2: not
    passive. Lipschitz in z. f jumps."""
    return v - where(abs(v) <= 1e-6, 0.0, abs(v)) / g(p, v) * z


@friction("unique bounded -smooth passive -drift_free", WithForce)
def TwoSlopes(p, v, z, dz_dt):
    """A spring that stiffens (Iwan's backbone): h = sigma_0 (z - clip(z, -Z/2, Z/2)), z h >= 0: B4, passive.
    B0."""
    half = p.F_s / p.sigma_0 / 2
    return p.sigma_0 * (2 * z - clip(z, -half, half)) + p.sigma_1 * dz_dt + p.sigma_2 * v


class LiesAboutEverything(BristleLaw):
    """LuGre as it is: B0, B1, with claims that are all wrong."""

    truth = "unique bounded -smooth passive -drift_free"
    claims = Claims(unique=False, bounded=False, smooth=True, passive=False, drift_free=True)

    @staticmethod
    def z_elastic(p):
        return p.F_c / p.sigma_0

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z
