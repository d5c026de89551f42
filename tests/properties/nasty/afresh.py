"""Laws written without sight of the prover: floors, stiffness that depends on speed, slips of the pen."""

from stribeck.expressions.ops import floor, sign, sin, sqrt, tanh, where
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


@rate("unique bounded -smooth passive -drift_free", WithForce)
def HessSoomBackwards(p, v, z):
    """g = (F_s - (F_s - F_c) v^2/(v^2 + v_s^2))/sigma_0 falls from Z to 1e-5: B0, B1: passive."""
    steady = (p.F_s - (p.F_s - p.F_c) * v**2 / (v**2 + p.v_s**2)) / p.sigma_0
    return v - abs(v) * z / steady


class Makkar(BristleLaw):
    """Makkar et al. 2005, beside LuGre's z, which the force does not use: F = 0.5 (tanh(1000 v) - tanh(100 v)) +
    tanh(1000 v) + 100 v has the sign of v: passive with S = 0. f is LuGre's: B0."""

    truth = "unique bounded -smooth passive -drift_free"
    v_d = None
    dz_dt = staticmethod(WithForce.dz_dt)

    @staticmethod
    def stored_energy(p, z):
        return 0.0 * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return (p.F_s - p.F_c) * (tanh(1000 * v) - tanh(100 * v)) + p.F_c * tanh(1000 * v) + p.sigma_2 * v


@rate("unique bounded -smooth passive -drift_free", Springy)
def BoucWenCubed(p, v, z):
    """Bouc-Wen, n = 3, beta = gamma = 0.5: f/v = 1 - |u|^3 for v z > 0, 1 else. C1 in z, inward or 0 for |u| >= 1:
    unique, bounded. sigma_0 z v - sigma_0 z f = sigma_0 |z v| |u|^3 or 0: passive. df/dv jumps at v = 0."""
    u = deflection(p, z)
    return v - 0.5 * abs(v) * u * abs(u) ** 2 - 0.5 * v * abs(u) ** 3


@rate("unique bounded -smooth passive -drift_free", Springy)
def DahlThreeHalves(p, v, z):
    """Dahl, exponent 3/2: f = v phi, phi = sgn(1 - r)|1 - r|^1.5, r = u sgn v: C1 in z, f falls with z: unique. 0 or
    inward at Z: bounded. phi <= 1 for z v > 0, >= 1 for z v < 0: D >= 0: passive."""
    r = deflection(p, z) * sign(v)
    return v * sign(1 - r) * abs(1 - r) ** 1.5


@rate("unique bounded -smooth passive -drift_free", Springy)
def DahlCubed(p, v, z):
    """Dahl, exponent 3: phi = (1 - r)^3, as DahlThreeHalves."""
    return v * (1 - deflection(p, z) * sign(v)) ** 3


@friction("unique bounded -smooth passive -drift_free", WithForce, values_changed={"sigma_2": 0.0})
def RationalDamping(p, v, z, dz_dt):
    """sigma_1/(1 + (v/v_s)^2), sigma_2 = 0: |v| sigma_1(v) <= 100 * 0.0005 = 0.05 N, so F v - W' f >= |v| (g_N r^2 -
    0.05 (r - 1)) >= 0 for 1 < r <= 1.5 (g_N r^2 > 1), and each term is >= 0 for r <= 1: passive. B0."""
    return p.sigma_0 * z + p.sigma_1 / (1 + (v / p.v_s) ** 2) * dz_dt + p.sigma_2 * v


@rate("unique bounded -smooth passive -drift_free", Springy)
def TanhSaturation(p, v, z):
    """f = v - |v| tanh(u)/tanh(1): Lipschitz in z; 0 or inward at Z; D = 100 v^2 + sigma_0 z |v| tanh(u)/tanh(1):
    passive."""
    return v - abs(v) * tanh(deflection(p, z)) / tanh(1.0)


@rate("unique -bounded smooth passive -drift_free", WithForce)
def RambergOsgood(p, v, z):
    """f = v/(1 + u^4): |f| <= |v| and Lipschitz in z: unique; held, z passes every bound: not bounded. Rational:
    smooth. S' = sigma_0 z (1 + u^4): F v - S' f = sigma_1 f v + sigma_2 v^2 >= 0 for every z: passive."""
    return v / (1 + deflection(p, z) ** 4)


@added("unique bounded -smooth ?passive -drift_free")
def ManyWaves(p, v, z, dz_dt):
    """h = 0.01 N times the sum of sin(k v/v_s), k <= 12: of either sign; whether what it gives outweighs the viscous
    loss is not derived. B0."""
    total = 0.0
    for k in range(1, 13):
        total = total + 0.01 * sin(k * v / p.v_s)
    return total


@added("unique bounded -smooth passive -drift_free", _Majorant, symmetric=False)
def SmoothStepMistyped(p, v, z, dz_dt):
    """3 u^2 - 2.0000001 u^3 meets 1 with a jump of 1e-9 N at u = 1: not smooth. h z >= 0: passive."""
    u = deflection(p, z)
    return 0.01 * where(u < 0, 0.0, where(u < 1, 3 * u**2 - 2.0000001 * u**3, 1.0))
