"""Stiff, tiny, huge: literals from 1e-300 to 1e155, and drift that hardly is one."""

from stribeck.constants import Constant
from stribeck.expressions.ops import both, clip, where
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g
from tests.properties.nasty.base import Lugre


class TinyDampingOnly(Lugre):
    """sigma_2 = 0, sigma_1 = 1e-12, F_s = 1.5 F_c: LuGre's condition fails: a pulse at large v (F v -> -0.5e-12
    v^2 + 1.5 v, v > 3e12 m/s) draws without limit: not passive. B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    values_changed = {"sigma_1": 1e-12, "sigma_2": 0.0}


class JustBelowLuGresCondition(Lugre):
    """sigma_2 = 49.9999995 against sigma_1 (F_s - F_c)/F_c = 50: Barabanov & Ortega: not passive. B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    values_changed = {"sigma_2": 49.9999995}


class AtLuGresCondition(Lugre):
    """sigma_2 = 50 = sigma_1 (F_s - F_c)/F_c, exactly: passive. B0."""

    truth = "unique bounded -smooth passive -drift_free"
    values_changed = {"sigma_2": 50.0}


class ElasticExceptWhenFast(BristleLaw):
    """LuGre's decay times the ramp clip((|z| - c)/c, 0, 1), c = 0.3e-5, but without it for |v| > 1e7: there f !=
    v: not drift_free. Lipschitz in z; inward at Z: bounded; D linear in the share: passive. Jumps."""

    truth = "unique bounded -smooth passive -drift_free"

    @staticmethod
    def z_elastic(p):
        return 0.3e-5

    @staticmethod
    def dz_dt(p, v, z):
        share = where(abs(v) > 1e7, 1.0, clip((abs(z) - 0.3e-5) / 0.3e-5, 0.0, 1.0))
        return v - share * abs(v) / g(p, v) * z


class ElasticExceptInAWindow(BristleLaw):
    """f = v but on 1e-8 < z < 1.01e-8, where f = v/2; LuGre's decay by a ramp from 0.5e-5 on. f = v for |z| <=
    1e-8: drift_free. z moves through the window at half speed, in either direction: dz/dy depends on z alone
    below the ramp, so solutions exist and do not part: unique. Inward at Z: bounded. With S' = 2 sigma_0 z in the
    window D = 150 v^2 there, else >= 0: passive. Jumps."""

    truth = "unique bounded -smooth passive drift_free"
    symmetric = False

    @staticmethod
    def z_elastic(p):
        return 1e-8

    @staticmethod
    def dz_dt(p, v, z):
        decay = clip((abs(z) - 0.5e-5) / 0.2e-5, 0.0, 1.0) * abs(v) / g(p, v) * z
        return v * where(both(z > 1e-8, z < 1.01e-8), 0.5, 1.0) - decay


class Piezo(Lugre):
    """Liu's piezo stage: sigma_1 (F_s - F_c) = 3000 <= sigma_2 F_c = 65000: LuGre's condition: passive. B0."""

    truth = "unique bounded -smooth passive -drift_free"
    values_changed = {"sigma_0": 1.67e6, "sigma_1": 6e3, "sigma_2": 2.6e4, "F_c": 2.5, "F_s": 3.0, "v_s": 1.6e-8}


class Valve(Lugre):
    """A stiff valve: sigma_1 (F_s - F_c) = 6.6e7 > sigma_2 F_c = 4.7e7: LuGre's condition fails: not passive.
    B0."""

    truth = "unique bounded -smooth -passive -drift_free"
    values_changed = {
        "sigma_0": 1.038e9, "sigma_1": 2.442e5, "sigma_2": 7.048e4, "F_c": 669.9, "F_s": 942.1, "v_s": 3.22e-3,
    }  # fmt: skip


class FallingDamping(Lugre):
    """LuGre with v_d = 1e-3: sigma_1 v_d/sqrt(2 e) = 0.043 <= 4 F_c: passive for every sigma_2 (theory.md), here
    0. B0."""

    truth = "unique bounded -smooth passive -drift_free"
    values_changed = {"sigma_2": 0.0, "v_d": 1e-3}


class OwnConstants(BristleLaw):
    """LuGre's f by constants of the law's own; F = k z + c v: D = c v^2 + k |v| z^2/G >= 0: passive. B0 with g =
    G = Z."""

    truth = "unique bounded -smooth passive -drift_free"
    uses = ()
    relations = ()
    v_d = None
    k = Constant("N/m", "stiffness", above=0, default=1e150)
    c = Constant("N s/m", "viscosity", at_least=0, default=1e-150)
    G = Constant("m", "deflection", above=0, default=1e-100)

    @staticmethod
    def z_bound(p):
        return p.G

    @staticmethod
    def scales(p):
        from stribeck.laws import Scales

        return Scales(p.G, 1.0, p.k * p.G)

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / p.G * z

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.k * z + p.c * v
