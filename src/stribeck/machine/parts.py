"""The structure of a machine: what it is made of and how that is wired, without any values.

Two machines that differ in numbers only have equal parts, and share compiled code. A part's ``path`` is the one by which
the file and the run-time constants name it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, is_dataclass, replace
from dataclasses import fields as fields_of
from functools import cached_property
from types import SimpleNamespace
from typing import ClassVar, TypeVar, cast

from stribeck.constants import Constant
from stribeck.control.sampled import Sampled
from stribeck.drives.base import Column, Drive
from stribeck.expressions.graph import Expr, symbol
from stribeck.expressions.names import Names
from stribeck.laws.base import Law
from stribeck.laws.form import Form
from stribeck.laws.values import Constants
from stribeck.machine.controllers import ControllerElement
from stribeck.machine.dither import DitherPart
from stribeck.machine.element import Element
from stribeck.machine.links import LinkElement
from stribeck.machine.loads import LoadElement
from stribeck.machine.motors import MotorElement
from stribeck.plants import Mass, Plant
from stribeck.signals import Signal
from stribeck.signals.pieces import DIRECTION, Reference, constants, fields, reference

RATIO = Constant("", "how far `from` counts", default=1.0)
RATIO_LARGEST = 1e30  # and its inverse the smallest: squares of it, times a mass, stay numbers
RATIO_ALLOWED = f"a finite number from {1 / RATIO_LARGEST:g} to {RATIO_LARGEST:g}, or the negative of one"
INPUT = "input"  # what an exported machine adds to a signal
_INPUT = Constant("", "added to the signal", default=0.0)
Named = dict[str, Constant]
_Part = TypeVar("_Part")


def joined(name: str, word: str, by: str = ".") -> str:
    """What an element's quantity is called: ``arm.y``; ``y`` of an element without a name, the only one of its kind."""
    return f"{name}{by}{word}" if name else word


def symbols_of(path: str) -> Callable[[str], Expr]:
    """What makes the symbol of a constant of the table ``path``."""
    return lambda name: symbol(f"{path}.{name}")


@dataclass(frozen=True)
class SignalUse:
    """A signal of the machine: a name for its numbers in the code, its table, its kind (None: straight pieces), whether
    it is cut where it turns, and whether something is added to it from outside (an export's input)."""

    name: str
    path: str
    kind: type[Signal] | None
    turns: bool = False
    open: bool = False

    @property
    def fields(self) -> tuple[str, ...]:
        """The numbers of a piece."""
        return fields(self.kind, self.turns)

    def constants(self) -> Named:
        """The constants of a run."""
        own = {n: self.kind.constants[n] for n in constants(self.kind)} if self.kind else {}
        return {**own, INPUT: _INPUT} if self.open else own

    def reference(self, t: Expr) -> Reference:
        """The signal and its derivatives at the time t."""
        values = {n: symbol(f"segment.{joined(self.name, n, '_')}") for n in self.fields}
        values |= {n: symbol(f"{self.path}.{n}") for n in self.constants()}
        found = reference(self.kind, SimpleNamespace(**values), t, values.get(DIRECTION, 0.0))
        return replace(found, value=found.value + values[INPUT]) if self.open else found


@dataclass(frozen=True)
class BodyPart:
    """A body: ``leader`` where it is tied to another, ``driven`` where its velocity is given; ``plant`` is what it is
    beside a mass, such as the piston of a cylinder."""

    name: str
    rotary: bool
    inertia: bool = True  # False: none is given
    leader: str | None = None
    ratio: bool = False
    driven: SignalUse | None = None
    plant: type[Plant] = Mass

    @property
    def path(self) -> str:
        """Its table."""
        return f"bodies.{self.name}" if self.name else "plant"

    @property
    def inertia_name(self) -> str:
        """What its inertia is called."""
        return "inertia" if self.rotary else "mass"

    def constants(self) -> Named:
        """The constants of a run."""
        mass = Constant("kg", "mass", above=0, rotary_unit="kg m^2")
        moment = Constant("kg m^2", "moment of inertia", above=0)
        found = {self.inertia_name: moment if self.rotary else mass} if self.inertia else {}
        if self.plant is not Mass:
            found = self.plant.constants
        return {**found, **({"ratio": RATIO} if self.ratio else {})}

    @cached_property
    def p(self) -> SimpleNamespace:
        """Its constants as symbols."""
        return SimpleNamespace(**{n: symbol(f"{self.path}.{n}") for n in self.constants()})


@dataclass(frozen=True)
class Span:
    """Between what an element acts: ``start`` is a body's name or a signal, ``end`` a body's name or None, the ground."""

    start: str | SignalUse
    end: str | None
    ratio: bool = False

    def constants(self) -> Named:
        """The constants of a run."""
        return {"ratio": RATIO} if self.ratio else {}


class _ElementPart:
    """What stands in a table of its own and has constants."""

    section: ClassVar[str]
    name: str
    kind: type[Element]
    form: Form

    @property
    def path(self) -> str:
        """Its table."""
        return f"{self.section}.{self.name}"

    @cached_property
    def p(self) -> SimpleNamespace:
        """Its constants as symbols."""
        return self.kind.symbolic(symbols_of(self.path), self.form)


