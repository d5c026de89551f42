"""Other states than a deflection, other signs, other ways to lose power, and forms that no law of the others has."""

from stribeck.constants import Constant
from stribeck.expressions.ops import atan, clip, cos, exp, log, pi, sign, sin, sqrt, tanh, where
from stribeck.laws import BristleLaw, Scales
from stribeck.laws.terms import g
from tests.properties.nasty.base import friction, rate


def plain(p, v, z, dz_dt):
    """LuGre's force."""
    return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v


class _Strange(BristleLaw):
    v_d = None
    friction = staticmethod(plain)

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z


class Mirrored(_Strange):
    """z is minus the deflection: f = -v - |v| z/g, F = -sigma_0 z - sigma_1 f + sigma_2 v: LuGre in -z: B0, B1."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def dz_dt(p, v, z):
        return -v - abs(v) / g(p, v) * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return -p.sigma_0 * z - p.sigma_1 * dz_dt + p.sigma_2 * v


class MirroredUndamped(Mirrored):
    """With sigma_2 = 0 LuGre's condition fails: not passive. B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    values_changed = {"sigma_2": 0.0}


@rate("unique bounded -smooth -passive -drift_free", _Strange)
def HalfMirrored(p, v, z):
    """f = -v - |v| z/g with LuGre's force: slid at v > 0, z -> -g, F = -g_N + 100 v: F v < 0 held at 1e-3: B3, not
    passive. Mirrored LuGre's f: unique, bounded; |v|."""
    return -v - abs(v) / g(p, v) * z


class Micrometres(_Strange):
    """z in um: f = 1e6 (v - |v| 1e-6 z/g), F with sigma_0 1e-6 z and sigma_1 1e-6 f, z_bound 1e6 Z: LuGre, B0, B1; f != v
    for every z: not drift_free."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def z_bound(p):
        return 1e6 * p.F_s / p.sigma_0

    @staticmethod
    def stored_energy(p, z):
        return p.sigma_0 * (1e-6 * z) ** 2 / 2

    @staticmethod
    def dz_dt(p, v, z):
        return 1e6 * (v - abs(v) / g(p, v) * (1e-6 * z))

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * (1e-6 * z) + p.sigma_1 * (1e-6 * dz_dt) + p.sigma_2 * v


class DieterichRuina(_Strange):
    """Rate and state: z is the age of contacts in s, f = 1 - |v| z/D: at rest z grows for ever: not bounded. Linear in z:
    unique. F = v/(|v| + 1e-6) (1 + 0.1 log(1 + z^2)) + sigma_2 v: F v >= 0: passive. |v|; f = 1 at z = 0."""

    truth = "unique -bounded -smooth passive -drift_free"
    natural = True

    @staticmethod
    def dz_dt(p, v, z):
        return 1 - abs(v) / 1e-5 * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return v / (abs(v) + 1e-6) * (1 + 0.1 * log(1 + z * z)) + p.sigma_2 * v


@friction("unique -bounded -smooth -passive -drift_free", DieterichRuina, natural=False)
def DieterichRuinaAged(p, v, z, dz_dt):
    """With 1 - 0.1 log(1 + z^2), < 0 for z > 150 s, which a rest of 200 s gives: F < 0 then at v = 1e-9 m/s (share 1e-3,
    sigma_2 v = 1e-7), while z goes from 200 to 150 at most as fast as 1 - 1e-4 * 200 ...: it rises: held at 1e-9, z -> D/v =
    1e4 s and stays there: F v < 0 for ever: not passive."""
    return v / (abs(v) + 1e-6) * (1 - 0.1 * log(1 + z * z)) + p.sigma_2 * v


@rate("unique bounded smooth -passive -drift_free", _Strange)
def Frozen(p, v, z):
    """f = 0: z stays where it is: unique, bounded, smooth (F = sigma_0 z + sigma_2 v). From z = Z/2 F v = (0.75 + 100 v) v <
    0 at v = -1e-3, for ever: not passive. f != v."""
    return 0 * v


@rate("unique bounded -smooth -passive -drift_free", _Strange)
def AlwaysWindsUp(p, v, z):
    """f = |v| (1 - z/g): z -> g for either sign of v: inward at +-Z: bounded; Lipschitz. Slid backwards slowly, z = g and
    F v = (g_N + 100 v) v < 0: not passive. |v|."""
    return abs(v) * (1 - z / g(p, v))


@rate("unique bounded -smooth passive -drift_free", _Strange)
def Latches(p, v, z):
    """f = v max(0, 1 - r): LuGre's where r <= 1; beyond z waits for v to turn: bounded, Lipschitz. D is LuGre's for r <= 1,
    else F v = (sigma_0 |z| + 100 |v|) |v| > 0: passive. B0 else."""
    share = 1 - sign(v) * z / g(p, v)
    return v * where(share > 0, share, 0.0)


@friction("unique bounded -smooth passive -drift_free", _Strange)
def AgainstItself(p, v, z, dz_dt):
    """sigma_1 = 0, F = sigma_0 z - 40 f + 100 v: f v = v^2 (1 - r) <= 2.5 v^2 for |r| <= 1.5: D = 100 v^2 - 40 f v + g_N |v|
    r^2 (1 + 40 |v|/g_N ...): with W alone F v - W' f = v^2 (100 - 40 (1 - r)) + g_N |v| r^2 >= 0: passive, just. B0."""
    return p.sigma_0 * z - 40.0 * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth -passive -drift_free", _Strange)
