"""The friction of a contact whose level varies, and what a controller does against it."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.expressions.graph import Expr, derivative, is_zero, substitute, symbol, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value, where
from stribeck.laws.evaluation import SLOWEST, steady_force
from stribeck.laws.values import Constants
from stribeck.machine.loads import sum_of_waves
from stribeck.machine.parts import CompensationPart, ContactPart, Factor, joined, symbols_of
from stribeck.signals.pieces import Reference


def contact_parameters(contact: ContactPart, d: Expr, forces: dict[str, Expr], t: Expr, called: Names) -> Constants:
    """The law's constants at one instant: times the factors, plus what the loads add, times the factor of the level.

    The law's terms are called by the contact's name too.
    """

    def on_term(name: str, latex: str, args: tuple[Value, ...], value: Value) -> Value:
        return called.term(joined(contact.name, name, "_"), latex, args, value)

    p = contact.law.symbolic(symbols_of(contact.law_path), contact.form, on_term)
    by_name = {factor.of: _factor(factor, d, t) for factor in contact.factors}
    for name, factor in by_name.items():
        if name != "level":
            p = p.replaced({name: getattr(p, name) * factor})
    levels = [name for name in ("F_c", "F_s") if hasattr(p, name)]
    for i, level in enumerate(contact.levels):
        make = symbols_of(level.path)
        total: Value = 0.0
        for source in level.sources:
            total = total + (make(f"weight_{source}") if level.weighted else 1.0) * forces[source]
        size = abs(total)
        if level.against is not None:
            other = forces[level.against]
            size = where(total * other < 0, where(size < abs(other), total**2, 0.0), 0.0)
        if isinstance(size, Expr) and size.args:
            called[size] = f"{contact.name}_load" + (f"_{i + 1}" if len(contact.levels) > 1 else "")
        for name in levels:
            if name in level.gains:
                p = p.replaced({name: getattr(p, name) + make(name) * size})
    for name in levels if "level" in by_name else ():
        p = p.replaced({name: getattr(p, name) * by_name["level"]})
    return p


def _factor(factor: Factor, d: Expr, t: Expr) -> Expr:
    if factor.signal is not None:
        return factor.signal.reference(t).value  # type: ignore[no-any-return]
    make = symbols_of(factor.path)
    names = ("amplitude", "waves", "phase")
    p = SimpleNamespace(**{n: tuple(make(f"{n}_{i}") for i in range(factor.waves)) for n in names})
    return wrap(1 + sum_of_waves(p, d))


def compensation(
    c: CompensationPart, r: Reference, v: Expr, z: Expr, called: Names, exact: bool, lead: Expr | None = None
) -> tuple[Expr, Expr | None]:
    """The force that makes up for friction, and the rate of the observer's deflection where there is one.

    ``exact``: where the reference rests the force is 0, as at a sample; else the sign is that of the present piece.
    ``lead``: that times dF/dt is added, with the reference's second derivative for the acceleration: what lags by it
    follows F (the paper's inner loop, Sobczyk, Perondi, Cunha, eq. 13, which has dF/dt in the derivative of p_d).
    """
    p = c.symbolic(called)
    if c.speed == "reference":
        speed = wrap(abs(r.rate))
        moving = wrap(where(speed > SLOWEST, speed, SLOWEST))  # at rest the limit: |v|/|v| is no number there
        force = r.direction * steady_force(c.law, p, moving)
        if lead is not None:
            rising = symbol("rising")
            (slope,) = substitute([derivative(steady_force(c.law, p, rising), rising)], {rising: moving}, called)
            force = force + lead * slope * r.second
        return (wrap(where(speed <= 0, 0.0, force)) if exact and not is_zero(speed) else wrap(force)), None
    rate = wrap(c.law.dz_dt(p, v, z)) if c.law.has_z else None
    force = wrap(c.law.friction(p, v, z, 0.0 * v if rate is None else rate))
    if lead is None:
        return force, rate
    by_v, by_z = _slopes(c, p)
    slopes = substitute([by_v, by_z], {_V: v, _Z: z}, called)
    change = slopes[0] * r.second + (slopes[1] * rate if rate is not None else 0.0)
    return wrap(force + lead * change), rate


_V, _Z = symbol("held v"), symbol("held z")


def _slopes(c: CompensationPart, p: SimpleNamespace) -> tuple[Expr, Expr]:
    """dF/dv and dF/dz of a law."""
    rate = wrap(c.law.dz_dt(p, _V, _Z)) if c.law.has_z else 0.0 * _V
    force = wrap(c.law.friction(p, _V, _Z, rate))
    return derivative(force, _V), derivative(force, _Z)
