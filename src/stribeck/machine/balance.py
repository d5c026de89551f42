"""The balance of forces and of energy of a machine, as expressions of its states, its signals and its constants."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stribeck.expressions.graph import (
    ZERO,
    Expr,
    derivative,
    is_zero,
    substitute,
    symbol,
    total_derivative,
    wrap,
)
from stribeck.expressions.names import Names
from stribeck.expressions.ops import both, clip, where
from stribeck.machine.controllers import Own
from stribeck.machine.driving import Driven, act
from stribeck.machine.friction import compensation, contact_parameters
from stribeck.machine.parts import BodyPart, ControllerPart, LinkPart, MotorPart, Span, joined, symbols_of
from stribeck.signals.pieces import Reference

if TYPE_CHECKING:
    from stribeck.machine.system import MachineSystem

LAYER = 1e-7  # share of a limit over which an integral fades out, so that it slides along the limit
T = symbol("t")


class Balance:
    """Every quantity of a machine by its column's name (``arm.y``, ``mesh.F``), and what follows from them."""

    def __init__(self, machine: MachineSystem, exact: bool = False, called: Names | None = None) -> None:
        self.machine, self.exact, self.called = machine, exact, Names() if called is None else called
        self.net: dict[str, Expr] = {body.name: ZERO for body in machine.bodies}
        self.power_in = self.lost = self.stored = ZERO
        self.own: dict[str, Expr] = {}  # the rates of the elements' own states
        self.k: dict[str, Expr] = {}
        self.unlimited: dict[str, Expr] = {}
        self.far: Expr = ZERO
        self._motion()
        self._loads()
        self._links()
        self._controllers()
        self._motors()
        self._contacts()
        self._bodies()
        self._drives()

    # -- the parts in the order in which they depend on each other ---------------------------------------------------

    def _name(self, name: str, value: object) -> Expr:
        """Keep a quantity under the name of its column, which its variable in the generated code has too."""
        found = wrap(value)
        self.called.give(found, name.replace(".", "_"))
        self.k[name] = found
        return found

    def _motion(self) -> None:
        for body in self.machine.bodies:
            ratio, leader = self.ratio(body), self.machine.leader(body.name)
            if body.leader is not None:
                self.k[f"{body.name}.y"] = ratio * symbol(f"{leader.name}.y")
                self.k[f"{body.name}.v"] = ratio * self._speed(leader)
                continue
            y, v = joined(body.name, "y"), joined(body.name, "v")
            self.k[y], self.k[v] = symbol(y), self._speed(body)
            for state in body.plant.states if body.driven is None else ():
                self.k[joined(body.name, state.name)] = symbol(joined(body.name, state.name))

    def motion(self, name: str) -> tuple[Expr, Expr]:
        """Position and velocity of a body."""
        return self.k[joined(name, "y")], self.k[joined(name, "v")]

    def _speed(self, body: BodyPart) -> Expr:
        return symbol(joined(body.name, "v")) if body.driven is None else wrap(body.driven.reference(T).value)

    def ratio(self, body: BodyPart) -> Expr:
        """How far a body moves by its leader."""
        total = wrap(1.0)
        while body.leader is not None:
            total = total * symbol(f"{body.path}.ratio") if body.ratio else total
            body = self.machine.body[body.leader]
        return total

    def span(self, span: Span, path: str) -> tuple[Expr, Expr, Expr]:
        """d, w and the ratio of an element."""
        ratio = symbol(f"{path}.ratio") if span.ratio else wrap(1.0)
        if isinstance(span.start, str):
            y, v = self.motion(span.start)
            d, w = ratio * y, ratio * v
        else:
            far = span.start.reference(T)
            d, w = ratio * far.value, ratio * far.rate
        if span.end is not None:
            d, w = d - self.k[f"{span.end}.y"], w - self.k[f"{span.end}.v"]
        return d, w, ratio

    def _act(self, span: Span, ratio: Expr, f: Expr) -> None:
        """Let a force act on both ends."""
        if isinstance(span.start, str):
            self.net[span.start] = self.net[span.start] - ratio * f
        else:
            self.power_in = self.power_in + f * (ratio * span.start.reference(T).rate)
        if span.end is not None:
            self.net[span.end] = self.net[span.end] + f

    def _states(self, name: str, names: tuple[str, ...]) -> tuple[Expr, ...]:
        return tuple(symbol(f"{name}.{n}") for n in names)

    def _loads(self) -> None:
        for load in self.machine.loads:
            y, v = self.k[f"{load.on}.y"], self.k[f"{load.on}.v"]
            r = load.signal.reference(T).value if load.signal else 0.0
            x = self._states(load.name, tuple(s.name for s in load.kind.states))
            f = self._name(f"{load.name}.f", load.kind.force(load.p, r, y, v, x))
            self._own(load.name, load.kind.states, load.kind.rates(load.p, r, y, v, x))
            self.net[load.on] = self.net[load.on] + f
            if load.kind.conservative:
                self.stored = self.stored + load.kind.stored_energy(load.p, y)
            else:
                self.power_in = self.power_in + f * v

    def _own(self, name: str, states: tuple[object, ...], rates: Own) -> None:
        for state, rate in zip(states, rates, strict=True):
            self.own[f"{name}.{getattr(state, 'name', state)}"] = wrap(rate)

    def _links(self) -> None:
        for link in self.machine.links:
            d, w, ratio = self.span(link.span, link.path)
            x = self._states(link.name, tuple(s.name for s in link.kind.states))
            f = self._name(f"{link.name}.f", link.kind.force(link.p, d, w, x))
            rates = tuple(wrap(rate) for rate in link.kind.rates(link.p, d, w, x))
            self._own(link.name, link.kind.states, rates)
            self._act(link.span, ratio, f)
            self._energy_of(link, d, w, f, dict(zip(x, rates, strict=True)))

    def _energy_of(self, link: LinkPart, d: Expr, w: Expr, f: Expr, rates: dict[Expr, Expr]) -> None:
        """What a link stores; what it dissipates is what is left of the power that it takes up."""
        own = symbol("stretch")
        stored = wrap(link.kind.stored_energy(link.p, d, tuple(rates)))
        self.stored = self.stored + stored
        if not isinstance(link.span.start, str):
            self.far = self.far + stored
        plain = wrap(link.kind.stored_energy(link.p, own, tuple(rates)))
        slopes = [derivative(plain, own), total_derivative(plain, rates)]
        slope, by_states = substitute(slopes, {own: d}, self.called)
        self.lost = self.lost + ((f - slope) * w - by_states)

    def _controllers(self) -> None:
        for each in self.machine.controllers:
            r = each.signal.reference(T)
            self.k[f"{each.name}.r"] = wrap(r.value)
            u = symbol(f"segment.{each.name}_u") if each.sampling is not None else self._continuous(each, r)
            self._name(f"{each.name}.u", u)
            if each.on in self.machine.body:
                self.net[each.on] = self.net[each.on] + u
                self.power_in = self.power_in + u * self.k[f"{each.on}.v"]

    def _continuous(self, each: ControllerPart, r: Reference) -> Expr:
        y, v = self.k[f"{each.measures}.y"], self.k[f"{each.measures}.v"]
        x = {n: symbol(f"{each.name}.{n}") for n in each.states}
        shaken = each.dither.at(T) if each.dither is not None else ZERO
        raw, rates = unlimited(each, r, y, v, x, self.called, self.exact, shaken)
        self.unlimited[each.name] = raw
        rates = held_at_limit(each, raw, rates, x, LAYER)
        self._own(each.name, tuple(rates), tuple(rates.values()))
        return limited(each, raw)

    def _motors(self) -> None:
        asked = {each.on: each for each in self.machine.controllers}
        for motor in self.machine.motors:
            v = self.k[f"{motor.on}.v"]
            if motor.name in asked:
                wanted, V = self.k[f"{asked[motor.name].name}.u"] / motor.p.K, ZERO
            else:
                assert motor.signal is not None
                wanted, V = None, wrap(motor.signal.reference(T).value)
            i = self._current(motor, wanted, V, v)
            torque = self._name(f"{motor.name}.torque", motor.p.K * i)
            self.net[motor.on] = self.net[motor.on] + torque
            self.power_in = self.power_in + torque * v

    def _current(self, motor: MotorPart, wanted: Expr | None, V: Expr, v: Expr) -> Expr:
        if motor.has_inductance:
            i, V, rate = motor.kind.with_inductance(motor.p, wanted, V, v, symbol(f"{motor.name}.i"))
            self.own[f"{motor.name}.i"] = wrap(rate)
        else:
            i, V = motor.kind.without_inductance(motor.p, wanted, V, v)
        self._name(f"{motor.name}.V", V)
        return self._name(f"{motor.name}.i", i)

    def _contacts(self) -> None:
        forces = {n.rpartition(".")[0]: x for n, x in self.k.items() if n.endswith((".f", ".torque"))}
        for contact in self.machine.contacts:
            d, w, ratio = self.span(contact.span, contact.path)
            z = symbol(joined(contact.name, "z")) if contact.law.has_z else ZERO
            p = contact_parameters(contact, d, forces, T, self.called)
            rate = wrap(contact.law.dz_dt(p, w, z)) if contact.law.has_z else ZERO
            F = wrap(contact.law.friction(p, w, z, rate))
            if rate.args:
                self.called[rate] = joined(contact.name, "dz_dt", "_")
            self.k[joined(contact.name, "z")], self.k[joined(contact.name, "w")] = z, w
            self._name(joined(contact.name, "F"), F)
            self._act(contact.span, ratio, F)
            if self.machine.energy:  # a law of one's own may say nothing of what it stores
                symbols = contact.law.symbolic(symbols_of(contact.law_path), contact.form)
                stored = wrap(contact.law.stored_energy(symbols, z))
                self.stored = self.stored + stored
                self.lost = self.lost + (F * w - (derivative(stored, z) * rate if contact.law.has_z else ZERO))
            if contact.law.has_z:
                self.own[joined(contact.name, "z")] = rate

    def _bodies(self) -> None:
        """Forces and inertias gathered at the leaders."""
        self.inertia: dict[str, Expr] = {body.name: ZERO for body in self.machine.bodies}
        self.force: dict[str, Expr] = {body.name: ZERO for body in self.machine.bodies}
        for body in self.machine.bodies:
            leader, ratio = self.machine.leader(body.name), self.ratio(body)
            self.force[leader.name] = self.force[leader.name] + ratio * self.net[body.name]
            if body.inertia and leader.driven is None and body.inertia_name in body.constants():
                m = symbol(f"{body.path}.{body.inertia_name}")
                self.inertia[leader.name] = self.inertia[leader.name] + m * ratio * ratio
        for body in self.machine.bodies:
            if body.driven is not None:  # what drives it supplies the forces on it
                self.power_in = self.power_in - self.force[body.name] * self.motion(body.name)[1]

    def _drives(self) -> None:
        """What moves the bodies beside forces, and how they obey."""
        self.driven: dict[str, Driven] = {}
        for body in self.machine.bodies:
            if body.leader is not None or body.driven is not None:
                continue
            found = act(self, body, self.machine.drive_on(body.name))
            self.driven[body.name] = found
            self.own |= found.rates
            self.k |= found.shown
            if self.machine.energy:
                self.power_in = self.power_in + found.power
                self.lost, self.stored = self.lost + found.lost, self.stored + found.stored
        for drive in self.machine.drives:
            if drive.on not in self.driven:  # which sets the velocity
                self.k[drive.drive.signal.name] = wrap(drive.signal.reference(T).value)

    # -- what follows ------------------------------------------------------------------------------------------------

    def rates(self) -> dict[str, Expr]:
        """The time derivatives of the states."""
        found = dict(self.own)
        for body in self.machine.bodies:
            if body.leader is None:
                found[joined(body.name, "y")] = self.motion(body.name)[1]
                if body.driven is None:
                    found[joined(body.name, "v")] = self.driven[body.name].acceleration
        return found | {"E_in": self.power_in, "E_dissipated": self.lost}

    def moved_energy(self) -> Expr | None:
        """The energy of links whose far end is a signal: where that jumps, its work is what they store."""
        return None if is_zero(self.far) else self.far

    def watched(self) -> list[Expr]:
        """What events are told by, in the order of the machine's ``watched``."""
        contacts = {name for name, _ in self.machine.watched}
        found = [self.k[joined(x.name, "w")] for x in self.machine.contacts if x.name in contacts]
        found += [self.span(x.span, x.path)[0] for x in self.machine.links if "gap" in x.form]
        controllers = [x for x in self.machine.controllers if x.sampling is None and "limit" in x.form]
        return [*found, *(self.unlimited[x.name] for x in controllers)]

    def outputs(self) -> dict[str, Expr]:
        """Every column by name."""
        energy = {"E_in": symbol("E_in"), "E_dissipated": symbol("E_dissipated"), "E_stored": self.stored}
        return {c.name: wrap({**self.k, **energy}[c.name]) for c in self.machine.columns}


