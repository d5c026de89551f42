"""A spring that imitates a loop of presliding: numbers that a static fit cannot tell beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from stribeck.identify.log import Log
from stribeck.identify.result import Estimate

_BENDS = 5.0  # k_v times the largest speed: a sign that bends so slowly shows no jump at a reversal


def of_a_loop(
    estimates: Mapping[str, Estimate], values: Mapping[str, float], log: Log
) -> tuple[Mapping[str, Estimate], list[str]]:
    """What a spring may stand for, beside no friction level or one that hardly comes to its end at the speeds measured: the
    other numbers bend its line to a loop, and are not known."""
    spring, level = estimates.get("stiffness"), estimates.get("F_c")
    if spring is None or level is None or not values["stiffness"] > 0:
        return estimates, []
    found = "no friction level"
    if level.identifiable:
        fastest, reach = float(np.max(abs(log.velocity))), float(np.ptp(log.position)) / 2
        bends = "k_v" in estimates and values["k_v"] * fastest < _BENDS
        if not bends or values["stiffness"] * reach < values["F_c"]:
            return estimates, []
        found = "a sign that bends over all speeds measured"
    why = f"it may imitate the loop of presliding: there is a spring and {found}"
    doubted = {
        n: replace(e, value=None, identifiable=False, why=why, best=e.value)
        for n, e in estimates.items()
        if n != "stiffness" and e.identifiable
    }
    return {**estimates, **doubted}, [
        f"a spring and {found}: if nothing but the contact holds the body, the record is one of presliding, and the "
        "spring is that of the bristles; a law that has them tells it (lugre, fitted by the method 'presliding')"
    ]
