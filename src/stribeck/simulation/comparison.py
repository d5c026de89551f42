"""Comparison of one scenario under several laws: the deviation of each from the first."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from stribeck.errors import InputError, arg, nearest
from stribeck.scenario import Scenario
from stribeck.simulation import Solution, simulate

if TYPE_CHECKING:
    from stribeck.mouth.document import Document


@dataclass(frozen=True)
class Comparison:
    """Solutions by label, of which the first is the reference, and the deviations of the others from it."""

    name: str
    solutions: dict[str, Solution]
    deviations: dict[str, dict[str, dict[str, float | None]]]

    @property
    def status(self) -> str:
        """``"done"`` if every law was simulated to the end, otherwise ``"failed"``."""
        return "done" if all(s.status == "done" for s in self.solutions.values()) else "failed"

    def document(self) -> Document:
        """The comparison as a document, for the terminal and for a page."""
        from stribeck.simulation import said

        return said.comparison(self)

    def summary(self) -> dict[str, object]:
        """The JSON of ``stribeck run --json`` with several laws, without the files."""
        labels = list(self.solutions)
        failed = {label: s.reason for label, s in self.solutions.items() if s.reason}
        return {
            "status": self.status,
            "reason": "; ".join(f"{label}: {reason}" for label, reason in failed.items()) or None,
            "scenario": self.name,
            "reference": labels[0],
            "laws": {
                label: {
                    "status": s.status,
                    **s.laws,
                    "rows": len(s.t),
                    "peaks": {name: s.peaks[name] for name in s.scenario.system.compared},
                    "deviations": self.deviations.get(label),
                }
                for label, s in self.solutions.items()
            },
        }


def deviations(reference: Solution, other: Solution) -> dict[str, dict[str, float | None]]:
    """Largest and root-mean-square deviation of the compared columns over the common rows, absolute and relative to the
    reference's peak there (None if that peak is 0)."""
    rows = min(len(reference.t), len(other.t))
    deviation: dict[str, dict[str, float | None]] = {}
    for name in reference.scenario.system.compared:
        a, b = reference[name][:rows], other[name][:rows]
        with np.errstate(all="ignore"):
            largest = float(np.max(np.abs(b - a), initial=0.0))
            rms = float(np.sqrt(np.mean((b - a) ** 2))) if rows else 0.0
        peak = float(np.max(np.abs(a), initial=0.0))
        deviation[name] = {
            "max": largest,
            "rms": rms,
            "max_relative": largest / peak if peak else None,
            "rms_relative": rms / peak if peak else None,
        }
    return deviation


def compare_laws(variants: Mapping[str, Scenario], progress: Callable[[float], None]) -> Comparison:
    """Simulate each variant of a scenario; deviations are from the first."""
    solutions: dict[str, Solution] = {}
    for i, (label, scenario) in enumerate(variants.items()):

        def tell(share: float, done: int = i) -> None:
            progress((done + share) / len(variants))

        solutions[label] = simulate(scenario, progress=tell)
    labels = list(solutions)
    reference = solutions[labels[0]]
    deviations_by_label = {label: deviations(reference, solutions[label]) for label in labels[1:]}
    return Comparison(reference.scenario.name, solutions, deviations_by_label)


def law_path(scenario: Scenario, contact: str | None) -> str:
    """The path of the law to replace: that of the ``contact``, or of the only one.

    Raises:
        InputError: if there is no such contact, or if there are several and none is given.
    """
    names = list(scenario.elements.contacts)
    if names == [""]:
        if contact is not None:
            raise InputError(f"{arg('contact')}: {contact!r}: must be left out: {scenario.name} is no machine")
        return "law"
    if contact is None and len(names) == 1:
        contact = names[0]
    if contact is None:
        known = f"one of {', '.join(names)}" if names else "of a contact, and there is none"
        raise InputError(f"{arg('contact')}: missing: must be given ({known})")
    if contact not in names:
        guess = nearest(contact, names) or f" (there is {', '.join(names) or 'none'})"
        raise InputError(f"{arg('contact')}: {contact!r}: there is no such contact{guess}")
    return f"contacts.{contact}.law"
