"""law + plant + drive -> one system of equations, for simulation, code and output columns alike.

A single body under a force and a pneumatic cylinder under a sampled controller with an observer are the same to it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from types import SimpleNamespace
from typing import Any, ClassVar

from stribeck.arrays import Array
from stribeck.constants import Constant
from stribeck.drives.base import Action, Column, Course, Drive, Motion, course
from stribeck.equations import Equations, Sample
from stribeck.expressions.emit import python_function
from stribeck.expressions.graph import Expr, derivative, symbol, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value, where
from stribeck.laws.base import Law
from stribeck.laws.form import Form
from stribeck.plants import Mass, Plant
from stribeck.signals import Signal
from stribeck.signals.pieces import constants, equation_of, fields

_Y, _V = Column("y", "m", "position"), Column("v", "m/s", "velocity")
_Z, _F = Column("z", "m", "mean bristle deflection"), Column("F", "N", "friction force")
_E_IN = Column("E_in", "J", "energy put into the body by the drive")
_E_OUT = Column("E_dissipated", "J", "energy dissipated by friction")
_E_STORED = Column("E_stored", "J", "kinetic energy and energy of the bristles")


@dataclass(frozen=True)
class Groups:
    """The constants of a system by their owner, as values or as symbols; ``signal`` holds the current piece where the
    signal is made of pieces."""

    law: SimpleNamespace
    plant: SimpleNamespace
    drive: SimpleNamespace
    signal: Any


@dataclass(frozen=True)
class System(Equations):
    """The structure of a simulation: which law, plant, drive and kind of signal, without any values.

    Two scenarios that differ in numbers only have equal systems, and share compiled code.
    """

    by_element: ClassVar[bool] = False

    law: type[Law]
    form: Form  # of the law's equations
    drive: Drive
    signal: type[Signal] | None  # None: made of straight pieces
    energy: bool = False
    plant: type[Plant] = Mass

    @property
    def _moved(self) -> type[Plant]:
        """The plant, or none where the drive sets the velocity."""
        return Nothing if self.drive.sets_velocity else self.plant

    @cached_property
    def states(self) -> tuple[Column, ...]:
        """The states in the order in which they are integrated."""
        body = (_Y,) if self.drive.sets_velocity else (_Y, _V)
        bristle = (_Z,) if self.law.has_z else ()
        energy = (_E_IN, _E_OUT) if self.energy else ()
        return (*body, *self._moved.states, *bristle, *self.drive.kept, *energy)

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The columns of the output after t."""
        energy = (_E_IN, _E_STORED, _E_OUT) if self.energy else ()
        return (*self.drive.listed((_Y, _V, _Z, _F), self._moved.states), *energy)

    @cached_property
    def groups(self) -> dict[str, dict[str, Constant]]:
        """The declarations of the run-time constants by owner."""
        signal = {n: self.signal.constants[n] for n in constants(self.signal)} if self.signal else {}
        law = self.law.numbers(self.form)
        return {"law": law, "plant": self._moved.constants, **self.drive.tables, "signal": signal}

    @cached_property
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """(group, name) of each run-time constant, in the order in which compiled code takes them."""
        return tuple((owner, name) for owner, constants in self.groups.items() for name in constants)

    def constant(self, owner: str, name: str) -> Constant:
        """The declaration of a run-time constant."""
        return self.groups[owner][name]

    @property
    def heading(self) -> tuple[str, ...]:
        """What this is, for the head of the generated code."""
        law = self.law
        return (f"Law: {law.name}. {law.__doc__}", f"Source: {law.source}", *self.drive.heading)

    # -- equations -------------------------------------------------------------------------------------------------

    def symbolic(self, called: Names | None = None) -> Groups:
        """The constants as symbols named ``group.name``; ``called`` takes the names of the law's terms."""

        def group(owner: str) -> SimpleNamespace:
            return SimpleNamespace(**{n: symbol(f"{owner}.{n}") for n in self.groups[owner]})

        on_term = None if called is None else called.term
        law = self.law.symbolic(lambda n: symbol(f"law.{n}"), self.form, on_term)
        return Groups(law, group("plant"), group("drive"), self._signal)

    @property
    def piece_fields(self) -> tuple[str, ...]:  # type: ignore[override]
        """The numbers of the signal's pieces."""
        return fields(self.signal)

    @property
    def _signal(self) -> SimpleNamespace:
        own = {n: symbol(f"segment.{n}") for n in self.piece_fields}
        return SimpleNamespace(**own, **{n: symbol(f"signal.{n}") for n in constants(self.signal)})

    def reference(self, t: Expr) -> Course:
        """The smooth signal at time t and its first three derivatives."""
        return course(self._desired(t), t)

    def _desired(self, t: Expr) -> Expr:
        return wrap(equation_of(self.signal).equation(self._signal, t))

    def quantities(self, q: Groups, r: Value, x: dict[str, Value], called: Names | None = None) -> dict[str, Value]:
        """Every named quantity from the signal's value r and the states."""
        return self._quantities(q, r, x, called)[0]

    def _quantities(
        self, q: Groups, r: Value, x: dict[str, Value], called: Names | None
    ) -> tuple[dict[str, Value], Motion, Action]:
        """The same, what the drive is told, and what it does."""
        plant, drive = self._moved, self.drive
        y, z = x["y"], x["z"] if self.law.has_z else 0.0 * x["y"]
        v = r if drive.sets_velocity else x["v"]
        inner, own = (tuple(x[s.name] for s in states) for states in (plant.states, drive.kept))
        dz_dt = self.law.dz_dt(q.law, v, z)
        F = self.law.friction(q.law, v, z, dz_dt)
        # what the drive measures must not depend on what it does at the same instant
        before = plant.acceleration(q.plant, 0.0, F, inner) if plant.states else 0.0
        for name, value in (("dz_dt", dz_dt), ("F", F), ("acceleration", before)):
            if called is not None:
                called.give(value, name)
        m = Motion(r, y, v, inner, own, z if self.law.has_z else None, F, before, q.plant, q.law)
        action = drive.act(q.drive, m, called)
        found = {drive.signal.name: r, **x, "y": y, "v": v, "z": z, "F": F, "dz_dt": dz_dt, "u": action.u}
        if self.energy:
            found["E_stored"] = self.law.stored_energy(q.law, z) + plant.stored_energy(q.plant, y, v, inner)
        return {**found, **action.shown}, m, action

    def rates(self, called: Names | None = None) -> list[Expr]:
        """The time derivatives of the states as expressions of ``t``, the states' names and the constants' symbols."""
        q, t, x = self.symbolic(called), symbol("t"), {state.name: symbol(state.name) for state in self.states}
        k, m, action = self._quantities(q, self._desired(t), x, called)
        plant, p, u = self._moved, self.drive.obeyed(q.plant, q.drive), action.u
        rates = {"y": m.v, "z": k["dz_dt"], "v": plant.acceleration(p, u, m.F, m.plant)}
        if (inside := plant.inside(p, m.y)) is not None:
            rates["v"] = where(inside, rates["v"], float("nan"))
        rates |= zip((s.name for s in plant.states), plant.rates(p, m.y, m.v, u, m.F, m.plant), strict=True)
        rates |= zip((s.name for s in self.drive.kept), action.rates, strict=True)
        if self.energy:
            stored_by_z = derivative(wrap(self.law.stored_energy(q.law, x["z"])), x["z"]) if self.law.has_z else 0.0
            lost = plant.lost_power(p, m.y, m.v, u, m.plant)
            rates |= {"E_in": u * m.v, "E_dissipated": m.F * m.v - stored_by_z * k["dz_dt"] + lost}
        return [wrap(rates[state.name]) for state in self.states]

    @property
    def held(self) -> tuple[str, ...]:
        """What a sampled drive gives."""
        return (self.drive.gives.name,) if self.drive.memory else ()

    @property
    def shown(self) -> tuple[str, ...]:
        """What of a sampled drive's memory the output shows."""
        return self.drive.shown

    @property
    def memory(self) -> dict[str, tuple[str, ...]]:
        """What a sampled drive remembers."""
        return {self.drive.kind: self.drive.memory} if self.drive.memory else {}

    def samples(self, called: Names | None = None) -> list[Sample]:
        """What a sampled drive does at its instants."""
        if not self.drive.memory:
            return []
        called, t = Names() if called is None else called, symbol("t")
        m = self._quantities(self.symbolic(), self._desired(t), {s.name: symbol(s.name) for s in self.states}, None)[1]
        u, after = self.drive.sample(self.reference(t), m, called)
        return [Sample(self.drive.kind, "sampling", wrap(u), {n: wrap(after[n]) for n in self.drive.memory})]

    def ended(self, values: Mapping[tuple[str, str], float], t: float, x: Array) -> str | None:
        """Why the plant's equations end in the state x."""
        p = SimpleNamespace(**{name: value for (owner, name), value in values.items() if owner == "plant"})
        at = {state.name: float(x[i]) for i, state in enumerate(self.states)}
        return None if self.drive.sets_velocity else self.plant.ended(p, t, at["y"], at["v"])

    # -- the columns of the output ---------------------------------------------------------------------------------

    @cached_property
    def outputs(self) -> dict[str, Expr]:
        """Every column as an expression of t, the states (and what a sampled controller holds) and the constants."""
        k = self.quantities(self.symbolic(), self._desired(symbol("t")), {s.name: symbol(s.name) for s in self.states})
        return {column.name: wrap(k[column.name]) for column in self.columns}

    def table(self, inputs: dict[str, Value]) -> dict[str, Value]:
        """Every column of the output by name, from the values of whatever symbols it is made of."""
        return dict(zip(self.outputs, _columns(self, tuple(inputs))(*inputs.values()), strict=True))


@lru_cache(maxsize=32)
def _columns(system: System, names: tuple[str, ...]) -> Callable[..., tuple[Value, ...]]:
    return python_function(names, list(system.outputs.values()))


class Nothing(Plant):
    """What stands under a drive that sets the velocity."""

    kind = "nothing"

    @staticmethod
    def acceleration(p: SimpleNamespace, u: Value, F: Value, x: tuple[Value, ...] = ()) -> Value:
        """Not a state's."""
        return 0.0

    @staticmethod
    def stored_energy(p: SimpleNamespace, y: Value, v: Value, x: tuple[Value, ...]) -> Value:
        """None."""
        return 0.0
