"""A machine as one system of equations: M dv/dt = drives - sum of b f over the elements (docs/reference/machines.md).

A file of schema 1 is the smallest machine: one body, one contact and what moves the body, none of which has a name.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import Column, Constant
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import Expr, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value
from stribeck.machine.assembly import Assembly
from stribeck.machine.element import Element
from stribeck.machine.equations import Sample, Watch, Watched
from stribeck.machine.signal import SignalUse
from stribeck.machine.table import Key, joined

if TYPE_CHECKING:
    from stribeck.machine.elements.bodies import Body
    from stribeck.machine.elements.contacts import Contact
    from stribeck.machine.elements.controllers import AnyController, Controller
    from stribeck.machine.elements.links import Link
    from stribeck.machine.elements.loads import Load
    from stribeck.machine.elements.motors import Motor
    from stribeck.machine.machine import Elements

_E_IN = Column("E_in", "J", "energy put in")
_E_OUT = Column("E_dissipated", "J", "energy dissipated")
E_STORED = Column("E_stored", "J", "kinetic energy, and energy of links, pendulums and bristles")
_COLUMNS = ("bodies", "contacts", "links", "loads", "motors", "controllers")  # whose columns come first


@dataclass(frozen=True)
class MachineSystem:
    """The structure of a machine as the code generator takes it: equal for machines that differ in numbers only."""

    elements: Elements  # of symbols

    @property
    def energy(self) -> bool:
        """Whether the output has the columns of energy."""
        return self.elements.energy

    @cached_property
    def signals(self) -> tuple[SignalUse, ...]:
        """The reference to each signal in the equations."""
        return tuple(use for each in self.elements for use in each.signals())

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The bodies."""
        return tuple(self.elements.bodies.values())

    @property
    def links(self) -> tuple[Link, ...]:
        """The links."""
        return tuple(self.elements.links.values())

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts."""
        return tuple(self.elements.contacts.values())

    @property
    def loads(self) -> tuple[Load, ...]:
        """The loads."""
        return tuple(self.elements.loads.values())

    @property
    def motors(self) -> tuple[Motor, ...]:
        """The motors."""
        return tuple(self.elements.motors.values())

    @property
    def controllers(self) -> tuple[Controller, ...]:
        """The controllers of a force: not those that move a valve."""
        return tuple(x for x in self.elements.controllers.values() if not x.moves_valve)  # type: ignore[misc]

    # -- what the code generator needs -----------------------------------------------------------------------------

    @cached_property
    def states(self) -> tuple[Column, ...]:
        """The states in the order in which they are integrated."""
        e = self.elements
        every = ((each, s) for each in e.in_order(_COLUMNS) for s in each.own_states(e))
        states = [Column(each.name_of(s.name), s.unit, s.meaning) for each, s in every]
        return (*states, *((_E_IN, _E_OUT) if self.energy else ()))

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The columns of the output after t."""
        energy = (_E_IN, E_STORED, _E_OUT) if self.energy else ()
        if listed := self.elements.listed:
            return (*(column for column, _ in listed), *energy)
        columns = [column for each in self.elements.in_order(_COLUMNS) for column in each.columns(self.elements)]
        return (*columns, *energy)

    @property
    def compared(self) -> tuple[str, ...]:
        """The columns in which two runs are compared: those of each body, contact and link."""
        e = self.elements
        if e.unnamed:
            return "y", "v", "F"
        motions = [f"{name}.{x}" for name, body in e.bodies.items() if body.tied_to is None for x in ("y", "v")]
        forces = [*(f"{name}.F" for name in e.contacts), *(f"{name}.f" for name in e.links)]
        return (*motions, *forces)

    @cached_property
    def tables(self) -> dict[str, tuple[dict[str, Constant], bool]]:
        """The run-time constants by table, and whether the table is of something that turns."""
        tables: dict[str, tuple[dict[str, Constant], bool]] = {}
        for leaf, turns in self.elements.leaves:
            path, name = leaf.key
            tables.setdefault(path, ({}, turns))[0][name] = leaf.constant
        return tables | {use.path: (constants, False) for use in self.signals if (constants := use.constants())}

    @cached_property
    def parameters(self) -> tuple[Key, ...]:
        """(table, name) of each run-time constant, in the order in which compiled code takes them."""
        return tuple((path, name) for path, (constants, _) in self.tables.items() for name in constants)

    def constant(self, owner: str, name: str) -> Constant:
        """The declaration of a run-time constant, with the unit and the words that it has there."""
        constants, rotary = self.tables[owner]
        return constants[name].of_motion(rotary)

    def field(self, owner: str, name: str) -> str:
        """``mesh_F_c`` for ``contacts.mesh.law`` and F_c; F_c where elements have no names."""
        if self.elements.unnamed:
            return name
        _, element, *inner = owner.split(".")
        if inner == ["compensation"]:
            return f"{element}_compensated_{name}"  # a law of its own may have a constant of that name
        inner = ["model" if word == "compensation" else word for word in inner if word not in ("law", "signal")]
        return "_".join((element, *inner, name))

    @cached_property
    def piece_fields(self) -> tuple[str, ...]:
        """The numbers of all signals' pieces."""
        return tuple(joined(signal.name, name, "_") for signal in self.signals for name in signal.fields)

    @property
    def heading(self) -> tuple[str, ...]:
        """A description for the head of the generated code."""
        e = self.elements
        if e.unnamed:
            law = e.contacts[""].friction.kind
            servo = [x.heading(e) for x in e.controllers.values() if x.moves_valve]
            return (f"Law: {law.name}. {law.__doc__}", f"Source: {law.source}", *servo)
        lines = [f"A machine of {len(e.bodies)} bod{'y' if len(e.bodies) == 1 else 'ies'}: {', '.join(e.bodies)}."]
        return (*lines, *(text for each in e if (text := each.heading(e))))

    # -- equations -------------------------------------------------------------------------------------------------

    @cached_property
    def _sampled(self) -> list[AnyController]:
        return [each for each in self.elements.controllers.values() if each.sampling is not None]

    @cached_property
    def held(self) -> tuple[str, ...]:
        """The outputs of the sampled controllers."""
        return tuple(each.name_of("u", "_") for each in self._sampled)

    @cached_property
    def shown(self) -> tuple[str, ...]:
        """The entries of the controllers' memory that an output needs: the first ones."""
        memory, needed = list[str](), 0
        for each in self._sampled:
            needed = len(memory) + len(shown) if (shown := each.shown()) else needed
            memory += [each.name_of(name, "_") for name in each.memory(self.elements)]
        return tuple(memory[:needed])

    @property
    def memory(self) -> dict[str, tuple[str, ...]]:
        """The memory of each sampled controller, by its name."""
        return {each.name: each.memory(self.elements) for each in self._sampled}

    def assembly(self, exact: bool = False, called: Names | None = None) -> Assembly:
        """All quantities of the machine as expressions; ``exact``: as an output shows them at one instant."""
        return Assembly(self.elements, called, exact)

    def forces(self, called: Names | None = None) -> list[Expr]:
        """The friction force of each contact."""
        quantities = self.assembly(called=called).k
        return [wrap(quantities[contact.name_of("F")]) for contact in self.contacts]

    def rates(self, called: Names | None = None) -> list[Expr]:
        """The time derivatives of the states. Here and below, ``called`` takes the names of intermediate results."""
        rates = self.assembly(called=called).rates
        return [rates[state.name] for state in self.states]

    @cached_property
    def watching(self) -> tuple[Element, ...]:
        """The elements of which a quantity is watched: slip and stick of each contact, the flanks of each play, the limit of
        each controller."""
        a = self.assembly()
        return tuple(each for each in (*self.contacts, *self.links, *self.controllers) if each.watches(a) is not None)

    @cached_property
    def watched(self) -> tuple[Watched, ...]:
        """The elements and events that are watched, without the quantities."""
        return tuple((watch.element, watch.events) for watch in self.watches())

    def watches(self, called: Names | None = None) -> list[Watch]:
        """The same with the quantities."""
        a = self.assembly(called=called)
        watches = ((each.name, each.watches(a)) for each in self.watching)
        return [Watch(name, watch[1], watch[0]) for name, watch in watches if watch is not None]

    def samples(self, called: Names | None = None) -> list[Sample]:
        """The update of each sampled controller at its instants, in the order of :attr:`held`."""
        a = self.assembly(called=called)
        return [each.sample(a) for each in self._sampled]

    def ended(self, values: Mapping[Key, float], t: float, x: Array) -> str | None:
        """Why the equations of a body end in the state x."""
        motion = {state.name: float(x[i]) for i, state in enumerate(self.states)}
        for body in (each for each in self.elements.with_values(values).bodies.values() if each.free):
            if text := body.ended(t, motion[body.name_of("y")], motion[body.name_of("v")]):
                return f"{body.name}: {text}" if body.name else text
        return None

    def moved_energy(self) -> Expr | None:
        """The energy of the links whose far end is a signal."""
        return self.assembly().moved_energy() if self.energy else None

    @cached_property
    def outputs(self) -> dict[str, Expr]:
        """Every column as an expression of t, the states, what sampled controllers hold, and the constants."""
        energies = [c.name for c in self.columns if c.name.startswith("E_")] if self.energy else []
        listed = [(c.name, quantity) for c, quantity in self.elements.listed] or [
            (c.name, c.name) for c in self.columns
        ]
        return self.assembly(exact=True).outputs([*listed, *((name, name) for name in energies)])

    def output_columns(
        self, values: Mapping[Key, Value], segment: Mapping[str, Value], t: Array, states: Mapping[str, Array],
        wanted: Sequence[str] = (),
    ) -> dict[str, Value]:  # fmt: skip
        """The ``wanted`` columns by name, all unless given; the other arguments are those of :meth:`evaluated`."""
        names = wanted or tuple(self.outputs)
        columns = self.evaluated(tuple(self.outputs[name] for name in names), values, segment, t, states)
        return dict(zip(names, columns, strict=True))

    def evaluated(
        self, quantities: tuple[Expr, ...], values: Mapping[Key, Value], segment: Mapping[str, Value], t: Value,
        states: Mapping[str, Value],
    ) -> tuple[Value, ...]:  # fmt: skip
        """Quantities from constants, numbers of the signals' pieces and held outputs, times and states; whatever shapes go
        together."""
        inputs: dict[str, Value] = {f"{path}.{name}": values[path, name] for path, name in self.parameters}
        kind = {**dict.fromkeys(segment, "segment"), **dict.fromkeys(self.shown, "memory")}
        inputs |= {f"{kind[name]}.{name}": x for name, x in segment.items()} | {"t": t, **states}
        function = _function(tuple(inputs), quantities)
        with np.errstate(all="ignore"):
            return function(*inputs.values())

    # -- variants ----------------------------------------------------------------------------------------------------

    def with_energy(self) -> MachineSystem:
        """The same machine, whose output has the columns of energy."""
        return replace(self, elements=replace(self.elements, energy=True))


@lru_cache(maxsize=64)
def interned(system: MachineSystem) -> MachineSystem:
    """The first of equal structures: what it finds out about itself, it finds once."""
    return system


@lru_cache(maxsize=32)
def _function(names: tuple[str, ...], quantities: tuple[Expr, ...]) -> Callable[..., tuple[Value, ...]]:
    """A Python function of the inputs ``names`` for the quantities of a machine."""
    return python_function(names, quantities)
