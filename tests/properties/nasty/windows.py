"""Forces and rates that are piecewise constant in z, dz/dt or v: windows some percent, some ppm wide, far out, far in."""

from stribeck.expressions.ops import both, sign, sqrt, where
from stribeck.laws import Claims
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, added, rate


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
def WeakPushInAWindowOfZ(p, v, z, dz_dt):
    """h = -0.4 N where |z/Z - 0.3| < 0.01: sigma_0 z >= 0.43 N there, so sigma_0 z + h > 0 and B4 says passive.
    B0."""
    return where(abs(z * p.sigma_0 / p.F_s - 0.3) < 0.01, -0.4, 0.0)


@rate("unique -bounded -smooth -passive -drift_free")
def PlasticOnlyWhenVeryFast(p, v, z):
    """f = v, and v - |v| z/g where |v| > 1e6 m/s. Lipschitz: unique. z = y at slow speeds: not bounded. f jumps.
    B2: not passive. f = v on no interval of z for all v: not drift_free."""
    return v - where(abs(v) > 1e6, abs(v), 0.0) / g(p, v) * z


@added("unique bounded -smooth passive -drift_free")
def DampingInAWindowOfRate(p, v, z, dz_dt):
    """h = 2 sgn v where |f| is in 1e-4 ... 1.03e-4, written with sgn f for |z| < g/2 only: sgn f = sgn v there (r
    < 1): h v >= 0: passive. B0."""
    within = both(abs(z) < 0.5 * p.F_c / p.sigma_0, both(abs(dz_dt) > 1e-4, abs(dz_dt) < 1.03e-4))
    return where(within, 2.0 * sign(dz_dt), 0.0)


@rate("?unique ?bounded -smooth -passive -drift_free")
def RateWindowOfZ(p, v, z):
    """f = v - c |v| z/g with c = -1 for 0.90 Z < |z| < 0.92 Z, else 1: in the window f = v (1 + r). Winding
    slowly there costs sigma_0 z/(1 + u), and unwinding slowly, f = v (1 - u), gives sigma_0 z/(1 - u), each
    meter, more: not passive. At Z inward: bounded if unique, and where f jumps it keeps no sign: unique not
    derived."""
    u = abs(z) * p.sigma_0 / p.F_s
    return v - where(both(u > 0.90, u < 0.92), -1.0, 1.0) * abs(v) / g(p, v) * z


class SlopesWherePushedBack(Lopsided):
    """The sqrt majorant with h = 0.1 sgn(v) (2 u + 1)^2 for u = z/Z < -1/2: it jumps at v = 0, where its slopes by z differ
    for such z only: not smooth. h v >= 0: passive as the majorant is (sigma_1 m(0) = 1e-4 <= F_s)."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-12) / g(p, v) * z

    @staticmethod
    def h(p, v, z, dz_dt):
        u = z * p.sigma_0 / p.F_s
        return where(u < -0.5, 0.1 * sign(v) * (2 * u + 1) ** 2, 0.0)
