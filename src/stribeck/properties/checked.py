"""The five properties of one law, each decided once; some proofs rest on others."""

from __future__ import annotations

from functools import cached_property

from stribeck.laws.base import Law
from stribeck.properties import bounded, drift, passive, smooth, unique
from stribeck.properties.certificate import Certificate
from stribeck.properties.claims import ClaimProver
from stribeck.properties.model import Model, Unreadable
from stribeck.properties.prover.search import Budget
from stribeck.properties.verdicts import Verdict, undecided

SHARES = {"bounded": 0.2, "unique": 0.5, "smooth": 0.1, "passive": 0.65, "drift_free": 0.1}


class Checked:
    """Decides the properties; ``work`` is shared out among them beforehand, so that none depends on the others' luck."""

    def __init__(self, law: Law, v_max: float | None, work: float) -> None:
        self.law, self.v_max, self.work = law, v_max, work

    @cached_property
    def model(self) -> Model:
        """The law's equations."""
        return Model(self.law, self.v_max)

    def claims(self, name: str) -> ClaimProver:
        """A prover with its share of the work."""
        return ClaimProver(self.model, Budget(SHARES[name] * self.work))

    @cached_property
    def _bounded(self) -> tuple[Verdict, Certificate | None]:
        claims = self.claims("bounded")
        certificate = bounded.prove(self.model, claims)
        return bounded.decide(self.model, certificate), certificate

    def bounded(self) -> Verdict:
        """|z| <= Z for ever."""
        try:
            return self._bounded[0]
        except Unreadable as error:
            return undecided(str(error))

    def unique(self) -> Verdict:
        """One solution."""
        try:
            certificate = self._bounded[1]
            return unique.decide(self.model, self.claims("unique"), certificate)
        except Unreadable as error:
            return undecided(str(error))

    def smooth(self) -> Verdict:
        """Continuously differentiable."""
        try:
            return smooth.decide(self.model, self.claims("smooth"))
        except Unreadable as error:
            return undecided(str(error))

    def passive(self) -> Verdict:
        """No more energy is given than was taken."""
        try:
            verdict, certificate = self._bounded
            return passive.decide(self.model, self.claims("passive"), certificate, verdict.holds is False)
        except Unreadable as error:
            return undecided(str(error))

    def drift_free(self) -> Verdict:
        """Elastic below some deflection."""
        try:
            return drift.decide(self.model, self.claims("drift_free"))
        except Unreadable as error:
            return undecided(str(error))
