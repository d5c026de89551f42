"""Other states than a deflection, other signs, other ways to lose power, and forms that no law of the others has."""

from stribeck.constants import Constant
from stribeck.expressions.ops import atan, clip, cos, exp, log, pi, sin
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from tests.properties.nasty.base import friction, rate
from tests.properties.nasty.constants import OwnConstants


def plain(p, v, z, dz_dt):
    """LuGre's force."""
    return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v


class _Strange(BristleLaw):
    v_d = None
    friction = staticmethod(plain)

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z


class DieterichRuina(_Strange):
    """Rate and state: z is the age of contacts in s, f = 1 - |v| z/D: at rest z grows for ever: not bounded. Linear in z:
    unique. F = v/(|v| + 1e-6) (1 + 0.1 log(1 + z^2)) + sigma_2 v: F v >= 0: passive. |v|; f = 1 at z = 0."""

    truth = "unique -bounded -smooth passive -drift_free"

    @staticmethod
    def dz_dt(p, v, z):
        return 1 - abs(v) / 1e-5 * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return v / (abs(v) + 1e-6) * (1 + 0.1 * log(1 + z * z)) + p.sigma_2 * v


@friction("unique -bounded -smooth -passive -drift_free", DieterichRuina)
def DieterichRuinaAged(p, v, z, dz_dt):
    """With 1 - 0.1 log(1 + z^2), < 0 for z > 150 s, which a rest of 200 s gives: F < 0 then at v = 1e-9 m/s (share 1e-3,
    sigma_2 v = 1e-7), while z goes from 200 to 150 at most as fast as 1 - 1e-4 * 200 ...: it rises: held at 1e-9, z -> D/v =
    1e4 s and stays there: F v < 0 for ever: not passive."""
    return v / (abs(v) + 1e-6) * (1 - 0.1 * log(1 + z * z)) + p.sigma_2 * v


@rate("unique bounded -smooth passive -drift_free", _Strange)
def SineSaturation(p, v, z):
    """f = v - |v| sin(pi u/2), u = z/Z: f = 0 or inward at |z| = Z, Lipschitz: unique, bounded (from outside Z z may run on,
    but it starts within). f v >= 0: D = 100 f v + 100 v^2 + sigma_0 z |v| sin >= 0 within Z: passive. |v|."""
    return v - abs(v) * sin(pi * z * p.sigma_0 / (2 * p.F_s))


@rate("unique bounded smooth passive -drift_free", _Strange)
def MajorantByCosine(p, v, z):
    """m = e/cos(atan(v/e)), e = 1e-6 m/s, is sqrt(v^2 + e^2): theory.md: smooth, bounded, passive (sigma_1 e <= F_s)."""
    return v - 1e-6 / cos(atan(v / 1e-6)) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free", _Strange)
def ShrinkingElastic(p, v, z):
    """f = v for |z| <= c/(1 + (v/v_s)^2), c = 0.3e-5, then a ramp to LuGre's: at each z > 0 it decays at large v: not
    drift_free. The share is in [0, 1] and 1 at Z: bounded, passive (D is linear in it); Lipschitz for bounded v."""
    c = 0.3e-5 / (1 + (v / p.v_s) ** 2)
    return v - clip((abs(z) - c) / c, 0.0, 1.0) * abs(v) / g(p, v) * z


@friction("unique bounded -smooth -passive -drift_free", _Strange, symmetric=False)
def BumpInBoth(p, v, z, dz_dt):
    """h = -1000 exp(-((v - 1)/0.01)^2 - ((u - 0.5)/0.02)^2), u = z/Z: at v = 1 f >= 0.2 there, and to wind z over the bump
    (2e-7 m) draws over 1e-4 J; slowly back gives or costs less than 1e-5 J: not passive. B0."""
    u = p.sigma_0 * z / p.F_s
    return plain(p, v, z, dz_dt) - 1000.0 * exp(-(((v - 1) / 0.01) ** 2) - ((u - 0.5) / 0.02) ** 2)


class NegativeBound(_Strange):
    """LuGre that says its bound is -1 m: there is nothing within it: bounded and passive are not derived. B0 else."""

    truth = "unique ?bounded -smooth ?passive -drift_free"

    @staticmethod
    def z_bound(p):
        return -1.0 + 0 * p.F_s


class OwnScales(OwnConstants):
    """The same of torsion, with constants of 1e-200 and 1e200."""

    truth = "unique bounded -smooth passive -drift_free"
    k = Constant("N m/rad", "stiffness", above=0, default=1e-200)
    G = Constant("rad", "deflection", above=0, default=1e200)
    c = Constant("N m s/rad", "viscosity", at_least=0, default=0.0)

    @staticmethod
    def stored_energy(p, z):
        return p.k * z**2 / 2
