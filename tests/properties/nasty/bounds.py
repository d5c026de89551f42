"""Bounds other than F_s/sigma_0, none at all though slowly, solutions that are not unique, escapes, and what lies outside Z."""

from stribeck.expressions.ops import clip, exp, log, sqrt, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, WithForce, friction, rate


class TwiceTheBound(BristleLaw):
    """f = v - |v| z/(2 g), z_bound = 2 Z: inward or 0 there: bounded. With r = z sgn v/(2 g) <= 1.5 D = v^2 (200
    - 100 r) + 2 g_N |v| r^2 >= 0: passive. B0 else."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def z_bound(p):
        return 2 * p.F_s / p.sigma_0

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / (2 * g(p, v)) * z


@rate("unique -bounded -smooth ?passive -drift_free")
def HalfTheDecay(p, v, z):
    """TwiceTheBound with the usual Z: z passes it (slowly held, to 2 g = 3e-5): not bounded by Z. Passive within
    2 Z, not for z unrestricted (B2): which is meant where another bound exists is not said. Else B0."""
    return v - abs(v) / (2 * g(p, v)) * z


@rate("unique -bounded -smooth passive -drift_free", values_changed={"sigma_1": 0.0})
def HalfTheDecayUndamped(p, v, z):
    """HalfTheDecay with sigma_1 = 0: D = 100 v^2 + sigma_0 z^2 |v|/(2 g) >= 0 for every z: passive."""
    return v - abs(v) / (2 * g(p, v)) * z


@rate("unique -bounded -smooth -passive -drift_free", values_changed={"sigma_1": 300.0})
def HalfTheDecayOverdamped(p, v, z):
    """HalfTheDecay with sigma_1 = 300: within 2 Z r reaches 1.5: 300 (1 - 1.5) + 100 < 0: a pulse at large v
    draws without limit, with z within 2 Z or unrestricted: not passive."""
    return v - abs(v) / (2 * g(p, v)) * z


class BoundTooLarge(BristleLaw):
    """LuGre with z_bound = 4 Z: invariant too: bounded. z may then start at r = 6: a pulse there draws without
    limit (B2 with r <= 6): not passive within that bound. B0."""

    truth = "unique bounded -smooth -passive -drift_free"

    @staticmethod
    def z_bound(p):
        return 4 * p.F_s / p.sigma_0

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z


class BoundTooSmall(BristleLaw):
    """LuGre with z_bound = F_c/sigma_0: at small v z goes on to g = 1.5e-5: not bounded by it. sigma_1 = 0: D =
    100 v^2 + g_N |v| r^2: passive for every z."""

    truth = "unique -bounded -smooth passive -drift_free"
    values_changed = {"sigma_1": 0.0}

    @staticmethod
    def z_bound(p):
        return p.F_c / p.sigma_0

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z


@rate("unique -bounded -smooth passive -drift_free", values_changed={"sigma_1": 0.0})
def BoundMissedByAHair(p, v, z):
    """f = v - c |v| z/g with c = 1e12/(1e12 + 1) < 1: held slowly z -> g/c > Z by 1e-12 of it: not bounded.
    sigma_1 = 0: passive for every z. A large literal. B0."""
    return v - 1e12 * abs(v) / (1e12 + 1) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def BoundMetByAHair(p, v, z):
    """As BoundMissedByAHair with c = (1e12 + 1)/1e12 > 1: inward at Z: bounded. r <= 1.5 c: D as B1: passive.
    B0."""
    return v - (1e12 + 1) / 1e12 * abs(v) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free", natural=True, values_changed={"F_s": 1.0})
def ConstantDeflection(p, v, z):
    """F_s = F_c: g = Z for every v, f = 0 at Z exactly: bounded. D = v^2 (200 - 100 r) + g_N |v| r^2, r <= 1:
    passive. B0."""
    return v - abs(v) / g(p, v) * z


@rate("unique -bounded smooth passive -drift_free")
def CubeRootGrowth(p, v, z):
    """f = v/(1 + u^2), u = z/Z: u + u^3/3 = y/Z: without limit, slowly: not bounded. |f| <= |v|, analytic:
    unique, smooth. S' = sigma_0 z (1 + u^2): D = 100 v^2/(1 + u^2) + 100 v^2 >= 0 for every z: passive. f != v
    for z != 0."""
    return v / (1 + (z * p.sigma_0 / p.F_s) ** 2)


@rate("unique -bounded -smooth passive -drift_free")
def LogarithmicGrowth(p, v, z):
    """f = v exp(-|u|): sgn(u) (exp|u| - 1) = y/Z: not bounded. S' = sigma_0 z exp|u|: D = 100 v^2 (exp(-|u|) +
    1): passive. Lipschitz, a kink at z = 0 (df/dz = -+v/Z)."""
    return v * exp(-abs(z) * p.sigma_0 / p.F_s)


@rate("unique -bounded -smooth passive -drift_free", values_changed={"sigma_1": 0.0})
def DecayThatSaturates(p, v, z):
    """f = v - |v| u/sqrt(1 + u^2), u = z/Z: |u|/sqrt(1 + u^2) < 1: held v > 0 gives f > 0 for ever, z ~ without
    limit (u^2 ~ y/Z): not bounded. sigma_1 = 0: F v - W' f = 100 v^2 + sigma_0 |v| z u/sqrt(1 + u^2) >= 0:
    passive. Lipschitz. |v|."""
    u = z * p.sigma_0 / p.F_s
    return v - abs(v) * u / sqrt(1 + u**2)


@rate("unique -bounded -smooth passive -drift_free", values_changed={"sigma_1": 0.0})
def LogarithmicDecay(p, v, z):
    """f = v - |v| log(1 + |u|) sgn u: inward only where |u| > e - 1 = 1.72: not bounded by Z, bounded by e - 1 of
    it. sigma_1 = 0: D = 100 v^2 + sigma_0 |v z| log(1 + |u|): passive for every z. log(1 + |u|) sgn u is
    Lipschitz."""
    u = z * p.sigma_0 / p.F_s
    return v - where(u > 0, abs(v) * log(1 + abs(u)), -abs(v) * log(1 + abs(u)))


@rate("-unique -bounded -smooth -passive -drift_free")
def LeavesByChoice(p, v, z):
    """f = v sqrt|1 - |z|/Z|: held v > 0 reaches Z in finite time, where it may stay (f = 0) or go on (f > 0
    beyond): not unique, not bounded. Staying at Z with v < 0 draws 1.5 |v| W for ever: not passive. Singular at
    Z: not smooth."""
    return v * sqrt(abs(1 - abs(z) * p.sigma_0 / p.F_s))


@rate("-unique -bounded -smooth -passive -drift_free")
def LeavesByChoiceFlatter(p, v, z):
    """f = v |1 - |u||^(1/3): as LeavesByChoice."""
    return v * abs(1 - abs(z) * p.sigma_0 / p.F_s) ** (1 / 3)


@rate("-unique -bounded -smooth -passive -drift_free")
def LeavesByChoiceAtRest(p, v, z):
    """f = LuGre's + 1e-6 sgn(u) sqrt|u| at v = 0 too: from z = 0 at rest z = 0 and z = +-(c t)^2 both obey it:
    not unique. At Z, v = 0 f > 0: not bounded. At rest z grows for nothing, without limit: not passive."""
    u = z * p.sigma_0 / p.F_s
    return v - abs(v) / g(p, v) * z + 1e-6 * where(u > 0, sqrt(abs(u)), -sqrt(abs(u)))


@rate("unique bounded -smooth ?passive -drift_free")
def SuddenlyUnique(p, v, z):
    """f = LuGre's - 1e-6 sgn(u) sqrt|u|: falls with z for each v: solutions do not part: unique. Inward at Z:
    bounded. D = D0 + 1e-6 sqrt|u| (1.5 |u| -+ 100 v): 100 |v| 1e-6 sqrt|u| <= 50 v^2 + g_N |v| u^2? at u = 1e-4,
    v = 1e-9: 1e-15 against 5e-17 + 1e-17 + 1e-6 * 1e-2 * 1.5e-4 = 1.5e-12: 2 sqrt(50 * 1.5e-6 |u|^1.5) = 1.7e-2
    |u|^.75 exceeds 1e-4 |u|^.5 for |u| > 1.2e-9, and below it not derived: small z may be wound up at less than
    W's rise."""
    u = z * p.sigma_0 / p.F_s
    return v - abs(v) / g(p, v) * z - 1e-6 * where(u > 0, sqrt(abs(u)), -sqrt(abs(u)))


