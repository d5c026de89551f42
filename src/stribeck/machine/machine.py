"""The elements of a machine: with numbers they are what a user wrote, with symbols the structure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

from stribeck.expressions.graph import wrap
from stribeck.expressions.ops import Value
from stribeck.laws.base import Scales
from stribeck.machine.element import GROUND, Element
from stribeck.machine.signal import SignalUse
from stribeck.machine.table import SYMBOLS, Carrier, ConstantLeaf, Frozen, Key
from stribeck.signals import Signal

if TYPE_CHECKING:
    from stribeck.machine.elements.bodies import Body
    from stribeck.machine.elements.contacts import Contact
    from stribeck.machine.elements.controllers import AnyController
    from stribeck.machine.elements.links import Link
    from stribeck.machine.elements.loads import Load
    from stribeck.machine.elements.motors import Motor
    from stribeck.machine.elements.sensors import Sensor

SECTIONS = ("bodies", "links", "contacts", "loads", "motors", "controllers", "sensors")  # of a file
# Natural magnitudes where no contact says any: a millimetre (milliradian) and its tenfold in a second.
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
    sensors: Mapping[str, Sensor] = field(default_factory=Frozen)
    energy: bool = False  # whether the output has what is put in, stored and dissipated

    def __hash__(self) -> int:
        return self._hash

    @cached_property
    def _hash(self) -> int:
        return hash(tuple(getattr(self, f.name) for f in fields(self)))

    def __iter__(self) -> Iterator[Element]:
        return (each for section in SECTIONS for each in getattr(self, section).values())

    # -- how it is wired ---------------------------------------------------------------------------------------------

    def leader(self, name: str) -> Body:
        """The body whose coordinate a body has."""
        body = self.bodies[name]
        while body.tied_to is not None:
            body = self.bodies[body.tied_to]
        return body

    def tie(self, name: str) -> Value:
        """How far a body moves by its leader."""
        body, total = self.bodies[name], wrap(1.0)
        while body.tied_to is not None:
            total = total * body.ratio if body.ratio is not None else total
            body = self.bodies[body.tied_to]
        return total

    def controller_of(self, motor: str) -> AnyController | None:
        """The controller that asks a motor for a current."""
        return next((x for x in self.controllers.values() if x.on == motor), None)

    @property
    def unnamed(self) -> bool:
        """Whether the elements have no names, as those of a file of schema 1: each is the only one of its section."""
        return "" in self.bodies

    @property
    def given_alone(self) -> bool:
        """Whether the velocity of the only body is given: then the signal itself tells the events."""
        return self.unnamed and self.bodies[""].velocity is not None

    # -- numbers, symbols, lanes ---------------------------------------------------------------------------------------

    @cached_property
    def symbolic(self) -> Elements:
        """The structure: what code is made of."""
        return self.carrying(SYMBOLS)

    @cached_property
    def signals(self) -> dict[SignalUse, Signal]:
        """The signals of elements with numbers, and how the equations refer to them."""
        order = ("bodies", "links", "loads", "motors", "contacts", "controllers")
        structure = self.symbolic
        pairs = ((x, getattr(structure, section)[n]) for section in order for n, x in getattr(self, section).items())
        return {use: signal.built for x, written in pairs
                for use, signal in zip(written.signals(), x.followed(), strict=True)}  # fmt: skip

    @property
    def leaves(self) -> Iterator[tuple[ConstantLeaf, bool]]:
        """Every run-time constant, in the order in which compiled code takes them, and whether it is of what turns."""
        return ((leaf, each.turning(self)) for each in self for leaf in each.leaves(each.path))

    @cached_property
    def values(self) -> dict[Key, Value]:
        """The values of the run-time constants."""
        return {leaf.key: leaf.value for leaf, _ in self.leaves}

    def with_values(self, values: Mapping[Key, Value]) -> Elements:
        """The same machine with these numbers, or arrays of one for each lane; nothing is compiled anew."""
        return self.carrying(Carrier(lambda owner, name: values.get((owner, name))))

    def carrying(self, carrier: Carrier) -> Elements:
        """The same machine of what the carrier puts in the place of its run-time constants."""
        sections: dict[str, Any] = {}
        for section in SECTIONS:
            own = getattr(self, section).items()
            sections[section] = Frozen({n: x.carrying(x.path, replace(carrier, name=n)) for n, x in own})
        return replace(self, **sections)

    # -- natural magnitudes, for the default tolerances ----------------------------------------------------------------

    @cached_property
    def scales(self) -> dict[str, Scales]:
        """Natural magnitudes of each body: those of its contacts, else of what it is linked to."""
        found: dict[str, Scales] = {}
        for contact in self.contacts.values():
            own, ratio = contact.scales(), 1.0 if contact.ratio is None else abs(contact.ratio)
            _smallest(found, contact.start, Scales(own.length / ratio, own.speed / ratio, own.force * ratio))
            if contact.end != GROUND:
                _smallest(found, contact.end, own)
        joints = [(str(x.start), x.end, x.ratio) for x in self.links.values() if x.far is None and x.end != GROUND]
        joints += [(x.tied_to, x.name, x.ratio) for x in self.bodies.values() if x.tied_to is not None]
        for _ in self.bodies:  # through links and ties, as far as they reach
            for start, end, given in joints:
                ratio = 1.0 if given is None else abs(given)
                if start in found and end not in found:
                    s = found[start]
                    found[end] = Scales(s.length * ratio, s.speed * ratio, s.force / ratio)
                elif end in found and start not in found:
                    s = found[end]
                    found[start] = Scales(s.length / ratio, s.speed / ratio, s.force * ratio)
        return {name: found.get(name, Scales(_LENGTH, _SPEED, _FORCE)) for name in self.bodies}

    def natural(self) -> dict[str, Value]:
        """The natural magnitude of each state that an element knows one of."""
        found = {n: x for each in self for n, x in each.natural(self.scales, self).items()}
        energy = min(s.force * s.length for s in self.scales.values())
        return {**found, "E_in": energy, "E_dissipated": energy}


NATURAL_LENGTH = _LENGTH  # of a state of which no element knows any


def _smallest(found: dict[str, Scales], name: str, s: Scales) -> None:
    if (old := found.get(name)) is not None:  # compared only then: of lanes they are arrays
        s = Scales(min(old.length, s.length), min(old.speed, s.speed), min(old.force, s.force))
    found[name] = s
