"""Freedom from drift: dz/dt = v exactly below some deflection."""

from __future__ import annotations

from time import monotonic
from typing import Any

import numpy as np

from stribeck.laws.base import Law
from stribeck.properties import replay
from stribeck.properties.model import U
from stribeck.properties.seams import Quadrants, fold, vanishes
from stribeck.properties.storage import own_speeds
from stribeck.properties.verdicts import Verdict, undecided

_METHOD = "exact algebra: for |z| <= z_0 every case of dz/dt that occurs (interval arithmetic) is v identically"
_MOVED = "a load below F_s that comes back to 0 leaves the body displaced, replayed by simulation"
_SLOW = 0.1  # of v_s: the speed of the dithered body
_STIFF = 20.0  # how far the contact's resonance lies above the dither
_CYCLES = 10
_VISIBLE = 0.01  # of the elastic displacement: enough to show
_NOISE = 1e-6  # of the elastic displacement: a smaller one would be rounding


def decide(quadrants: Quadrants, deadline: float) -> Verdict:
    """dz/dt = v for |z| <= z_0; or a load that moves the body for good."""
    law = quadrants.model.law
    z_0 = _elastic(law)
    if z_0 > 0 and _is_v(quadrants, z_0):
        evidence = {"z_0": z_0, "F_0": float(law.force(0.0, z_0))}
        return Verdict(True, _METHOD, evidence, again=lambda: _is_v(quadrants, z_0))
    if z_0 > 0:
        return undecided(f"dz/dt is v up to |z| = {z_0:g} as far as sampled; no proof was found")
    return _moved(law, deadline)


def _elastic(law: Law) -> float:
    """The largest deflection, among the law's own and halves of the natural one, up to which dz/dt = v as sampled."""
    scales = law.scales(law.p)
    try:
        own = [float(law.z_elastic(law.p))]
    except NotImplementedError:
        own = []
    v = np.concatenate([-np.logspace(-9, 6, 60), np.logspace(-9, 6, 60)]) * scales.speed
    for z_0 in (*own, *(scales.length * 2.0**-k for k in range(40))):
        z = np.linspace(-z_0, z_0, 41)[:, None]
        if np.all(law.rate(v, z) == v + 0 * z):
            return z_0
    return 0.0


def _is_v(quadrants: Quadrants, z_0: float) -> bool:
    within = quadrants.within(z_0)
    return all(vanishes(fold(form, within, True) - side[0] * U) for side, form in quadrants.form.items())


def _moved(law: Law, deadline: float) -> Verdict:
    """A sawtooth load, between a fifth and all of its peak, that begins and ends at 0: fast enough to be short, or slow
    enough for the smooth signs to be felt."""
    slow = own_speeds(law)[0]
    for speed in (_SLOW * getattr(law.p, "v_s", law.scales(law.p).speed), slow, slow / 10):
        verdict = _moved_at(law, speed)
        if (
            verdict.holds is False
            and abs(verdict.evidence["distance"]) > _VISIBLE * verdict.evidence["elastic_displacement"]
        ):
            break
        if monotonic() > deadline or "distance" not in verdict.evidence:
            break
    return verdict


def _moved_at(law: Law, speed: float) -> Verdict:
    scales = law.scales(law.p)
    own = getattr(law.p, "z_ba", None)
    stiffness = abs(float(law.force(0.0, 1e-6 * scales.length))) / (1e-6 * scales.length)
    if not stiffness > 0:
        return undecided("dz/dt is not v at any |z| as far as sampled; the contact has no stiffness to load")
    peak = 0.5 * scales.force if own is None else min(0.5 * scales.force, 0.9 * stiffness * own)
    length = peak / stiffness
    rise, fall = length / speed, 0.2 * length / speed
    loads, times = [0.0, peak], [0.0, rise]
    for _ in range(_CYCLES):
        loads += [0.2 * peak, peak]
        times += [times[-1] + fall, times[-1] + fall + rise]
    loads += [0.0, 0.0]
    times += [times[-1] + fall, times[-1] + fall + rise]
    mass = stiffness * (fall / _STIFF) ** 2
    drive = {"kind": "force", "signal": {"kind": "points", "t": times, "value": loads}}
    tables = replay.scenario_of(law, "drift_free", drive, times[-1], {"mass": mass})
    solution = replay.run(tables)
    if tables is None or solution is None:
        return undecided("dz/dt is not v at any |z| as far as sampled; a dithered load could not be simulated")
    moved = solution.final["y"]
    evidence: dict[str, Any] = {
        "largest_load": peak, "F_s": scales.force, "cycles": _CYCLES, "time": times[-1], "distance": moved,
        "elastic_displacement": length, "replay": {"y": moved},
    }  # fmt: skip
    if not abs(moved) > _NOISE * length:
        reason = "dz/dt is not v at any |z| as far as sampled, but a dithered load moved the body too little"
        return undecided(reason, **evidence)
    return Verdict(False, _MOVED, evidence, tables, again=lambda: replay.repeats(tables, {"y": moved}))
