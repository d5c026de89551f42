"""What a law with given constants guarantees: proofs, and counterexamples that the simulator replays."""

from __future__ import annotations

from time import monotonic

from stribeck.laws.base import Law
from stribeck.properties import bounded, drift, passive, smooth, unique
from stribeck.properties.model import Model
from stribeck.properties.seams import Quadrants
from stribeck.properties.storage import reach_of, storage_interval
from stribeck.properties.verdicts import NAMES, Verdict, Verdicts, undecided

__all__ = ["NAMES", "Verdict", "Verdicts", "check", "storage_interval"]

_SECONDS = 4.0  # for all five properties


def check(law: Law, v_max: float | None = None, seconds: float = _SECONDS) -> Verdicts:
    """Whether a law with its constants has each of the five properties.

    Args:
        law: the law.
        v_max: passivity is asked for \\|v\\| <= v_max, m/s; for every v unless given.
        seconds: what is not decided by then is null.

    Returns:
        The verdicts: each true with a proof, false with a counterexample, or null with the reason. docs/check.md.
    """
    started = monotonic()
    if not law.has_z:
        reason = f"law '{law.name}' has no internal state z, which the properties are about"
        return Verdicts(law, {name: undecided(reason) for name in NAMES}, v_max)
    deadline = started + seconds
    model = Model(law)
    quadrants = Quadrants(model)
    within = bounded.decide(model, deadline)
    reach = reach_of(law, within.holds)
    found = {
        "unique": unique.decide(quadrants, reach if within.holds else None, deadline),
        "bounded": within,
        "smooth": smooth.decide(quadrants),
        "passive": passive.decide(model, v_max, within.holds, deadline),
        "drift_free": drift.decide(quadrants, deadline),
    }
    return Verdicts(law, found, v_max, monotonic() - started)
