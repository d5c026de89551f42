"""What a fit of a machine tells."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypedDict

import numpy as np

from stribeck.arrays import Array
from stribeck.files import finite
from stribeck.identify.core.states import Estimate


@dataclass
class Trace:
    """A measured column and what was simulated of it."""

    column: str
    unit: str
    t: Array
    measured: Array
    predicted: Array

    @property
    def rms(self) -> float:
        """The error's root mean square."""
        return float(np.sqrt(np.mean((self.predicted - self.measured) ** 2)))

    @property
    def relative(self) -> float:
        """The error by the changes of what was measured."""
        size = float(np.std(self.measured))
        return self.rms / size if size > 0 else float("inf")


@dataclass
class LogResult:
    """One recording: its errors by column; ``traces`` for the page."""

    file: str
    held_out: bool
    traces: list[Trace]

    def to_json(self) -> dict[str, object]:
        """As the command prints it."""
        errors = {x.column: {"rms": x.rms, "relative": x.relative, "unit": x.unit} for x in self.traces}
        return {"file": self.file, "held_out": self.held_out, "errors": errors}


class Group(TypedDict):
    """Numbers that can stand for each other, and how each pair of them goes together."""

    names: list[str]
    correlation: dict[str, float]


class Baseline(TypedDict, total=False):
    """What other friction leaves of the recordings, as a share of their changes, and how many numbers it has; or why it
    could not be fitted."""

    fitted: float | None
    held_out: float | None
    numbers: int
    why: str


class Picked(TypedDict):
    """The laws that were tried: which was taken, each one's held-out error and how many numbers, and which failed why."""

    picked: str
    errors: dict[str, float]
    numbers: dict[str, int]
    failed: dict[str, str]


Moved = TypedDict("Moved", {"name": str, "from": dict[str, object], "to": dict[str, object]})


class Transfer(TypedDict):
    """How other recordings are predicted, which numbers are other there, which the same, and which are not told."""

    logs: list[dict[str, object]]
    moved: list[Moved]
    same: list[str]
    not_told: list[str]
    parameters: dict[str, dict[str, object]]


@dataclass
class MachineFit:
    """The machine's numbers from its recordings.

    Attributes:
        status: "done", "missed" (the model does not follow the recordings: nothing is identified) or "stopped".
        parameters: estimates by path, each with a 95 % interval, a model range and a state.
        levels: the friction of each contact at four ``speeds`` that were seen, estimates like all others.
        data: the machine with what was found, as tables.
    """

    status: str
    reason: str
    parameters: dict[str, Estimate]
    correlated: list[Group]
    logs: list[LogResult]
    notes: list[str]
    noise: dict[str, float]
    data: dict[str, object]
    levels: dict[str, Estimate] = field(default_factory=dict)
    speeds: dict[str, float] = field(default_factory=dict)
    baselines: dict[str, Baseline] = field(default_factory=dict)
    laws: Picked | None = None
    transfer: Transfer | None = None
    relation: tuple[list[str], Array] | None = None
    nuisance: dict[str, float] = field(default_factory=dict)
    agreeing: int = 1

    def __getitem__(self, name: str) -> Estimate:
        """An estimate by its path, or by the end of it where no other path ends so: ``fit["F_c"]``.

        Raises:
            KeyError: no path, or several, end so.
        """
        every = {**self.parameters, **self.levels}
        found = [n for n in every if n == name] or [n for n in every if n.endswith(f".{name}")]
        if len(found) != 1:
            raise KeyError(
                f"{name!r}: {'several paths end' if found else 'no path ends'} so (there are {', '.join(found or every)})"
            )
        return every[found[0]]

    def error(self, held_out: bool) -> float | None:
        """The relative error over all recordings of that kind: root mean square over their columns."""
        squares = [x.relative**2 for log in self.logs if log.held_out is held_out for x in log.traces]
        return float(np.sqrt(np.mean(squares))) if squares else None

    def to_json(self) -> dict[str, object]:
        """As ``--json`` prints it."""
        told = {
            "status": self.status, "reason": self.reason,
            "parameters": {name: p.to_json() for name, p in self.parameters.items()},
            "levels": {name: p.to_json() | {"speed": self.speeds[name]} for name, p in self.levels.items()},
            "correlated": self.correlated, "logs": [log.to_json() for log in self.logs],
            "noise": self.noise, "notes": self.notes, "baselines": self.baselines, "laws": self.laws or {},
            "transfer": self.transfer, "error": {"fitted": self.error(False), "held_out": self.error(True)},
        }  # fmt: skip
        return dict(finite(told))
