"""What a law says of itself may be wrong: its symmetry, its scales, its stored energy, its claims, its bound."""

from stribeck.constants import Constant
from stribeck.expressions.ops import both, exp, log, pi, sqrt, tanh, where
from stribeck.laws import BristleLaw, Claims, Scales
from stribeck.laws.terms import g, term
from tests.properties.nasty.base import rate


def lugre(p, v, z):
    return v - abs(v) / g(p, v) * z


class PushesBackwardsOnly(BristleLaw):
    """h = 10 N where v < -1e-4, and it does not say that it is not symmetric: held at v = -1e-3, F v = (-1.2 -
    0.1 + 10) v < 0: B3, not passive. B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    v_d = None
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + where(v < -1e-4, 10.0, 0.0)


@rate("unique -bounded -smooth passive -drift_free", values_changed={"sigma_1": 0.0})
def LooseBackwardsOnly(p, v, z):
    """|v|/g for v > 0, |v|/(2 g) for v < 0, said to be symmetric: held slowly backwards z -> -2 g < -Z: not
    bounded. sigma_1 = 0: D = 100 v^2 + sigma_0 z^2 (|v|/g or half of it) >= 0 for every z: passive. B0 else."""
    return v - where(v > 0, 1.0, 0.5) * abs(v) / g(p, v) * z


class ElasticForwardsOnly(BristleLaw):
    """The ramp of elasto-plastic laws for z > 0 only, said to be symmetric: f != v for -z_0 <= z < 0: not
    drift_free. Lipschitz; decays fully at |z| >= 1e-5: bounded; D is linear in the share: passive. |v|."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def z_elastic(p):
        return 0.5e-5

    @staticmethod
    def dz_dt(p, v, z):
        ramp = where(z < 0.5e-5, 0.0, where(z < 1e-5, (z - 0.5e-5) / 0.5e-5, 1.0))
        return v - where(z > 0, ramp, 1.0) * abs(v) / g(p, v) * z


class KinkForNegativeZOnly(BristleLaw):
    """sqrt majorant with h = 0 for z > -Z/2 and 0.1 (z + Z/2) 1e5 below: a kink at z = -Z/2, said to be
    symmetric: not smooth. h z >= 0 and S' = sigma_0 z + h: D as the majorant's, plus h z m/g >= 0: passive. Else
    as RootMajorant."""

    truth = "unique bounded -smooth passive -drift_free"
    v_d = None

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-12) / g(p, v) * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        half = -0.5 * p.F_s / p.sigma_0
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + where(z > half, 0.0, 1e4 * (z - half))


class ScalesTooLarge(BristleLaw):
    """LuGre that says its length is 1e5 m, its speed 1e9 m/s: B0, B1."""

    truth = "unique bounded -smooth passive -drift_free"
    dz_dt = staticmethod(lugre)

    @staticmethod
    def scales(p):
        return Scales(1e5, 1e9, 1e12)


class ScalesTooSmall(BristleLaw):
    """LuGre with sigma_2 = 0 that says its length is 1e-20 m, its speed 1e-25 m/s: LuGre's condition fails: not
    passive. B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    values_changed = {"sigma_2": 0.0}
    dz_dt = staticmethod(lugre)

    @staticmethod
    def scales(p):
        return Scales(1e-20, 1e-25, 1e-20)


class ScalesThatHideAWindow(BristleLaw):
    """No decay for 1 < v < 1.0001 m/s, scales of 1e-9: held there z has no limit: not bounded; B2: not passive.
    Jumps. Lipschitz."""

    truth = "unique -bounded -smooth -passive -drift_free"

    @staticmethod
    def scales(p):
        return Scales(1e-9, 1e-9, 1.0)

    @staticmethod
    def dz_dt(p, v, z):
        return v - where(both(v > 1, v < 1.0001), 0.0, abs(v)) / g(p, v) * z


class NegativeStoredEnergy(BristleLaw):
    """LuGre that says it stores -W: B0, B1: passive all the same (some S >= 0 exists)."""

    truth = "unique bounded -smooth passive -drift_free"
    dz_dt = staticmethod(lugre)

    @staticmethod
    def stored_energy(p, z):
        return -p.sigma_0 * z**2 / 2


class GenerousStoredEnergy(BristleLaw):
    """LuGre with sigma_2 = 0 that says it stores 1e6 W and claims everything: LuGre's condition fails: not
    passive. B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    values_changed = {"sigma_2": 0.0}
    claims = Claims(unique=True, bounded=True, smooth=True, passive=True, drift_free=True)
    dz_dt = staticmethod(lugre)

    @staticmethod
    def z_elastic(p):
        return 1.0

    @staticmethod
    def stored_energy(p, z):
        return 1e6 * p.sigma_0 * z**2


