"""The elements of a machine: with numbers they are what a user wrote, with symbols the structure, with arrays its lanes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, reduce
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.constants import Column
from stribeck.expressions.ops import Value, smaller, sqrt
from stribeck.laws.base import Law, Scales
from stribeck.machine.element import GROUND, SECTIONS, Element
from stribeck.machine.signal import SignalUse
from stribeck.machine.system import MachineSystem, interned
from stribeck.machine.table import SYMBOLS, Carrier, ConstantLeaf, Frozen, Key
from stribeck.waveforms import Signal
from stribeck.waveforms.pieces import Pieces, merged, pieces

if TYPE_CHECKING:
    from stribeck.machine.elements.bodies import Body
    from stribeck.machine.elements.contacts import Contact
    from stribeck.machine.elements.controllers import AnyController
    from stribeck.machine.elements.links import Link
    from stribeck.machine.elements.loads import Load
    from stribeck.machine.elements.motors import Motor

INITIAL = "initial"  # in the place of the owner of a constant: where a state starts
_IN_PIECES = ("ramp", "step")  # signals whose constants make pieces
# Natural magnitudes where no contact says any: a millimeter (milliradian) and its tenfold in a second.
_LENGTH, _SPEED, _FORCE = 1e-3, 1e-2, 1.0


@dataclass(frozen=True)
class Elements:
    """The elements of a machine by section and name; they do not change.

    Two machines that differ in numbers only are equal when symbolic, and share compiled code.
    """

    bodies: Mapping[str, Body] = field(default_factory=Frozen)
    links: Mapping[str, Link] = field(default_factory=Frozen)
    contacts: Mapping[str, Contact] = field(default_factory=Frozen)
    loads: Mapping[str, Load] = field(default_factory=Frozen)
    motors: Mapping[str, Motor] = field(default_factory=Frozen)
    controllers: Mapping[str, AnyController] = field(default_factory=Frozen)
    energy: bool = False  # whether the output has what is put in, stored and dissipated
    # the columns but energies, and their quantities, if not every element's own
    listed: tuple[tuple[Column, str], ...] = ()

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash(tuple(getattr(self, f.name) for f in fields(self)))

    def __iter__(self) -> Iterator[Element]:
        return self.in_order(SECTIONS)

    def in_order(self, sections: Iterable[str]) -> Iterator[Element]:
        """The elements of these sections, one section after the other."""
        return (each for section in sections for each in getattr(self, section).values())

    # -- how it is wired ---------------------------------------------------------------------------------------------

    def leader(self, name: str) -> Body:
        """The body whose coordinate a body has."""
        body = self.bodies[name]
        while body.tied_to is not None:
            body = self.bodies[body.tied_to]
        return body

    def tie(self, name: str) -> Value:
        """The displacement of a body per unit of its leader's."""
        body, total = self.bodies[name], 1.0
        while body.tied_to is not None:
            total = total * body.ratio if body.ratio is not None else total
            body = self.bodies[body.tied_to]
        return total

    def carried(self, body: str) -> dict[str, float]:
        """The displacement of each leading body per unit of ``body``, if links are rigid; its own leader first."""
        travel = {self.leader(body).name: 1.0 / self.tie(body)}
        for _ in self.bodies:
            for link in self.links.values():
                if len(link.ends) < 2:
                    continue
                start, end = link.ends
                a, b = self.leader(start).name, self.leader(end).name
                # ratio y_start = y_end
                ratio = (1.0 if link.ratio is None else link.ratio) * self.tie(start) / self.tie(end)
                if a in travel and b not in travel:
                    travel[b] = travel[a] * ratio
                elif b in travel and a not in travel:
                    travel[a] = travel[b] / ratio
        return travel

    def controller_of(self, motor: str) -> AnyController | None:
        """The controller that asks a motor for a current."""
        return next((x for x in self.controllers.values() if x.on == motor), None)

    @property
    def unnamed(self) -> bool:
        """Whether the elements have no names, as those of a file of schema 1: each is the only one of its section."""
        return "" in self.bodies

    # -- numbers, symbols, lanes ---------------------------------------------------------------------------------------

    @cached_property
    def symbolic(self) -> Elements:
        """The structure: what code is made of."""
        return self.carrying(SYMBOLS)

    @cached_property
    def system(self) -> MachineSystem:
        """The equations of the structure; one for all machines that differ in numbers only."""
        return interned(MachineSystem(self.symbolic))

    @cached_property
    def signals(self) -> dict[SignalUse, Signal]:
        """The signals of elements with numbers, and how the equations refer to them."""
        followed = (signal.built for each in self for signal in each.followed())
        return dict(zip(self.system.signals, followed, strict=True))

    @cached_property
    def laws(self) -> dict[str, Law]:
        """The laws of a file by their tables, each with the units of where it acts."""
        entries = ((path, x.law, each) for each in self for path, x in each.laws())
        return {path: law.of_motion(each.turning(self)) for path, law, each in entries if law is not None}

    @property
    def leaves(self) -> Iterator[tuple[ConstantLeaf, bool]]:
        """Every run-time constant, in the order in which compiled code takes them, and whether it is of what turns."""
        return ((leaf, each.turning(self)) for each in self for leaf in each.leaves(each.path))

    @cached_property
    def values(self) -> dict[Key, Value]:
        """The values of the run-time constants."""
        return {leaf.key: leaf.value for leaf, _ in self.leaves}

    @cached_property
    def places(self) -> dict[str, Key]:
        """The key of every number in which lanes can differ, by its path.

        These are run-time constants, initial values (key :data:`INITIAL` and the state), and constants of signals that are
        made of pieces."""
        keys: dict[str, Key] = {leaf.path: leaf.key for leaf, _ in self.leaves}
        for each in self:
            if "initial" in type(each).model_fields:
                keys |= {
                    f"{each.path}.initial.{s.name}": (INITIAL, each.name_of(s.name)) for s in each.own_states(self)
                }
        for use, signal in self.signals.items():
            if signal.kind in _IN_PIECES:
                keys |= {f"{use.path}.{name}": (use.path, name) for name in signal.constants}
        return keys

    def with_values(self, values: Mapping[Key, Value], signals: Mapping[str, Signal] | None = None) -> Elements:
        """The same machine with other values of some constants: numbers, arrays with one for each lane, or symbols.

        ``signals`` replaces signals by others of the same kinds, by their paths. Nothing is compiled anew."""
        put = lambda owner, name: values.get((owner, name), self.values.get((owner, name)))  # noqa: E731
        machine = self.carrying(Carrier(put, signals=signals or {}))
        vars(machine)["system"] = self.system  # which no value changes
        return machine

    def carrying(self, carrier: Carrier) -> Elements:
        """The same machine of what the carrier puts in the place of its run-time constants."""
        sections: dict[str, Any] = {}
        for section in SECTIONS:
            elements = getattr(self, section).items()
            sections[section] = Frozen({n: x.carrying(x.path, replace(carrier, name=n)) for n, x in elements})
        return replace(self, **sections)

    # -- natural magnitudes, for the default tolerances ----------------------------------------------------------------

    @cached_property
    def scales(self) -> dict[str, Scales]:
        """Natural magnitudes of each body: those of its contacts, else of what it is linked to."""
        by_body: dict[str, Scales] = {}
        for contact in self.contacts.values():
            contact_scales, ratio = contact.scales(), 1.0 if contact.ratio is None else abs(contact.ratio)
            _smallest(
                by_body,
                contact.start,
                Scales(contact_scales.length / ratio, contact_scales.speed / ratio, contact_scales.force * ratio),
            )
            if contact.end != GROUND:
                _smallest(by_body, contact.end, contact_scales)
        joints = [(str(x.start), x.end, x.ratio) for x in self.links.values() if x.far is None and x.end != GROUND]
        joints += [(x.tied_to, x.name, x.ratio) for x in self.bodies.values() if x.tied_to is not None]
        for _ in self.bodies:  # through links and ties, as far as they reach
            for start, end, given in joints:
                ratio = 1.0 if given is None else abs(given)
                if start in by_body and end not in by_body:
                    s = by_body[start]
                    by_body[end] = Scales(s.length * ratio, s.speed * ratio, s.force / ratio)
                elif end in by_body and start not in by_body:
                    s = by_body[end]
                    by_body[start] = Scales(s.length / ratio, s.speed / ratio, s.force * ratio)
        return {name: by_body.get(name, Scales(_LENGTH, _SPEED, _FORCE)) for name in self.bodies}

    @cached_property
    def natural(self) -> dict[str, Value]:
        """The natural magnitude of each state; a length's where no element knows any."""
        with np.errstate(all="ignore"):  # of constants at the ends of what floats hold
            magnitudes = {n: x for each in self for n, x in each.natural(self.scales, self).items()}
            energy = _least(*(s.force * s.length for s in self.scales.values()))
        magnitudes |= {"E_in": energy, "E_dissipated": energy}
        sizes = {state.name: magnitudes.get(state.name, _LENGTH) for state in self.system.states}
        return {name: _least(x) for name, x in sizes.items()}

    @property
    def mass(self) -> Value:
        """The mass that the one drive moves without anything between; None where there is no such thing."""
        body = self.bodies.get("")
        return body.heavy if body is not None and body.kind == "body" else None

    def damping(self) -> Value:
        """The damping ratio of the one body on its bristles at rest; many bodies and contacts have no such number, and
        infinity stands for it."""
        contact, mass = self.contacts.get(""), self.mass
        if contact is None or mass is None or not contact.has_z:
            return float("inf")
        p = contact.friction.p.numbers
        if "sigma_0" not in p:
            return float("inf")
        given = [p.get("sigma_1"), p.get("sigma_2"), *(getattr(x, "K_d", None) for x in self.controllers.values())]
        return sum(x for x in given if x is not None) / (2 * sqrt(p["sigma_0"] * mass))

    # -- what a solver takes -------------------------------------------------------------------------------------------

    @cached_property
    def initial(self) -> dict[str, float]:
        """The states at t = 0 that are not 0."""
        return {each.name_of(s.name): s.start for each in self for s in each.own_states(self) if s.start}

    def pieces(self, t_end: float, others: Mapping[SignalUse, Signal] | None = None) -> Pieces:
        """All signals as one table; ``others`` in the place of some."""
        if not self.signals:
            return Pieces(np.zeros(1), np.zeros((1, 0)), np.ones(1, np.int8))
        return merged([pieces(x, use.turns, t_end) for use, x in {**self.signals, **(others or {})}.items()])

    @property
    def longest_step(self) -> float:
        """The longest step that cannot miss a wave of a signal, s."""
        shaken = (each.longest_step() for each in self.controllers.values())
        return min([*shaken, *(signal.longest_step for signal in self.signals.values())], default=np.inf)

    def thresholds(self) -> list[Value]:
        """The level of each watched quantity: the speed of a contact's slip, half of a play, the limit of a controller."""
        return [getattr(self, each.section)[each.name].level() for each in self.system.watching]

    def sampling(self) -> list[dict[str, Value]]:
        """Period, delay, noise and seed of each sampled controller, in the order of its outputs."""
        samplings = (each.sampling for each in self.controllers.values() if each.sampling is not None)
        return [{"period": s.period, "delay": s.delay, "noise": 0.0 if s.noise is None else s.noise, "seed": s.seed}
                for s in samplings]  # fmt: skip


def _smallest(by_body: dict[str, Scales], name: str, s: Scales) -> None:
    if (smallest := by_body.get(name)) is not None:
        s = Scales(_least(smallest.length, s.length), _least(smallest.speed, s.speed), _least(smallest.force, s.force))
    by_body[name] = s


def _least(*values: Value) -> Value:
    """The least of numbers, arrays or symbols; a number of NumPy's, which is written otherwise, as one of Python's."""
    least = reduce(smaller, values)
    return least.item() if isinstance(least, np.generic) else least
