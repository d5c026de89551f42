"""Required precision of parameters: shortfalls of a fit, and experiments that remove them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TypeVar

import numpy as np

from stribeck.errors import InputError, arg
from stribeck.identify.core.states import Estimate, EstimateState
from stribeck.identify.features.guess import sizes_of
from stribeck.identify.features.what_to_measure import experiment_for
from stribeck.identify.models.forms import in_words
from stribeck.identify.result import Fit, LogFit, MachineFit
from stribeck.mouth.cells import percent

Kind = TypeVar("Kind", LogFit, MachineFit)


def with_requirements(fit: Kind, require: Mapping[str, float]) -> Kind:
    """The fit judged by what the user requires: a number is identified if its model range is within this share of it.

    Args:
        require: half widths as shares of the estimates, by name.

    Raises:
        InputError: the fit has no such number.
    """
    judged, wrong = fit.parameters, list[str]()
    notes: list[str] = []
    for name, share in require.items():
        try:
            path = fit.path_of(name)
        except KeyError as error:
            wrong.append(f"{arg('require')}: {error.args[0]}")
            continue
        e = _judged(fit[path], share)
        if e.state is not EstimateState.IDENTIFIED:
            e = replace(e, experiment=e.experiment or _experiment(fit, path))
            notes.append(_note(path, e, share))
        judged[path] = e
    if wrong:
        raise InputError(wrong)
    estimates, levels = ({n: judged[n] for n in part} for part in (fit.estimates, fit.levels))
    return replace(fit, estimates=estimates, levels=levels, notes=[*notes, *fit.notes])


def unmet(fit: Fit, require: Mapping[str, float]) -> bool:
    """Whether something that is required is not reached."""
    return any(fit[name].state is not EstimateState.IDENTIFIED for name in require)


def half_width(ends: tuple[float, float] | None, value: float) -> float:
    """The larger half width of an interval, relative to the estimate."""
    if ends is None or not value:
        return np.inf
    return max(abs(ends[0] - value), abs(ends[1] - value)) / abs(value)


def _judged(e: Estimate, share: float) -> Estimate:
    """The state by the required width instead of a factor of two. Bounds, and numbers that are not identifiable, stay so."""
    if e.state not in (EstimateState.IDENTIFIED, EstimateState.MODEL_DEPENDENT):
        return e
    if half_width(e.interval, e.value) > share:
        return replace(e, state=EstimateState.NOT_IDENTIFIABLE)
    wide = half_width(e.range or e.interval, e.value) > share
    return replace(e, state=EstimateState.MODEL_DEPENDENT) if wide else e


def _experiment(fit: Fit, name: str) -> str:
    """The motion that would identify a number of a log."""
    if not isinstance(fit, LogFit) or fit.log is None:
        return ""
    known = {n: x for n, x in fit.values.items() if isinstance(x, int | float)}
    return experiment_for(name, known, sizes_of(fit.log), fit.unidentified, rotary=fit.log.rotary)


def _note(name: str, e: Estimate, share: float) -> str:
    """The precision that is missing, and the experiment, in one sentence."""
    narrow, wide = half_width(e.interval, e.value), half_width(e.range or e.interval, e.value)
    if e.state in (EstimateState.AT_LEAST, EstimateState.AT_MOST):
        known = f"has a bound only ({e.state})"
    elif narrow > share:
        known = f"is known within {_share(narrow)} by its interval" if np.isfinite(narrow) else "has an open interval"
    elif wide <= share:
        known = f"is known within {_share(wide)}, but the fit is doubtful for the reasons in other notes"
    else:
        cause = f", because of {in_words(e.depends_on)}" if e.depends_on else ""
        known = f"is known within {_share(narrow)} by its interval, but {_share(wide)} by its model range{cause}"
    measure = f". To measure: {e.experiment}" if e.experiment else ""
    return f"{name} {known}; {percent(share)} is required{measure}."


def _share(x: float) -> str:
    return percent(x) if x < 1 else f"{x:.2g} times itself"
