"""Finite escape: a constant speed that takes z to infinity in finite time."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from stribeck.expressions.graph import wrap
from stribeck.properties import replay
from stribeck.properties.model import SIGNS, Model, W
from stribeck.properties.prover.search import Budget
from stribeck.properties.storage import own_speeds
from stribeck.properties.verdicts import Verdict

_METHOD = (
    "a constant speed takes z to infinity in finite time: |dz/dt| >= c |z|^power for all |z| >= z_start "
    "(signs over the whole range)"
)
_POWERS = (2, 3, 4)  # powers of z with a multiple below dz/dt: above 1, z is infinite in finite time
_WORK = 20  # regions of one attempt: few suffice for a low bound


def escape(model: Model) -> Verdict | None:
    """A constant speed at which |z| grows at least like |z|^2 from some z on."""
    law = model.law
    length = law.scales(law.p).length
    for v in (x * side for x in own_speeds(law) for side in SIGNS):
        for t in SIGNS:
            z = t * length * np.logspace(0, 12, 200)
            with np.errstate(all="ignore"):
                outward = t * law.rate(v, z)
                growth = np.log(outward[-1] / outward[100]) / np.log(z[-1] / z[100])
            if not (np.all(outward > 0) and np.isfinite(growth) and growth > 1.9):
                continue
            power = max(p for p in _POWERS if p <= growth + 0.1)
            verdict = _shown(model, v, t, length, power, float(np.min(outward / abs(z) ** power)))
            if verdict is not None:
                return verdict
    return None


def _shown(model: Model, v: float, t: int, start: float, power: int, least: float) -> Verdict | None:
    """The certain statement: t f(v, z) >= c w^power for all w >= start."""
    c = Fraction(least / 2)
    if not c > 0:
        return None
    s, work = 1 if v > 0 else -1, Budget(_WORK)
    statement = wrap(model.form(s, t) * t - model.number(c) * W**power)
    exact = abs(Fraction(v))
    ranges = {"u": (exact, exact), "w": (Fraction(start), None)}
    if model.prover.show(statement, ">=0", ranges, work) is None:
        return None
    time = start ** (1 - power) / (float(c) * (power - 1))
    evidence = {
        "v": v, "z_start": t * start, "escape_time": time, "growth": f"|dz/dt| >= c |z|^{power}",
        "enclosed": {"c": float(c), "power": power},
    }  # fmt: skip
    drive, end = replay.velocity_drive([v], [2 * time])
    tables = replay.scenario_of(model.law, "unique", drive, end, {"initial": {"z": t * start}})
    return Verdict(False, _METHOD, evidence, tables)
