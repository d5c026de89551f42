"""Forces and rates that are piecewise constant in z, dz/dt or v: windows some percent, some ppm wide, far out, far in."""

from stribeck.expressions.ops import both, either, sign, sin, where
from stribeck.laws import Claims
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, added, rate


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushesInAWindowOfZ(p, v, z, dz_dt):
    """h = -10 N for 0.97 Z < z < 0.99 Z. B0. Held where g = 0.98 Z, F = 1.47 + 100 v - 10 < 0: B3, not
    passive."""
    u = z * p.sigma_0 / p.F_s
    return where(both(u > 0.97, u < 0.99), -10.0, 0.0)


class PushesWhereNoSpeedRests(Lopsided):
    """h = -10 N for 0.5 Z < z < 0.502 Z, below every steady z. B0. B4: z (sigma_0 z + h) < 0 there: not
    passive."""

    truth = "unique bounded -smooth -passive -drift_free"
    claims = Claims(unique=True, bounded=True, smooth=False, passive=True, drift_free=False)  # a lie

    @staticmethod
    def h(p, v, z, dz_dt):
        u = z * p.sigma_0 / p.F_s
        return where(both(u > 0.5, u < 0.502), -10.0, 0.0)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def BrakesInAWindowOfZ(p, v, z, dz_dt):
    """h = +10 N for 0.5 Z < z < 0.52 Z. B0. B4: z (sigma_0 z + h) >= 0: passive."""
    u = z * p.sigma_0 / p.F_s
    return where(both(u > 0.5, u < 0.52), 10.0, 0.0)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushesInAPartPerMillion(p, v, z, dz_dt):
    """h = -2 N where |z/Z - 0.3| < 5e-7: B0; there sigma_0 z = 0.45 N, so B4 says not passive."""
    return where(abs(z * p.sigma_0 / p.F_s - 0.3) < 5e-7, -2.0, 0.0)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def WeakPushInAWindowOfZ(p, v, z, dz_dt):
    """h = -0.4 N where |z/Z - 0.3| < 0.01: sigma_0 z >= 0.43 N there, so sigma_0 z + h > 0 and B4 says passive.
    B0."""
    return where(abs(z * p.sigma_0 / p.F_s - 0.3) < 0.01, -0.4, 0.0)


@added("unique bounded -smooth passive -drift_free")
def SignOfZ(p, v, z, dz_dt):
    """h = 0.5 sgn z: z h >= 0, so B4 says passive. B0; F jumps at z = 0: not smooth."""
    return 0.5 * sign(z)


@added("unique bounded -smooth -passive -drift_free")
def MinusSignOfZ(p, v, z, dz_dt):
    """h = -0.5 sgn z: z (sigma_0 z + h) < 0 for |z| < 0.5e-5: B4, not passive. B0."""
    return -0.5 * sign(z)


@added("unique bounded -smooth passive -drift_free")
def SignOfRate(p, v, z, dz_dt):
    """h = 0.5 sgn f: v sgn f = |v| for r < 1, -|v| for r > 1, where D0 >= g_N |v| r^2 >= |v| > 0.5 |v|: D >= 0.
    B0."""
    return 0.5 * sign(dz_dt)


@added("unique bounded -smooth -passive -drift_free")
def StrongSignOfRate(p, v, z, dz_dt):
    """h = 5 sgn f. From z = Z held at v = 5e-3 (g = 1e-5 but for 1e-11 of it) z falls to g and never reaches it,
    so f < 0 for ever, and F -> 1 + 0.5 - 5 < 0: endless energy, not passive. B0."""
    return 5.0 * sign(dz_dt)


@added("unique bounded -smooth -passive -drift_free")
def MinusSignOfRate(p, v, z, dz_dt):
    """h = -0.5 sgn f: to and fro on |z| <= a, slowly, draws 0.5 |dz| and costs (2/3) g_N a (a/g)^2 + O(v): a
    small: not passive. B0."""
    return -0.5 * sign(dz_dt)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def WindowOfRate(p, v, z, dz_dt):
    """h = -10 N for 1e-5 < f < 1.01e-5 m/s. From z = 0 to 1e-6 m at such f draws 1e-5 J; all else on the way
    there and back at f = -1e-6 m/s costs below 1e-7 J (W is given back; D0 is 200 v^2 + 1.5 r^2 |v| with r <
    0.07). Not passive. B0."""
    return where(both(dz_dt > 1e-5, dz_dt < 1.01e-5), -10.0, 0.0)


