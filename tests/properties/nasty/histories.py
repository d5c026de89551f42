"""Laws that fail for some histories only, one-sided slopes, singular or removable points, and rates inside the force."""

from stribeck.expressions.ops import both, sign, sqrt, tanh, where
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lopsided, Springy, added, deflection, rate


@rate("-unique -bounded -smooth -passive -drift_free", Lopsided)
def OutwardOnlyAfterAChange(p, v, z):
    """LuGre, but for 1 < v < 1.001 m/s the decay is v (2 - 1.2 u)/... : f = v (1 - u (u - 0.5)/... is outward at z = Z and
    takes z to 0.3 Z from below: f = v (u - 0.3)(u - 0.9). No held speed takes z from 0 past Z; slowly to 0.999 Z, then at
    1.0005 m/s, does: not bounded. f is C1 in z: f -> infinity like u^2 there: z escapes: not unique. z is not
    restricted, LuGre at larger v: B2, not passive."""
    u = deflection(p, z)
    usual = v - abs(v) / g(p, v) * z
    return where(both(v > 1, v < 1.001), v * (u - 0.3) * (u - 0.9), usual)


@rate("unique -bounded -smooth -passive -drift_free", Lopsided)
def LeavesWhenJerked(p, v, z):
    """As LuGre, but for 1 < v < 1.001 m/s f = v clip(20 (u - 0.95), -1, 1) + 0: inward below 0.95 Z (to where? u = 0.95
    repels), outward at Z. From 0 held there z falls; slowly to 0.99 Z and then there z leaves: not bounded. Lipschitz in z:
    unique. B2 at larger v: not passive. f is not v at those speeds, nor at others: not drift_free."""
    s = 20 * (deflection(p, z) - 0.95)
    ramp = where(s < -1, -1.0, where(s > 1, 1.0, s))
    return where(both(v > 1, v < 1.001), v * ramp, v - abs(v) / g(p, v) * z)


@rate("-unique ?bounded -smooth ?passive -drift_free", Springy, symmetric=False)
def StiffAsItStarts(p, v, z):
    """f = v - |v| z/g - 1e-3 z/v for v > 0. With v(t) = 1e-3 t from z(0) = z_0 != 0: |z| <= C t^(-1) near 0 only where C =
    0: no solution starts at z_0, so not unique in the sense of check.md (none exists). f is not v. Bounded and passive
    are said of solutions: not derived."""
    return v - abs(v) / g(p, v) * z - where(v > 0, 1e-3 / where(v > 0, v, 1.0), 0.0) * z


@rate("-unique -bounded -smooth -passive -drift_free", Lopsided)
def ClimbsAtRestByARoot(p, v, z):
    """f = 1e-3 sqrt|z| more where v <= 0. At rest from z = 0: z = 0 stays, z = (0.5e-3 t)^2 leaves: not unique. z grows at
    rest without end: not bounded, and for free; unwound at v = 1 m/s it gives back sigma_0 z^2/2 and more than the way
    costs: from z = 1 m, r > 2: B2, not passive."""
    return v - abs(v) / g(p, v) * z + where(v <= 0, 1e-3 * sqrt(abs(z)), 0.0)


@rate("unique bounded -smooth -passive -drift_free", Springy, symmetric=False)
def RootFallsAtOneDeflection(p, v, z):
    """f = v - |v| (u + sgn(u - 1/2) |u - 1/2|^(1/2)) with u = z/Z: f falls with z: solutions do not part; continuous in z:
    unique. At u = 1: v - |v| 1.7, at u = -1: v + |v| (1 + 1.22) : inward: bounded. At v -> 0+ from u = 0: f/v = 1 + 0.7.
    Passive? F v - S' f with S' = sigma_0 z: z |v| (u + root): at 0 < u < 1/2 u + root < 0 near 0: S' must exceed F v/f on
    unwinding: f = v (1 + ...) both ways: L = F/(1 + u + root), U = F/(1 - u - root) with root < 0: L > U at u = 0.1
    (1/(0.47) > 1/1.53): not passive. Not drift_free."""
    u = deflection(p, z)
    return v - abs(v) * (u + sign(u - 0.5) * abs(u - 0.5) ** 0.5)


@rate("-unique bounded -smooth ?passive -drift_free", Springy, symmetric=False)
def RootRisesAtOneDeflection(p, v, z):
    """f = v - |v| (2 u - sgn(u - 1/2) |u - 1/2|^(1/2)/2): f rises at u = 1/2 like a root of the distance, f there is v -
    |v| = 0 for v > 0: held, z = Z/2 stays or leaves (dw/dt = +w^(1/2) v/(2 Z)): not unique. At u = 1: 1 - 2 + 0.354 < 0,
    for v < 0 v (1 + 1.65): inward, at u = -1: v > 0: 1 + 2 - 0.61 > 0 outward? -sgn(z) f = f there > 0, that is towards
    0: inward; v < 0: v (1 - 2 + 0.61) > 0: inward: outside Z likewise: bounded. Passive is not derived."""
    u = deflection(p, z)
    return v - abs(v) * (2 * u - 0.5 * sign(u - 0.5) * abs(u - 0.5) ** 0.5)


