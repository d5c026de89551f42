"""The derivative of V along the loop (the paper's eq. 19), derived with SymPy from plant, controller and observer.

V = (M s^2 + rho p_err^2 + z_err^2/K)/2. The simulator's own equations are evaluated on SymPy symbols.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from types import SimpleNamespace
from typing import TYPE_CHECKING

from stribeck.errors import StribeckError, needed
from stribeck.expressions.ops import Value
from stribeck.laws.base import BristleLaw
from stribeck.machine.elements.bodies.cylinder import GAS
from stribeck.machine.elements.controllers.pressure_cascade import GAINS
from stribeck.machine.pneumatic import cascade
from stribeck.machine.pneumatic.cylinder import Cylinder
from stribeck.machine.pneumatic.observer import observe

if TYPE_CHECKING:
    import sympy

ERRORS = ("s", "p_err", "z_err")


@dataclass(frozen=True)
class QuadraticForm:
    """dV/dt = -(ss s^2 + pp p_err^2 + zz z_err^2 + sz s z_err).

    The coefficients are SymPy expressions of the gains, sigma_0, sigma_1 and w. ``rates`` are those of s, p_err and
    z_err.
    """

    rates: dict[str, sympy.Expr]
    ss: sympy.Expr
    pp: sympy.Expr
    zz: sympy.Expr
    sz: sympy.Expr

    @property
    def derivative(self) -> sympy.Expr:
        """dV/dt."""
        import sympy

        s, p_err, z_err = sympy.symbols(ERRORS, real=True)
        return -self.ss * s**2 - self.pp * p_err**2 - self.zz * z_err**2 - self.sz * s * z_err

    @property
    def exact(self) -> sympy.Expr:
        """(4 ss zz - sz^2)/w. If w > 0 and it is not negative, dV/dt <= 0 for all errors."""
        import sympy

        return sympy.expand(sympy.cancel((4 * self.ss * self.zz - self.sz**2) / sympy.Symbol("w", real=True)))

    @property
    def sufficient(self) -> tuple[sympy.Expr, sympy.Expr]:
        """The two conditions of the paper's eq. 21, from |s z_err| <= (s^2 + z_err^2)/2.

        Neither may be negative. The second is divided by w.
        """
        import sympy

        w = sympy.Symbol("w", real=True)
        return self.ss - self.sz / 2, sympy.expand(sympy.cancel((self.zz - self.sz / 2) / w))


@lru_cache(maxsize=1)
def derive() -> QuadraticForm:
    """The form for any law dz/dt = S_1(v) v - w(v) z with F = sigma_0 z + sigma_1 dz/dt + sigma_2 v.

    Plant and observer share the law. Assumptions: the valve does not saturate, and the controller knows the plant. A
    sigma_1 that falls with speed enters by its value, because its rate is part of dp_d/dt and cancels.

    Raises:
        StribeckError: the derivative is not such a form.
    """
    with needed("the proof of a servo's gains"):
        import sympy

    def named(*groups: Iterable[str]) -> SimpleNamespace:
        return SimpleNamespace(**{n: sympy.Symbol(n, positive=True) for group in groups for n in group})

    class Linear(BristleLaw):
        @staticmethod
        def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
            return sympy.Function("S_1")(v) * v - sympy.Function("w")(v) * z

    c, m = named(GAINS), named(GAS)
    p = Linear.symbolic(lambda name: sympy.Symbol(name, positive=True))
    y, v, p_1, p_2, z, z_hat = sympy.symbols("y v p_1 p_2 z z_hat", real=True)
    path = sympy.symbols("y_d dy_d d2y_d d3y_d", real=True)
    e, s = cascade.tracking_errors(c, path, y, v)
    observed = observe(Linear, p, c.K, v, s, {"z_hat": z_hat})
    dz_dt = Linear.dz_dt(p, v, z)
    acceleration = Cylinder.acceleration(m, 0.0, Linear.friction(p, v, z, dz_dt), (p_1, p_2))
    p_d = cascade.desired_pressure(c, m, path, v, s, observed.F)
    motion = {y: v, v: acceleration, z: dz_dt, z_hat: observed.rates["z_hat"], **dict(pairwise(path))}

    def along(x: sympy.Expr) -> sympy.Expr:
        return sum(sympy.diff(x, each) * rate for each, rate in motion.items())

    p_err = p_1 - p_2 - p_d
    u_hat = cascade.pressure_demand(c, m, y, v, p_1, p_2, s, p_err, along(p_d))
    rates = {
        "s": along(s),
        "p_err": Cylinder.unforced(m, y, v, p_1, p_2) + u_hat - along(p_d),
        "z_err": along(z_hat - z),
    }
    E = dict(zip(ERRORS, sympy.symbols(ERRORS, real=True), strict=True))
    # the states as functions of the errors; a state that does not cancel remains and is detected
    by_errors = [
        (p_1, p_2 + p_d + E["p_err"]),
        (z_hat, z + E["z_err"]),
        (path[1], v + getattr(c, "lambda") * e - E["s"]),
    ]
    for name, rate in rates.items():
        for old, new in by_errors:
            rate = rate.subs(old, new)
        rates[name] = sympy.expand(sympy.expand(rate)).subs(sympy.Function("w")(v), sympy.Symbol("w", real=True))
    return _form(rates, cascade.energy(c, m.mass, *E.values()), E, {y, v, p_1, p_2, z, *path})


def _form(
    rates: dict[str, sympy.Expr], V: sympy.Expr, E: dict[str, sympy.Symbol], others: set[sympy.Symbol]
) -> QuadraticForm:
    """dV/dt as a form in the errors ``E``, free of the symbols ``others``."""
    import sympy

    dV = sympy.expand(sum(sympy.diff(V, E[name]) * rate for name, rate in rates.items()))
    poly = sympy.Poly(dV, *E.values())
    form = QuadraticForm(
        rates, *(sympy.factor(-poly.coeff_monomial(each)) for each in
                 (E["s"] ** 2, E["p_err"] ** 2, E["z_err"] ** 2, E["s"] * E["z_err"])),
    )  # fmt: skip
    if sympy.expand(dV - form.derivative) != 0 or dV.has(*others):
        raise StribeckError(
            "dV/dt is not the quadratic form of eq. 19: plant, controller and observer do not fit together"
        )
    return form
