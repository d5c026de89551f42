"""What a fit of a machine tells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.files import finite
from stribeck.identify.core.states import Estimate
from stribeck.identify.result import Fit
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Document
from stribeck.scenario import Scenario

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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


class TraceError(TypedDict):
    """What is left of a column: root mean square in ``unit``, and as a share of its changes."""

    rms: float
    relative: float
    unit: str


@dataclass
class LogResult:
    """One recording: its errors by column; ``traces`` for the page, of a fit that was made just now."""

    file: str
    held_out: bool
    traces: list[Trace]
    errors: dict[str, TraceError] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for x in self.traces:
            self.errors[x.column] = {"rms": x.rms, "relative": x.relative, "unit": x.unit}

    def to_dict(self) -> dict[str, object]:
        """As the command prints it."""
        return {"file": self.file, "held_out": self.held_out, "errors": self.errors}


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


@dataclass(repr=False)
class MachineFit(Fit):
    """The machine's numbers from its recordings.

    Attributes:
        status: "done", "missed" (the model does not follow the recordings: nothing is identified) or "stopped".
        estimates: what was sought, by path, each with a 95 % interval, a model range and a state.
        levels: the friction of each contact at four ``speeds`` that were seen, estimates like all others.
        data: the machine with what was found, as tables; ``folder``: where its relative paths begin.
        name: the machine's; ``source``: the file of the recordings, where there is one.
        trust: whether laws in files that the machine names may be executed wherever these lie.
    """

    status: str
    reason: str
    estimates: dict[str, Estimate]
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
    name: str = "the machine"
    folder: Path = field(default_factory=Path)
    source: Path | None = None
    trust: bool = True

    @property
    def parameters(self) -> dict[str, Estimate]:
        """All estimates: what was sought, and the levels."""
        return {**self.estimates, **self.levels}

    @property
    def title(self) -> str:
        """The machine."""
        return self.name

    @property
    def lead(self) -> str:
        """What the machine leaves of its recordings, fitted and held out."""
        left = f"relative residual {percent(self.error(False))}"
        if (held := self.error(True)) is not None:
            left += f", {percent(held)} held out"
        if self.laws:
            left = f"{self.laws['picked']}, {left}"
        return left if self.status == "done" else f"{self.status}: {self.reason}; {left}"

    @property
    def machine(self) -> Scenario:
        """The machine with what was found, as it is simulated."""
        if not self.data:
            raise InputError(f"fit: {self.status}: there is no machine with these numbers")
        return Scenario(self.data, folder=self.folder, trust=self.trust)

    def error(self, held_out: bool) -> float | None:
        """The relative error over all recordings of that kind: root mean square over their columns."""
        squares = [e["relative"] ** 2 for log in self.logs if log.held_out is held_out for e in log.errors.values()]
        return float(np.sqrt(np.mean(squares))) if squares else None

    def plot(self) -> Figure:
        """The first recording: measured and simulated, as a Matplotlib figure."""
        from stribeck.identify import figures
        from stribeck.mouth import plots

        traced = [log for log in self.logs if log.traces]
        if not traced:
            raise InputError("fit: it holds no recording; there is nothing to plot")
        with plots.style():
            return figures.recording(traced[0].traces)

    def document(self) -> Document:
        """What the fit says to people, for the terminal and for a page."""
        from stribeck.identify import said

        return said.of_machine(self)

    def to_dict(self) -> dict[str, object]:
        """What ``stribeck fit --logs --json`` prints."""
        told: Mapping[str, object] = {
            "status": self.status, "reason": self.reason,
            "parameters": {name: p.to_dict() for name, p in self.estimates.items()},
            "levels": {name: p.to_dict() | {"speed": self.speeds[name]} for name, p in self.levels.items()},
            "correlated": self.correlated, "logs": [log.to_dict() for log in self.logs],
            "noise": self.noise, "notes": self.notes, "baselines": self.baselines, "laws": self.laws or {},
            "transfer": self.transfer, "error": {"fitted": self.error(False), "held_out": self.error(True)},
        }  # fmt: skip
        return dict(finite(told))
