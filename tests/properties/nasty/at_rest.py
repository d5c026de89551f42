"""What happens at v = 0 exactly, at the origin only, and within 1e-200 of them."""

from stribeck.expressions.ops import clip, exp, log, sign, sqrt, where
from stribeck.laws import BristleLaw, Claims
from stribeck.laws.terms import g
from tests.properties.nasty.base import rate


def lugre(p, v, z):
    return v - abs(v) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def DecaysAtRest(p, v, z):
    """f = LuGre's - z/1000 s. Lipschitz; inward at Z; |v|; decays. D = D0 + 100 z^2 - 0.1 z v >= 50 v^2 + 100 z^2
    - 0.1 |z v| >= 0."""
    return lugre(p, v, z) - 1e-3 * z


@rate("unique -bounded -smooth -passive -drift_free")
def GrowsAtRest(p, v, z):
    """f = LuGre's + z/1000 s. At v = 0 z grows without limit, for nothing (F v = 0), and winding it back at a
    slow v < 0 gives sigma_0 z/(1 + z/g) -> g_N for each metre: without limit: neither bounded nor passive.
    Lipschitz, |v|."""
    return lugre(p, v, z) + 1e-3 * z


class GrowsAtRestOnly(BristleLaw):
    """f = z/1000 s where v = 0, LuGre's else. As GrowsAtRest: z grows for nothing while v = 0. Lipschitz in z:
    unique."""

    truth = "unique -bounded -smooth -passive -drift_free"
    claims = Claims(unique=True, bounded=True, smooth=False, passive=True, drift_free=False)  # a lie

    @staticmethod
    def dz_dt(p, v, z):
        return where(abs(v) <= 0, 1e-3 * z, lugre(p, v, z))


@rate("unique bounded -smooth passive -drift_free")
def DecaysAtRestOnly(p, v, z):
    """f = -z where v = 0, LuGre's else: inward at Z: bounded. At v = 0, F v = 0 and W' f <= 0; else B1: passive.
    f jumps. B0."""
    return where(abs(v) <= 0, -z, lugre(p, v, z))


@rate("unique -bounded -smooth -passive -drift_free", symmetric=False)
def ClimbsAtRestOnly(p, v, z):
    """f = 1e-6 m/s where v = 0, LuGre's else: z passes Z at rest, for nothing, and unwinding draws: neither
    bounded nor passive."""
    return where(abs(v) <= 0, 1e-6, lugre(p, v, z))


@rate("unique -bounded -smooth passive -drift_free")
def ElasticButCreepsAtRestOnly(p, v, z):
    """f = v, but -z where v = 0. z = y while it moves: not bounded. S = W: D = 200 v^2 or W' z >= 0: passive. f
    jumps at v = 0 (z != 0). At v = 0 f = -z is not v: not drift_free."""
    return where(abs(v) <= 0, -z, v)


@rate("unique bounded -smooth -passive -drift_free", symmetric=False)
def WindsUpAtRest(p, v, z):
    """f = LuGre's + 1e-6 clip(1 - (z/Z)^2, -1, 1). Lipschitz, bounded growth: unique. At z = Z f <= 0, at -Z f >=
    0: bounded. At v = 0 z tends to Z for nothing; unwinding it at v = -1e-4 m/s draws the integral of (1.5 u -
    0.03)/(1 + u) Z du > 0, again and again: not passive. |v|: not smooth."""
    return lugre(p, v, z) + 1e-6 * clip(1 - (z * p.sigma_0 / p.F_s) ** 2, -1.0, 1.0)


@rate("unique bounded -smooth passive -drift_free")
def CreepsToTheMiddle(p, v, z):
    """f = LuGre's - 1e-6 clip(z/Z, -1, 1): inward at Z. Lipschitz. D = D0 + 1e-6 u (sigma_0 z - 100 v) with u =
    z/Z: >= 50 v^2 + 1.5e-6 u^2 - 1e-4 |u v| , 4 * 50 * 1.5e-6 = 3e-4 > 1e-8: passive."""
    return lugre(p, v, z) - 1e-6 * clip(z * p.sigma_0 / p.F_s, -1.0, 1.0)