class IrrationalBound(BristleLaw):
    """LuGre with z_bound = Z (pi/3)^(1/2) > Z: inward there: bounded. r <= 1.54: 100 (1 - 1.54) + 100 > 0:
    passive. B0."""

    truth = "unique bounded -smooth passive -drift_free"
    dz_dt = staticmethod(lugre)

    @staticmethod
    def z_bound(p):
        return p.F_s / p.sigma_0 * (pi / 3) ** 0.5


class OptionalTerm(BristleLaw):
    """A constant that is off: h = -k v^3 only with k: LuGre: B0, B1."""

    truth = "unique bounded -smooth passive -drift_free"
    natural = True
    v_d = None
    k = Constant("N s^3/m^3", "a term that is off", above=0, optional=True)
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        force = p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v
        return force if p.k is None else force - p.k * v**3


class ChosenTerm(BristleLaw):
    """A choice, set to its first word: m = sqrt(v^2 + 1e-12), theory.md's majorant: smooth, bounded, passive;
    leaks."""

    truth = "unique bounded smooth passive -drift_free"
    natural = True
    kind = Constant("", "which |v|", choices=("smooth", "exact"))

    @staticmethod
    def dz_dt(p, v, z):
        m = sqrt(v**2 + 1e-12) if p.kind == "smooth" else abs(v)
        return v - m / g(p, v) * z


@term("q")
def q(p, v):
    """A term with a name."""
    return where(abs(v) < 2e-9, -10.0, 0.0)


class NamedTerm(BristleLaw):
    """h = q(v) tanh(1e12 v) with q = -10 N for |v| < 2e-9, 0 else: held at 1e-9, F = 1.5 - 10 < 0: B3, not
    passive. B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    v_d = None
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + q(p, v) * tanh(1e12 * v)


class SoftSign(BristleLaw):
    """sqrt majorant with h = v/(|v| + 1e-6): its derivative 1e-6/(|v| + 1e-6)^2 is continuous: smooth. h v >= 0:
    passive."""

    truth = "unique bounded smooth passive -drift_free"
    natural = True
    v_d = None

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-12) / g(p, v) * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + v / (abs(v) + 1e-6)


class WallAtTheBound(BristleLaw):
    """F = sigma_0 z/(1 - u^2) + ...: no value at |z| = Z, where z may start: not smooth; passive not derived
    there. B0."""

    truth = "unique bounded -smooth ?passive -drift_free"
    v_d = None
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        u = z * p.sigma_0 / p.F_s
        return p.sigma_0 * z / (1 - u**2) + p.sigma_1 * dz_dt + p.sigma_2 * v


class WallOutside(BristleLaw):
    """F = sigma_0 z/(1 - u^2/1.21) + ...: h = sigma_0 z (1/(1 - u^2/1.21) - 1), z h >= 0 within Z: B4, passive.
    Singular at 1.1 Z; |v|. B0."""

    truth = "unique bounded -smooth passive -drift_free"
    natural = True
    v_d = None
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        u = z * p.sigma_0 / p.F_s
        return p.sigma_0 * z / (1 - u**2 / 1.21) + p.sigma_1 * dz_dt + p.sigma_2 * v


class OneOverV(BristleLaw):
    """h = 1e-9/v: no value at v = 0, singular: not smooth; F has no value at rest: passive not derived. B0."""

    truth = "unique bounded -smooth ?passive -drift_free"
    v_d = None
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + 1e-9 / v


class ExpOfMinusOneOverV(BristleLaw):
    """h = -1e3 v exp(-1e3/|v|) (0 at v = 0): all its derivatives at 0 are 0, f is the sqrt majorant's: smooth
    (written with a case). Held at v = 1e4, F = 1 + 1e6 - 1e7 exp(-0.1) < 0: B3, not passive."""

    truth = "unique bounded smooth -passive -drift_free"
    v_d = None

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-12) / g(p, v) * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        h = where(abs(v) > 0, -1e3 * v * exp(-1e3 / abs(v)), 0.0)
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + h


class LogOfZ(BristleLaw):
    """h = 1e-3 z log(z^2) (0 at z = 0) in SI numbers: sigma_0 z + h = z (1e5 + 2e-3 log|z|) is of the other sign
    than z for 0 < |z| < exp(-5e7): B4, not passive, in a range that no float holds. B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    v_d = None
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        h = where(abs(z) > 0, 1e-3 * z * log(z**2), 0.0)
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + h
