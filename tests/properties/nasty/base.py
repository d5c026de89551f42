"""What most of the laws here begin with, and decorators for those that are one equation."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stribeck.expressions.ops import sqrt
from stribeck.laws import BristleLaw
from stribeck.laws.terms import g


class Lugre(BristleLaw):
    """LuGre's dz/dt."""

    @staticmethod
    def dz_dt(p, v, z):
        return v - abs(v) / g(p, v) * z


class Root(BristleLaw):
    """The same with sqrt(v^2 + 1e-12) for |v|."""

    @staticmethod
    def dz_dt(p, v, z):
        return v - sqrt(v**2 + 1e-12) / g(p, v) * z


class WithForce(Lugre):
    """LuGre with a force h added."""

    v_d = None

    @staticmethod
    def h(p, v, z, dz_dt):
        return 0.0

    @classmethod
    def friction(cls, p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_1 * dz_dt + p.sigma_2 * v + cls.h(p, v, z, dz_dt)


class Lopsided(WithForce):
    """The same where h need not be odd."""

    symmetric = False


class Springy(BristleLaw):
    """F = sigma_0 z + sigma_2 v."""

    v_d = None

    @staticmethod
    def friction(p, v, z, dz_dt):
        return p.sigma_0 * z + p.sigma_2 * v


def deflection(p, z):
    """u = z/Z."""
    return z * p.sigma_0 / p.F_s


def _of_one(method: str, own_base: type[BristleLaw]) -> Callable[..., Any]:
    """A decorator that makes a law of the function that gives its ``method``; the docstring derives the ``truth``."""

    def of(truth: str, base: type[BristleLaw] = own_base, **attributes: Any) -> Callable[..., type[BristleLaw]]:
        def built(equation: Callable[..., Any]) -> type[BristleLaw]:
            given = {"truth": truth, method: staticmethod(equation), **attributes}
            own = {"__doc__": equation.__doc__, "__module__": equation.__module__}
            return type(base)(equation.__name__, (base,), own | given)

        return built

    return of


added = _of_one("h", WithForce)
rate = _of_one("dz_dt", BristleLaw)
friction = _of_one("friction", BristleLaw)