def AgainstItselfByAHair(p, v, z, dz_dt):
    """With -40.001: from z = -Z a pulse at large v has F v/v^2 -> 100 - 40.001 * 2.5 < 0 near r = -1.5, z moves like v: it
    draws without limit: not passive. B0."""
    return p.sigma_0 * z - 40.001 * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth -passive -drift_free", _Strange)
def SquareDamping(p, v, z, dz_dt):
    """F = sigma_0 z + 100 f |f| + 100 v. From near Z at large v, r near 1.5: f |f| v = -v^3 (r - 1)^2: it draws like v^2 for
    each metre of z: not passive. B0."""
    return p.sigma_0 * z + 100.0 * dz_dt * abs(dz_dt) + p.sigma_2 * v


class SquareDampingFlat(SquareDamping):
    """With F_s = F_c r <= 1 within Z: f v >= 0: D = 100 |f| f v + g_N |v| r^2 + 100 v^2 >= 0: passive. B0 with g = Z."""

    truth = "unique bounded -smooth passive -drift_free"
    values_changed = {"F_c": 1.5}


@friction("unique bounded -smooth passive -drift_free", _Strange)
def SaturatedDamping(p, v, z, dz_dt):
    """F = sigma_0 z + tanh(f/v_s) + 100 v: v tanh(f/v_s) >= -|v| where f v < 0, so where r > 1, and there g_N |v| r^2 >=
    |v|: D >= 0: passive. B0."""
    return p.sigma_0 * z + tanh(dz_dt / p.v_s) + p.sigma_2 * v


@rate("unique bounded -smooth passive -drift_free", _Strange, natural=True)
def SineSaturation(p, v, z):
    """f = v - |v| sin(pi u/2), u = z/Z: f = 0 or inward at |z| = Z, Lipschitz: unique, bounded (from outside Z z may run on,
    but it starts within). f v >= 0: D = 100 f v + 100 v^2 + sigma_0 z |v| sin >= 0 within Z: passive. |v|."""
    return v - abs(v) * sin(pi * z * p.sigma_0 / (2 * p.F_s))


@rate("unique -bounded -smooth -passive -drift_free", _Strange, values_changed={"sigma_1": 0.0})
def SineSaturationTooLong(p, v, z):
    """With u less by 1e-7 of it: sin < 1 at Z: held v > 0 takes z past Z (to Z (1 + 1e-7)): not bounded. sigma_1 = 0: D =
    100 v^2 + sigma_0 z |v| sin(...) < 0 where the sine is < 0, at z from 2 Z to 4 Z; to and fro there slowly: unwinding (v <
    0) f = -|v| (1 + sin), winding v (1 - sin), sin < 0: L = sigma_0 z/(1 + sin) > U = sigma_0 z/(1 - sin): not passive, with
    z not restricted. Lipschitz."""
    return v - abs(v) * sin(pi * z * p.sigma_0 / (2 * p.F_s) * (1 - 1e-7))


