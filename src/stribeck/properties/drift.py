"""Freedom from drift: dz/dt = v exactly below some deflection."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import product

import numpy as np

from stribeck.expressions.graph import wrap
from stribeck.laws.base import Law
from stribeck.properties import replay
from stribeck.properties.certificate import Certificate
from stribeck.properties.claims import NULL, ClaimProver
from stribeck.properties.model import SIGNS, Model, U
from stribeck.properties.plain import Json
from stribeck.properties.prover.search import Budget
from stribeck.properties.storage import own_speeds
from stribeck.properties.verdicts import Verdict, proved, undecided

_METHOD = "for |z| <= z_0, dz/dt equals v exactly in every case that occurs"
_MOVED = "at a constant speed dz/dt differs from v for all z in (0, z_1] (signs over the whole range), so that no z_0 > 0 exists"
_SLOW = 0.1  # of v_s: the speed of the dithered body
_STIFF = 20.0  # ratio of the contact's resonance to the dither frequency
_CYCLES = 10  # of the load: enough to show a repeated drift in a short run
_WORK = 12  # regions of one attempt: few suffice to show that dz/dt is not v on a small range
_VISIBLE = 0.01  # of the elastic displacement: a visible drift
_NOISE = 1e-6  # of the elastic displacement: a smaller drift may be rounding


def decide(model: Model, claims: ClaimProver) -> Verdict:
    """A proof of dz/dt = v for |z| <= z_0, or a load that moves the body permanently."""
    law = model.law
    for z_0 in _candidates(law):
        shown = claims.elastic((NULL, Fraction(z_0)))
        if shown is not None:
            evidence = {"z_0": z_0, "F_0": float(law.force(0.0, z_0))}
            return proved(model, Certificate("drift_free", "elastic", shown, {"z_0": Fraction(z_0)}), _METHOD, evidence)
    apart = _departs(model)
    if apart is None:
        return undecided("neither was dz/dt shown to be v up to some |z|, nor to differ from v near z = 0")
    return _shown(law, apart)


def _candidates(law: Law) -> Iterator[float]:
    """Deflections up to which dz/dt = v in samples: the law's claim, and then halves of the natural length."""
    scales = law.scales(law.p)
    try:
        stated = [float(law.z_elastic(law.p))]
    except (NotImplementedError, AttributeError, TypeError):
        stated = []
    v = np.concatenate([-np.logspace(-9, 6, 60), [0.0], np.logspace(-9, 6, 60)]) * scales.speed
    tried = 0
    for z_0 in (*stated, *(scales.length * 2.0**-k for k in range(40))):
        z = np.linspace(-z_0, z_0, 41)[:, None]
        if z_0 > 0 and np.all(abs(law.rate(v, z) - v) <= 1e-12 * abs(v)) and tried < 4:
            tried += 1
            yield z_0


def _departs(model: Model) -> dict[str, float] | None:
    """A constant speed at which dz/dt is not v on a range of deflections from 0."""
    law = model.law
    length, law_speeds = law.scales(law.p).length, own_speeds(law)
    speeds = (*law_speeds, law_speeds[0] / 10, law_speeds[-1] * 10, 0.0)
    sided = [(speed, s) for speed in speeds for s in (SIGNS if speed else (0,))]
    for (speed, s), t, share in product(sided, SIGNS, (0.1, 1e-4, 1e-8)):
        exact, top = Fraction(speed), Fraction(length * share)
        form = model.form(s, t) - (U * s if s else wrap(0.0))
        ranges = {"u": (exact, exact)} if s else {}
        if model.prover.show(form, "!=0", {**ranges, "w": (NULL, top)}, Budget(_WORK)) is not None:
            return {"v": s * speed, "z_from": 0.0, "z_to": t * float(top)}
    return None


def _shown(law: Law, apart: dict[str, float]) -> Verdict:
    """The verdict, with a sawtooth load between a fifth and all of its peak.

    The load begins and ends at 0. A fast load gives a short run; a slow one shows the effect of smooth signs.
    """
    slow = own_speeds(law)[0]
    best: Verdict | None = None
    for speed in (_SLOW * getattr(law.p, "v_s", law.scales(law.p).speed), slow, slow / 10):
        moved = _moved_at(law, speed) if speed > 0 else None
        if moved is None:
            break
        evidence, tables = moved
        best = Verdict(False, _MOVED, {"not_elastic": apart, **evidence}, tables)
        if abs(evidence["distance"]) > _VISIBLE * evidence["elastic_displacement"]:
            break
    if best is not None and abs(best.evidence["distance"]) > _NOISE * best.evidence["elastic_displacement"]:
        return best
    return Verdict(False, _MOVED, {"not_elastic": apart})


def _moved_at(law: Law, speed: float) -> tuple[dict[str, Json], dict[str, Json]] | None:
    scales = law.scales(law.p)
    z_ba = getattr(law.p, "z_ba", None)
    stiffness = abs(float(law.force(0.0, 1e-6 * scales.length))) / (1e-6 * scales.length)
    if not (stiffness > 0 and np.isfinite(stiffness)):
        return None
    peak = 0.5 * scales.force if z_ba is None else min(0.5 * scales.force, 0.9 * stiffness * z_ba)
    length = peak / stiffness
    rise, fall = length / speed, 0.2 * length / speed
    loads, times = [0.0, peak], [0.0, rise]
    for _ in range(_CYCLES):
        loads += [0.2 * peak, peak]
        times += [times[-1] + fall, times[-1] + fall + rise]
    loads += [0.0, 0.0]
    times += [times[-1] + fall, times[-1] + fall + rise]
    with np.errstate(all="ignore"):
        mass = float(stiffness * np.square(fall / _STIFF))
    if not 0 < mass < np.inf:
        return None
    drive = {"kind": "force", "signal": {"kind": "points", "t": times, "value": loads}}
    tables = replay.scenario_of(law, "drift_free", drive, times[-1], {"mass": mass})
    solution = replay.run(tables)
    if tables is None or solution is None:
        return None
    moved = solution.final["y"]
    evidence = {
        "largest_load": peak, "F_s": scales.force, "cycles": _CYCLES, "time": times[-1], "distance": moved,
        "elastic_displacement": length, "replay": {"y": float(moved)},
    }  # fmt: skip
    return evidence, tables
