"""One scenario under several laws: how far each is from the first."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from stribeck.scenario import Scenario
from stribeck.simulation import Solution, simulate

COMPARED = ("y", "v", "F")


def compared(scenario: Scenario) -> tuple[str, ...]:
    """The columns that are compared: of a machine, those of each body, contact and link."""
    if scenario.rig is None:
        return COMPARED
    machine = scenario.rig.machine
    found = [f"{body.name}.{x}" for body in machine.bodies if body.leader is None for x in ("y", "v")]
    return (*found, *(f"{x.name}.F" for x in machine.contacts), *(f"{x.name}.f" for x in machine.links))


@dataclass(frozen=True)
class Comparison:
    """Solutions by label, the first being the reference, and the deviations of the others from it."""

    name: str
    solutions: dict[str, Solution]
    deviations: dict[str, dict[str, dict[str, float | None]]]

    @property
    def status(self) -> str:
        """``"done"`` when every law was simulated to the end, else ``"failed"``."""
        return "done" if all(s.status == "done" for s in self.solutions.values()) else "failed"

    def summary(self) -> dict[str, Any]:
        """What ``stribeck compare --json`` prints, without the files."""
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
                    "peaks": {name: s.peaks[name] for name in compared(s.scenario)},
                    "deviations": self.deviations.get(label),
                }
                for label, s in self.solutions.items()
            },
        }


def deviations(reference: Solution, other: Solution) -> dict[str, dict[str, float | None]]:
    """Largest and root-mean-square deviation of y, v and F over the common rows, absolute and relative to the
    reference's peak there (None where that peak is 0)."""
    rows = min(len(reference.t), len(other.t))
    found: dict[str, dict[str, float | None]] = {}
    for name in compared(reference.scenario):
        a, b = reference[name][:rows], other[name][:rows]
        with np.errstate(all="ignore"):
            largest = float(np.max(np.abs(b - a), initial=0.0))
            rms = float(np.sqrt(np.mean((b - a) ** 2))) if rows else 0.0
        peak = float(np.max(np.abs(a), initial=0.0))
        found[name] = {
            "max": largest,
            "rms": rms,
            "max_relative": largest / peak if peak else None,
            "rms_relative": rms / peak if peak else None,
        }
    return found


def compare_laws(variants: Mapping[str, Scenario], progress: Callable[[float], None] | None = None) -> Comparison:
    """Simulate each variant of a scenario; deviations are from the first."""
    solutions: dict[str, Solution] = {}
    for i, (label, scenario) in enumerate(variants.items()):

        def tell(share: float, done: int = i) -> None:
            if progress is not None:
                progress((done + share) / len(variants))

        solutions[label] = simulate(scenario, tell)
    labels = list(solutions)
    reference = solutions[labels[0]]
    found = {label: deviations(reference, solutions[label]) for label in labels[1:]}
    return Comparison(reference.scenario.name, solutions, found)
