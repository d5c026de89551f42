"""Sensors: columns of what an instrument reads; nothing acts back on the machine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from stribeck.constants import Column
from stribeck.expressions.ops import Value, floor
from stribeck.machine.element import BodyName, Element, ratio_constant
from stribeck.machine.table import quantity

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.machine import Elements


class Sensor(Element, family=True):
    """The reading of an instrument on a body, at each row of the output.

    A sensor of your own overrides ``reading``.
    """

    section, positional = "sensors", ("name", "on")
    on: BodyName = Field(description="the body")

    @classmethod
    def encoder(cls, name: str, on: str, resolution: float, ratio: float | None = None, offset: float = 0.0) -> Encoder:
        """The position in whole counts."""
        return Encoder(name=name, on=on, resolution=resolution, ratio=ratio, offset=offset)

    def reading(self, y: Value, v: Value) -> Value:
        """The reading, m or rad."""
        raise NotImplementedError

    def equations(self, a: Assembly) -> None:
        """Name the reading."""
        a.show(self.name_of("reading"), self.reading(*a.motion(self.on)))

    def turning(self, m: Elements) -> bool:
        """As the body."""
        return m.bodies[self.on].turns

    def columns(self, m: Elements) -> list[Column]:
        """Its reading."""
        return [Column(self.name_of("reading"), "rad" if self.turning(m) else "m", "reading of the sensor")]

    def heading(self, m: Elements) -> str:
        """See :class:`Element`."""
        return f"Sensor {self.name}: {self.kind} on {self.on}."


class Encoder(Sensor):
    """An encoder: ratio y + offset, to the nearest count."""

    kind: Literal["encoder"] = "encoder"
    resolution: float = quantity("m", "step of the encoder", above=0, rotary_unit="rad")
    ratio: float | None = ratio_constant("reading per position of the body; 1 unless given")
    offset: float = quantity("m", "reading at y = 0", default=0.0, rotary_unit="rad")

    def reading(self, y: Value, v: Value) -> Value:
        """Rounded half up, as a sampled controller's."""
        y = y if self.ratio is None else self.ratio * y
        return floor((y + self.offset) / self.resolution + 0.5) * self.resolution
