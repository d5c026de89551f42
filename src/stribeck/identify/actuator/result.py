"""The result of a fit of a machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from typing_extensions import TypedDict  # Pydantic takes no other before Python 3.12

from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.files import finite
from stribeck.identify.core.states import Estimate
from stribeck.identify.log import Trace
from stribeck.identify.result import Fit
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Document
from stribeck.scenario import Scenario

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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


@dataclass(repr=False)
class MachineFit(Fit):
    """A machine's parameters estimated from its recordings.

    Attributes:
        status: "done", "missed" (the model does not describe the recordings: nothing is identified) or "stopped".
        estimates: the fitted parameters by path, each with a 95 % interval, a model range and a state.
        levels: estimates of each contact's friction at four recorded ``speeds``.
        data: the machine with the fitted values, as tables; ``folder``: the base of its relative paths.
        name: the machine's; ``source``: the file of the recordings, if there is one.
        trust: whether laws in files may be executed from any folder.
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
    relation: tuple[list[str], Array] | None = None
    nuisance: dict[str, float] = field(default_factory=dict)
    name: str = "the machine"
    folder: Path = field(default_factory=Path)
    source: Path | None = None
    trust: bool = True

    @property
    def title(self) -> str:
        """The machine's name as a title."""
        return self.name

    @property
    def lead(self) -> str:
        """The relative residuals of the fitted and the held-out recordings, in words."""
        left = f"relative residual {percent(self.error(False))}"
        if (held := self.error(True)) is not None:
            left = f"relative residual {percent(held)} held out, {percent(self.error(False))} fitted"
        if self.laws:
            left = f"{self.laws['picked']}, {left}"
        return left if self.status == "done" else f"{self.status}: {self.reason}; {left}"

    @property
    def machine(self) -> Scenario:
        """The machine with the fitted values, ready to simulate."""
        if not self.data:
            raise InputError(f"fit: {self.status}: there is no machine with these numbers")
        return Scenario(self.data, folder=self.folder, trust=self.trust)

    def error(self, held_out: bool) -> float | None:
        """The relative error over the held-out or the fitted recordings: root mean square over their columns."""
        squares = [e["relative"] ** 2 for log in self.logs if log.held_out is held_out for e in log.errors.values()]
        return float(np.sqrt(np.mean(squares))) if squares else None

    def plot(self) -> Figure:
        """The first recording: measured and simulated, as a Matplotlib figure."""
        from stribeck.identify import figures
        from stribeck.mouth import plots

        traces = next((log.traces for log in self.logs if log.traces), None)
        if traces is None:
            raise InputError("fit: it holds no recording; there is nothing to plot")
        with plots.style():
            return figures.traces(traces, ("measured", "simulated"))

    def document(self) -> Document:
        """The fit as a document for the terminal and for a page."""
        from stribeck.identify import said

        return said.of_machine(self)

    def to_dict(self) -> dict[str, object]:
        """The fit as ``stribeck fit --logs --json`` prints it."""
        data: Mapping[str, object] = {
            "status": self.status, "reason": self.reason,
            "parameters": {name: p.to_dict() for name, p in self.estimates.items()},
            "levels": {name: p.to_dict() | {"speed": self.speeds[name]} for name, p in self.levels.items()},
            "correlated": self.correlated, "logs": [log.to_dict() for log in self.logs],
            "noise": self.noise, "notes": self.notes, "baselines": self.baselines, "laws": self.laws or {},
            "error": {"fitted": self.error(False), "held_out": self.error(True)},
        }  # fmt: skip
        return dict(finite(data))