@added("unique bounded -smooth passive -drift_free")
def WindowOfRateAgainstMotion(p, v, z, dz_dt):
    """h = 10 sgn v where |f| is within 1e-5 ... 1.01e-5 m/s: h v >= 0, B1: passive. B0; F jumps: not smooth."""
    return where(both(abs(dz_dt) > 1e-5, abs(dz_dt) < 1.01e-5), 10.0 * sign(v), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def PushesInAWindowOfV(p, v, z, dz_dt):
    """h = -10 sgn v for 1e-4 < |v| < 1.001e-4: F v < 0 when held there (1.5 + 0.01 - 10): B3, not passive. B0."""
    return where(both(abs(v) > 1e-4, abs(v) < 1.001e-4), -10.0 * sign(v), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def PushesFarOut(p, v, z, dz_dt):
    """h = -1e9 sgn v for 1e6 < |v| < 1.000001e6; sigma_2 v = 1e8 N: held there F v < 0, B3: not passive. B0."""
    return where(both(abs(v) > 1e6, abs(v) < 1.000001e6), -1e9 * sign(v), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def PushesVeryFarOut(p, v, z, dz_dt):
    """h = -1e20 sgn v for |v| > 1e15, sigma_2 |v| = 1e17 N: F v < 0 held at 2e15 m/s: B3, not passive. B0."""
    return where(abs(v) > 1e15, -1e20 * sign(v), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def PushesWhenCreeping(p, v, z, dz_dt):
    """h = -10 sgn v for 1e-9 < |v| < 1.001e-9: held there F = 1.5 - 10 < 0: B3, not passive. B0."""
    return where(both(abs(v) > 1e-9, abs(v) < 1.001e-9), -10.0 * sign(v), 0.0)


@added("unique bounded -smooth passive -drift_free")
def BrakesInAWindowOfV(p, v, z, dz_dt):
    """h = +10 sgn v for 1e-4 < |v| < 1.01e-4: h v >= 0, B1: passive. B0."""
    return where(both(abs(v) > 1e-4, abs(v) < 1.01e-4), 10.0 * sign(v), 0.0)


@added("unique bounded -smooth passive -drift_free")
def CoulombBesides(p, v, z, dz_dt):
    """h = 0.3 sgn v: h v >= 0, B1: passive. B0."""
    return 0.3 * sign(v)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def BrakesWhenUnwinding(p, v, z, dz_dt):
    """h = -100 N where z > 0.9 Z and v < 0: h v >= 0, B1: passive. B0. A condition on v and z."""
    return where(both(z > 0.9 * p.F_s / p.sigma_0, v < 0), -100.0, 0.0)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def PushesWhenUnwinding(p, v, z, dz_dt):
    """h = +100 N where z > 0.9 Z and v < 0. B0. Slowly from 0.9 Z to 0.95 Z costs W's rise and at most 1.5 Z
    (0.95^2) ln 2 = 1.5e-5 J; back gives W and draws at least 100/2 * 0.05 Z = 3.7e-5 J, less 1.5 * 0.05 Z =
    1.2e-6 J: not passive."""
    return where(both(z > 0.9 * p.F_s / p.sigma_0, v < 0), 100.0, 0.0)


@added("unique bounded -smooth -passive -drift_free")
def FastOrFarPushes(p, v, z, dz_dt):
    """h = -1e6 sgn v where |z| > 2 Z or |v| > 1e3; sigma_2 |v| = 1e5 N at 1e3 m/s: F v < 0 held just above: B3.
    B0."""
    return where(either(abs(z) > 2 * p.F_s / p.sigma_0, abs(v) > 1e3), -1e6 * sign(v), 0.0)


@added("unique bounded -smooth passive -drift_free")
def FarOnlyPushes(p, v, z, dz_dt):
    """h = -1e6 sgn v where |z| > 2 Z, which z within Z never meets: LuGre there, passive (B1). B0; F jumps at 2 Z
    and |v|."""
    return where(either(abs(z) > 2 * p.F_s / p.sigma_0, both(v > 1, v < 0)), -1e6 * sign(v), 0.0)


@added("unique bounded -smooth passive -drift_free")
def OppositeSigns(p, v, z, dz_dt):
    """h = 3 sgn v where v z < 0, else 0: h v >= 0, B1: passive. B0."""
    return where(v * z < 0, 3.0 * sign(v), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def AidedUnwinding(p, v, z, dz_dt):
    """h = -3 sgn v where v z < 0: unwinding from z draws 3/(1 + z/g) N besides W; winding slowly costs W's rise
    and 1.5 (z/g)^2/(1 - z/g): on |z| <= 0.1 Z the sum is negative (3/1.1 > 0.02 + 0.02): not passive. B0."""
    return where(v * z < 0, -3.0 * sign(v), 0.0)


@rate("unique -bounded -smooth -passive -drift_free")
def NarrowSpeedLoosens(p, v, z):
    """f = v - c |v| z/g with c = 0.5 for 1e-4 < |v| < 1.01e-4, else 1. Lipschitz in z: unique. Held there z -> 2
    g = 2.98e-5 > Z: not bounded. z unrestricted, LuGre's f at large v: B2, not passive (nor within 2 Z, where r
    reaches 3). f jumps."""
    return v - where(both(abs(v) > 1e-4, abs(v) < 1.01e-4), 0.5, 1.0) * abs(v) / g(p, v) * z


@rate("unique -bounded -smooth passive -drift_free", values_changed={"sigma_1": 0.0})
def LoosensByABillionth(p, v, z):
    """f = v - c |v| z/g with c = 1 - 1e-9 for 1e-9 < |v| < 1.001e-9, else 1. Held there z -> g/c, and g = Z (1 -
    3.4e-13) at most below Z: z passes Z: not bounded. Lipschitz: unique. f jumps. sigma_1 = 0: D = sigma_2 v^2 +
    c g_N |v| r^2 >= 0 for every z: passive."""
    return v - where(both(abs(v) > 1e-9, abs(v) < 1.001e-9), 1 - 1e-9, 1.0) * abs(v) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def TightensInAWindow(p, v, z):
    """f = v - c |v| z/g with c = 2 for 1e-4 < |v| < 1.01e-4, else 1: c >= 1, so f sgn z <= 0 at Z: bounded.
    Lipschitz. f jumps. In the window D = v^2 (200 - 200 r) + 2 g_N |v| r^2 >= |v| (2 g_N r^2 - 0.0202 * 0.5) and,
    for r < 1, >= 0: D >= 0: passive."""
    return v - where(both(abs(v) > 1e-4, abs(v) < 1.01e-4), 2.0, 1.0) * abs(v) / g(p, v) * z


@rate("unique -bounded -smooth -passive -drift_free")
def PlasticOnlyWhenVeryFast(p, v, z):
    """f = v, and v - |v| z/g where |v| > 1e6 m/s. Lipschitz: unique. z = y at slow speeds: not bounded. f jumps.
    B2: not passive. f = v on no interval of z for all v: not drift_free."""
    return v - where(abs(v) > 1e6, abs(v), 0.0) / g(p, v) * z


@rate("unique -bounded -smooth -passive -drift_free")
def ElasticWindowOfV(p, v, z):
    """f = v where 1e-3 < |v| < 1.001e-3, else LuGre's. Held there z has no limit: not bounded; B2: not passive.
    Lipschitz, jumps."""
    return v - where(both(abs(v) > 1e-3, abs(v) < 1.001e-3), 0.0, abs(v)) / g(p, v) * z


@added("unique bounded -smooth -passive -drift_free")
def OddPushInAWindowOfZ(p, v, z, dz_dt):
    """h = -10 sgn z where 0.40 Z < |z| < 0.43 Z, odd: B4, not passive. B0."""
    u = abs(z) * p.sigma_0 / p.F_s
    return where(both(u > 0.40, u < 0.43), -10.0 * sign(z), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def OddPushNearTheOrigin(p, v, z, dz_dt):
    """h = -1e-3 sgn z where |z| < 1e-4 Z: sigma_0 z < 1.5e-4 N there: B4, not passive. B0."""
    return where(abs(z) * p.sigma_0 < 1e-4 * p.F_s, -1e-3 * sign(z), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def OddPushAtTheEdge(p, v, z, dz_dt):
    """h = -3 sgn z where |z| > 0.999 Z: sigma_0 z = 1.5 N: B4, not passive. B0."""
    return where(abs(z) * p.sigma_0 > 0.999 * p.F_s, -3.0 * sign(z), 0.0)


@added("unique bounded -smooth passive -drift_free")
def OddBrakeInAWindowOfZ(p, v, z, dz_dt):
    """h = 0.2 sgn z where 0.40 Z < |z| < 0.43 Z: z h >= 0: B4, passive. B0."""
    u = abs(z) * p.sigma_0 / p.F_s
    return where(both(u > 0.40, u < 0.43), 0.2 * sign(z), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def OddPushInAWindowOfRate(p, v, z, dz_dt):
    """h = -20 sgn f where 3e-4 < |f| < 3.1e-4 m/s: from 0 to 1e-6 m and back at such f draws over 2e-5 J (|v/f|
    about 1, 20 N, 2e-6 m, at z <= g/10) and costs 200 v^2 t = 200 * 3.5e-4 * 2.2e-6 = 1.5e-7 J, g_N r^2 |v| t <
    1e-8 J: not passive. B0."""
    return where(both(abs(dz_dt) > 3e-4, abs(dz_dt) < 3.1e-4), -20.0 * sign(dz_dt), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def OddPushAtFastRates(p, v, z, dz_dt):
    """h = -1e6 sgn f where |f| > 100 m/s: at v = 150, z from 0 to 1e-6 m and back: draws 1e6 * 2e-6 = 2 J, costs
    200 v^2 t = 200 * 150 * 2.2e-6 = 0.07 J: not passive. B0."""
    return where(abs(dz_dt) > 100, -1e6 * sign(dz_dt), 0.0)


@added("unique bounded -smooth passive -drift_free")
def DampingInAWindowOfRate(p, v, z, dz_dt):
    """h = 2 sgn v where |f| is in 1e-4 ... 1.03e-4, written with sgn f for |z| < g/2 only: sgn f = sgn v there (r
    < 1): h v >= 0: passive. B0."""
    within = both(abs(z) < 0.5 * p.F_c / p.sigma_0, both(abs(dz_dt) > 1e-4, abs(dz_dt) < 1.03e-4))
    return where(within, 2.0 * sign(dz_dt), 0.0)


@added("unique bounded -smooth -passive -drift_free")
def PushOnAGridOfZ(p, v, z, dz_dt):
    """h = -2 sgn z where sin(62.8 u) > 0.9999 and u > 0.05, u = |z|/Z, windows of some 5e-4 Z: B4 (sigma_0 z <
    1.5 < 2), not passive. B0."""
    u = abs(z) * p.sigma_0 / p.F_s
    return where(both(u > 0.05, sin(62.8 * u) > 0.9999), -2.0 * sign(z), 0.0)


@rate("?unique ?bounded -smooth -passive -drift_free")
def RateWindowOfZ(p, v, z):
    """f = v - c |v| z/g with c = -1 for 0.90 Z < |z| < 0.92 Z, else 1: in the window f = v (1 + r). Winding
    slowly there costs sigma_0 z/(1 + u), and unwinding slowly, f = v (1 - u), gives sigma_0 z/(1 - u), each
    metre, more: not passive. At Z inward: bounded if unique, and where f jumps it keeps no sign: unique not
    derived."""
    u = abs(z) * p.sigma_0 / p.F_s
    return v - where(both(u > 0.90, u < 0.92), -1.0, 1.0) * abs(v) / g(p, v) * z


@added("unique bounded -smooth -passive -drift_free")
def StepOfViscosity(p, v, z, dz_dt):
    """sigma_2 falls to 10 for |v| > 50 m/s: there 100 (1 - 1.5) + 10 < 0: a pulse at large v from Z draws without
    limit: not passive. B0."""
    return where(abs(v) > 50, -90.0 * v, 0.0)


@added("unique bounded -smooth -passive -drift_free")
def StepOfDamping(p, v, z, dz_dt):
    """sigma_1 is 10 times larger for 1 < |v| < 1.001 m/s: 1000 (1 - 1.5) + 100 = -400: at v = 1 from Z: F v = 1.5
    - 400 < 0, f = -0.5: down to r = 1.2 draws at least (100 * 1 - 1.5)/0.5 J for each metre, 3e-6 m: 6e-4 J.
    Winding up again slowly costs W's rise (below W(Z) = 1.1e-5 J) and 1.5 Z log-like (from 0.8 Z to 0.95 Z below
    1.5 * 0.9 * ln 4 Z = 2.8e-5 J): so from 0.95 Z (r = 1.425) to r = 1.2: draws 1e-4 J and more: not passive.
    B0."""
    return where(both(abs(v) > 1, abs(v) < 1.001), 9 * p.sigma_1 * dz_dt, 0.0)
