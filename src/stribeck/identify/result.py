"""What a fit returns: numbers with two uncertainties and a state each, and the model that was chosen."""

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
from stribeck.identify.core.predictor import EXPECTED, Predictor
from stribeck.identify.core.states import Estimate as Estimate
from stribeck.identify.details import Candidate, FitDetails, RecordReading
from stribeck.identify.log import Log
from stribeck.identify.models.terms import TERMS
from stribeck.laws.base import Law
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Document, Told

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stribeck.identify.predict import Predicted

_TOLD = (
    "forms",
    "friction_error",
    "missed",
    "rest",
    "output_error",
    "nearest_stribeck",
)
_LIKE = {
    "spring": "stiffness",
    "weight": "gravity_sin",
    "level by position": "F_c_by_position",
}  # forms that act like terms


@dataclass(frozen=True)
class Prediction:
    """Measured friction and the fit's, row by row (SI): for plots and residuals."""

    time: Array
    position: Array
    velocity: Array
    measured: Array
    fitted: Array


class Fit(Told, ABC):
    """What a fit found: a :class:`LogFit` of a log, a :class:`MachineFit` of a machine's recordings.

    ``fit["F_c"]`` is an estimate with ``value``, ``interval``, ``range`` and ``state``; ``print(fit)`` shows all of them.

    Attributes:
        status: "done", or why there is less; of Ctrl-C "stopped".
        levels: friction at speeds that were seen.
        notes: what a reader should know, a sentence each, the most important one first.
    """

    status: str
    levels: dict[str, Estimate]
    notes: Sequence[str]

    @property
    @abstractmethod
    def parameters(self) -> dict[str, Estimate]:
        """All estimates by name."""

    @property
    @abstractmethod
    def title(self) -> str:
        """What was fitted."""

    @property
    @abstractmethod
    def lead(self) -> str:
        """The answer in one sentence."""

    @abstractmethod
    def document(self) -> Document:
        """What the fit says to people, for the terminal and for a page."""

    @abstractmethod
    def to_dict(self) -> dict[str, object]:
        """What ``stribeck fit --json`` prints."""

    @abstractmethod
    def plot(self) -> Figure:
        """What was measured beside what the fit makes of it, as a Matplotlib figure."""

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
        found = [n for n in every if n == name] or [n for n in every if n.endswith(f".{name}")]
        if len(found) != 1:
            why = "several paths end so" if found else "no such parameter"
            raise KeyError(f"{name!r}: {why} (it has {', '.join(found or every)})")
        return found[0]

    def __repr__(self) -> str:
        known = ", ".join(f"{n} = {e.value:.4g}" for n, e in self.parameters.items() if e.identifiable)
        open_ones = f"; not identifiable: {', '.join(self.unidentified)}" if self.unidentified else ""
        return f"<{type(self).__name__} of {self.title}: {self.lead}: {known}{open_ones}>"

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
        from stribeck.identify import saved

        return saved.load(folder, trust)

    def report(self, path: Path | str) -> None:
        """Write the page of the fit."""
        from stribeck.mouth import page

        place = Path(path)
        page.write(self.document(), place.parent, "", place.name, pictures=False)

    def save(self, folder: Path | str, command: str = "") -> list[str]:
        """Write the results, then report.html, into a folder; their names.

        Args:
            folder: the folder; made if missing.
            command: that made the fit: the files and the page name it.
        """
        from stribeck.identify import written

        return [Path(each).name for each in written.write_fit(self, Path(folder), command)]


