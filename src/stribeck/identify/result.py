"""What a fit returns: estimates with intervals, and a verdict on what the data cannot tell."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape

import numpy as np

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import InputError
from stribeck.identify.details import FitDetails
from stribeck.laws.base import Law

_TOLD = (
    "levels",
    "selection",
    "candidates",
    "friction_error",
    "rest",
    "misfit_share",
    "intervals_over",
    "output_error",
)


@dataclass(frozen=True)
class Estimate:
    """A parameter as the data tell it.

    ``low`` and ``high`` bound the 95 % interval; None is an open side. Where the data do not determine the parameter,
    ``identifiable`` is False, ``value`` is None, ``why`` says what is missing and ``experiment`` what to measure; ``best`` is
    what the fitted curve uses, known or not.
    """

    value: float | None
    low: float | None
    high: float | None
    unit: str
    identifiable: bool = True
    why: str = ""
    experiment: str = ""
    best: float | None = None

    @property
    def doubt(self) -> str:
        """Why the data do not determine it, and the range that they leave."""
        alike = self.low and self.high and abs(self.high / self.low - 1) < 0.02
        digits = 6 if alike else 3
        ends = [
            f"{word} {x:.{digits}g} {self.unit}"
            for word, x in (("above", self.low), ("below", self.high))
            if x is not None
        ]
        return self.why + (f" (95 %: {' and '.join(ends)})" if ends else "")

    def to_json(self) -> dict[str, object]:
        """As the contract has it, with why and experiment where there is something to say."""
        words = {key: getattr(self, key) for key in ("why", "experiment") if getattr(self, key)}
        keys = ("value", "low", "high", "unit", "identifiable")
        best = {} if self.identifiable or self.best is None else {"best": self.best}
        return {key: getattr(self, key) for key in keys} | best | words


@dataclass(frozen=True)
class Profile:
    """Cost along a parameter, all others optimised: the values tried and how far 2 * log-likelihood falls there."""

    values: Array
    fall: Array


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
        law: the law's name.
        method: "static", "presliding" or "dynamic".
        estimates: the law's parameters by name.
        body: what belongs to the rig, not to the law: mass, offset, ...
        fixed: constants that were given, not fitted.
        used: every number that the fitted curve uses, unidentifiable ones too; for plots, not to be quoted.
        names: the parameters of ``covariance``, in its order.
        relative_force_error: norm(residual)/norm(force), a fraction.
        cross_validated_error: the same over blocks that were left out; None where it was not computed.
        notes: what a reader should know, a line each.
        status: "done", or "stopped" where Ctrl-C ended it: the values are the best until then.
    """

    law: str
    method: str
    estimates: dict[str, Estimate]
    body: dict[str, Estimate]
    fixed: dict[str, float]
    used: dict[str, float]
    names: tuple[str, ...]
    covariance: Array
    relative_force_error: float
    data_hash: str
    cross_validated_error: float | None = None
    profiles: Mapping[str, Profile] = field(default_factory=dict)
    prediction: Prediction | None = None
    notes: tuple[str, ...] = ()
    details: FitDetails = field(default_factory=FitDetails)
    status: str = "done"

    def __repr__(self) -> str:
        known = (f"{n} = {e.value:.4g}" for n, e in self.estimates.items() if e.value is not None)
        unknown = f"; not determined: {', '.join(self.unidentified)}" if self.unidentified else ""
        error = f"error {100 * self.relative_force_error:.3g} %"
        return f"<Fit {self.law}, {self.method}, {error}: {', '.join(known)}{unknown}>"

    def _repr_html_(self) -> str:
        """For notebooks: the estimates with their intervals, and what the data do not determine."""
        rows = ""
        for name, e in {**self.estimates, **self.body}.items():
            ends = ("-" if x is None else f"{x:.4g}" for x in (e.low, e.high))
            value = "-" if e.value is None else f"{e.value:.4g}"
            cells = (name, value, " to ".join(ends), e.unit, "" if e.identifiable else e.why)
            rows += f"<tr>{''.join(f'<td>{escape(x)}</td>' for x in cells)}</tr>"
        head = "".join(f"<th>{word}</th>" for word in ("", "value", "95 %", "unit", "not determined"))
        title = f"{self.law}, {self.method} fit: {100 * self.relative_force_error:.3g} % of the force is left"
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
        known = {n: e.value for n, e in self.estimates.items() if e.identifiable and e.value is not None}
        return {**self.fixed, **known}

    @property
    def unidentified(self) -> tuple[str, ...]:
        """The parameters that the data do not determine."""
        return tuple(n for n, e in {**self.estimates, **self.body}.items() if not e.identifiable)

    def as_law(self, *, guessing: bool = False) -> Law:
        """The law of the fitted curve.

        Args:
            guessing: take for what the data do not determine the number that the curve happens to use: for plots.

        Raises:
            InputError: a parameter that the law needs is not determined by the data, with the experiment that would.
        """
        missing = [n for n in self.unidentified if n in self.estimates]
        if missing and not guessing:
            raise InputError(
                [
                    f"{n}: not determined by the data: {self.estimates[n].why}; {self.estimates[n].experiment}"
                    for n in missing
                ]
            )
        found = laws.find(self.law)
        return found({n: v for n, v in {**self.fixed, **self.used, **self.values}.items() if n in found.constants()})

    def to_json(self) -> dict[str, object]:
        """What ``stribeck fit --json`` prints."""
        told: Mapping[str, object] = {**self.details}
        return {
            "law": self.law,
            "method": self.method,
            "status": self.status,
            "parameters": {n: e.to_json() for n, e in self.estimates.items()},
            "body": {n: e.to_json() for n, e in self.body.items()},
            "fixed": self.fixed,
            "covariance": {"names": list(self.names), "matrix": self.covariance.tolist()},
            "correlations": self.correlations.tolist(),
            "relative_force_error": self.relative_force_error,
            "cross_validated_error": self.cross_validated_error,
            "unidentified": list(self.unidentified),
            **{name: told[name] for name in _TOLD if told.get(name) is not None},
            "data_hash": self.data_hash,
            "notes": list(self.notes),
        }
