"""``stribeck.predict``: another record by a fit, or by a machine that is simulated."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from stribeck.errors import InputError, arg
from stribeck.identify.data.read import ColumnNames
from stribeck.identify.predicted import Predicted, predicted
from stribeck.identify.result import Fit, LogFit
from stribeck.identify.validate import Validated, validate
from stribeck.scenario import Scenario


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
    return predicted(model, data, names, cutoff)
