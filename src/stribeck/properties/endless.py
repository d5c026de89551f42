"""Energy that can be drawn without limit and without a cycle: by sliding, or by ever faster unwinding."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np

from stribeck.expressions.graph import wrap
from stribeck.expressions.intervals import Box, Range
from stribeck.properties import cycles
from stribeck.properties.model import SIGNS, Model, U
from stribeck.properties.plain import Json
from stribeck.properties.prover.search import Budget
from stribeck.properties.storage import Storage, own_speeds
from stribeck.properties.verdicts import Verdict

_SLIDING = (
    "at a constant speed z stays in an interval with F v < 0 (interval arithmetic), so that energy is drawn forever"
)
_ENDLESS = (
    "while z unwinds from z_start to z_end at speeds |v| >= u, F v <= -c v^2 and |dz/dt| <= C |v| (signs over the whole range): "
    "the energy drawn grows with |v| without limit, and exceeds every storage function"
)
_WORK = 60  # regions of one attempt: few suffice for signs on a small range of z
_SHARES = (1e-2, 1e-4, 1e-6, 1e-9, 1e-11, 1e-13)  # of the bound, over which z unwinds


def steady_gain(model: Model, storage: Storage) -> Verdict | None:
    """A speed at which sliding draws energy."""
    law = model.law
    share, v = storage.sliding
    if not share < -1e-9:
        return None
    z = float(law.steady_deflection(v))
    length = law.scales(law.p).length
    for width in (1e-2, 1e-4, 1e-6):
        low, high = z - width * length, z + width * length
        if storage.reach is not None and max(abs(low), abs(high)) > storage.reach:
            continue
        held = {**model.inputs, "v": (v, v)}
        left: Range = Box({**held, "z": (low, low)})(model.rate)
        right: Range = Box({**held, "z": (high, high)})(model.rate)
        inside: Range = Box({**held, "z": (low, high)})(model.power_force)
        power = sorted(x * v for x in inside)
        if left[0] > 0 and right[1] < 0 and power[1] < 0:
            evidence = {"v": v, "z_from": low, "z_to": high, "enclosed": {"power": power}}
            return Verdict(False, _SLIDING, evidence)
    return None


def without_limit(model: Model, storage: Storage, unrestricted: bool) -> Verdict | None:
    """A range of z on which unwinding returns energy that grows with speed without limit."""
    law = model.law
    fast = own_speeds(law)[-1] * 1e4
    top = float(model.bound[0]) * (1 - 2**-52)
    tops = [top * 10.0**k for k in range(10)] if unrestricted else [top]
    # near a threshold the elastic force matters up to higher speeds
    for z_top, share, near, s, t in product(tops, _SHARES, (False, True), SIGNS, SIGNS):
        verdict = unwinding(model, (s, t), fast / share if near else fast, z_top, share)
        if verdict is not None:
            if (run := cycles.unwinding(law, storage, t * z_top, s)) is not None:
                verdict.evidence |= cycles.evidence(run)
                cycles.add_run(verdict, cycles.scenario(law, verdict.evidence))
            return verdict
    return None


def unwinding(model: Model, sides: tuple[int, int], fast: float, top: float, share: float) -> Verdict | None:
    """A proof that unwinding from z = t ``top`` to (1 - ``share``) of it at v = s u, u >= ``fast``, returns energy like u."""
    law, (s, t) = model.law, sides
    u = np.geomspace(fast, fast * 1e12, 7)[:, None]
    w = top * np.array([1 - share, 1 - share / 2, 1.0])
    with np.errstate(all="ignore"):
        rate, force = law.rate(s * u, t * w), law.force(s * u, t * w)
        given, moved = -force * s / u, -t * rate / u
    if not (np.all(np.isfinite(given)) and given.min() > 0 and moved.min() > 0):
        return None
    if given[-1].min() < 0.5 * given[0].min():  # it does not grow with the speed
        return None
    c, most, start = Fraction(float(given.min()) / 2), Fraction(2 * float(moved.max())), Fraction(fast)
    ranges = {"u": (start, None), "w": (Fraction(float(w[0])), Fraction(top))}
    f, force_form = model.form(s, t), model.form_of(model.power_force, s, t)
    claims_made = (
        (-force_form * s - model.number(c) * U, ">=0"),
        (f * -t, ">0"),
        (model.number(most) * U + f * t, ">=0"),
    )
    work = Budget(_WORK)
    if any(model.prover.show(wrap(e), relation, ranges, work) is None for e, relation in claims_made):
        return None
    evidence: dict[str, Json] = {
        "z_start": t * top, "z_end": t * float(w[0]), "v_sign": s,
        "enclosed": {"u": fast, "c": float(c), "C": float(most)},
    }  # fmt: skip
    return Verdict(False, _ENDLESS, evidence)
