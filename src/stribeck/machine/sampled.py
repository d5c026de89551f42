"""What a sampled controller does at its instants, as difference equations written from the same output and rates."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stribeck.equations import Sample
from stribeck.expressions.graph import Expr, derivative, substitute, symbol, symbols, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import exp, floor, where
from stribeck.machine.parts import ControllerPart

if TYPE_CHECKING:
    from stribeck.machine.system import Machine

_SUBSTEPS = 24  # of an observer whose law is not linear in z


def sampled_states(each: ControllerPart) -> tuple[str, ...]:
    """What a sampled controller remembers: how often it read, its last reading, its filter, its own states."""
    assert each.sampling is not None
    estimator = ("filter_y", "filter_v") if each.sampling.bandwidth else ("last",)
    return ("readings", *estimator, *each.states)


def samples_of(machine: Machine, called: Names) -> list[Sample]:
    """What each sampled controller does at its instants."""
    from stribeck.machine.balance import Balance

    balance = Balance(machine, called=called)
    return [_sample(balance, each, called) for each in machine.controllers if each.sampling is not None]


def _sample(balance: object, each: ControllerPart, called: Names) -> Sample:
    from stribeck.machine.balance import T, held_at_limit, limited, unlimited

    assert each.sampling is not None
    m = {n: symbol(f"memory.{each.name}_{n}") for n in sampled_states(each)}
    own = f"{each.path}.sampling"
    period = symbol(f"{own}.period")
    y = balance.k[f"{each.measures}.y"]  # type: ignore[attr-defined]
    if each.sampling.noise:
        y = y + symbol(f"{own}.noise") * symbol("noise")
    if each.sampling.resolution:
        count = symbol(f"{own}.resolution")
        y = floor(y / count + 0.5) * count
    called[y] = f"{each.name}_reading"
    first = m["readings"] <= 0
    after: dict[str, Expr] = {"readings": m["readings"] + 1}
    if each.sampling.bandwidth:
        v, filtered = _filter(where(first, y, m["filter_y"]), m["filter_v"], y, symbol(f"{own}.bandwidth"), period)
        after |= filtered
    else:
        v = where(first, 0.0, (y - m["last"]) / period)
        after["last"] = y
    called[v] = f"{each.name}_speed"
    x = {n: m[n] for n in each.states}
    raw, rates = unlimited(each, each.signal.reference(T), y, v, x, called, exact=True)
    rates = held_at_limit(each, raw, rates, x, 0.0)
    for name, rate in rates.items():
        after[name] = x[name] + period * rate if name != "z_hat" else _exact_step(rate, x[name], period, called)
    return Sample(each.name, limited(each, raw), {f"{each.name}_{n}": wrap(after[n]) for n in m})


def _filter(y: Expr, v: Expr, reading: Expr, bandwidth: Expr, period: Expr) -> tuple[Expr, dict[str, Expr]]:
    """The speed now, and a critically damped filter one period on with the reading held."""
    decay, off = exp(-bandwidth * period), y - reading
    pull = v + bandwidth * off
    return wrap(v + 0.0), {
        "filter_y": reading + (off + pull * period) * decay, "filter_v": (v - bandwidth * pull * period) * decay,
    }  # fmt: skip


def _exact_step(rate: Expr, z: Expr, period: Expr, called: Names) -> Expr:
    """z one period on with all else held: exact where the rate is linear in z, else in many small steps of that kind."""
    slope = derivative(rate, z)
    if str(z.value) not in symbols([slope]):
        return wrap(z + period * phi_1(slope * period) * rate)
    step, at = period / _SUBSTEPS, z
    for _ in range(_SUBSTEPS):
        f, df = substitute([rate, slope], {z: at}, called)
        at = wrap(at + step * phi_1(df * step) * f)
    return at


def phi_1(x: Expr) -> Expr:
    """(e^x - 1)/x, by its series where the difference would lose digits."""
    series = wrap(1.0)
    for n in range(9, 1, -1):
        series = 1 + series * x / n
    small = abs(x) < 0.1
    return wrap(where(small, series, (exp(x) - 1) / where(small, 1.0, x)))
