"""What happens at v = 0 exactly, at the origin only, and within 1e-200 of them."""

from stribeck.expressions.ops import exp, log, sqrt, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from tests.properties.nasty.base import rate


def lugre(p, v, z):
    return v - abs(v) / g(p, v) * z


@rate("unique -bounded -smooth passive -drift_free")
def ElasticButCreepsAtRestOnly(p, v, z):
    """f = v, but -z where v = 0. z = y while it moves: not bounded. S = W: D = 200 v^2 or W' z >= 0: passive. f
    jumps at v = 0 (z != 0). At v = 0 f = -z is not v: not drift_free."""
    return where(abs(v) <= 0, -z, v)


def root(p, v, z):
    """A smooth law, passive with MILD: m = sqrt(v^2 + 1e-12) >= |v|, sigma_1 m(0) = 1e-4 <= F_s."""
    return v - sqrt(v**2 + 1e-12) / g(p, v) * z


class ConeAtTheOrigin(BristleLaw):
    """root with h = 0.1 v z^2/(z^2 + 1e-4 v^2) (0 at the origin), homogeneous of degree 1 and not linear: no
    derivative at the origin, C1 elsewhere: not smooth. |h| <= 0.1 |v|, h v >= 0; root is passive (theory.md, sqrt
    majorant), bounded, leaks."""

    truth = "unique bounded -smooth passive -drift_free"
    v_d = None
    dz_dt = staticmethod(root)

    @staticmethod
    def friction(p, v, z, dz_dt):
        h = where(z**2 + v**2 > 0, 0.1 * v * z**2 / (z**2 + 1e-4 * v**2), 0.0)
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + h


class LogarithmicViscosity(BristleLaw):
    """h = 1e-3 v log |v| (0 at v = 0). B0. To and fro about z = 0 on |z| <= a at |v| = exp(-3e5): h v = -300 v^2,
    D0 = 200 v^2 + O(a v^2) + O(a^2 |v|): with a^2 << |v| energy is drawn each time: not passive (at speeds that
    no float holds)."""

    truth = "unique bounded -smooth -passive -drift_free"
    v_d = None
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + where(abs(v) > 0, 1e-3 * v * log(abs(v)), 0.0)


@rate("unique -bounded -smooth -passive -drift_free")
def GrowsBelow1eMinus200(p, v, z):
    """f = z where |v| < 1e-200, LuGre's else: z grows for nothing there. Lipschitz in z: unique."""
    return where(abs(v) < 1e-200, z, lugre(p, v, z))


@rate("unique -bounded -smooth -passive -drift_free", symmetric=False)
def SignFrom1eMinus200(p, v, z):
    """|v| written v where v > 1e-200, else -v. At v = 1e-200 f = v (1 + z/g): z grows for ever: not bounded. f
    jumps (z != 0). Lipschitz. z unrestricted: B2, not passive."""
    return v - where(v > 1e-200, v, -v) / g(p, v) * z


@rate("unique -bounded -smooth passive -drift_free", values_changed={"sigma_1": 0.0})
def FlatAtZero(p, v, z):
    """f = v - e(z) |v| z/g with e = exp(-(0.1 Z/z)^2) for z != 0, 0 at z = 0: below |v| everywhere, so held
    speeds take z to where e z = g > Z: not bounded (sigma_1 = 0: D = 100 v^2 + e g_N |v| r^2 >= 0: passive). e is
    C-infinity: f is Lipschitz in z. e > 0 for z != 0: not drift_free, though e < 1e-43 for |z| < 0.01 Z. |v|: not
    smooth."""
    u = z * p.sigma_0 / p.F_s
    return v - where(abs(u) > 0, exp(-0.01 / u**2), 0.0) * abs(v) / g(p, v) * z
