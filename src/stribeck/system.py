"""law + plant + drive -> one system of equations, for simulation, code and output columns alike."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from types import SimpleNamespace
from typing import Any

from stribeck.constants import Constant
from stribeck.drives.base import Column, Drive
from stribeck.equations import Equations
from stribeck.expressions.graph import Expr, derivative, symbol, wrap
from stribeck.expressions.names import Names
from stribeck.expressions.ops import Value
from stribeck.laws.base import Law
from stribeck.laws.form import Form
from stribeck.plants.mass import Mass
from stribeck.signals import Segment, Signal

_Y, _V = Column("y", "m", "position"), Column("v", "m/s", "velocity")
_Z, _F = Column("z", "m", "mean bristle deflection"), Column("F", "N", "friction force")
_E_IN = Column("E_in", "J", "energy put into the body by the drive")
_E_OUT = Column("E_dissipated", "J", "energy dissipated by friction")
_E_STORED = Column("E_stored", "J", "kinetic energy and energy of the bristles")


@dataclass(frozen=True)
class Groups:
    """The constants of a system by their owner, as values or as symbols; ``signal`` holds the current piece where the
    signal is made of pieces."""

    law: Any
    plant: Any
    drive: Any
    signal: Any


@dataclass(frozen=True)
class System(Equations):
    """The structure of a simulation: which law, drive and kind of signal, without any values.

    Two scenarios that differ in numbers only have equal systems, and share compiled code.
    """

    law: type[Law]
    form: Form  # of the law's equations
    drive: type[Drive]
    signal: type[Signal] | None  # None: made of straight pieces
    energy: bool = False

    @cached_property
    def states(self) -> tuple[Column, ...]:
        """The states in the order in which they are integrated."""
        body = (_Y,) if self.drive.sets_velocity else (_Y, _V)
        bristle = (_Z,) if self.law.has_z else ()
        return (*body, *bristle, *self.drive.states, *((_E_IN, _E_OUT) if self.energy else ()))

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The columns of the output after t."""
        first = (_Y, _V, _Z, _F)
        signal = () if self.drive.sets_velocity else (self.drive.signal,)
        energy = (_E_IN, _E_STORED, _E_OUT) if self.energy else ()
        return (*first, *signal, *self.drive.columns, *self.drive.states, *energy)

    @cached_property
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """(group, name) of each run-time constant, in the order in which compiled code takes them."""
        names = [("law", n) for n in self.law.numbers(self.form)]
        names += [] if self.drive.sets_velocity else [("plant", n) for n in Mass.constants]
        names += [("drive", n) for n in self.drive.constants]
        return (*names, *(("signal", n) for n in (self.signal.constants if self.signal else ())))

    def constant(self, owner: str, name: str) -> Constant:
        """The declaration of a run-time constant."""
        tables = {"law": self.law.constants(), "plant": Mass.constants, "drive": self.drive.constants}
        return {**tables, "signal": self.signal.constants if self.signal else {}}[owner][name]

    @property
    def heading(self) -> tuple[str, ...]:
        """What this is, for the head of the generated code."""
        law, drive = self.law, self.drive
        return (
            f"Law: {law.name}. {law.__doc__}", f"Source: {law.source}", f"Drive: {drive.kind}; {drive.meaning}."
        )  # fmt: skip

    def symbolic(self, called: Names | None = None) -> Groups:
        """The constants as symbols named ``group.name``; ``called`` takes the names of the law's terms."""

        def group(owner: str) -> SimpleNamespace:
            return SimpleNamespace(**{n: symbol(f"{o}.{n}") for o, n in self.parameters if o == owner})

        on_term = None if called is None else called.term
        law = self.law.symbolic(lambda n: symbol(f"law.{n}"), self.form, on_term)
        piece = Segment(*(symbol(f"segment.{n}") for n in ("start", "value", "slope")))
        return Groups(law, group("plant"), group("drive"), group("signal") if self.signal else piece)

    def quantities(self, q: Groups, r: Value, x: dict[str, Value], called: Names | None = None) -> dict[str, Value]:
        """Every named quantity from the signal's value r and the states."""
        y, z = x["y"], x["z"] if self.law.has_z else 0.0 * x["y"]
        v = r if self.drive.sets_velocity else x["v"]
        own = tuple(x[state.name] for state in self.drive.states)
        dz_dt = self.law.dz_dt(q.law, v, z)
        F = self.law.friction(q.law, v, z, dz_dt)
        u = F if self.drive.sets_velocity else self.drive.force(q.drive, r, y, v, own)
        found = {self.drive.signal.name: r, **x, "y": y, "v": v, "z": z, "F": F, "dz_dt": dz_dt, "u": u}
        for name, value in (("dz_dt", dz_dt), ("F", F), ("u", u)):
            if called is not None:
                called.give(value, name)
        if self.energy:
            kinetic = 0.0 if self.drive.sets_velocity else Mass.kinetic_energy(q.plant, v)
            found["E_stored"] = self.law.stored_energy(q.law, z) + kinetic
        return found

    def rates(self, called: Names | None = None) -> list[Expr]:
        """The time derivatives of the states as expressions of ``t``, the states' names and the constants' symbols."""
        q, t, x = self.symbolic(called), symbol("t"), {state.name: symbol(state.name) for state in self.states}
        r = (self.signal.equation if self.signal else Segment.equation)(q.signal, t)
        k = self.quantities(q, r, x, called)
        own = tuple(x[state.name] for state in self.drive.states)
        rates = dict(
            zip((s.name for s in self.drive.states), self.drive.rates(q.drive, r, k["y"], k["v"], own), strict=True)
        )
        rates |= {"y": k["v"], "z": k["dz_dt"]}
        if not self.drive.sets_velocity:
            rates["v"] = Mass.acceleration(q.plant, k["u"], k["F"])
        if self.energy:
            stored_by_z = derivative(wrap(self.law.stored_energy(q.law, x["z"])), x["z"]) if self.law.has_z else 0.0
            rates |= {"E_in": k["u"] * k["v"], "E_dissipated": k["F"] * k["v"] - stored_by_z * k["dz_dt"]}
        return [wrap(rates[state.name]) for state in self.states]