@dataclass(frozen=True)
class LinkPart(_ElementPart):
    """A link between two bodies."""

    section: ClassVar[str] = "links"

    name: str
    kind: type[LinkElement]
    form: Form
    span: Span


@dataclass(frozen=True)
class Factor:
    """What a parameter of a contact is multiplied by: a signal, or so many waves of the position."""

    of: str
    path: str
    signal: SignalUse | None
    waves: int = 0


@dataclass(frozen=True)
class Level:
    """A load that raises a contact's level: the elements whose forces count, and which have a weight.

    ``against``: only while this force has the other sign and is the larger one, and then by the square.
    """

    path: str
    sources: tuple[str, ...]
    weighted: bool
    gains: tuple[str, ...]
    against: str | None = None


@dataclass(frozen=True)
class ContactPart:
    """Friction between two bodies."""

    name: str
    law: type[Law]
    form: Form
    span: Span
    levels: tuple[Level, ...] = ()
    factors: tuple[Factor, ...] = ()

    @property
    def path(self) -> str:
        """Its table."""
        return f"contacts.{self.name}"

    @property
    def law_path(self) -> str:
        """The table of its law."""
        return f"{self.path}.law" if self.name else "law"


@dataclass(frozen=True)
class LoadPart(_ElementPart):
    """A force on a body."""

    section: ClassVar[str] = "loads"

    name: str
    kind: type[LoadElement]
    form: Form
    on: str
    signal: SignalUse | None = None


@dataclass(frozen=True)
class MotorPart(_ElementPart):
    """A motor on a body; ``signal`` is its voltage where no controller asks for a current."""

    section: ClassVar[str] = "motors"

    name: str
    form: Form
    on: str
    signal: SignalUse | None = None
    kind: type[MotorElement] = MotorElement

    @property
    def has_inductance(self) -> bool:
        """Whether its current is a state."""
        return "L" in self.form


@dataclass(frozen=True)
class CompensationPart:
    """Which law a controller takes the friction for, and at which speed."""

    law: type[Law]
    form: Form
    path: str  # of the law's table: the contact's, or one of its own
    speed: str  # "reference" or "measured"
    share: bool = False  # whether a share of it other than the whole is given
    lead: bool = False  # whether lead dF/dt is added, so that an inner loop that lags follows F

    def symbolic(self, called: Names) -> Constants:
        """The law's constants as symbols."""
        return self.law.symbolic(symbols_of(self.path), self.form, called.term)

    @property
    def observes(self) -> bool:
        """Whether a deflection of its own is followed."""
        return self.speed == "measured" and self.law.has_z


@dataclass(frozen=True)
class ControllerPart(_ElementPart):
    """A controller on a motor or a body."""

    section: ClassVar[str] = "controllers"

    name: str
    kind: type[ControllerElement]
    form: Form
    on: str
    measures: str
    signal: SignalUse
    feedforward: bool = False
    compensation: CompensationPart | None = None
    sampling: Sampled | None = None
    dither: DitherPart | None = None

    @property
    def states(self) -> tuple[str, ...]:
        """The names of its own states and of its observer's."""
        own = tuple(state.name for state in self.kind.states_of(self.form))
        return (*own, "z_hat") if self.compensation is not None and self.compensation.observes else own


@dataclass(frozen=True)
class DrivePart:
    """What moves a body, and gives what that takes: a force, or the voltage of a cylinder's valve."""

    name: str
    drive: Drive
    on: str
    signal: SignalUse

    @property
    def path(self) -> str:
        """Its table."""
        return f"controllers.{self.name}" if self.name else "drive"

    def table(self, owner: str) -> str:
        """The path of one of the drive's tables (:attr:`Drive.tables`)."""
        if not self.name:
            return owner
        return self.path if owner == "drive" else f"{self.path}.{owner}"

    def constants(self) -> dict[str, Named]:
        """The constants of a run by table."""
        return {self.table(owner): constants for owner, constants in self.drive.tables.items()}

    @property
    def output(self) -> str:
        """What its held output is called."""
        return joined(self.name, "u", "_")

    @property
    def columns(self) -> tuple[Column, ...]:
        """What the output has of one with a name, beside the body's columns: the signal, the output, and the rest."""
        motion = tuple(Column(n, "", "") for n in ("y", "v", "z", "F"))
        own = [c for c in self.drive.listed(motion, ()) if c.name not in ("y", "v", "z", "F", "u")]
        return (replace(self.drive.signal, name="r"), self.drive.gives, *own)


def with_inputs(part: _Part) -> _Part:
    """A machine, or a part of one, to whose signals something can be added from outside; not to those that multiply
    parameters, which must stay positive."""
    if isinstance(part, SignalUse):
        return part if ".factors." in part.path else replace(part, open=True)
    if isinstance(part, tuple):
        return cast(_Part, tuple(map(with_inputs, part)))
    if is_dataclass(part) and not isinstance(part, type):
        return replace(part, **{field.name: with_inputs(getattr(part, field.name)) for field in fields_of(part)})
    return part
