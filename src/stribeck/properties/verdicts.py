"""What a check returns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from time import monotonic
from typing import Any

from stribeck.laws.base import Law

_AGAIN = 60.0  # s: a second run of a proof that was found in a few may take as long
NAMES = ("unique", "bounded", "smooth", "passive", "drift_free")


@dataclass
class Verdict:
    """Whether a property holds.

    Attributes:
        holds: True (proved), False (a counterexample is in the evidence) or None (undecided; the evidence says why).
        method: how it was decided.
        evidence: numbers that belong to it, SI units.
        scenario: of a counterexample, the tables of a scenario that shows it; else None.
        verified: whether a second run of the proof or the replay agreed; None where none was made.
    """

    holds: bool | None
    method: str
    evidence: dict[str, Any] = field(default_factory=dict)
    scenario: dict[str, Any] | None = None
    verified: bool | None = None
    again: Callable[[], bool] | None = field(default=None, repr=False)

    def to_json(self) -> dict[str, Any]:
        """The verdict as JSON."""
        data: dict[str, Any] = {"holds": self.holds, "method": self.method, "evidence": self.evidence}
        return data if self.verified is None else {**data, "verified": self.verified}


def later() -> float:
    """The deadline of a proof's second run."""
    return monotonic() + _AGAIN


def undecided(reason: str, **evidence: Any) -> Verdict:
    """Neither proved nor refuted."""
    return Verdict(None, "undecided", {"reason": reason, **evidence})


@dataclass
class Verdicts:
    """The verdicts on a law with its constants; ``properties`` holds a :class:`Verdict` by name."""

    law: Law
    properties: dict[str, Verdict]
    v_max: float | None = None
    seconds: float = 0.0

    def __getitem__(self, name: str) -> Verdict:
        return self.properties[name]

    def verify(self) -> bool:
        """Run every proof and replay every counterexample once more; True where all agree."""
        for verdict in self.properties.values():
            if verdict.again is not None:
                verdict.verified = verdict.again()
        return all(verdict.verified is not False for verdict in self.properties.values())

    def to_json(self) -> dict[str, Any]:
        """``{"law": ..., "properties": {NAME: {"holds", "method", "evidence"}}}`` and what belongs to it."""
        return {
            "law": self.law.name,
            "properties": {name: verdict.to_json() for name, verdict in self.properties.items()},
            "constants": {**self.law.values, **self.law.choices},
            "v_max": self.v_max,
        }
