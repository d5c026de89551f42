"""What the result of a fit holds beside its estimates."""

from __future__ import annotations

from dataclasses import dataclass, field

from typing_extensions import TypedDict  # Pydantic takes no other before Python 3.12

from stribeck.arrays import Array
from stribeck.identify.log import Trace


class Candidate(TypedDict):
    """A model of the record: its law and forms, how many numbers it has, and its error; ``chosen``: it is the fit."""

    name: str
    law: str
    forms: list[str]
    numbers: int
    relative_force_error: float
    chosen: bool


@dataclass(frozen=True)
class FrictionRows:
    """Measured friction and the fit's, row by row (SI)."""

    time: Array
    velocity: Array
    measured: Array
    fitted: Array


class TraceError(TypedDict):
    """The residual of a column: rms in ``unit``, and relative to its changes."""

    rms: float
    relative: float
    unit: str


@dataclass
class LogResult:
    """One recording: its errors by column; ``traces`` for the page, not restored from a file."""

    file: str
    held_out: bool
    traces: list[Trace]
    errors: dict[str, TraceError] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for x in self.traces:
            self.errors[x.column] = {"rms": x.rms, "relative": x.relative, "unit": x.unit}

    def to_dict(self) -> dict[str, object]:
        """The recording as ``stribeck fit --logs --json`` prints it."""
        return {"file": self.file, "held_out": self.held_out, "errors": self.errors}


class Group(TypedDict):
    """Parameters that cannot be separated, and the correlation of each pair."""

    names: list[str]
    correlation: dict[str, float]


class Baseline(TypedDict, total=False):
    """The relative residual of other friction and its number of parameters; or why it could not be fitted."""

    fitted: float | None
    held_out: float | None
    numbers: int
    why: str


class Picked(TypedDict):
    """The tried laws: the chosen one, each held-out error and number of parameters, and reasons of failed fits."""

    picked: str
    errors: dict[str, float]
    numbers: dict[str, int]
    failed: dict[str, str]