def unlimited(
    each: ControllerPart, r: Reference, y: Expr, v: Expr, x: dict[str, Expr], called: Names, exact: bool, shaken: Expr
) -> tuple[Expr, dict[str, Expr]]:
    """A controller's output without its limit, its dither's force ``shaken`` among it, and the rates of its states."""
    own = tuple(x[s.name] for s in each.kind.states_of(each.form))
    names = [s.name for s in each.kind.states_of(each.form)]
    u = wrap(each.kind.output(each.p, r, y, v, own))
    rates = dict(zip(names, map(wrap, each.kind.rates(each.p, r, y, v, own)), strict=True))
    if each.feedforward:
        u = u + symbol(f"{each.path}.feedforward.inertia") * r.second
    if each.compensation is not None:
        force, rate = compensation(each.compensation, r, v, x.get("z_hat", ZERO), called, exact, lead_of(each))
        u = u + (symbol(f"{each.path}.compensation.share") * force if each.compensation.share else force)
        if rate is not None and "z_hat" in x:
            rates["z_hat"] = rate
    return wrap(u + shaken), rates


def lead_of(each: ControllerPart) -> Expr | None:
    """The lag by which a controller's compensation is led."""
    led = each.compensation is not None and each.compensation.lead
    return symbol(f"{each.path}.compensation.lead") if led else None


def limited(each: ControllerPart, u: Expr) -> Expr:
    """A controller's output within its limit."""
    return u if each.p.limit is None else wrap(clip(u, -each.p.limit, each.p.limit))


def held_at_limit(
    each: ControllerPart, u: Expr, rates: dict[str, Expr], x: dict[str, Expr], layer: float
) -> dict[str, Expr]:
    """The rates with the integrals held where the limit is exceeded and they would drive it further; with a ``layer``
    they fade out over that share of the limit."""
    if each.p.limit is None:
        return rates
    found = dict(rates)
    for name in each.kind.integrals:
        if name not in rates:
            continue
        drives_further = derivative(u, x[name]) * rates[name] * u > 0
        over = abs(u) - each.p.limit
        share = clip(1 - over / (layer * each.p.limit), 0.0, 1.0) if layer else 0.0
        found[name] = wrap(where(both(over > 0, drives_further), rates[name] * share, rates[name]))
    return found
