"""The base of machine elements: a named table, and its equations."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from pydantic import Field

from stribeck.constants import Column
from stribeck.expressions.graph import Expr
from stribeck.expressions.ops import Value
from stribeck.laws.base import Scales
from stribeck.machine.equations import Events
from stribeck.machine.family import Family
from stribeck.machine.law import Friction
from stribeck.machine.signal import SignalTable, SignalUse
from stribeck.machine.table import (
    FileTable,
    Held,
    Loc,
    Problem,
    Refers,
    annotation,
    below,
    joined,
    quantity,
    table_path,
    within,
)

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.machine import Elements
    from stribeck.machine.reading import Draft

SECTIONS = ("bodies", "links", "contacts", "loads", "motors", "controllers")  # of a file
GROUND = "ground"
BodyName = Annotated[str, Refers(("bodies",))]
BodyOrGround = Annotated[str, Refers(("bodies",), (GROUND,))]
Own = Mapping[str, Value]  # states by name, or their rates
NONE: Own = MappingProxyType({})  # of an element without states


@dataclass(frozen=True)
class State:
    """A state of an element beside its body's: its name, its unit and meaning, and where it starts."""

    name: str
    unit: str
    meaning: str
    start: float = 0.0


class Element(Family):
    """The base of bodies, links, contacts, loads, motors and controllers."""

    section: ClassVar[str]
    states: ClassVar[tuple[State, ...]] = ()
    follows_others: ClassVar[bool] = False  # whether what its table leaves out is as in another's
    positional: ClassVar[tuple[str, ...]] = ("name",)
    kind: str = ""
    name: str = Field("", exclude=True)

    @classmethod
    def _place(cls, values: tuple[object, ...], named: Mapping[str, object]) -> str:
        return table_path(cls.section, str(named.get("name", values[0] if values else "")))

    @property
    def path(self) -> str:
        """Its table."""
        return table_path(self.section, self.name)

    def name_of(self, word: str, by: str = ".") -> str:
        """The name of one of its quantities: ``gear.f``; ``f`` of an element without a name."""
        return joined(self.name, word, by)

    # -- what it says of itself: structure -------------------------------------------------------------------------

    def own_states(self, m: Elements) -> tuple[State, ...]:
        """The states that the equations have in this form."""
        return self.states

    def columns(self, m: Elements) -> list[Column]:
        """Its columns of the output."""
        return []

    def heading(self, m: Elements) -> str:
        """A description for the head of the generated code."""
        return ""

    def turning(self, m: Elements) -> bool:
        """Whether its forces are N m."""
        return False

    def whole(self) -> bool:
        """Whether nothing of it was left aside because it is in a file of code."""
        return True

    # -- what it does: equations -----------------------------------------------------------------------------------

    def equations(self, a: Assembly) -> None:
        """Take part: name quantities, act on bodies, give the rates of the states, account for energy."""

    def watches(self, a: Assembly) -> tuple[Events, Expr] | None:
        """A quantity whose passing of a level is an event, and what the events are called."""
        return None

    def level(self) -> Value:
        """That level; None where nothing is watched."""
        return None

    # -- what it is worth: numbers ---------------------------------------------------------------------------------

    def natural(self, scales: Mapping[str, Scales], m: Elements) -> dict[str, Value]:
        """Natural magnitudes of its states, for the default tolerances."""
        return {}

    def wiring(self, m: Draft) -> list[tuple[Loc, str]]:
        """Contradictions with other elements: place below its table, message."""
        return []

    def until(self, m: Elements, t_end: float) -> list[Problem]:
        """Contradictions with the end of a run: path, message."""
        return []

    def laws(self) -> list[tuple[str, Friction]]:
        """The friction laws in its table, by their paths."""
        return [(path, x) for path, x in everything(self, self.path) if isinstance(x, Friction)]

    def signals(self) -> Iterator[SignalUse]:
        """The references to the signals of its table in the equations; only of a structure."""
        yield from (x for _, x in everything(self, self.path) if isinstance(x, SignalUse))

    @property
    def use(self) -> SignalUse:
        """The reference to its first signal in the equations; only of a structure."""
        return next(self.signals())

    def followed(self) -> Iterator[SignalTable]:
        """Every signal in its table but the parts of sums, in the same order."""
        return _outermost(self)

    def references(self) -> Iterator[tuple[str, str, Refers]]:
        """The names of other elements in its table: path, name, which sections may have it."""
        tables = [(self.path, self), *((p, x) for p, x in everything(self, self.path) if isinstance(x, FileTable))]
        for path, table in tables:
            for field, info in type(table).model_fields.items():
                refers, value = annotation(info, Refers), getattr(table, field)
                if refers is None:
                    continue
                for name in value if isinstance(value, dict) else [value] if isinstance(value, str) else ():
                    yield below(path, (info.alias or field,)), name, refers


def everything(value: Held, path: str) -> Iterator[tuple[str, Held]]:
    """Whatever stands within a table, however deep, by its path as messages have it."""
    for inner_path, inner in within(value, path):
        yield inner_path, inner
        yield from everything(inner, inner_path)


def _outermost(value: Held) -> Iterator[SignalTable]:
    for _, each in within(value, ""):
        if isinstance(each, SignalTable):
            yield each
        else:
            yield from _outermost(each)


class FarEnd(FileTable):
    """The far end of a link, where that is moved."""

    signal: SignalTable = Field(description="a table with kind and its constants")


class BetweenBodies(Element):
    """An element between two bodies, along d = ratio y_from - y_to."""

    positional = ("name", "start", "end")
    if TYPE_CHECKING:  # each kind says what its ends may be
        start: Any
        end: str
        ratio: Any

    @property
    def far(self) -> Any:
        """The signal of the far end, where it has one."""
        return None if isinstance(self.start, str) else self.start.signal

    @property
    def ends(self) -> tuple[str, ...]:
        """The bodies at its ends: at the start first."""
        return tuple(x for x in (self.start, self.end) if isinstance(x, str) and x != GROUND)

    def turning(self, m: Elements) -> bool:
        """By the body at the end, or else at the start."""
        return next((m.bodies[x].turns for x in reversed(self.ends) if x in m.bodies), False)

    def wiring(self, m: Draft) -> list[tuple[Loc, str]]:
        """Both ends on one body."""
        same = self.start == self.end
        return [(("to",), f"{self.end!r}: must be another body than from, or 'ground'")] if same else []

    def between(self) -> str:
        """From where to where."""
        return f"{self.start if self.far is None else f'the signal {self.far.name}'} to {self.end}"


RATIO = "factor of the motion of `from`, d = ratio y_from - y_to; 1 unless given"
_RATIO_LARGEST = 1e30  # and its inverse the smallest: squares of it, times a mass, stay numbers


def ratio_constant(meaning: str = RATIO) -> Held:
    """A ratio, which takes part in the equations where it is given."""
    return quantity("", meaning, optional=True, largest=_RATIO_LARGEST)


def force_unit(rotary: bool) -> str:
    """Of a force or a torque."""
    return "N m" if rotary else "N"
