"""Friction compensation of a controller: a law's steady force at the reference's speed, or an observer."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.expressions.graph import Expr, derivative, is_zero, substitute, symbol, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import where
from stribeck.laws.base import Law
from stribeck.laws.steady import SLOWEST, steady_force
from stribeck.machine.law import Friction
from stribeck.waveforms.pieces import Reference


def compensation(
    law: Friction, speed: str, r: Reference, v: Expr, z: Expr, called: Names, exact: bool, lead: Expr | None = None
) -> tuple[Expr, Expr | None]:  # fmt: skip
    """The force that compensates friction, and the rate of the observer's deflection if there is one.

    ``speed``: of the reference, or as measured.
    ``exact``: if the reference rests, the force is 0, as at a sample; otherwise the sign is that of the present piece.
    ``lead``: this time multiplies dF/dt, which is added, with the reference's second derivative as acceleration. A drive
    that lags by it then follows F. The paper's inner loop does the same (Sobczyk, Perondi, Cunha, eq. 13): it has dF/dt in
    the derivative of p_d.
    """
    kind, p = law.kind, law.with_named_terms(called.term)
    if speed == "reference":
        fast = wrap(abs(r.rate))
        moving = wrap(where(fast > SLOWEST, fast, SLOWEST))  # at rest the limit: |v|/|v| is no number there
        force = r.direction * steady_force(kind, p, moving)
        if lead is not None:
            rising = symbol("rising")
            (slope,) = substitute([derivative(steady_force(kind, p, rising), rising)], {rising: moving}, called)
            force = force + lead * slope * r.second
        return (wrap(where(fast <= 0, 0.0, force)) if exact and not is_zero(fast) else wrap(force)), None
    rate = wrap(kind.dz_dt(p, v, z)) if kind.has_z else None
    force = wrap(kind.friction(p, v, z, 0.0 * v if rate is None else rate))
    if lead is None:
        return force, rate
    slopes = substitute(_slopes(kind, p), {_V: v, _Z: z}, called)
    change = slopes[0] * r.second + (slopes[1] * rate if rate is not None else 0.0)
    return wrap(force + lead * change), rate


_V, _Z = symbol("held v"), symbol("held z")


def _slopes(kind: type[Law], p: SimpleNamespace) -> list[Expr]:
    """dF/dv and dF/dz of a law."""
    rate = wrap(kind.dz_dt(p, _V, _Z)) if kind.has_z else 0.0 * _V
    force = wrap(kind.friction(p, _V, _Z, rate))
    return [derivative(force, _V), derivative(force, _Z)]
