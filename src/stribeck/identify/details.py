"""What a fit tells beside its numbers (:attr:`stribeck.identify.result.Fit.details`), each part with its keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TypedDict

from stribeck.arrays import Array


class Candidate(TypedDict):
    """A model of the record: its law and forms, how many numbers it has, and its error; ``chosen``: it is the fit."""

    name: str
    law: str
    forms: list[str]
    numbers: int
    relative_force_error: float
    cross_validated_error: float | None
    chosen: bool


class FitDetails(TypedDict, total=False):
    """All that a fit may tell; which parts there are depends on the method."""

    forms: dict[str, float]
    speeds: dict[str, float]
    missed: float
    nearest_stribeck: dict[str, float]
    friction_error: float
    rest: float
    seen: dict[str, tuple[float, float]]
    decimation: int
    output: str
    output_error: float
    output_trace: Mapping[str, Array]


@dataclass(frozen=True)
class RecordReading:
    """How a record was read.

    Attributes:
        files: the record's, if it is from files.
        columns, units, force_gain, cutoff: as the user gave them.
        output: what a simulation was to meet.
        published: whether the record's last rows were kept, as in the published procedure.
        simulated: whether the motion was filtered for a simulation, with a higher cut-off.
    """

    files: tuple[str, ...] = ()
    columns: Mapping[str, str] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)
    force_gain: float | str | None = None
    cutoff: float | None = None
    output: str = "force"
    published: bool = False
    simulated: bool = False

    @property
    def title(self) -> str:
        """The file's name, or how many there are."""
        if not self.files:
            return "the record"
        return Path(self.files[0]).name if len(self.files) == 1 else f"{len(self.files)} files"
