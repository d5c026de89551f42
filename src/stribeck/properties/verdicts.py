"""The results of a check."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from stribeck.constants import DECIDED
from stribeck.laws.base import Law
from stribeck.laws.render import ranges_in_words
from stribeck.mouth.document import Document
from stribeck.mouth.terminal import Told
from stribeck.properties.certificate import FORMAT, Certificate
from stribeck.properties.plain import Json
from stribeck.properties.statement import statement

if TYPE_CHECKING:
    from stribeck.properties.model import Model
    from stribeck.properties.steepness import Steepness
    from stribeck.properties.worst import Varied

NAMES = ("unique", "bounded", "smooth", "passive", "drift_free")


@dataclass(repr=False)
class Verdict:
    """Whether a property holds.

    Attributes:
        holds: True (proved), False (a counterexample is in the evidence) or None (undecided; the evidence says why).
        method: how it was decided.
        evidence: the values that support the decision, SI units; in ``replay`` the final values of ``scenario``.
        scenario: tables of a scenario that shows a counterexample, or None.
        certificate: the proof as plain data, which ``stribeck check --verify`` and other programs check, or None.
        verified: whether the independent checker, or a second run of a counterexample, agreed; None if neither was
            requested or applies.
        law: if constants vary, the law that was decided, which represents all laws or is one of them.
    """

    holds: bool | None
    method: str
    evidence: dict[str, Json] = field(default_factory=dict)
    scenario: dict[str, Json] | None = None
    verified: bool | None = None
    certificate: dict[str, Json] | None = field(default=None, repr=False)
    law: Law | None = field(default=None, repr=False)

    @property
    def reason(self) -> str:
        """The method of the decision, or the reason why there is none."""
        return str(self.evidence.get("reason", self.method)) if self.holds is None else self.method

    def __repr__(self) -> str:
        return f"{DECIDED[self.holds]}: {self.reason}"

    def to_dict(self) -> dict[str, Json]:
        """The verdict as JSON."""
        data: dict[str, Json] = {"holds": self.holds, "method": self.method, "evidence": self.evidence}
        return data if self.verified is None else {**data, "verified": self.verified}

    def verify(self, law: Law, name: str, v_max: float | None = None) -> bool | None:
        """Check the certificate with the independent checker, or run the scenario again; None for a law without z."""
        from stribeck.properties import replay

        if not law.has_z:
            return None
        if self.holds:
            self.verified = self.certificate is not None and not refusals(self.certificate, law, name, v_max)
        elif self.holds is False:
            from stribeck_verify import confirmed

            agreed = confirmed(statement(law), name, self.evidence)
            if self.scenario is not None and "replay" in self.evidence:
                agreed = agreed is not False and replay.repeats(self.scenario, self.evidence["replay"])
            self.verified = agreed
        return self.verified


def refusals(certificate: Json, law: Law, name: str, v_max: float | None = None) -> list[str]:
    """The reasons why the independent checker rejects a certificate of a law's property; none if it accepts."""
    from stribeck_verify import verify

    return verify(certificate, statement(law), name, v_max)


def accepted(verdict: Verdict, law: Law, name: str, v_max: float | None = None) -> Verdict:
    """The verdict, or undecided if the independent checker rejects its certificate."""
    if not verdict.holds:
        return verdict
    refused = refusals(verdict.certificate, law, name, v_max)
    return undecided(f"a proof was found, but the independent checker rejects it: {refused[0]}") if refused else verdict


def undecided(reason: str, **evidence: Json) -> Verdict:
    """Neither proved nor refuted."""
    return Verdict(None, "undecided", {"reason": reason, **evidence})


def proved(model: Model, certificate: Certificate, method: str, evidence: Mapping[str, Json]) -> Verdict:
    """A proof."""
    with_regions = {**evidence, "regions": certificate.leaves}
    return Verdict(True, method, with_regions, certificate=certificate.to_json(model))


@dataclass(repr=False)
class Verdicts(Told):
    """The verdicts on a law with its constants.

    Attributes:
        properties: a :class:`Verdict` by name.
        steepness: if tolerances were given, the smallest k_v that meets them, for the law and for the majorant law of its
            family.
        varied: if constants vary, the law and their ranges. Each verdict holds for every history within these.
    """

    law: Law
    properties: dict[str, Verdict]
    v_max: float | None = None
    steepness: dict[str, Steepness] = field(default_factory=dict)
    varied: Varied | None = None

    def __getitem__(self, name: str) -> Verdict:
        return self.properties[name]

    @property
    def level(self) -> dict[str, list[float | None]]:
        """The varying constants with their lower and upper bounds, None if unbounded; empty in a check without ``level``."""
        return {} if self.varied is None else self.varied.to_dict()

    def headings(self) -> list[str]:
        """The law with its constants, and the varying constants if any."""
        declared = self.law.constants()
        units = {n: declared[n].unit_for(self.law.rotary) for n in self.law.p.numbers}
        values = {n: f"{x:g} {units[n]}".rstrip() for n, x in self.law.p.numbers.items()} | self.law.choices
        lines = [f"{self.law.name} with " + ", ".join(f"{n} = {x}" for n, x in values.items())]
        return [*lines, f"for every history of {ranges_in_words(self.level, self.law)}"] if self.level else lines

    def document(self) -> Document:
        """The verdicts as a document, for the terminal and for a page."""
        from stribeck.properties import said

        return said.law(self)

    def __repr__(self) -> str:
        decided = ", ".join(f"{name} {DECIDED[v.holds]}" for name, v in self.properties.items())
        return f"<{type(self).__name__} on {self.law.name}: {decided}>"

    def verify(self) -> bool:
        """Check every proof's certificate and replay every counterexample; True where all agree."""
        for name, verdict in self.properties.items():
            verdict.verify(verdict.law or self.law, name, self.v_max)
            if verdict.verified and verdict.holds and self.varied is not None:
                verdict.verified = (verdict.certificate or {}).get("level") == self.varied.exactly()
        return all(verdict.verified is not False for verdict in self.properties.values())

    @property
    def unverified(self) -> list[str]:
        """The decided properties that :meth:`verify` cannot check, such as those of a law without z: it has no certificate."""
        return [n for n, v in self.properties.items() if v.holds is not None and v.verified is None]

    @property
    def proved(self) -> bool:
        """Whether there is a proof with a certificate."""
        return any(v.holds and v.certificate is not None for v in self.properties.values())

    def certificates(self) -> dict[str, Json]:
        """The certificates of all proofs, as plain data."""
        return {
            "format": FORMAT,
            "law": self.law.name,
            "certificates": {
                n: v.certificate for n, v in self.properties.items() if v.holds and v.certificate is not None
            },
        }

    def to_dict(self) -> dict[str, Json]:
        """``{"law": ..., "properties": {NAME: {"holds", "method", "evidence"}}}`` and further results."""
        varied = {} if self.varied is None else {"level": self.level}
        more = {"steepness": {name: each.to_dict() for name, each in self.steepness.items()}} if self.steepness else {}
        return {
            **more,
            "law": self.law.name,
            "properties": {name: verdict.to_dict() for name, verdict in self.properties.items()},
            "constants": {**self.law.values, **self.law.choices},
            "v_max": self.v_max,
            **varied,
        }
