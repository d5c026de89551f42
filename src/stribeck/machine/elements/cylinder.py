"""The piston of a pneumatic cylinder, as a kind of body."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from stribeck.constants import show
from stribeck.expressions.ops import Value
from stribeck.machine.elements.bodies import Body
from stribeck.machine.table import Aside, FileTable, Problem, given_as, quantity
from stribeck.plants import Plant
from stribeck.plants.cylinder import Cylinder

_C = Cylinder.constants


class Filled(FileTable):
    """Where a piston starts."""

    y: float = quantity("m", "position")
    v: float = quantity("m/s", "velocity", default=0.0)
    p_1: float = quantity("Pa", "pressure in chamber 1")
    p_2: float = quantity("Pa", "pressure in chamber 2")


class Piston(Body):
    """The piston of a pneumatic cylinder between two chambers of gas, which a valve fills and empties."""

    plant: ClassVar[type[Plant]] = Cylinder
    kind: Literal["pneumatic"] = "pneumatic"
    mass: float = given_as(_C["mass"])
    area: float = given_as(_C["area"])
    stroke: float = given_as(_C["stroke"])
    dead_volume_1: float = given_as(_C["dead_volume_1"])
    dead_volume_2: float = given_as(_C["dead_volume_2"])
    heat_ratio: float = given_as(_C["heat_ratio"])
    gas_constant: float = given_as(_C["gas_constant"])
    temperature: float = given_as(_C["temperature"])
    supply_pressure: float = given_as(_C["supply_pressure"])
    atmospheric_pressure: float = given_as(_C["atmospheric_pressure"])
    beta_fill: float = given_as(_C["beta_fill"])
    beta_empty: float = given_as(_C["beta_empty"])
    initial: Annotated[Filled, Aside()] = Field(description="the state at t = 0, with y, p_1 and p_2")  # type: ignore[assignment]

    @property
    def constants(self) -> dict[str, Value]:
        """See :class:`Body`."""
        return {n: getattr(self, n) for n in _C}

    def wrong(self) -> list[Problem]:
        """What a piston does not have; a start outside the stroke, and pressures that cannot be."""
        more = [n for n in ("inertia", "tied_to", "ratio", "velocity", "rotary") if getattr(self, n) is not None]
        found = [
            (n, f"{show(getattr(self, n))}: must be left out: this body is the piston of a cylinder") for n in more
        ]
        p = SimpleNamespace(**self.constants)
        return found or Cylinder.problems(p, dict(self.initial))
