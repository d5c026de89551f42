"""An observer's deflection from one sample to the next."""

from __future__ import annotations

from stribeck.expressions.graph import Expr, derivative, substitute, symbols, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import where
from stribeck.machine.law import Friction
from stribeck.machine.sampled import phi_1

# An observer whose law is not linear in z takes so many steps until it could have gone 25 times its largest deflection; it is
# as good as steady then.
_SUBSTEPS, _REACH = 48, 25


def observed(law: Friction, rate: Expr, z: Expr, v: Expr, period: Expr, called: Names) -> Expr:
    """An observer's deflection one period on at the speed v held: exact where its rate is linear in z."""
    slope = derivative(rate, z)
    if str(z.value) not in symbols([slope]):
        return wrap(z + period * phi_1(slope * period) * rate)
    bound = wrap(law.kind.z_bound(law.with_named_terms(called.term)))
    at_0, at_bound = (substitute([rate], {z: x}, called)[0] for x in (wrap(0.0), bound))
    fastest, reach = abs(at_0) + abs(at_0 - at_bound), _REACH * bound
    time = wrap(where(period * fastest > reach, reach / where(fastest > 0, fastest, 1.0), period))
    step, z_k = time / _SUBSTEPS, z
    for _ in range(_SUBSTEPS):
        z_k = _rosenbrock(rate, slope, z, z_k, step, called)
    f, df = substitute([rate, slope], {z: z_k}, called)
    return wrap(z_k + (period - time) * phi_1(df * (period - time)) * f)


def _rosenbrock(rate: Expr, slope: Expr, z: Expr, z_k: Expr, step: Expr, called: Names) -> Expr:
    """One step of order 4 (Shampine, Implementation of Rosenbrock methods, ACM TOMS 8(2):93-113, 1982)."""
    f, df = substitute([rate, slope], {z: z_k}, called)
    pivot = 1 / (2 / step - df)
    k_1 = f * pivot
    (f,) = substitute([rate], {z: wrap(z_k + 2 * k_1)}, called)
    k_2 = (f - 8 / step * k_1) * pivot
    (f,) = substitute([rate], {z: wrap(z_k + 48 / 25 * k_1 + 6 / 25 * k_2)}, called)
    k_3 = (f + (372 / 25 * k_1 + 12 / 5 * k_2) / step) * pivot
    k_4 = (f - (112 / 125 * k_1 + 54 / 125 * k_2 + 2 / 5 * k_3) / step) * pivot
    return wrap(z_k + 19 / 9 * k_1 + k_2 / 2 + 25 / 108 * k_3 + 125 / 108 * k_4)
