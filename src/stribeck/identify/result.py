"""Results of fits: estimates with two uncertainties and a state each, and the chosen model."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.files import finite
from stribeck.identify import figures, said, saved, written
from stribeck.identify.core.states import Estimate
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.data.reading import RecordReading
from stribeck.identify.force import with_constants
from stribeck.identify.log import Log, Trace, size_ratio
from stribeck.identify.models.predictor import EXPECTED, Predictor
from stribeck.identify.models.terms import TERMS
from stribeck.identify.predicted import Predicted, predicted
from stribeck.identify.result_parts import Baseline, Candidate, FrictionRows, Group, LogResult, Picked
from stribeck.laws.base import Law
from stribeck.mouth import page, plots
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Document
from stribeck.mouth.terminal import Told
from stribeck.scenario import Scenario

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FURTHER = ("forms", "friction_error", "missed", "rest", "output_error", "nearest_stribeck")  # of JSON, where they are


class Fit(Told, ABC):
    """The result of a fit: a :class:`LogFit` of a log, a :class:`MachineFit` of a machine's recordings.

    ``fit["F_c"]`` is an estimate with ``value``, ``interval``, ``range`` and ``state``; ``print(fit)`` shows all of them.

    Attributes:
        status: "done", "missed" (the model does not describe the data: nothing is identified) or "stopped" (by Ctrl-C).
        estimates: the fitted parameters by name.
        levels: the friction at four speeds of the record, and at those that were asked for; ``speeds``: theirs.
        notes: one sentence each, the most important one first.
    """

    status: str
    estimates: dict[str, Estimate]
    levels: dict[str, Estimate]
    speeds: dict[str, float]
    notes: Sequence[str]

    @property
    def parameters(self) -> dict[str, Estimate]:
        """All estimates by name, levels included."""
        return {**self.estimates, **self.levels}

    @property
    @abstractmethod
    def title(self) -> str:
        """The fitted model."""

    @property
    @abstractmethod
    def lead(self) -> str:
        """The answer in one sentence."""

    @abstractmethod
    def document(self) -> Document:
        """The document of the fit, for the terminal and for a page."""

    @abstractmethod
    def to_dict(self) -> dict[str, object]:
        """The JSON of ``stribeck fit --json``."""

    @abstractmethod
    def files(self, folder: Path, command: str) -> dict[str, str]:
        """The numbers as the text of files by name, as a folder will hold them; ``command`` made the fit."""

    @abstractmethod
    def plot(self) -> Figure:
        """Measured and fitted signals, as a Matplotlib figure."""

    def __getitem__(self, name: str) -> Estimate:
        """An estimate by its name, or by the end of its path where no other path ends so.

        Raises:
            KeyError: there is no such parameter, or several; the message names those that there are.
        """
        return self.parameters[self.path_of(name)]

    def path_of(self, name: str) -> str:
        """The whole path of a parameter whose path is this name, or ends so.

        Raises:
            KeyError: as :meth:`__getitem__`.
        """
        every = self.parameters
        paths = [n for n in every if n == name] or [n for n in every if n.endswith(f".{name}")]
        if len(paths) != 1:
            why = "several paths end so" if paths else "no such parameter"
            raise KeyError(f"{name!r}: {why} (it has {', '.join(paths or every)})")
        return paths[0]

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.title}: {self.lead}>"

    @property
    def unidentified(self) -> tuple[str, ...]:
        """The parameters that the data do not determine; levels are none."""
        return tuple(n for n, e in self.parameters.items() if not e.identifiable and n not in self.levels)

    @staticmethod
    def load(folder: Path | str, trust: bool = False) -> Fit:
        """The fit that ``stribeck fit --out`` or :meth:`save` left in a folder, without its record.

        Args:
            folder: the folder, or its fit.json.
            trust: execute laws in files (``FILE.py:NAME``) wherever these lie, and not only in the current folder, in the
                fit's or below them.

        Raises:
            InputError: there is none, it is not whole, or it names a law elsewhere.
        """
        data, path = saved.read(folder)
        if data["kind"] == saved.LOG:
            return LogFit(**saved.of_log(data, path, trust))
        return MachineFit(**saved.of_machine(data, path.parent, trust))

    def report(self, path: Path | str) -> None:
        """Write the page of the fit."""
        place = Path(path)
        page.write(self.document(), place.parent, "", place.name, pictures=False)

    def save(self, folder: Path | str, command: str = "") -> list[str]:
        """Write the results, then report.html, into a folder; their names.

        Args:
            folder: the folder; made if missing.
            command: that made the fit: the files and the page name it.
        """
        return [Path(each).name for each in written.write_fit(self, Path(folder), command)]


@dataclass(frozen=True, repr=False)
class LogFit(Fit):
    """A law fitted to a log.

    Attributes:
        law_name: the law's name.
        method: "static" or "dynamic".
        estimates: the fitted parameters: the law's, then the rig's (mass, offset, ...).
        values: every number of the fitted curve, and the law's words; those of ``given`` were not fitted.
        relative_force_error: norm(residual)/norm(force), a fraction.
        friction_error: norm(residual)/norm(friction); ``missed``: the residual as a share of the force's deviation.
        status: "done", or "stopped" (by Ctrl-C): the values are the best until then.
        candidates: the laws that were compared, and simpler models of the same record.
        predictor: predicts the force along other records; None for fits by simulation.
        log, reading: the record, and how it was read.
        levels: friction at ``speeds`` of the record, m/s or rad/s.
        seen: the ranges of the record. A prediction outside them is an extrapolation.
        friction: measured and fitted, row by row.
        forms: the force of each form beside the law, N (rms); ``rest``: the share of the rows at rest.
        nearest_stribeck: the Stribeck law nearest to a curve of forms.
        output: the fitted motion, measured and simulated.
        relation: names, and the correlation of their estimates; of fits by simulation.
    """

    law_name: str
    method: str
    estimates: dict[str, Estimate]
    values: Mapping[str, float | str]
    given: tuple[str, ...]
    relative_force_error: float
    data_hash: str
    levels: dict[str, Estimate] = field(default_factory=dict)
    speeds: dict[str, float] = field(default_factory=dict)
    friction_error: float | None = None
    missed: float | None = None
    notes: Sequence[str] = ()
    status: str = "done"
    candidates: tuple[Candidate, ...] = ()
    predictor: Predictor | None = None
    log: Log | None = None
    reading: RecordReading = field(default_factory=RecordReading)
    seen: dict[str, tuple[float, float]] = field(default_factory=dict)
    friction: FrictionRows | None = None
    forms: dict[str, float] | None = None
    rest: float | None = None
    nearest_stribeck: dict[str, float] | None = None
    output: Trace | None = None
    relation: tuple[list[str], Array] | None = None

    @property
    def cross_validated_error(self) -> float | None:
        """The relative residual over held-out blocks, of rows that slide; None if there is no predictor."""
        return self.predictor.error if self.predictor else None

    @property
    def body(self) -> dict[str, Estimate]:
        """The estimates of the rig."""
        return {n: e for n, e in self.estimates.items() if n in TERMS}

    @property
    def of_law(self) -> dict[str, Estimate]:
        """The estimates of the law."""
        return {n: e for n, e in self.estimates.items() if n not in TERMS}

    @property
    def title(self) -> str:
        """The record's file, or how many there are."""
        return self.reading.title

    @property
    def lead(self) -> str:
        """The law, and what it leaves."""
        held_out = "" if self.cross_validated_error is None else f"{percent(self.cross_validated_error)} held out, "
        fitted = percent(self.relative_force_error) + (" fitted" if held_out else "")
        text = f"{self.law_name}, relative residual {held_out}{fitted}"
        if self.output is not None:
            text += f" of the force and {percent(self.output_error)} of the {self.output.column}"
        return text if self.status == "done" else f"{self.status}: {text}"

    @property
    def output_error(self) -> float | None:
        """The residual of the fitted motion as a share of it."""
        shown = self.output
        return None if shown is None else size_ratio(shown.measured - shown.predicted, shown.measured)

    @property
    def terms(self) -> tuple[str, ...]:
        """The terms of the body that the curve has."""
        return tuple(n for n in self.values if n in TERMS)

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """The terms that the curve has, and its forms."""
        return (*self.terms, *dict.fromkeys(form for form, _ in (self.predictor.forms if self.predictor else {})))

    @property
    def expected(self) -> float | None:
        """The error that another record of the machine is expected to have, inside the ranges that were seen."""
        return EXPECTED * self.predictor.error if self.predictor else None

    @property
    def slowest(self) -> float | None:
        """The slowest sliding that a static fit has seen, m/s or rad/s; below it the curve does not tell the force."""
        return next(iter(self.speeds.values()), None) if self.predictor else None

    @property
    def known(self) -> dict[str, float | None]:
        """The errors of the fit itself, for comparison with those of a prediction."""
        return {
            "relative_force_error": self.relative_force_error, "cross_validated_error": self.cross_validated_error,
            "friction_error": self.friction_error, "missed": self.missed,
        }  # fmt: skip

    def law(self, *, accept: Sequence[str] = (), guessing: bool = False) -> Law:
        """The law of the fitted curve.

        Args:
            accept: parameters to take although the data do not determine them.
            guessing: take all: for plots.

        Raises:
            InputError: a parameter that the law needs is not determined by the data, with the experiment that would.
        """
        missing = {n: e for n, e in self.of_law.items() if not (e.usable or guessing or n in accept)}
        if missing:
            raise InputError([
                f"{n}: {e.state}{f': {e.why}' if e.why else ''}; {arg('accept')} takes it as it is"
                f"{f'; measure {e.experiment}' if e.experiment else ''}"
                for n, e in missing.items()
            ])  # fmt: skip
        return with_constants(laws.find(self.law_name), self.values)

    def predict(self, data: object, **columns: str) -> Predicted:
        """The force that the fitted model predicts for another record, with its error.

        Args:
            data: a file, a table of columns or a Log; columns as in the fit unless given.
        """
        return predicted(self, data, ColumnNames(columns))

    def files(self, folder: Path, command: str) -> dict[str, str]:
        """A parameter set, and fit.json."""
        return written.of_log(self, folder, command)

    def plot(self) -> Figure:
        """Measured friction and the fitted law against the velocity, as a Matplotlib figure."""
        if self.friction is None:
            raise InputError("fit: it holds no measured friction; there is nothing to plot")
        with plots.style():
            return figures.curve(self, self.friction)

    def document(self) -> Document:
        """The document of the fit, for the terminal and for a page."""
        return said.of_log(self)

    def to_dict(self) -> dict[str, object]:
        """The JSON of ``stribeck fit --json``."""
        further = {name: getattr(self, name) for name in _FURTHER}
        return {
            "law": self.law_name, "method": self.method, "status": self.status,
            "parameters": {n: e.to_dict() for n, e in self.of_law.items()},
            "body": {n: e.to_dict() for n, e in self.body.items()},
            "levels": {n: e.to_dict() | {"speed": self.speeds[n]} for n, e in self.levels.items()},
            "fixed": {n: self.values[n] for n in self.given},
            "relative_force_error": self.relative_force_error, "cross_validated_error": self.cross_validated_error,
            "unidentified": list(self.unidentified), "candidates": [dict(c) for c in self.candidates],
            **{name: value for name, value in further.items() if value is not None},
            "data_hash": self.data_hash, "notes": list(self.notes),
        }  # fmt: skip


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

    def files(self, folder: Path, command: str) -> dict[str, str]:
        """The parameters, fit.json, and the machine with the fitted values."""
        return written.of_machine(self, folder, command)

    def plot(self) -> Figure:
        """The first recording: measured and simulated, as a Matplotlib figure."""
        traces = next((log.traces for log in self.logs if log.traces), None)
        if traces is None:
            raise InputError("fit: it holds no recording; there is nothing to plot")
        with plots.style():
            return figures.traces(traces, ("measured", "simulated"))

    def document(self) -> Document:
        """The fit as a document for the terminal and for a page."""
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
