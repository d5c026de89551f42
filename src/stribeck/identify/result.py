"""What a fit returns: estimates with two uncertainties, the candidates, and the model that was chosen."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError, arg
from stribeck.identify.core.predictor import Predictor
from stribeck.identify.core.states import Estimate as Estimate
from stribeck.identify.details import Candidate, FitDetails
from stribeck.identify.log import Log
from stribeck.laws.base import Law

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


@dataclass(frozen=True)
class Prediction:
    """Measured friction and the fit's, row by row (SI): for plots and residuals."""

    time: Array
    position: Array
    velocity: Array
    measured: Array
    fitted: Array


@dataclass(frozen=True, repr=False)
class Fit:
    """The result of a fit.

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
        notes: what a reader should know, a sentence each, the most important one first.
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
    reading: Mapping[str, object] = field(default_factory=dict)

    @property
    def parameters(self) -> dict[str, Estimate]:
        """All estimates: of the law, of the rig, and the levels."""
        return {**self.estimates, **self.body, **self.levels}

    def __getitem__(self, name: str) -> Estimate:
        """An estimate by name.

        Raises:
            KeyError: there is no such parameter; the message names those that there are.
        """
        if name not in self.parameters:
            raise KeyError(f"{name!r}: no such parameter (it has {', '.join(self.parameters)})")
        return self.parameters[name]

    def __repr__(self) -> str:
        known = ", ".join(f"{n} = {e.value:.4g}" for n, e in self.estimates.items() if e.identifiable)
        open_ones = f"; not identifiable: {', '.join(self.unidentified)}" if self.unidentified else ""
        left = f"relative residual {100 * self.relative_force_error:.3g} %"
        return f"<Fit {self.law_name}, {self.method}, {left}: {known}{open_ones}>"

    def _repr_html_(self) -> str:
        """For notebooks: the estimates with both uncertainties."""
        head = "".join(f"<th>{word}</th>" for word in ("", "estimate", "95 % interval", "model range", "unit", "state"))
        rows = ""
        for name, e in self.parameters.items():
            ends = (" to ".join(f"{x:.4g}" for x in pair) if pair else "-" for pair in (e.interval, e.range))
            cells = (name, f"{e.value:.4g}", *ends, e.unit, str(e.state))
            rows += f"<tr>{''.join(f'<td>{escape(x)}</td>' for x in cells)}</tr>"
        title = f"{self.law_name}, {self.method} fit: relative residual {100 * self.relative_force_error:.3g} %"
        notes = "".join(f"<li>{escape(note)}</li>" for note in self.notes)
        return f"<b>{escape(title)}</b><table><tr>{head}</tr>{rows}</table>{f'<ul>{notes}</ul>' if notes else ''}"

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
    def unidentified(self) -> tuple[str, ...]:
        """The parameters that the data do not determine."""
        return tuple(n for n, e in {**self.estimates, **self.body}.items() if not e.identifiable)

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

        return predict.predicted(self, data, columns)

    def plot(self) -> Figure:
        """Measured friction and the fitted law against the velocity, as a Matplotlib figure."""
        from stribeck.identify.report import pictures

        return pictures.curve_figure(self)

    def report(self, path: Path | str) -> None:
        """Write the page of the fit."""
        from stribeck.files import write_text
        from stribeck.identify.report.page import page

        write_text(Path(path), page(self, "", "the record"))

    def save(self, folder: Path | str) -> list[str]:
        """Write parameters.toml, fit.json and report.html into a folder, results before the page; their names."""
        from stribeck.identify.report.files import write_fit

        return write_fit(self, Path(folder), "", "the record")

    def to_json(self) -> dict[str, object]:
        """What ``stribeck fit --json`` prints."""
        told: Mapping[str, object] = {**self.details}
        matrix = {"names": list(self.names), "matrix": self.covariance.tolist()}
        of_simulation = {"covariance": matrix, "correlations": self.correlations.tolist()} if self.names else {}
        return {
            "law": self.law_name, "method": self.method, "status": self.status,
            "parameters": {n: e.to_json() for n, e in self.estimates.items()},
            "body": {n: e.to_json() for n, e in self.body.items()},
            "levels": {n: e.to_json() for n, e in self.levels.items()},
            "fixed": self.fixed, **of_simulation,
            "relative_force_error": self.relative_force_error, "cross_validated_error": self.cross_validated_error,
            "unidentified": list(self.unidentified), "candidates": [dict(c) for c in self.candidates],
            **{name: told[name] for name in _TOLD if told.get(name) is not None},
            "data_hash": self.data_hash, "notes": list(self.notes),
        }  # fmt: skip