@rate("-unique -bounded -smooth -passive -drift_free")
def EscapesWhenSliding(p, v, z):
    """f = v + |v| u^3: held v > 0 takes z to infinity in finite time: not unique (no z(t) for all t), not
    bounded. Unwinding from z at v < 0, |v| (u^3 - 1) > 0 for u > 1: z rises, F v < 0 near 1: F = sigma_0 z + 100
    |v| (u^3 - 2) > 0 for u^3 > 2, v < 0: draws without limit: not passive. |v|."""
    return v + abs(v) * (z * p.sigma_0 / p.F_s) ** 3


@rate("-unique -bounded -smooth -passive -drift_free")
def EscapesSlowly(p, v, z):
    """f = v + 1e-3 |v| u log(1 + u^2)^2: du/(u log^2) is integrable: infinity in finite time: not unique, not
    bounded. For v < 0, u large, z rises while F > 0: draws without limit: not passive. |v|."""
    u = z * p.sigma_0 / p.F_s
    return v + 1e-3 * abs(v) * u * log(1 + u**2) ** 2


@rate("unique -bounded -smooth -passive -drift_free")
def NearlyEscapes(p, v, z):
    """f = v + 1e-3 |v| u log(1 + u^2): du/(u log u) is not integrable: exists for all t; locally Lipschitz:
    unique. Not bounded; as EscapesSlowly not passive. |v|."""
    u = z * p.sigma_0 / p.F_s
    return v + 1e-3 * abs(v) * u * log(1 + u**2)


