"""The force that a fit predicts for another record, and its error."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from stribeck.errors import InputError, arg
from stribeck.identify import said
from stribeck.identify.beyond import Beyond, beyond
from stribeck.identify.core.judging import EXPLAINED
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.data.reading import RecordReading, files_of, read_log
from stribeck.identify.features.rest import at_rest
from stribeck.identify.force import initial_deflections, parts
from stribeck.identify.log import Log, Trace, size_ratio
from stribeck.identify.models import terms
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Document
from stribeck.mouth.terminal import Told

if TYPE_CHECKING:
    from stribeck.identify.result import LogFit


@dataclass(frozen=True)
class Predicted(Told):
    """A prediction of the force of a record.

    Attributes:
        force_error: norm(residual)/norm(force) over the compared rows: for a static law the rows that slide, no slower than
            the fit has seen; for a law with bristles all rows.
        friction_error: the same over norm(friction), which is the force less the terms that are not friction.
        all_rows_error: as the first, over all rows.
        constant_error: as the first, for a prediction by the mean force: a model must leave less to be of use.
        slow: the share of the rows that are not compared: at rest, or slower than the fit has seen.
        beyond: rows beyond what the fit has seen; None where it tells no ranges.
        force, friction: measured and predicted, against time.
        title: the record; ``fitted``: whether the fit was made from this very record.
    """

    model: LogFit
    force_error: float
    friction_error: float
    all_rows_error: float
    constant_error: float
    slow: float
    beyond: Beyond | None
    force: Trace
    friction: Trace
    title: str
    fitted: bool

    def document(self) -> Document:
        """The document of the prediction, for the terminal and for a page."""
        return said.of_prediction(self)

    def to_dict(self) -> dict[str, object]:
        """The JSON of ``stribeck predict --json``."""
        return {
            "law": self.model.law_name, "method": self.model.method, "relative_force_error": self.force_error,
            "friction_error": self.friction_error, "all_rows_error": self.all_rows_error,
            "constant_error": self.constant_error, "expected_error": self.model.expected, "slow": self.slow,
            "fit": self.model.known, "beyond": self.beyond.to_dict() if self.beyond else None,
        }  # fmt: skip

    def notes(self) -> list[str]:
        """The notes of the report, a sentence each."""
        notes = []
        if self.fitted:
            notes.append("This recording was used in the fit: test the fit with a recording of another motion.")
        if self.constant_error <= self.force_error:
            notes.append("A constant force predicts this recording better than the model.")
        inside, within = self.force_error, ""
        if self.beyond and self.beyond.rows and self.beyond.within is not None:
            inside, within = self.beyond.within, " within the fitted range"
        here, usual = percent(inside), percent(self.model.expected)
        if inside > (self.model.expected or np.inf) and here != usual:
            notes.append(f"The residual{within} is {here}; {usual} is expected of another motion of this machine.")
        if (self.model.missed or 0.0) > EXPLAINED:
            notes.append(
                "The fit's own residual exceeds a quarter of its force's deviation: its model does not describe the data."
            )
        if self.beyond and (outside := self.beyond.text()):
            notes.append(f"{outside[:1].upper()}{outside[1:]}.")
        return notes


def predicted(fit: LogFit, data: object, names: ColumnNames, cutoff: float | None = None) -> Predicted:
    """The force that a fitted model predicts for a record; the record is read as that of the fit, unless told otherwise.

    Raises:
        InputError, StribeckError: as :func:`force_along`; the record cannot be read.
    """
    if isinstance(data, Log):
        return force_along(fit, data)
    kept = fit.reading
    how = kept.how if cutoff is None else replace(kept.how, cutoff=cutoff)
    as_fitted = names.over(kept.named)
    units = {n: u for n, u in as_fitted.units.items() if n in names.units or n in as_fitted.names.values()}
    log = read_log(data, replace(as_fitted, units=units), how)
    return force_along(fit, log, RecordReading(files_of(data)).title)


def force_along(fit: LogFit, log: Log, title: str = "the record") -> Predicted:
    """The force that a fitted model predicts for a record, which its fit has not seen.

    Raises:
        InputError: the record lacks a column that a term takes.
        StribeckError: the simulation fails.
    """
    terms.check(fit.terms, log)
    rows, unit = np.ones(len(log), bool), log.unit("N")
    if fit.slowest is not None:
        rows = ~at_rest(log) & (abs(log.velocity) >= fit.slowest)
        if not rows.any():
            raise InputError(
                f"{arg('data')}: the body is nowhere as fast as {fit.slowest:.3g} {log.unit('m/s')}, the slowest sliding that "
                "was fitted: a static law does not tell the force there"
            )
    if fit.predictor is None:
        deflections = initial_deflections(fit.law_name, fit.values, log)
        modeled_friction, not_friction = parts(fit.law_name, fit.values, log, deflections)
    else:
        modeled_friction, not_friction = fit.predictor.parts(log)
    force = modeled_friction + not_friction
    left = log.force - not_friction
    residual, measured = log.force - force, log.force[rows]
    return Predicted(
        fit, size_ratio(residual[rows], measured), size_ratio(residual[rows], left[rows]), size_ratio(residual, log.force),
        size_ratio(measured - float(np.mean(measured)), measured), float(np.mean(~rows)),
        beyond(fit.seen, fit.hangs_on, log, rows, residual) if fit.seen else None,
        Trace("force", unit, log.time, log.force, force), Trace("friction", unit, log.time, left, modeled_friction),
        title, log.hash == fit.data_hash,
    )  # fmt: skip
