"""Bounds other than F_s/sigma_0, none at all though slowly, solutions that are not unique, escapes, and what lies outside Z."""

from stribeck.expressions.ops import exp, sqrt
from stribeck.laws.terms import g
from tests.properties.nasty.base import rate


@rate("unique -bounded -smooth ?passive -drift_free")
def HalfTheDecay(p, v, z):
    """LuGre's with half the decay: z passes Z (slowly held, to 2 g = 3e-5): not bounded by it. D = v^2 (200 - 100 r)
    + 2 g_N |v| r^2 >= 0 with r = z sgn v/(2 g) <= 1.5: passive within 2 Z, not for z unrestricted (B2): which is
    meant where another bound exists is not said. Else B0."""
    return v - abs(v) / (2 * g(p, v)) * z


@rate("unique bounded -smooth passive -drift_free", values_changed={"F_s": 1.0})
def ConstantDeflection(p, v, z):
    """F_s = F_c: g = Z for every v, f = 0 at Z exactly: bounded. D = v^2 (200 - 100 r) + g_N |v| r^2, r <= 1:
    passive. B0."""
    return v - abs(v) / g(p, v) * z


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


@rate("-unique -bounded -smooth -passive -drift_free")
def EscapesWhenSliding(p, v, z):
    """f = v + |v| u^3: held v > 0 takes z to infinity in finite time: not unique (no z(t) for all t), not
    bounded. Unwinding from z at v < 0, |v| (u^3 - 1) > 0 for u > 1: z rises, F v < 0 near 1: F = sigma_0 z + 100
    |v| (u^3 - 2) > 0 for u^3 > 2, v < 0: draws without limit: not passive. |v|."""
    return v + abs(v) * (z * p.sigma_0 / p.F_s) ** 3
