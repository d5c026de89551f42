"""A machine as one system of equations: M dv/dt = drives - sum of b f over the elements (docs/machines.md).

A law on a plant under a drive (``schema = 1``) is the smallest machine: one body, one contact and one drive, none of
which needs a name.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from types import SimpleNamespace

from stribeck.arrays import Array
from stribeck.constants import Constant
from stribeck.drives.base import Column
from stribeck.equations import SLIP_AND_STICK, Equations, Sample, Watch, Watched
from stribeck.expressions.graph import Expr
from stribeck.expressions.names import Names
from stribeck.machine.balance import Balance
from stribeck.machine.parts import (
    BodyPart,
    ContactPart,
    ControllerPart,
    DrivePart,
    LinkPart,
    LoadPart,
    MotorPart,
    Named,
    SignalUse,
    Span,
    joined,
)
from stribeck.machine.sampled import sampled_states, samples_of

_FACTOR = {
    "amplitude": Constant("", "amplitude of a wave of the factor"),
    "waves": Constant("rad/m", "2 pi over a wave's length", rotary_unit="1"),
    "phase": Constant("rad", "phase of a wave", default=0.0),
}
_GAIN = Constant("", "rise of the level by the force", at_least=0, default=0.0)
_WEIGHT = Constant("", "weight of a force in a load")
_FEEDFORWARD = Constant("kg", "force by the signal's second derivative", rotary_unit="kg m^2")
FEEDFORWARD = _FEEDFORWARD
FACTOR, GAIN, WEIGHT = _FACTOR, _GAIN, _WEIGHT
SHARE = Constant("", "share of the law's force that the controller adds", at_least=0)
LEAD = Constant("s", "lag of the inner loop that the force is led by: lead dF/dt is added", above=0)


@dataclass(frozen=True)
class MachineSystem(Equations):
    """The structure of a machine; bodies, elements, controllers and signals, each in the file's order."""

    bodies: tuple[BodyPart, ...]
    links: tuple[LinkPart, ...] = ()
    contacts: tuple[ContactPart, ...] = ()
    loads: tuple[LoadPart, ...] = ()
    motors: tuple[MotorPart, ...] = ()
    controllers: tuple[ControllerPart, ...] = ()
    signals: tuple[SignalUse, ...] = ()
    energy: bool = False
    drives: tuple[DrivePart, ...] = ()

    # -- what it is made of ----------------------------------------------------------------------------------------

    @cached_property
    def body(self) -> dict[str, BodyPart]:
        """The bodies by name."""
        return {body.name: body for body in self.bodies}

    @property
    def single(self) -> bool:
        """Whether it is a law on one body under a drive (``schema = 1``), whose columns need no names in front."""
        return any(not drive.name for drive in self.drives)

    @property
    def by_element(self) -> bool:
        """Whether events are told by the element's name."""
        return not self.single

    @property
    def drive(self) -> DrivePart:
        """What moves the one body of a machine without names."""
        (drive,) = self.drives
        return drive

    def drive_on(self, body: str) -> DrivePart | None:
        """What moves a body whose velocity is not given."""
        found = (x for x in self.drives if x.on == body and self.body[body].driven is None)
        return next(found, None)

    def rotary(self, name: str | None, other: str | SignalUse | None = None) -> bool:
        """Whether forces there are N m: by the body ``name``, or by ``other`` where that is the ground."""
        for each in (name, other):
            if isinstance(each, str) and each in self.body:
                return self.body[each].rotary
        return False

    @property
    def free(self) -> list[BodyPart]:
        """The bodies that have coordinates of their own and obey forces."""
        return [body for body in self.bodies if body.leader is None and body.driven is None]

    def leader(self, name: str) -> BodyPart:
        """The body whose coordinate a body has."""
        body = self.body[name]
        while body.leader is not None:
            body = self.body[body.leader]
        return body

    # -- what the code generator needs -----------------------------------------------------------------------------

    @cached_property
    def states(self) -> tuple[Column, ...]:
        """The states in the order in which they are integrated."""
        found: list[Column] = []
        for body in self.bodies:
            if body.leader is None:
                found.append(self._y(body))
                found += [self._v(body)] if body.driven is None else []
                found += self._inner(body)
        found += [self._z(contact) for contact in self.contacts if contact.law.has_z]
        for link in self.links:
            found += [Column(f"{link.name}.{s.name}", s.unit, s.meaning) for s in link.kind.states]
        for load in self.loads:
            found += [Column(f"{load.name}.{s.name}", s.unit, s.meaning) for s in load.kind.states]
        found += [Column(f"{m.name}.i", "A", "current") for m in self.motors if m.has_inductance]
        for each in self.controllers:
            if each.sampling is None:
                found += [Column(f"{each.name}.{n}", "", f"{n} of the controller") for n in each.states]
        found += [_of(drive.name, column) for drive in self.drives for column in drive.drive.kept]
        if self.energy:
            found += [_E_IN, _E_OUT]
        return tuple(found)

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The columns of the output after t."""
        energy = (_E_IN, _E_STORED, _E_OUT) if self.energy else ()
        if self.single:
            (body,), (contact,) = self.bodies, self.contacts
            motion = (self._y(body), self._v(body), self._z(contact), self._F(contact))
            return (*self.drive.drive.listed(motion, tuple(self._inner(body))), *energy)
        found = [column for body in self.bodies for column in (self._y(body), self._v(body), *self._inner(body))]
        for contact in self.contacts:
            rotary = self.rotary(contact.span.end, contact.span.start)
            found += [self._z(contact), self._F(contact)]
            found.append(Column(f"{contact.name}.w", "rad/s" if rotary else "m/s", "sliding speed"))
        found += [
            Column(f"{x.name}.f", _force(self.rotary(x.span.end, x.span.start)), "force of the link")
            for x in self.links
        ]
        found += [Column(f"{x.name}.f", _force(self.rotary(x.on)), "force of the load") for x in self.loads]
        for motor in self.motors:
            torque = Column(f"{motor.name}.torque", _force(self.rotary(motor.on)), "torque of the motor")
            found += [Column(f"{motor.name}.i", "A", "current"), Column(f"{motor.name}.V", "V", "voltage"), torque]
        for each in self.controllers:
            rotary = self.rotary(each.measures)
            found.append(Column(f"{each.name}.r", "rad" if rotary else "m", "reference"))
            found.append(Column(f"{each.name}.u", _force(rotary), "output of the controller"))
        for drive in self.drives:
            found += [_of(drive.name, column) for column in drive.columns]
        return (*found, *energy)

    @staticmethod
    def _y(body: BodyPart) -> Column:
        return Column(joined(body.name, "y"), "rad" if body.rotary else "m", "position")

    @staticmethod
    def _v(body: BodyPart) -> Column:
        return Column(joined(body.name, "v"), "rad/s" if body.rotary else "m/s", "velocity")

    @staticmethod
    def _inner(body: BodyPart) -> list[Column]:
        return [] if body.driven is not None else [_of(body.name, column) for column in body.plant.states]

    def _z(self, contact: ContactPart) -> Column:
        rotary = self.rotary(contact.span.end, contact.span.start)
        return Column(joined(contact.name, "z"), "rad" if rotary else "m", "mean bristle deflection")

    def _F(self, contact: ContactPart) -> Column:
        rotary = self.rotary(contact.span.end, contact.span.start)
        return Column(joined(contact.name, "F"), _force(rotary), "friction force")

    @cached_property
    def tables(self) -> dict[str, tuple[Named, bool]]:
        """The run-time constants by table, and whether the table is of something that turns."""
        found: dict[str, tuple[Named, bool]] = {}
        for body in self.bodies:
            found[body.path] = body.constants(), body.rotary
        for link in self.links:
            rotary = self.rotary(link.span.end, link.span.start)
            found[link.path] = {**link.kind.numbers(link.form), **link.span.constants()}, rotary
        for contact in self.contacts:
            found |= self._of_contact(contact)
        for load in self.loads:
            found[load.path] = load.kind.numbers(load.form), self.rotary(load.on)
        for motor in self.motors:
            found[motor.path] = motor.kind.numbers(motor.form), self.rotary(motor.on)
        for each in self.controllers:
            found |= self._of_controller(each)
        for drive in self.drives:
            found |= {path: (constants, False) for path, constants in drive.constants().items()}
        for signal in self.signals:
            found[signal.path] = signal.constants(), False
        return {path: (constants, rotary) for path, (constants, rotary) in found.items() if constants}

    def _of_contact(self, contact: ContactPart) -> dict[str, tuple[Named, bool]]:
        rotary = self.rotary(contact.span.end, contact.span.start)
        found = {contact.path: contact.span.constants(), contact.law_path: contact.law.numbers(contact.form)}
        for level in contact.levels:
            weights = {f"weight_{source}": _WEIGHT for source in level.sources} if level.weighted else {}
            found[level.path] = {**dict.fromkeys(level.gains, _GAIN), **weights}
        for factor in contact.factors:
            found[factor.path] = {f"{n}_{i}": c for n, c in _FACTOR.items() for i in range(factor.waves)}
        return {path: (constants, rotary) for path, constants in found.items()}

    def _of_controller(self, each: ControllerPart) -> dict[str, tuple[Named, bool]]:
        rotary = self.rotary(each.measures)
        found = {each.path: each.kind.numbers(each.form)}
        if each.feedforward:
            found[f"{each.path}.feedforward"] = {"inertia": _FEEDFORWARD}
        if each.compensation is not None and each.compensation.path.startswith(each.path):
            found[each.compensation.path] = each.compensation.law.numbers(each.compensation.form)
        if each.compensation is not None and (each.compensation.share or each.compensation.lead):
            on = {"share": (each.compensation.share, SHARE), "lead": (each.compensation.lead, LEAD)}
            found[f"{each.path}.compensation"] = {n: constant for n, (there, constant) in on.items() if there}
        if each.sampling is not None:
            found[f"{each.path}.sampling"] = each.sampling.numbers
        if each.dither is not None:
            found[each.dither.path] = each.dither.constants
        return {path: (constants, rotary) for path, constants in found.items()}

    @cached_property
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """(table, name) of each run-time constant, in the order in which compiled code takes them."""
        return tuple((path, name) for path, (constants, _) in self.tables.items() for name in constants)

    def constant(self, owner: str, name: str) -> Constant:
        """The declaration of a run-time constant, with the unit that it has there."""
        constants, rotary = self.tables[owner]
        found = constants[name]
        return replace(found, unit=found.rotary_unit) if rotary and found.rotary_unit is not None else found

    def field(self, owner: str, name: str) -> str:
        """``mesh_F_c`` for ``contacts.mesh.law`` and F_c."""
        if "." not in owner:
            return name
        _, element, *inner = owner.split(".")
        if inner == ["compensation"]:
            return f"{element}_compensated_{name}"  # a law of its own may have a constant of that name
        inner = ["model" if word == "compensation" else word for word in inner if word not in ("law", "signal")]
        return "_".join((element, *inner, name))

    @cached_property
    def piece_fields(self) -> tuple[str, ...]:  # type: ignore[override]
        """The numbers of all signals' pieces."""
        return tuple(joined(signal.name, name, "_") for signal in self.signals for name in signal.fields)

    @property
    def heading(self) -> tuple[str, ...]:
        """What this is, for the head of the generated code."""
        if self.single:
            law = self.contacts[0].law
            return (f"Law: {law.name}. {law.__doc__}", f"Source: {law.source}", *self.drive.drive.heading)
        lines = [f"A machine of {len(self.bodies)} bodies: {', '.join(self.body)}."]
        lines += [f"Link {link.name}: {_between(link.span)}." for link in self.links]
        lines += [f"Contact {x.name}: {_between(x.span)}, law {x.law.name}." for x in self.contacts]
        lines += [f"Load {load.name}: {load.kind.kind} on {load.on}." for load in self.loads]
        lines += [f"Motor {motor.name} on {motor.on}." for motor in self.motors]
        for each in self.controllers:
            how = "sampled" if each.sampling else "continuous"
            lines.append(f"Controller {each.name}: {each.kind.kind}, {how}, on {each.on}, measures {each.measures}.")
        lines += [f"{drive.name} on {drive.on}: {text}" for drive in self.drives for text in drive.drive.heading]
        return tuple(lines)

    # -- equations -------------------------------------------------------------------------------------------------

    @cached_property
    def held(self) -> tuple[str, ...]:
        """The outputs of the sampled controllers."""
        outputs = tuple(drive.output for drive in self.drives if drive.drive.memory)
        return (*outputs, *(f"{each.name}_u" for each in self.controllers if each.sampling is not None))

    @cached_property
    def shown(self) -> tuple[str, ...]:
        """What of the controllers' memory the output shows: as much of it from the first as has to be."""
        found: list[str] = []
        for drive in self.drives:
            if drive.drive.memory:
                found += [joined(drive.name, name, "_") for name in drive.drive.memory]
                last = len(drive.drive.memory) - len(drive.drive.shown)
        return tuple(found[: len(found) - last]) if found else ()

    def balance(self, exact: bool = False, called: Names | None = None) -> Balance:
        """All quantities of the machine as expressions; ``exact``: as an output shows them at one instant."""
        return Balance(self, exact, called)

    def rates(self, called: Names | None = None) -> list[Expr]:
        """The time derivatives of the states."""
        found = self.balance(called=called).rates()
        return [found[state.name] for state in self.states]

    @cached_property
    def watched(self) -> tuple[Watched, ...]:
        """Slip and stick of each contact, the flanks of each play, the limit of each controller."""
        found = [] if self.given_alone else [(contact.name, SLIP_AND_STICK) for contact in self.contacts]
        found += [(link.name, _FLANKS) for link in self.links if "gap" in link.form]
        found += [(x.name, _LIMIT) for x in self.controllers if x.sampling is None and "limit" in x.form]
        return tuple(found)

    @property
    def given_alone(self) -> bool:
        """Whether the only body's velocity is given: then the signal itself tells the events."""
        return self.single and self.bodies[0].driven is not None

    def watches(self, called: Names | None = None) -> list[Watch]:
        """The same with the quantities."""
        values = self.balance(called=called).watched()
        return [Watch(name, value, events) for (name, events), value in zip(self.watched, values, strict=True)]

    def samples(self, called: Names | None = None) -> list[Sample]:
        """What each sampled controller does at its instants, in the order of :attr:`held`."""
        return samples_of(self, Names() if called is None else called)

    def ended(self, values: Mapping[tuple[str, str], float], t: float, x: Array) -> str | None:
        """Why the equations of a body end in the state x."""
        at = {state.name: float(x[i]) for i, state in enumerate(self.states)}
        for body in self.free:
            p = SimpleNamespace(**{name: value for (path, name), value in values.items() if path == body.path})
            if text := body.plant.ended(p, t, at[joined(body.name, "y")], at[joined(body.name, "v")]):
                return f"{body.name}: {text}" if body.name else text
        return None

    def moved_energy(self) -> Expr | None:
        """The energy of the links whose far end is a signal."""
        return self.balance().moved_energy() if self.energy else None

    @property
    def memory(self) -> dict[str, tuple[str, ...]]:
        """What each sampled controller remembers, by its name."""
        own = {drive.name or drive.drive.kind: drive.drive.memory for drive in self.drives if drive.drive.memory}
        return own | {each.name: sampled_states(each) for each in self.controllers if each.sampling is not None}

    # -- the columns of the output ---------------------------------------------------------------------------------

    @cached_property
    def outputs(self) -> dict[str, Expr]:
        """Every column as an expression of t, the states, what sampled controllers hold, and the constants."""
        return self.balance(exact=True).outputs()


_FLANKS = ("flank_up", "flank_up_left", "flank_down", "flank_down_left")
_LIMIT = ("limit_reached", "limit_left", "limit_reached", "limit_left")
_E_IN = Column("E_in", "J", "energy put in")
_E_OUT = Column("E_dissipated", "J", "energy dissipated")
_E_STORED = Column("E_stored", "J", "kinetic energy, and energy of links, pendulums and bristles")


def _of(name: str, column: Column) -> Column:
    return replace(column, name=joined(name, column.name))


def _force(rotary: bool) -> str:
    return "N m" if rotary else "N"


def _between(span: Span) -> str:
    first = span.start if isinstance(span.start, str) else f"the signal {span.start.name}"
    return f"{first} to {span.end or 'ground'}"