@dataclass(frozen=True, repr=False)
class LogFit(Fit):
    """A law fitted to a log.

    Attributes:
        law_name: the law's name.
        method: "static" or "dynamic".
        estimates: the law's parameters; ``body``: what belongs to the rig: mass, offset, ...
        levels: friction at speeds that were seen.
        fixed: constants that were given, not fitted.
        used: every number that the fitted curve uses; for plots, not to be quoted.
        names: the parameters of ``covariance``, in its order; of fits by simulation.
        relative_force_error: norm(residual)/norm(force), a fraction.
        cross_validated_error: the same over blocks that were left out; None where it was not computed.
        status: "done", or "stopped" where Ctrl-C ended it: the values are the best until then.
        candidates: the laws that were compared, and plainer models of the same record.
        predictor: of the force along other records; None for fits by simulation.
        log, reading: the record, and how it was read.
    """

    law_name: str
    method: str
    estimates: dict[str, Estimate]
    body: dict[str, Estimate]
    fixed: dict[str, float]
    used: dict[str, float]
    relative_force_error: float
    data_hash: str
    levels: dict[str, Estimate] = field(default_factory=dict)
    names: tuple[str, ...] = ()
    covariance: Array = field(default_factory=lambda: np.zeros((0, 0)))
    cross_validated_error: float | None = None
    prediction: Prediction | None = None
    notes: tuple[str, ...] = ()
    details: FitDetails = field(default_factory=FitDetails)
    status: str = "done"
    candidates: tuple[Candidate, ...] = ()
    predictor: Predictor | None = None
    log: Log | None = None
    reading: RecordReading = field(default_factory=RecordReading)

    @property
    def parameters(self) -> dict[str, Estimate]:
        """All estimates: of the law, of the rig, and the levels."""
        return {**self.estimates, **self.body, **self.levels}

    @property
    def speeds(self) -> Mapping[str, float]:
        """The speed of each level, m/s or rad/s."""
        return self.details.get("speeds", {})

    @property
    def title(self) -> str:
        """The record's file, or how many there are."""
        return self.reading.title

    @property
    def lead(self) -> str:
        """The law, and what it leaves."""
        text = f"{self.law_name}, relative residual {percent(self.relative_force_error)}"
        if "output" in self.details and (left := self.details.get("output_error")) is not None:
            text += f" of the force and {percent(left)} of the {self.details['output']}"
        return text if self.status == "done" else f"{self.status}: {text}"

    @property
    def correlations(self) -> Array:
        """The covariance scaled to a diagonal of ones."""
        with np.errstate(all="ignore"):
            deviation = np.sqrt(np.diag(self.covariance))
            return np.asarray(self.covariance / np.outer(deviation, deviation))

    @property
    def values(self) -> dict[str, float]:
        """The law's constants that are known: identified ones and given ones."""
        return {**self.fixed, **{n: e.value for n, e in self.estimates.items() if e.identifiable}}

    @property
    def of_curve(self) -> dict[str, float]:
        """The constants of the law, words too, and the terms of the body, as the fitted curve has them."""
        known = laws.find(self.law_name).constants()
        return {n: x for n, x in {**self.fixed, **self.used}.items() if n in known or n in TERMS}

    @property
    def terms(self) -> tuple[str, ...]:
        """The terms of the body that the curve has."""
        return tuple(n for n in self.of_curve if n in TERMS)

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """The terms that the curve has, and those that its forms act like."""
        forms = self.predictor.forms if self.predictor else {}
        return (*self.terms, *dict.fromkeys(t for f, t in _LIKE.items() if any(key[0] == f for key in forms)))

    @property
    def expected(self) -> float | None:
        """The error that another record of the machine is expected to have, inside the ranges that were seen."""
        return EXPECTED * self.predictor.error if self.predictor else None

    @property
    def known(self) -> dict[str, float | None]:
        """The errors of the fit itself, for comparison with those of a prediction."""
        return {
            "relative_force_error": self.relative_force_error, "cross_validated_error": self.cross_validated_error,
            "friction_error": self.details.get("friction_error"), "missed": self.details.get("missed"),
        }  # fmt: skip

    def law(self, *, accept: Sequence[str] = (), guessing: bool = False) -> Law:
        """The law of the fitted curve.

        Args:
            accept: parameters to take although the data do not determine them.
            guessing: take all: for plots.

        Raises:
            InputError: a parameter that the law needs is not determined by the data, with the experiment that would.
        """
        missing = [n for n, e in self.estimates.items() if not (e.usable or guessing or n in accept)]
        if missing:
            told = [(n, self.estimates[n]) for n in missing]
            texts = [
                f"{n}: {e.state}{f': {e.why}' if e.why else ''}; {arg('accept')} takes it as it is; {e.experiment}"
                for n, e in told
            ]
            raise InputError(texts)
        found = laws.find(self.law_name)
        return found({n: v for n, v in {**self.fixed, **self.used}.items() if n in found.constants()})

    def predict(self, data: object, **columns: str) -> Predicted:
        """The force that the fitted model predicts for another record, with its error.

        Args:
            data: a file, a table of columns or a Log; columns as in the fit unless given.
        """
        from stribeck.identify import predict

        found = predict.predict(data, self, columns=columns)
        assert isinstance(found, predict.Predicted)
        return found

    def plot(self) -> Figure:
        """Measured friction and the fitted law against the velocity, as a Matplotlib figure."""
        from stribeck.identify import figures
        from stribeck.mouth import plots

        if self.prediction is None:
            raise InputError("fit: it holds no measured friction; there is nothing to plot")
        with plots.style():
            return figures.curve(self, self.prediction)

    def document(self) -> Document:
        """What the fit says to people, for the terminal and for a page."""
        from stribeck.identify import said

        return said.of_log(self)

    def to_dict(self) -> dict[str, object]:
        """What ``stribeck fit --json`` prints."""
        told: Mapping[str, object] = {**self.details}
        matrix = {"names": list(self.names), "matrix": self.covariance.tolist()}
        of_simulation = {"covariance": matrix, "correlations": self.correlations.tolist()} if self.names else {}
        return {
            "law": self.law_name, "method": self.method, "status": self.status,
            "parameters": {n: e.to_dict() for n, e in self.estimates.items()},
            "body": {n: e.to_dict() for n, e in self.body.items()},
            "levels": {n: e.to_dict() for n, e in self.levels.items()},
            "fixed": self.fixed, **of_simulation,
            "relative_force_error": self.relative_force_error, "cross_validated_error": self.cross_validated_error,
            "unidentified": list(self.unidentified), "candidates": [dict(c) for c in self.candidates],
            **{name: told[name] for name in _TOLD if told.get(name) is not None},
            "data_hash": self.data_hash, "notes": list(self.notes),
        }  # fmt: skip
