"""A fitted model on another record: what force it predicts, and how far off that is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from stribeck.errors import InputError, arg
from stribeck.identify import api
from stribeck.identify.beyond import Beyond, beyond
from stribeck.identify.core.judging import EXPLAINED
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.features.rest import at_rest
from stribeck.identify.log import Log, Trace, size_ratio
from stribeck.identify.models import terms
from stribeck.identify.onebody import initial_deflections, parts
from stribeck.identify.result import Fit, LogFit, RecordReading
from stribeck.identify.validate import Validated, validate
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Document
from stribeck.mouth.terminal import Told
from stribeck.scenario import Scenario


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
        from stribeck.identify import said

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
        if self.model.expected and inside > self.model.expected:
            usual = percent(self.model.expected)
            notes.append(
                f"The residual{within} is {percent(inside)}; {usual} is expected of another motion of this machine."
            )
        if (self.model.missed or 0.0) > EXPLAINED:
            notes.append(
                "The fit's own residual exceeds a quarter of its force's deviation: its model does not describe the data."
            )
        if self.beyond and (outside := self.beyond.text()):
            notes.append(f"{outside[:1].upper()}{outside[1:]}.")
        return notes


def predict(
    data: object,
    fit: Fit | Path | str | None = None,
    machine: Scenario | str | Path | Mapping[str, object] | None = None,
    *,
    columns: Mapping[str, str] | None = None,
    unit: Mapping[str, str] | None = None,
    force_gain: float | str | None = None,
    cutoff: float | None = None,
    trust: bool = False,
    **named: str,
) -> Predicted | Validated:
    """Predict another record by a fit of a log, or by a machine that is simulated.

    Args:
        data: the record: a file, a table of columns, several of one layout, or a :class:`stribeck.identify.log.Log`; for a
            ``machine`` one file.
        fit: the fit, or the folder that it was saved in; columns, unit, force_gain and cutoff are the fit's unless given.
        machine: a scenario of one body, whose motion is compared with the record.
        columns: the record's column for each role; also as keywords (``time="t"``). Of a machine ``command`` replaces its
            signal.
        unit: unit of a column by its name; SI unless given.
        force_gain: force per unit of the force column.
        cutoff: cut-off frequency of the motion's filter, Hz.
        trust: execute a fit's law in a file (``FILE.py:NAME``) wherever it lies.
        **named: columns by role.

    Returns:
        The predicted force of a fit, or the motion of the machine beside the measured one; each with its errors.

    Raises:
        InputError: the record or the fit cannot be used; not one of fit and machine is given.
    """
    names = ColumnNames({**(columns or {}), **named}, dict(unit or {}), force_gain)
    if (fit is None) == (machine is None):
        raise InputError(f"{arg('fit')}, {arg('machine')}: one must be given, and not both")
    if machine is not None:
        if not isinstance(data, str | Path):
            raise InputError(f"{arg('data')}: must be one file for a machine")
        return validate(Scenario.of(machine), Path(data), names.names, names.units, names.force_gain)
    model = fit if isinstance(fit, Fit) else Fit.load(str(fit), trust)
    if not isinstance(model, LogFit):
        raise InputError(
            f"{arg('fit')}: {model.title}: is a fit of a machine; give its machine.toml as {arg('machine')}"
        )
    if isinstance(data, Log):
        return force_along(model, data)
    kept = model.reading
    how = kept.how if cutoff is None else replace(kept.how, cutoff=cutoff)
    as_fitted = names.over(kept.named)
    units = {n: u for n, u in as_fitted.units.items() if n in names.units or n in as_fitted.names.values()}
    log = api.read_log(data, replace(as_fitted, units=units), how)
    return force_along(model, log, RecordReading(api.files_of(data)).title)


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
