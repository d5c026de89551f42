"""What a sampled controller does at its instants, as difference equations written from the same output and rates."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from stribeck.control.sampled import phi_1
from stribeck.equations import Sample
from stribeck.expressions.graph import Expr, derivative, substitute, symbol, symbols, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import exp, sign, where
from stribeck.machine.dither import PHASE
from stribeck.machine.driving import sample_of
from stribeck.machine.parts import ControllerPart
from stribeck.signals.pieces import Reference

if TYPE_CHECKING:
    from stribeck.machine.balance import Balance
    from stribeck.machine.system import MachineSystem

# An observer whose law is not linear in z takes so many steps until it could have gone 25 times its largest deflection; it is
# as good as steady then.
_SUBSTEPS, _REACH = 48, 25


def sampled_states(each: ControllerPart) -> tuple[str, ...]:
    """What a sampled controller remembers: how often it read, its last reading, its filter, its states, its dither's phase."""
    assert each.sampling is not None
    estimator = ("filter_y", "filter_v") if each.sampling.bandwidth else ("last",)
    return ("readings", *estimator, *each.states, *([PHASE] if each.dither is not None else []))


def samples_of(machine: MachineSystem, called: Names) -> list[Sample]:
    """What each sampled controller does at its instants."""
    from stribeck.machine.balance import Balance

    balance = Balance(machine, called=called)
    found = [sample_of(balance, drive, called) for drive in machine.drives if drive.drive.memory]
    return found + [_sample(balance, each, called) for each in machine.controllers if each.sampling is not None]


def _sample(balance: Balance, each: ControllerPart, called: Names) -> Sample:
    from stribeck.machine.balance import T

    assert each.sampling is not None
    own = f"{each.path}.sampling"
    y = wrap(each.sampling.reading(each.sampling.symbols(own), balance.k[f"{each.measures}.y"]))
    called[y] = f"{each.name}_reading"
    m = {n: symbol(f"memory.{each.name}_{n}") for n in sampled_states(each)}
    u, after = stepped(each, y, each.signal.reference(T), m, called)
    return Sample(each.name, own, u, {f"{each.name}_{n}": after[n] for n in m})


def stepped(
    each: ControllerPart, y: Expr, r: Reference, m: dict[str, Expr], called: Names
) -> tuple[Expr, dict[str, Expr]]:
    """One sample of a controller that reads ``y`` and is asked for ``r``: its output, and what it remembers after it,
    from what it remembered (``m``). The simulation, the exports and their tests all take it from here."""
    from stribeck.machine.balance import held_at_limit, limited, unlimited

    assert each.sampling is not None
    p = each.sampling.symbols(f"{each.path}.sampling")
    first = m["readings"] <= 0
    after: dict[str, Expr] = {"readings": m["readings"] + 1}
    if each.sampling.bandwidth:
        v, filtered = _filter(where(first, y, m["filter_y"]), m["filter_v"], y, p.bandwidth, p.period)
        after |= filtered
    else:
        v = where(first, 0.0, (y - m["last"]) / p.period)
        after["last"] = y
    called[v] = f"{each.name}_speed"
    x = {n: m[n] for n in each.states}
    r = replace(r, direction=sign(r.rate))  # all that a controller knows of it, and what its export has
    shaken = wrap(0.0)
    if each.dither is not None:
        shaken = each.dither.force(m[PHASE])
        after[PHASE] = each.dither.next_phase(m[PHASE], p.period)
    raw, rates = unlimited(each, r, y, v, x, called, exact=True, shaken=shaken)
    rates = held_at_limit(each, raw, rates, x, 0.0)
    for name, rate in rates.items():
        after[name] = (
            x[name] + p.period * rate if name != "z_hat" else observed(each, rate, x[name], v, p.period, called)
        )
    return wrap(limited(each, raw)), {n: wrap(x) for n, x in after.items()}


def _filter(y: Expr, v: Expr, reading: Expr, bandwidth: Expr, period: Expr) -> tuple[Expr, dict[str, Expr]]:
    """The speed now, and a critically damped filter one period on with the reading held."""
    decay, off = exp(-bandwidth * period), y - reading
    pull = v + bandwidth * off
    return wrap(v + 0.0), {
        "filter_y": reading + (off + pull * period) * decay, "filter_v": (v - bandwidth * pull * period) * decay,
    }  # fmt: skip


def observed(each: ControllerPart, rate: Expr, z: Expr, v: Expr, period: Expr, called: Names) -> Expr:
    """An observer's deflection one period on at the speed v held: exact where its rate is linear in z."""
    slope = derivative(rate, z)
    if str(z.value) not in symbols([slope]):
        return wrap(z + period * phi_1(slope * period) * rate)
    assert each.compensation is not None
    bound = wrap(each.compensation.law.z_bound(each.compensation.symbolic(called)))
    at_0, at_bound = (substitute([rate], {z: x}, called)[0] for x in (wrap(0.0), bound))
    fastest, reach = abs(at_0) + abs(at_0 - at_bound), _REACH * bound
    time = wrap(where(period * fastest > reach, reach / where(fastest > 0, fastest, 1.0), period))
    step, at = time / _SUBSTEPS, z
    for _ in range(_SUBSTEPS):
        at = _rosenbrock(rate, slope, z, at, step, called)
    f, df = substitute([rate, slope], {z: at}, called)
    return wrap(at + (period - time) * phi_1(df * (period - time)) * f)


def _rosenbrock(rate: Expr, slope: Expr, z: Expr, at: Expr, step: Expr, called: Names) -> Expr:
    """One step of order 4 (Shampine, Implementation of Rosenbrock methods, ACM TOMS 8(2):93-113, 1982)."""
    f, df = substitute([rate, slope], {z: at}, called)
    pivot = 1 / (2 / step - df)
    k_1 = f * pivot
    (f,) = substitute([rate], {z: wrap(at + 2 * k_1)}, called)
    k_2 = (f - 8 / step * k_1) * pivot
    (f,) = substitute([rate], {z: wrap(at + 48 / 25 * k_1 + 6 / 25 * k_2)}, called)
    k_3 = (f + (372 / 25 * k_1 + 12 / 5 * k_2) / step) * pivot
    k_4 = (f - (112 / 125 * k_1 + 54 / 125 * k_2 + 2 / 5 * k_3) / step) * pivot
    return wrap(at + 19 / 9 * k_1 + k_2 / 2 + 25 / 108 * k_3 + 125 / 108 * k_4)