@rate("-unique ?bounded -smooth ?passive -drift_free")
def UndefinedAtRest(p, v, z):
    """|v| written v^2/|v|: at v = 0 f is 0/0, no number, so that no solution exists for v = 0: not unique, not
    smooth. Else LuGre."""
    return v - v**2 / abs(v) / g(p, v) * z


class UndefinedAtTheOrigin(BristleLaw):
    """h = 10 v z^2/(z^2 + 1e-4 v^2), 0/0 at the origin only: F is not smooth. f is LuGre's: B0. F has no value at
    rest at z = 0."""

    truth = "unique bounded -smooth ?passive -drift_free"
    v_d = None
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + 10 * v * z**2 / (z**2 + 1e-4 * v**2)


class FilledAtTheOrigin(BristleLaw):
    """As UndefinedAtTheOrigin, with h = 0 there: |h| <= 10 |v|, h v >= 0, B1: passive. B0."""

    truth = "unique bounded -smooth passive -drift_free"
    v_d = None
    dz_dt = staticmethod(lugre)

    @staticmethod
    def friction(p, v, z, dz_dt):
        h = where(z**2 + v**2 > 0, 10 * v * z**2 / (z**2 + 1e-4 * v**2), 0.0)
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + h


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


class SaddleAtTheOrigin(BristleLaw):
    """root with h = 0.1 v^3 x^2/(v^2 + x^2), x = 100 z/s (0 at the origin), of degree 3: C1 with both derivatives
    0 at the origin: smooth. h v >= 0: passive. unique, bounded, leaks as root."""

    truth = "unique bounded smooth passive -drift_free"
    v_d = None
    dz_dt = staticmethod(root)

    @staticmethod
    def friction(p, v, z, dz_dt):
        x = 100 * z
        h = where(x**2 + v**2 > 0, 0.1 * v**3 * x**2 / (v**2 + x**2), 0.0)
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + h


class WildAtRest(BristleLaw):
    """root with h = 1e-3 v^3/(v^2 + 1e-300): for real numbers C1 (the denominator is > 0), within 1e-150 of 1e-3
    v but near 0. h v >= 0: passive. As root else."""

    truth = "unique bounded smooth passive -drift_free"
    v_d = None
    dz_dt = staticmethod(root)

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + 1e-3 * v**3 / (v**2 + 1e-300)


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
    """f = z where |v| < 1e-200, LuGre's else: as GrowsAtRestOnly."""
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


@rate("?unique bounded -smooth passive -drift_free")
def HalvedAtZeroOnly(p, v, z):
    """f = LuGre's, but v/2 where z = 0, v: f != v at z = 0: not drift_free. Inward at Z: bounded, as the
    solutions of LuGre but for a set of times of measure 0 (z = 0 with f != 0 is left at once): unique, passive
    (B1)."""
    return where(abs(z) <= 0, 0.5 * v, lugre(p, v, z))


@rate("-unique bounded -smooth ?passive -drift_free")
def SignOfZInTheRate(p, v, z):
    """f = v - |v| sgn z: for v > 0 it is 2 v at z < 0, v at 0, 0 above. From z = 0 no z(t) obeys it (it cannot
    stay, f = v, nor rise, f = 0): not unique. At Z f <= 0: it never moves outwards: bounded within any level. f
    jumps."""
    return v - abs(v) * sign(z)


@rate("unique bounded -smooth -passive -drift_free")
def HoldsAtRestByAThreshold(p, v, z):
    """f = LuGre's where |v| > 1e-12, else 0: below it nothing moves. Lipschitz in z; bounded; jumps (z != 0 or v
    != 0). At |v| <= 1e-12 and z of the other sign than v, f = 0 and F v = sigma_0 z v + 100 v^2 < 0 for ever: not
    passive."""
    return where(abs(v) > 1e-12, lugre(p, v, z), 0.0)
