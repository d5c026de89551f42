"""CasADi: a law as a function for optimal control, and CasADi's symbols in every equation of Stribeck."""

from __future__ import annotations

from collections.abc import Sequence
from types import ModuleType
from typing import TYPE_CHECKING

from stribeck.constants import show
from stribeck.errors import InputError, nearest
from stribeck.exports.optional import Operations, package
from stribeck.expressions import ops
from stribeck.laws import builtin
from stribeck.laws.base import Law

if TYPE_CHECKING:
    import casadi


ops.register("casadi", Operations("casadi", where="if_else", both="logic_and", either="logic_or"))


def to_casadi(law: Law, free: Sequence[str] = ()) -> casadi.Function:
    """A law as a CasADi function (v, z) -> (dz_dt, F); static laws have no z and give F alone.

    Args:
        law: the law with its constants.
        free: constants that become further inputs, after the others, in this order.

    Raises:
        InputError: the law is not smooth, so that derivatives for optimization do not exist; or it has no such constant.
        MissingExtra: CasADi is not installed.
    """
    ca: ModuleType = package("casadi")
    known = list(law.p.numbers)
    problems = [
        f"free: {show(n)}: law '{law.name}' has no such constant{nearest(n, known)}" for n in free if n not in known
    ]
    if reason := _not_smooth(law):
        problems.append(reason)
    if problems:
        raise InputError(problems)
    v, z = ca.MX.sym("v"), ca.MX.sym("z")
    inputs = {name: ca.MX.sym(name) for name in dict.fromkeys(free)}
    p = law.p.replaced(inputs)
    rate = law.dz_dt(p, v, z)
    outputs = {"dz_dt": rate, "F": law.friction(p, v, z, rate)}
    states = {"v": v, "z": z}
    if not law.has_z:
        del outputs["dz_dt"], states["z"]
    arguments = [*states.values(), *inputs.values()]
    function: casadi.Function = ca.Function(
        law.name, arguments, list(outputs.values()), [*states, *inputs], list(outputs)
    )
    return function


def _not_smooth(law: Law) -> str | None:
    """The reason why a law is not smooth enough for gradient-based optimization, or None."""
    if law.differentiable:
        return None
    others = ", ".join(name for name, other in builtin().items() if other.has_z and other.claims.smooth)
    return (
        f"law '{law.name}' is not smooth: its derivatives jump (it holds |v| or sgn v), and an optimiser that follows "
        f"them fails or stalls at v = 0; take a smooth law: {others}"
    )
