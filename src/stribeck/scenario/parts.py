"""What a scenario is made of, and what a drive may have beside its constants and its signal."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Protocol

from stribeck.arrays import Array
from stribeck.drives import Drive
from stribeck.laws.base import Law
from stribeck.plants import Plant
from stribeck.scenario import tables
from stribeck.signals import Signal

if TYPE_CHECKING:
    from stribeck.machine.driving import DrivePart
    from stribeck.machine.machine import Elements
    from stribeck.scenario import Scenario
    from stribeck.scenario.rig import Rig


class Courses(Protocol):
    """What a remark is made of: the rows of a solution."""

    @property
    def t(self) -> Array:
        """The times, s."""

    @property
    def held(self) -> Mapping[str, Array]:
        """What controllers held at these times."""

    def __getitem__(self, name: str, /) -> Array:
        """A column."""


class Settings:
    """What a drive has in the file beside its constants and its signal: for most nothing.

    A controller with more is a class derived from this one, which :mod:`stribeck.scenario.drives` lists by its kind.
    """

    laws: ClassVar[tuple[str, ...]] = ()  # the keys of [drive] that hold a law, or "none"
    observer: Law | None = None  # the law by which friction is compensated

    @classmethod
    def fields(cls) -> tables.Fields:
        """Further keys of [drive], as fields of a pydantic model."""
        return {}

    @classmethod
    def read(
        cls, values: tables.StrictTable | None, table: Mapping[str, object], law: Law | None,
        plant: object, folder: Path, executes: bool,
    ) -> tuple[Settings | None, list[tables.Problem]]:  # fmt: skip
        """From the validated table [drive] and that of the plant (None where they are not valid), and the ``table`` as
        it stands in the file; None where something is wrong, and what."""
        return cls(), []

    @classmethod
    def fullest(cls, kind: type[Drive]) -> Drive:
        """The drive with every state that it can have."""
        return kind()

    def drive(self, kind: type[Drive], given: Collection[str]) -> Drive:
        """The drive whose constants ``given`` are on."""
        return kind()

    def values(self) -> dict[tuple[str, str], float]:
        """Run-time constants beside those of law, plant, drive and signal."""
        return {}

    def judge(self, parts: Parts) -> list[tables.Problem]:
        """What is wrong with valid tables taken together."""
        return []

    def sampling_of(self) -> list[dict[str, float]]:
        """Period, delay, noise and seed of the controller, where it samples."""
        return []

    def remarks(self, scenario: Scenario, solution: Courses, drive: DrivePart) -> list[str]:
        """What is to be said about a solution."""
        return []


@dataclass(frozen=True)
class Parts:
    """What a scenario is made of; None where there is no such part, or none that is valid."""

    law: Law | None = None
    plant: type[Plant] | None = None
    plant_values: dict[str, float] | None = None
    drive: type[Drive] | None = None
    drive_values: dict[str, float] | None = None
    settings: Settings | None = None
    signal: Signal | None = None
    rig: Rig | None = None
    elements: Elements | None = None  # of a machine
    initial: dict[str, float] | None = None
    solve: tables.Solve | None = None
    output: tables.Output | None = None
