"""The same functions in other spellings, and smooth functions that do not look it."""

from stribeck.expressions.ops import both, clip, cos, either, exp, log, sign, sin, sqrt, where
from stribeck.laws.terms import g
from tests.properties.nasty.base import Root, added, rate


@rate("unique bounded -smooth passive -drift_free")
def AbsAsRootPlusRoundedZero(p, v, z):
    """sqrt(v^2 + c) with c = (v + 1) - v - 1 = 0: LuGre: B0, B1; in floats c is noise of either sign."""
    return v - sqrt(v**2 + ((v + 1) - v - 1)) / g(p, v) * z


@rate("unique bounded -smooth passive -drift_free")
def SignTimesV(p, v, z):
    """v (1 - sgn(v) z/g): LuGre: B0, B1."""
    return v * (1 - sign(v) * z / g(p, v))


@rate("unique bounded -smooth passive -drift_free")
def OverOneDenominator(p, v, z):
    """(g v - |v| z)/g: LuGre: B0, B1."""
    return (g(p, v) * v - abs(v) * z) / g(p, v)


@rate("unique bounded -smooth passive -drift_free")
def ByCases(p, v, z):
    """v - v z/g for v >= 0, v + v z/g else: LuGre: B0, B1."""
    return where(v >= 0, v - v * z / g(p, v), v + v * z / g(p, v))


class _Root(Root):
    """A smooth law, passive with MILD (sqrt majorant of theory.md), to which aliases are added."""

    v_d = None

    @classmethod
    def friction(cls, p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + cls.h(p, v, z)


@added("unique bounded smooth passive -drift_free", _Root)
def PowerOneAndAHalf(p, v, z):
    """h = 10 v (v^2)^0.25 = 10 sgn(v) |v|^1.5: derivative 15 |v|^0.5, continuous: smooth; passive."""
    return 10 * v * (v**2) ** 0.25


@added("unique bounded smooth passive -drift_free", _Root)
def StepThatCancels(p, v, z):
    """h = where(v > 1, v, 1) - clip(v, 1, inf) = 0: smooth, passive."""
    return where(v > 1, v, 1.0) - clip(v, 1.0, float("inf"))


@added("unique bounded -smooth ?passive -drift_free", _Root, symmetric=False)
def TinyKinkInZ(p, v, z):
    """h = 1e-30 |z - Z/3|: a kink at z = Z/3: not smooth. h = 1e-30 * 1e-5 at z = 0-, so sigma_0 z + h > 0 there,
    of the wrong sign. But S' need not be B4's: the law is dissipative by its leak and viscous friction? At z in
    (-5e-41, 0) slow cycles draw up to 1e-35 N against r^2 of 1e-71: as B4 but for the leak m(0)/g z, which is
    smaller still at speeds >> 1e-6. Not derived."""
    return 1e-30 * abs(z - 0.5e-5)


@added("unique bounded smooth passive -drift_free", _Root)
def LogOfExp(p, v, z):
    """h = 20 log(exp(v)) = 20 v: smooth, passive."""
    return 20 * log(exp(v))


@added("unique bounded smooth passive -drift_free", _Root)
def SineAndCosine(p, v, z):
    """h = 10 v (sin^2 z + cos^2 z) = 10 v: smooth, passive."""
    return 10 * v * (sin(1e6 * z) ** 2 + cos(1e6 * z) ** 2)


@added("unique bounded smooth passive -drift_free", _Root)
def NeverTrue(p, v, z):
    """h = -1e3 sgn v where v > 1 and v < -1, or v^2 < 0: never: h = 0: smooth, passive."""
    return where(either(both(v > 1, v < -1), v**2 < 0), -1e3 * sign(v), 0.0)
