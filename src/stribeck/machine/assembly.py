"""The equations of a machine, put together by its elements: each names its quantities and acts on bodies."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from stribeck.expressions.graph import ZERO, Expr, derivative, is_zero, substitute, symbol, total_derivative, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value
from stribeck.machine.table import joined
from stribeck.waveforms.pieces import Reference

if TYPE_CHECKING:
    from stribeck.machine.element import BetweenBodies, Element
    from stribeck.machine.elements.bodies import Body
    from stribeck.machine.machine import Elements
    from stribeck.machine.signal import SignalUse

T = symbol("t")
_ORDER = ("bodies", "loads", "links", "controllers", "motors", "contacts")  # each needs only what stands before it


class Assembly:
    """Every quantity of a machine by its column's name (``arm.y``, ``mesh.F``), and what follows from them.

    Args:
        system: the elements, of symbols.
        called: takes the names of intermediate results.
        exact: as an output shows the quantities at one instant.
    """

    def __init__(self, system: Elements, called: Names | None = None, exact: bool = False) -> None:
        self.system, self.exact = system, exact
        self.called = Names() if called is None else called
        self.k: dict[str, Expr] = {}  # the quantities
        self.rates: dict[str, Expr] = {}  # the time derivatives of the states
        self.unlimited: dict[str, Expr] = {}  # outputs of continuous controllers without their limits
        self.net: dict[str, Expr] = dict.fromkeys(system.bodies, ZERO)
        self.power_in: Value = ZERO
        self.lost: Value = ZERO
        self.stored: Value = ZERO
        self.far: Value = ZERO  # the energy that jumps with signals: of links' far ends, of what is added to bodies
        for element in system.in_order(_ORDER):
            element.equations(self)
        self._bodies()
        self.rates |= {"E_in": self.power_in, "E_dissipated": self.lost}

    # -- what elements ask and say -----------------------------------------------------------------------------------

    def show(self, name: str, value: object) -> Expr:
        """Keep a quantity under the name of its column, which its variable in the generated code has too."""
        quantity = wrap(value)
        self.called.give(quantity, name.replace(".", "_"))
        self.k[name] = quantity
        return quantity

    def state(self, element: Element, name: str) -> Expr:
        """A state of an element."""
        return symbol(element.name_of(name))

    def motion(self, body: str) -> tuple[Expr, Expr]:
        """Position and velocity of a body."""
        return self.k[joined(body, "y")], self.k[joined(body, "v")]

    def speed(self, body: Body) -> Expr:
        """The velocity of a body with a coordinate: a state, or a signal."""
        return symbol(body.name_of("v")) if body.velocity is None else wrap(self.reference(body.velocity.signal).value)

    def reference(self, signal: Any) -> Reference:
        """A signal and its derivatives now."""
        use: SignalUse = signal
        return use.reference(T)

    def force_of(self, name: str) -> Expr:
        """The force of a link or load, or the torque of a motor."""
        force = self.k.get(joined(name, "f"))
        return self.k[joined(name, "torque")] if force is None else force

    def along(self, x: BetweenBodies) -> tuple[Expr, Expr, Expr]:
        """d, w and the ratio of an element between two bodies."""
        ratio = wrap(1.0) if x.ratio is None else x.ratio
        if x.far is None:
            y, v = self.motion(x.start)
            d, w = ratio * y, ratio * v
        else:
            far = self.reference(x.far)
            d, w = ratio * far.value, ratio * far.rate
        if x.end != "ground":
            y, v = self.motion(x.end)
            d, w = d - y, w - v
        return d, w, ratio

    def push(self, body: str, force: Expr) -> None:
        """Let a force act on a body."""
        self.net[body] = self.net[body] + force

    def act(self, x: BetweenBodies, ratio: Expr, f: Expr) -> None:
        """Let a force act on both ends."""
        if x.far is None:
            self.net[x.start] = self.net[x.start] - ratio * f
        else:
            self.power_in = self.power_in + f * (ratio * self.reference(x.far).rate)
        if x.end != "ground":
            self.push(x.end, f)

    def account(
        self, energy: Callable[[Value], Value], d: Expr, w: Expr, f: Expr, rates: Mapping[Expr, Expr], far: object
    ) -> None:  # fmt: skip
        """Energy that depends on the stretch d (and on states with their rates) is stored; what is left of the power f w
        is dissipated. ``far``: where a far end jumps, its work is what is stored."""
        stretch = symbol("stretch")
        stored = wrap(energy(d))
        self.stored = self.stored + stored
        self.far = self.far + stored if far is not None else self.far
        plain = wrap(energy(stretch))
        slopes = [derivative(plain, stretch), total_derivative(plain, dict(rates))]
        slope, by_states = substitute(slopes, {stretch: d}, self.called)
        self.lost = self.lost + ((f - slope) * w - by_states)

    # -- what follows ------------------------------------------------------------------------------------------------

    def _bodies(self) -> None:
        """Forces and inertias gathered at the leaders, and how these obey."""
        self.inertia: dict[str, Expr] = dict.fromkeys(self.system.bodies, ZERO)
        self.force = dict(self.inertia)
        for name, body in self.system.bodies.items():
            leader, ratio = self.system.leader(name), self.system.tie(name)
            self.force[leader.name] = self.force[leader.name] + ratio * self.net[name]
            if body.heavy is not None and leader.velocity is None:
                self.inertia[leader.name] = self.inertia[leader.name] + body.heavy * ratio * ratio
        for body in sorted(self.system.bodies.values(), key=lambda each: each.velocity is None):
            body.obey(self)

    def moved_energy(self) -> Expr | None:
        """The energy of links whose far end is a signal: where it jumps, it is put in."""
        return None if is_zero(self.far) else self.far

    def outputs(self, columns: Iterable[tuple[str, str]]) -> dict[str, Expr]:
        """Quantities and states by the names of columns, of which each is a pair with the quantity's own name."""
        states = {name: symbol(name) for name in self.rates}
        known = {**states, **self.k, "E_stored": self.stored}
        return {name: wrap(known[quantity]) for name, quantity in columns}