@rate("unique bounded -smooth passive -drift_free", _Strange)
def SinhDecay(p, v, z):
    """f = v - |v| sinh(u)/sinh(1): falls with z: unique; it is inward or 0 at |u| >= 1: bounded. f v >= 0 within: D = 100 f v
    + 100 v^2 + sigma_0 z |v| sinh(u)/sinh(1) >= 0: passive. |v|."""
    u = p.sigma_0 * z / p.F_s
    return v - abs(v) * (exp(u) - exp(-u)) / (exp(1.0 + 0 * u) - exp(-1.0 + 0 * u))


@rate("-unique -bounded smooth ?passive -drift_free", _Strange)
def CoshEscape(p, v, z):
    """f = v cosh(z/1 m): held v > 0 takes z to infinity within pi m of way: not unique (no z for all t), not bounded.
    Analytic: smooth. Passive not derived (z ends). f != v."""
    return v * (exp(z) + exp(-z)) / 2


@rate("unique bounded -smooth -passive -drift_free", _Strange)
def ExponentialSlip(p, v, z):
    """f = v - z (exp|v| - 1)/1e-5: exp|v| - 1 >= |v|, 1e-5 <= Z: inward: bounded; linear in z: unique. From z = Z/2 at v = 20
    f is about -0.75e-5 e^20/1e-5: unwinding draws F v/f = 100 v + O(1) for each metre, and more with v: not passive (with
    sigma_1 = 100; winding costs a fixed amount). |v|."""
    return v - z * (exp(abs(v)) - 1) / 1e-5


@rate("unique -bounded -smooth passive -drift_free", _Strange, values_changed={"sigma_1": 0.0})
def RootSlip(p, v, z):
    """f = v - sqrt|v| z/(1e-3 s^.5): z -> 1e-3 sqrt v without bound for large v: not bounded. Linear: unique. sigma_1 = 0: D =
    100 v^2 + sigma_0 z^2 sqrt|v|/1e-3 >= 0 for every z: passive. sqrt|v| is not C1 at 0."""
    return v - sqrt(abs(v)) * z / 1e-3


@rate("unique bounded smooth passive -drift_free", _Strange)
def MajorantByCosine(p, v, z):
    """m = e/cos(atan(v/e)), e = 1e-6 m/s, is sqrt(v^2 + e^2): theory.md: smooth, bounded, passive (sigma_1 e <= F_s)."""
    return v - 1e-6 / cos(atan(v / 1e-6)) / g(p, v) * z


@rate("unique -bounded smooth -passive -drift_free", _Strange, values_changed={"F_c": 1.5})
def MajorantRoundedDown(p, v, z):
    """m = (2/pi) v atan(k v) + 0.6366197/k, k = 1e6, whose last term is less than 2/(pi k): at large v m < |v| by 7e-14.
    F_s = F_c: g = Z: held there z -> Z |v|/m > Z: not bounded. B2: not passive. Smooth."""
    return v - (2 / pi * v * atan(1e6 * v) + 0.6366197e-6) / g(p, v) * z


@rate("unique bounded smooth passive -drift_free", _Strange, values_changed={"F_c": 1.5})
def MajorantRoundedUp(p, v, z):
    """With 0.6366198: m >= |v|, m - |v| <= m(0), sigma_1 m(0) <= F_s: theory.md's proofs: smooth, bounded, passive."""
    return v - (2 / pi * v * atan(1e6 * v) + 0.6366198e-6) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free", _Strange)
def ShrinkingElastic(p, v, z):
    """f = v for |z| <= c/(1 + (v/v_s)^2), c = 0.3e-5, then a ramp to LuGre's: at each z > 0 it decays at large v: not
    drift_free. The share is in [0, 1] and 1 at Z: bounded, passive (D is linear in it); Lipschitz for bounded v."""
    c = 0.3e-5 / (1 + (v / p.v_s) ** 2)
    return v - clip((abs(z) - c) / c, 0.0, 1.0) * abs(v) / g(p, v) * z


class ShrinkingElasticToAFloor(_Strange):
    """With c = 0.3e-5 (1 + 1/(1 + (v/v_s)^2)) >= 0.3e-5: f = v for |z| <= 0.3e-5: drift_free; c <= 0.6e-5, so the share is 1
    from 1.2e-5 on. Else as ShrinkingElastic."""

    truth = "unique bounded -smooth passive drift_free"

    @staticmethod
    def z_elastic(p):
        return 0.2e-5 + 0 * p.F_c

    @staticmethod
    def dz_dt(p, v, z):
        c = 0.3e-5 * (1 + 1 / (1 + (v / p.v_s) ** 2))
        return v - clip((abs(z) - c) / c, 0.0, 1.0) * abs(v) / g(p, v) * z


