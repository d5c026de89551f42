"""How the piston of a cylinder obeys the pressures that its cascade asks for; and what the cascade does.

A drive writes its equations with plain names (``y``, ``drive.K_D``, ``segment.u``); in a machine with several bodies they
become those of its body and of its own tables.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import TYPE_CHECKING

from stribeck.constants import Column, Constant
from stribeck.control.cascade import Action, Course, Motion, PressureCascade, course
from stribeck.control.cylinder import Cylinder
from stribeck.equations import Sample
from stribeck.expressions.graph import ZERO, Expr, substitute, symbol, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value
from stribeck.machine.signal import SignalUse
from stribeck.machine.table import joined

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.elements.contacts import Contact
    from stribeck.machine.elements.cylinder import Piston

_T = symbol("t")


@dataclass(frozen=True)
class DrivePart:
    """What moves a body, and gives what that takes: a force, or the voltage of a cylinder's valve."""

    name: str
    drive: PressureCascade
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

    def constants(self) -> dict[str, dict[str, Constant]]:
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


def act(a: Assembly, body: Piston) -> None:
    """A piston under the forces on it and what its drive does: its rates, and what the output shows."""
    y, v = a.motion(body.name)
    drive = a.drive_on(body.name)
    F = wrap(-a.force[body.name])  # what holds it back: friction, links, less the loads
    inner = tuple(symbol(body.of(state.name)) for state in body.states)
    p, u = _constants(a, body), ZERO
    if drive is not None:
        action, rename = _action(a, body, drive, F)
        own = {n: rename.one(x) for n, x in vars(_symbols(drive, "drive")).items()}
        p = drive.drive.obeyed(p, SimpleNamespace(**own))
        u = rename.one(action.u)
        a.called.give(u, joined(drive.name, "u", "_"))
        shown = {joined(drive.name, name): rename.one(x) for name, x in action.shown.items()}
        shown |= {joined(drive.name, state.name): symbol(joined(drive.name, state.name)) for state in drive.drive.kept}
        first = drive.drive.signal.name if not drive.name else "r"
        signal = wrap(drive.signal.reference(_T).value)
        a.k |= {joined(drive.name, first): signal, **shown, joined(drive.name, "u"): u}
        a.rates |= {
            joined(drive.name, s.name): rename.one(x) for s, x in zip(drive.drive.kept, action.rates, strict=True)
        }
    rates = Cylinder.rates(p, y, v, u, F, inner)
    rates_of = {s.name: x for s, x in zip(body.states, rates, strict=True)}
    body.obey_rates(a, wrap(Cylinder.acceleration(p, u, F, inner)), rates_of)


def _constants(a: Assembly, body: Piston) -> SimpleNamespace:
    """A piston's constants; its mass is that of all that is tied to it, seen from it."""
    return SimpleNamespace(**{**body.constants, "mass": a.inertia[body.name]})


def _action(a: Assembly, body: Piston, drive: DrivePart, F: Expr) -> tuple[Action, _Renamed]:
    """What a drive does, and how its names become the machine's."""
    called = a.called if not drive.name else None
    rename = _Renamed(drive, body, a.called)
    motion = measured(a, body, drive, F)
    a.called.give(motion.acceleration, joined(body.name, "acceleration", "_"))
    return drive.drive.act(_symbols(drive, "drive"), motion, called), rename


def measured(a: Assembly, body: Piston, drive: DrivePart, F: Expr) -> Motion:
    """What a drive may measure: not what depends on what it does at the same instant."""
    y, v = a.motion(body.name)
    inner = tuple(symbol(joined(body.name, state.name)) for state in body.states)
    own = tuple(symbol(joined(drive.name, state.name)) for state in drive.drive.kept)
    p = _constants(a, body)
    before = Cylinder.acceleration(p, 0.0, F, inner)
    contact = contact_of(a, body.name)
    z = None if contact is None or not contact.has_z else a.k[contact.of("z")]
    law = SimpleNamespace() if contact is None else contact.friction.p
    r = drive.signal.reference(_T).value
    return Motion(r, y, v, inner, own, z, F, before, p, law)


def contact_of(a: Assembly, body: str) -> Contact | None:
    """The first contact of a body with the ground."""
    found = (x for x in a.system.contacts.values() if x.start == body and x.end == "ground")
    return next(found, None)


def sample_of(a: Assembly, drive: DrivePart, called: Names) -> Sample:
    """What a sampled drive does at its instants."""
    body: Piston = a.system.bodies[drive.on]  # type: ignore[assignment]
    rename = _Renamed(drive, body, called)
    motion = measured(a, body, drive, wrap(-a.force[body.name]))
    path: Course = course(wrap(drive.signal.reference(_T).value), _T)
    u, after = drive.drive.sample(path, motion, called)
    memory = {joined(drive.name, n, "_"): rename.one(after[n]) for n in drive.drive.memory}
    return Sample(drive.name or drive.drive.kind, drive.table("sampling"), rename.one(u), memory)


def _symbols(drive: DrivePart, owner: str) -> SimpleNamespace:
    """The constants of one of a drive's tables, as it names them."""
    return SimpleNamespace(**{n: symbol(f"{owner}.{n}") for n in drive.drive.tables[owner]})


class _Renamed:
    """The plain names of a drive's equations as those of its body, its tables, its states and its memory."""

    def __init__(self, drive: DrivePart, body: Piston, called: Names) -> None:
        self.known: dict[Expr, Expr] = {}
        self.called = called
        if not drive.name:
            return
        moving = ("y", "v", *(state.name for state in body.states))
        self.known = {symbol(n): symbol(joined(body.name, n)) for n in moving}
        self.known |= {symbol(s.name): symbol(joined(drive.name, s.name)) for s in drive.drive.kept}
        for owner, constants in drive.drive.tables.items():
            self.known |= {symbol(f"{owner}.{n}"): symbol(f"{drive.table(owner)}.{n}") for n in constants}
        for name in drive.drive.memory:
            self.known[symbol(f"memory.{name}")] = symbol(f"memory.{joined(drive.name, name, '_')}")
        self.known[symbol("segment.u")] = symbol(f"segment.{drive.output}")

    def one(self, value: Value) -> Expr:
        """An expression in the machine's names."""
        node = wrap(value)
        return substitute([node], self.known, self.called)[0] if self.known else node
