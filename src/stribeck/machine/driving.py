"""How a body obeys: a mass the sum of forces on it, another plant what its drive gives; and what the drive does.

A drive writes its equations with plain names (``y``, ``drive.K_D``, ``segment.u``); in a machine with several bodies they
become those of its body and of its own tables.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import TYPE_CHECKING

from stribeck.drives.base import Action, Course, Motion, course
from stribeck.equations import Sample
from stribeck.expressions.graph import ZERO, Expr, substitute, symbol, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value, where
from stribeck.machine.parts import BodyPart, ContactPart, DrivePart, joined, symbols_of
from stribeck.plants import Mass

if TYPE_CHECKING:
    from stribeck.machine.balance import Balance

_T = symbol("t")


@dataclass(frozen=True)
class Driven:
    """How a body moves: dv/dt, the rates of its own states and of its drive's, what the output shows, and its energy."""

    acceleration: Expr
    rates: dict[str, Expr]
    shown: dict[str, Expr]
    power: Expr
    lost: Expr
    stored: Expr


def act(balance: Balance, body: BodyPart, drive: DrivePart | None) -> Driven:
    """A free body under the forces on it and what its drive does."""
    y, v = balance.motion(body.name)
    F = wrap(-balance.force[body.name])  # what holds it back: friction, links, less the loads
    inner = tuple(symbol(joined(body.name, state.name)) for state in body.plant.states)
    p, u = _constants(balance, body), ZERO
    rates: dict[str, Expr] = {}
    shown: dict[str, Expr] = {}
    if drive is not None:
        action, rename = _action(balance, body, drive, F)
        p = drive.drive.obeyed(p, _symbols(drive, "drive"))
        u = rename.one(action.u)
        shown = {joined(drive.name, name): rename.one(x) for name, x in action.shown.items()}
        shown |= {joined(drive.name, state.name): symbol(joined(drive.name, state.name)) for state in drive.drive.kept}
        first = drive.drive.signal.name if not drive.name else "r"
        shown = {joined(drive.name, first): wrap(drive.signal.reference(_T).value), **shown, joined(drive.name, "u"): u}
        rates = {joined(drive.name, s.name): rename.one(x) for s, x in zip(drive.drive.kept, action.rates, strict=True)}
    acceleration = wrap(body.plant.acceleration(p, u, F, inner))
    if (inside := body.plant.inside(p, y)) is not None:
        acceleration = wrap(where(inside, acceleration, float("nan")))
    own = body.plant.rates(p, y, v, u, F, inner)
    rates |= {joined(body.name, s.name): wrap(x) for s, x in zip(body.plant.states, own, strict=True)}
    if not balance.machine.energy:
        return Driven(acceleration, rates, shown, ZERO, ZERO, ZERO)
    lost, stored = body.plant.lost_power(p, y, v, u, inner), body.plant.stored_energy(p, y, v, inner)
    return Driven(acceleration, rates, shown, wrap(u * v), wrap(lost), wrap(stored))


def _constants(balance: Balance, body: BodyPart) -> SimpleNamespace:
    """A body's constants; its mass is that of all that is tied to it, seen from it."""
    own = vars(body.p)
    if body.inertia_name in own or body.plant is Mass:
        own = {**own, "mass": balance.inertia[body.name]}
    return SimpleNamespace(**own)


def _action(balance: Balance, body: BodyPart, drive: DrivePart, F: Expr) -> tuple[Action, _Renamed]:
    """What a drive does, and how its names become the machine's."""
    called = balance.called if not drive.name else None
    rename = _Renamed(drive, body, balance.called)
    motion = measured(balance, body, drive, F)
    if not drive.name:
        for name, value in (("acceleration", motion.acceleration),):
            balance.called.give(value, name)
    return drive.drive.act(_symbols(drive, "drive"), motion, called), rename


def measured(balance: Balance, body: BodyPart, drive: DrivePart, F: Expr) -> Motion:
    """What a drive may measure: not what depends on what it does at the same instant."""
    y, v = balance.motion(body.name)
    inner = tuple(symbol(joined(body.name, state.name)) for state in body.plant.states)
    own = tuple(symbol(joined(drive.name, state.name)) for state in drive.drive.kept)
    p = _constants(balance, body)
    before = body.plant.acceleration(p, 0.0, F, inner) if body.plant.states else 0.0
    contact = contact_of(balance, body.name)
    z = None if contact is None or not contact.law.has_z else balance.k[joined(contact.name, "z")]
    law = SimpleNamespace() if contact is None else contact.law.symbolic(symbols_of(contact.law_path), contact.form)
    r = drive.signal.reference(_T).value
    return Motion(r, y, v, inner, own, z, F, before, p, law)


def contact_of(balance: Balance, body: str) -> ContactPart | None:
    """The first contact of a body with the ground."""
    found = (x for x in balance.machine.contacts if x.span.start == body and x.span.end is None)
    return next(found, None)


def sample_of(balance: Balance, drive: DrivePart, called: Names) -> Sample:
    """What a sampled drive does at its instants."""
    body = balance.machine.body[drive.on]
    rename = _Renamed(drive, body, called)
    motion = measured(balance, body, drive, wrap(-balance.force[body.name]))
    path: Course = course(wrap(drive.signal.reference(_T).value), _T)
    u, after = drive.drive.sample(path, motion, called)
    memory = {joined(drive.name, n, "_"): rename.one(after[n]) for n in drive.drive.memory}
    return Sample(drive.name or drive.drive.kind, drive.table("sampling"), rename.one(u), memory)


def _symbols(drive: DrivePart, owner: str) -> SimpleNamespace:
    """The constants of one of a drive's tables, as it names them."""
    return SimpleNamespace(**{n: symbol(f"{owner}.{n}") for n in drive.drive.tables[owner]})


class _Renamed:
    """The plain names of a drive's equations as those of its body, its tables, its states and its memory."""

    def __init__(self, drive: DrivePart, body: BodyPart, called: Names) -> None:
        self.known: dict[Expr, Expr] = {}
        self.called = called
        if not drive.name:
            return
        moving = ("y", "v", *(state.name for state in body.plant.states))
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