@rate("-unique -bounded -smooth passive -drift_free", Springy, symmetric=False)
def DahlHalfMistyped(p, v, z):
    """f = v |1 - r|^(1/2), without the sign: at r = 1 z stays or goes on past Z (dw/dt = v (w/Z)^(1/2)): not unique, and
    not bounded. z = r Z without limit, F v = sigma_0 z v; for r > 1 winding costs F/(r - 1)^(1/2), unwinding (v
    reversed) gives F/(1 + r)^(1/2) a metre, less: L = F/(1 + r)^(1/2) <= U = F/|1 - r|^(1/2) for all r > 0: S' = F/(1 +
    r)^(1/2) serves, sigma_2 adds: passive. |v|."""
    return v * abs(1 - deflection(p, z) * sign(v)) ** 0.5


@rate("unique bounded -smooth passive -drift_free", Springy, symmetric=False)
def JumpsDownwards(p, v, z):
    """f = v - |v| z/g, less |v|/5 where z > Z/2: jumps down by |v|/5 as z rises. For slow v > 0: f = 1/2 v before, 0.3 v
    behind: z passes. At v_1 with g = 0.55 Z ... g >= 0.67 Z, so 1 - 0.5/0.67 = 0.25 before, 0.05 behind: z always passes;
    v < 0 passes too: f never vanishes at the jump: solutions exist and, as f + ... falls, do not part: unique. Inward at
    Z: bounded. W: D = |v| z (z/g + 1/5 [z > Z/2]) sigma_0 + sigma_2 v^2 >= 0: passive."""
    return v - abs(v) / g(p, v) * z - where(deflection(p, z) > 0.5, 0.2, 0.0) * abs(v)


@rate("-unique ?bounded -smooth ?passive -drift_free", Springy, symmetric=False)
def JumpsToTheOtherSide(p, v, z):
    """f = v - |v| z/g, less |v| where z > Z/2: v > 0 at z = Z/2: before f = v/4 or more, behind f < 0, at Z/2 itself f =
    v (1 - Z/(2 g)) > 0: z can neither stay nor go: no solution: not unique. Inward at Z: bounded is vacuous there, not
    derived; passive likewise."""
    return v - abs(v) / g(p, v) * z - where(deflection(p, z) > 0.5, 1.0, 0.0) * abs(v)


class UndefinedAtOneDeflectionAtRest(Lopsided):
    """F is multiplied by (z - c)/(z - c), c = Z/2, at v = 0 exactly: it has no value at (0, c), and is LuGre's else: F is
    not differentiable where it has none. f is LuGre's: B0. Passive: F v at rest is 0 or nothing: not derived."""

    truth = "unique bounded -smooth ?passive -drift_free"

    @classmethod
    def friction(cls, p, v, z, dz_dt):
        c = 0.5 * p.F_s / p.sigma_0
        usual = p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v
        return usual * where(both(v <= 0, v >= 0), (z - c) / (z - c), 1.0)


class _Smooth(Lopsided):
    """The sqrt majorant with k_v = 1e6."""

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-12) / g(p, v) * z


class SmoothButUndefinedAtOneDeflectionAtRest(_Smooth):
    """UndefinedAtOneDeflectionAtRest with a smooth dz/dt: F has no value at (0, c): not smooth. dz/dt: unique, bounded (a
    majorant), leaks."""

    truth = "unique bounded -smooth ?passive -drift_free"

    @classmethod
    def friction(cls, p, v, z, dz_dt):
        c = 0.5 * p.F_s / p.sigma_0
        usual = p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v
        return usual * where(both(v <= 0, v >= 0), (z - c) / (z - c), 1.0)


@added("unique bounded -smooth ?passive -drift_free", _Smooth)
def SmoothButForARemovableLine(p, v, z, dz_dt):
    """h = (z^2 - c^2)/(z - c) - (z + c), 0 but for z = c = Z/2, where it has no value: not smooth. f is a majorant's:
    unique, bounded, not elastic. Passive: z = c at steady sliding has no F: not derived."""
    c = 0.5 * p.F_s / p.sigma_0
    return (z**2 - c**2) / (z - c) - (z + c)


@added("unique bounded -smooth ?passive -drift_free", _Smooth)
def NothingTimesAPole(p, v, z, dz_dt):
    """h = 0 * (1/(z - c)), c = Z/2: has no value at z = c, 0 else: not smooth; passive not derived."""
    return (z - z) * (1 / (z - 0.5 * p.F_s / p.sigma_0))