@rate("-unique -bounded -smooth -passive -drift_free")
def EscapesFromVeryFar(p, v, z):
    """f = v + |v| (z/1e20 m)^3: LuGre's without its decay; held v takes z to infinity in finite time, after 1e20
    m: not unique. Not bounded. For v < 0, z > 1e20 z rises and F > 0: draws: not passive. |v|."""
    return v + abs(v) * (z * 1e-20) ** 3


@rate("unique bounded -smooth passive -drift_free")
def FriendlyFarOut(p, v, z):
    """LuGre's decay times clip(3 - |u|, -1, 1): LuGre for |u| <= 2, growing for |u| > 3: Lipschitz in z on
    bounded sets, linear growth: unique. Within Z it is LuGre: bounded, passive. |v|."""
    return v - abs(v) / g(p, v) * z * clip(3 - abs(z) * p.sigma_0 / p.F_s, -1.0, 1.0)


@rate("unique -bounded -smooth -passive -drift_free", symmetric=False)
def DriftsSideways(p, v, z):
    """f = v - |v| (z - Z/10)/g: held v < 0 takes z to Z/10 - g >= -Z, held v > 0 to g + Z/10 > Z (slowly): not
    bounded. z unrestricted: B2 (r from the middle): not passive. Lipschitz, |v|, f(z = 0) = v + 0.1 |v| Z/g."""
    return v - abs(v) / g(p, v) * (z - 0.1 * p.F_s / p.sigma_0)


@friction("unique bounded -smooth -passive -drift_free", WithForce)
def WrongSpring(p, v, z, dz_dt):
    """F = -sigma_0 z + ...: held slowly F v = -g_N |v| + ... < 0: B3: not passive. B0."""
    return -p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v


@friction("unique bounded -smooth -passive -drift_free", Lopsided)
def SpringWithARest(p, v, z, dz_dt):
    """F = sigma_0 (z - Z/10) + ...: h = -0.15 N: sigma_0 z + h < 0 for 0 < z < Z/10: B4, not passive. B0."""
    return p.sigma_0 * (z - 0.1 * p.F_s / p.sigma_0) + p.sigma_1 * dz_dt + p.sigma_2 * v