@friction("unique bounded -smooth passive -drift_free", _Strange, values_changed={"sigma_1": 0.0})
def HighPower(p, v, z, dz_dt):
    """sigma_1 = 0, viscosity 100 (1 - (z/Z)^40) >= 0 within Z: D = that v^2 + g_N |v| r^2 >= 0: passive. B0."""
    return p.sigma_0 * z + p.sigma_2 * (1 - (p.sigma_0 * z / p.F_s) ** 40) * v


@friction("unique bounded -smooth -passive -drift_free", _Strange, values_changed={"sigma_1": 0.0})
def HighPowerTooMuch(p, v, z, dz_dt):
    """100 (1 - 1.01 (z/Z)^40) is -1 at Z: from there, at large v, F v -> -v^2, and z falls like v: a pulse draws without
    limit: not passive. B0."""
    return p.sigma_0 * z + p.sigma_2 * (1 - 1.01 * (p.sigma_0 * z / p.F_s) ** 40) * v


@friction("unique bounded -smooth -passive -drift_free", _Strange, symmetric=False)
def BumpInBoth(p, v, z, dz_dt):
    """h = -1000 exp(-((v - 1)/0.01)^2 - ((u - 0.5)/0.02)^2), u = z/Z: at v = 1 f >= 0.2 there, and to wind z over the bump
    (2e-7 m) draws over 1e-4 J; slowly back gives or costs less than 1e-5 J: not passive. B0."""
    u = p.sigma_0 * z / p.F_s
    return plain(p, v, z, dz_dt) - 1000.0 * exp(-(((v - 1) / 0.01) ** 2) - ((u - 0.5) / 0.02) ** 2)


@friction("unique bounded -smooth -passive -drift_free", _Strange, symmetric=False)
def PushesFarOutByAPower(p, v, z, dz_dt):
    """h = 1e-3 (v^2 + (100 z)^2)^0.75 >= 0, also backwards: at v = -1e13 h = 3e16 N, 100 v = -1e15 N: F v < 0, held: B3, not
    passive. B0."""
    return plain(p, v, z, dz_dt) + 1e-3 * (v**2 + (100.0 * z) ** 2) ** 0.75


@friction("unique bounded -smooth ?passive -drift_free", _Strange)
def RootRunsOut(p, v, z, dz_dt):
    """h = sqrt(1 - (v/10)^2): no value beyond 10 m/s: F is not C1. Passive not derived. f is LuGre's: B0."""
    return plain(p, v, z, dz_dt) + v * sqrt(1 - (v / 10.0) ** 2)


class Subnormal(_Strange):
    """sigma_1 = 5e-324, sigma_2 = 0, F_s = 1.5 F_c: LuGre's condition fails: not passive. B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    values_changed = {"sigma_1": 5e-324, "sigma_2": 0.0}


class SubnormalDamped(_Strange):
    """sigma_1 = sigma_2 = 5e-324: LuGre's condition holds: passive. B0."""

    truth = "unique bounded -smooth passive -drift_free"
    values_changed = {"sigma_1": 5e-324, "sigma_2": 5e-324}


class NegativeBound(_Strange):
    """LuGre that says its bound is -1 m: there is nothing within it: bounded and passive are not derived. B0 else."""

    truth = "unique ?bounded -smooth ?passive -drift_free"

    @staticmethod
    def z_bound(p):
        return -1.0 + 0 * p.F_s


class OwnScales(_Strange):
    """A law of torsion with constants of 1e-200 and 1e200: D = c v^2 + k |v| z^2/G >= 0: passive. Its f = v - |v| z/G: B0
    with g = G."""

    truth = "unique bounded -smooth passive -drift_free"
    uses = ()
    relations = ()
    k = Constant("N m/rad", "stiffness", above=0, default=1e-200)
    G = Constant("rad", "deflection", above=0, default=1e200)
    c = Constant("N m s/rad", "viscosity", at_least=0, default=0.0)

    @staticmethod
    def z_bound(p):
        return p.G

    @staticmethod
    def scales(p):
        return Scales(p.G, 1.0, p.k * p.G)

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / p.G * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.k * z + p.c * v

    @staticmethod
    def stored_energy(p, z):
        return p.k * z**2 / 2