@added("unique bounded -smooth passive -drift_free", _Smooth)
def KinkBelowTheUlp(p, v, z, dz_dt):
    """h = 1e-17 |v|: a kink at v = 0: not smooth. At u -> 0+, v < 0 it draws 1e-17 |v|; the majorant leaks m(0) = 1e-6:
    D = v^2 (sigma_1 (1 - z m/(v g)) + sigma_2) + g_N m r^2 ... + h v, at z -> 0 200 v^2 - 1e-17 v^2 > 0: D >= (100 + 50
    - 1e-17) v^2 + ... as |h v| = 1e-17 v^2: passive as the majorant is (sigma_1 m(0) = 1e-4 <= F_s)."""
    return 1e-17 * abs(v)


@added("unique bounded smooth passive -drift_free", _Smooth)
def PowersOfOddSizes(p, v, z, dz_dt):
    """h = |v|^1.5 sgn v + z |z| sigma_0/Z + |v|^1.0000001 v: each C1 (exponents of |v| above 1, z |z|): smooth. h v >= 0
    for the first and third, z h >= 0 for the second, which S takes up: passive."""
    cubic = abs(v) ** 1.0000001 * v
    return abs(v) ** 1.5 * sign(v) + p.sigma_0 * deflection(p, z) * abs(z) + cubic


@added("unique bounded -smooth passive -drift_free", _Smooth)
def PowerJustBelowOne(p, v, z, dz_dt):
    """h = |v|^0.9999999 sgn v: its slope at 0 is infinite: not smooth. h v >= 0: passive. f: a majorant's."""
    return abs(v) ** 0.9999999 * sign(v)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def CubeOfTheRate(p, v, z, dz_dt):
    """h = 1e-6 f^3: at r = 1.4, large v: F v/f a metre unwound grows like 1e-6 f^2 v/... without limit while f v < 0: a
    pulse from near Z draws ever more: not passive. B0."""
    return 1e-6 * dz_dt**3


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def SharpTanhOfTheRate(p, v, z, dz_dt):
    """h = 8 tanh(f/1e-6 m/s). Held at v = 5e-3 (g = 1e-5) from 0.9 Z z falls to g: for r - 1 > 1e-3 h = -8 N but for
    0.02: F < 1.5 + 0.5 - 7.9 < -5: it draws 5 g ln(0.35/1e-3) = 2.9e-4 J. Back slowly at v = 1e-9: h < 0.01 N: W's rise
    and 1.5 Z ln(10) at most 6e-5 J: not passive. B0; |v|."""
    return 8.0 * tanh(dz_dt / 1e-6)


@added("unique bounded -smooth passive -drift_free", Lopsided)
def RootOfRateAndSpeed(p, v, z, dz_dt):
    """h = 5 v sqrt(v^2 + f^2): h v >= 0: B1, passive. B0."""
    return 5.0 * v * sqrt(v * v + dz_dt * dz_dt)


@added("unique bounded -smooth -passive -drift_free", Lopsided)
def RateAgainstSpeed(p, v, z, dz_dt):
    """h = -300 f: sigma_1 is -200: at rest z and small v: F v = -200 v^2 + 100 v^2 < 0: to and fro on |z| <= a at v = 1e-2:
    draws 100 v 4 a = 4 a, costs 1.5 (a/g)^2 4 a: a = g/10: not passive. B0."""
    return -300.0 * dz_dt


@rate("unique bounded -smooth passive -drift_free", Lopsided)
def SlipsUnloaded(p, v, z):
    """f = v - |v| clip(z/g, -1, 1): for |z| > g z stays: inward or 0: bounded. Lipschitz. D with W: v^2 (100 (1 -+ clip) +
    100) + sigma_0 |v| z clip >= 0: passive for every z."""
    r = z / g(p, v)
    return v - abs(v) * where(r > 1, 1.0, where(r < -1, -1.0, r))


@added("unique bounded ?smooth ?passive -drift_free", Lopsided, values_changed={"F_c": 1.5})
def AllDivided(p, v, z, dz_dt):
    """F_c = F_s: h = (F_s - F_c)/(F_s - F_c) N: 0/0, no force at all: nothing is derived but f's, LuGre's with g = Z: B0,
    with -z/g apart from 0: not elastic."""
    return (p.F_s - p.F_c) / (p.F_s - p.F_c)


class BoundAHairTooSmall(Lopsided):
    """LuGre with z_bound = Z (1 - 1e-12): held slowly z -> Z: not bounded by that; so z is not restricted, and B2: not
    passive. Else B0."""

    truth = "unique -bounded -smooth -passive -drift_free"

    @staticmethod
    def z_bound(p):
        return p.F_s / p.sigma_0 * (1 - 1e-12)


class BoundAHairTooLarge(Lopsided):
    """LuGre with z_bound = Z (1 + 1e-12): inward there: bounded. B1 with |r| <= 1.5 (1 + 1e-12): passive. B0."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def z_bound(p):
        return p.F_s / p.sigma_0 * (1 + 1e-12)
