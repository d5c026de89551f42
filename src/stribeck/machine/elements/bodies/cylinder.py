"""The piston of a pneumatic cylinder, as a kind of body."""

from __future__ import annotations

from math import inf
from types import SimpleNamespace
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import Field

from stribeck.constants import show
from stribeck.expressions.graph import ZERO, Expr, symbol, wrap
from stribeck.expressions.ops import Value, both
from stribeck.machine.element import Own, State
from stribeck.machine.elements.bodies import Body
from stribeck.machine.pneumatic.cylinder import Cylinder
from stribeck.machine.table import Aside, FileTable, Problem, quantity

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly

_AT_COVER = 1e-6  # share of the stroke within which the piston is at a cover: well above the solver's error


class Filled(FileTable):
    """Where a piston starts."""

    y: float = quantity("m", "position")
    v: float = quantity("m/s", "velocity", default=0.0)
    p_1: float = quantity("Pa", "pressure in chamber 1")
    p_2: float = quantity("Pa", "pressure in chamber 2")


class Piston(Body):
    """The piston of a pneumatic cylinder between two chambers of gas, which a valve fills and empties."""

    kind: Literal["pneumatic"] = "pneumatic"
    states = State("p_1", "Pa", "pressure in chamber 1"), State("p_2", "Pa", "pressure in chamber 2")
    mass: float = quantity("kg", "mass of piston and load", above=0)
    area: float = quantity("m^2", "cross-section of the piston", above=0)
    stroke: float = quantity("m", "stroke; the position y runs from 0 to it", above=0)
    dead_volume_1: float = quantity("m^3", "volume of chamber 1 at y = 0", above=0)
    dead_volume_2: float = quantity("m^3", "volume of chamber 2 at y = stroke", above=0)
    heat_ratio: float = quantity("", "polytropic exponent", above=0)
    gas_constant: float = quantity("J/(kg K)", "specific gas constant", above=0)
    temperature: float = quantity("K", "temperature of the gas", above=0)
    supply_pressure: float = quantity("Pa", "absolute pressure of the supply", above=0)
    atmospheric_pressure: float = quantity("Pa", "absolute pressure of the exhaust", above=0)
    beta_fill: float = quantity("kg/(s Pa)", "flow into a chamber by opening and pressure", above=0)
    beta_empty: float = quantity("kg/(s Pa)", "flow out of a chamber by opening and pressure", above=0)
    initial: Annotated[Filled, Aside()] = Field(description="the state at t = 0, with y, p_1 and p_2")  # type: ignore[assignment]

    @property
    def constants(self) -> dict[str, Value]:
        """The arguments of the gas equations."""
        return {n: getattr(self, n) for n in GAS}

    def obey_force(self, a: Assembly) -> None:
        """The rates under the pressures of the chambers, which a valve fills and empties; closed unless a cascade moves it."""
        y, v = a.motion(self.name)
        F = wrap(-a.force[self.name])  # what holds it back: friction, links, less the loads
        p, u = self.gas(a), ZERO
        on = (x for x in a.system.controllers.values() if x.moves_valve and x.on == self.name)
        if (cascade := next(on, None)) is not None:
            p, u = cascade.valve(a, self, p, F)
        rates = Cylinder.rates(p, y, v, u, F, self.pressures)
        rates_of = {s.name: x for s, x in zip(self.states, rates, strict=True)}
        self.obey_rates(a, wrap(Cylinder.acceleration(p, u, F, self.pressures)), rates_of)

    @property
    def pressures(self) -> tuple[Expr, ...]:
        """The pressures in the chambers."""
        return tuple(symbol(self.name_of(s.name)) for s in self.states)

    def gas(self, a: Assembly) -> SimpleNamespace:
        """Its constants in the equations: its mass is that of all that is tied to it, seen from it."""
        return SimpleNamespace(**{**self.constants, "mass": a.inertia[self.name]})

    def inside(self, y: Value) -> Value | None:
        """The equations end where the piston meets a cover."""
        return both(y >= 0, y <= self.stroke)

    def ended(self, t: float, y: float, v: float) -> str | None:
        """At which cover the piston is."""
        cover = 0.0 if v < 0 else self.stroke
        if abs(y - cover) > _AT_COVER * self.stroke:
            return None
        return f"the piston reached the end of its stroke, y = {cover:g} m, at t = {t:.6g} s with v = {v:.4g} m/s"

    def state_scales(self, length: Value, speed: Value, force: Value) -> Own:
        """The pressures that make the friction force."""
        return {s.name: force / self.area for s in self.states}

    def wrong(self) -> list[Problem]:
        """Keys that a piston does not have, a start outside the stroke, and invalid pressures."""
        more = [n for n in ("inertia", "tied_to", "ratio", "velocity", "rotary") if getattr(self, n) is not None]
        if more:
            text = "must be left out: this body is the piston of a cylinder"
            return [(n, f"{show(getattr(self, n))}: {text}") for n in more]
        problems, room = list[Problem](), f"within the stroke, 0 to {self.stroke:g} m"
        for name, highest in (("y", self.stroke), ("p_1", inf), ("p_2", inf)):
            if not 0 <= (x := getattr(self.initial, name)) <= highest:
                allowed = room if name == "y" else "an absolute pressure >= 0 Pa"
                problems.append((f"initial.{name}", f"{show(x)}: must be {allowed}"))
        if self.supply_pressure <= self.atmospheric_pressure:
            text = f"must be above atmospheric_pressure ({self.atmospheric_pressure:g} Pa)"
            problems.append(("supply_pressure", f"{show(self.supply_pressure)}: {text}"))
        return problems


GAS = ("mass", *(name for name in Piston.model_fields if name not in Body.model_fields))  # arguments of its equations
