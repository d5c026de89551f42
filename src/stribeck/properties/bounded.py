"""A bound Z on |z| for every v(t)."""

from __future__ import annotations

import numpy as np

from stribeck.arrays import Array
from stribeck.properties import enclosed, replay
from stribeck.properties.certificate import Certificate
from stribeck.properties.claims import ClaimProver
from stribeck.properties.cycles import integrate
from stribeck.properties.model import Model
from stribeck.properties.plain import Json
from stribeck.properties.storage import Storage
from stribeck.properties.unique import prove as prove_unique
from stribeck.properties.verdicts import Verdict, proved, undecided

_OUTSIDE = "for |z| >= Z, dz/dt points inward or is 0, for every v, so that |z| does not grow"
_EDGE = "at |z| = Z, dz/dt points inward or is 0, for every v, and solutions are unique up to |z| = 2 Z, so that none leaves"
_PASSED = "constant speeds take z past the bound, as dz/dt keeps its sign (interval arithmetic)"
_LEVELS = (2.0, 10.0, 100.0, 1e4, 1e6)  # of the bound: passing the last level is reported as passing every tried level
_REPLAYED = 10.0  # of the bound: largest deflection in a replayed run


def prove(model: Model, claims: ClaimProver) -> Certificate | None:
    """The proof that z never leaves |z| <= Z."""
    low, high = model.bound
    inward = claims.inward((low, None))
    if inward is not None:
        return Certificate("bounded", "outside", inward)
    if low != high:
        return None
    inward = claims.inward((high, high))
    if inward is None:
        return None
    unique = prove_unique(model, claims, None, 2 * high)
    return Certificate("bounded", "edge", inward, {}, {"unique": unique}) if isinstance(unique, Certificate) else None


def decide(model: Model, claims: ClaimProver) -> tuple[Verdict, Certificate | None]:
    """Decide whether z never leaves |z| <= Z; the proof is the second value.

    A search for constant speeds that pass the bound comes first, as it is cheaper.
    """
    passed = _passed(model)
    if passed is not None and passed.holds is False:
        return passed, None
    certificate = prove(model, claims)
    if certificate is None:
        return passed or _from_the_edge(model), None
    method = _OUTSIDE if certificate.theorem == "outside" else _EDGE
    return proved(model, certificate, method, {"Z": float(model.bound[1])}), certificate


def _passed(model: Model) -> Verdict | None:
    """Speeds that take z from 0 past the bound, and the largest z; None if none was found."""
    law, z_bound = model.law, float(model.bound[1])
    levels: list[dict[str, float]] = []
    for level in (1 + 1e-6, *_LEVELS):
        fastest = _fastest(model, level * z_bound)
        if fastest is None:
            break
        levels.append({"z": level * z_bound, "z_over_Z": level, "v": fastest[0], "time": fastest[1]})
    if not levels:
        return None
    farthest = levels[-1]["z_over_Z"]
    shown = max((x for x in levels if x["z_over_Z"] <= _REPLAYED), key=lambda x: x["z"])
    if farthest < _LEVELS[-1]:
        shown = _to_the_end(model, shown, farthest)
    evidence: dict[str, Json] = {
        "Z": z_bound, "levels": levels if farthest >= _LEVELS[-1] else [shown],
        "passes_any_level": farthest >= _LEVELS[-1],
    }  # fmt: skip
    way = enclosed.least(model, model.rate * np.sign(shown["z"]), shown["v"], 0.0, shown["z"])
    if not way > 0:
        return undecided(
            "constant speeds take z past the bound by quadrature, but interval arithmetic does not confirm this",
            **evidence,
        )
    evidence["enclosed"] = {"v": shown["v"], "z_from": 0.0, "z_to": shown["z"], "dz_dt_at_least": way}
    drive, end = replay.velocity_drive([shown["v"]], [shown["time"]])
    tables = replay.scenario_of(law, "bounded", drive, end, {}, energy=True)  # compiled for passive, too
    solution = replay.run(tables)
    if solution is None or not abs(solution.final["z"]) > z_bound:
        return Verdict(False, _PASSED, evidence)
    evidence["replay"] = {"z": solution.final["z"]}
    return Verdict(False, _PASSED, evidence, tables)


def _from_the_edge(model: Model) -> Verdict:
    """A constant speed, or rest, that moves z outward from the bound."""
    z_bound = float(model.bound[1])
    speeds = np.append(Storage(model.law, per_decade=4).v, 0.0)
    for side in (1.0, -1.0):
        start = z_bound if side > 0 else -z_bound
        with np.errstate(all="ignore"):
            outward = side * model.law.rate(speeds, start)
            size = np.maximum(abs(model.law.rate(speeds, -start)), abs(model.law.rate(speeds, 0.0)))
            share = np.where(np.isfinite(outward), outward / np.maximum(size, 1e-300), -1.0)
        v = float(speeds[int(np.argmax(share))])
        if not share.max() > 1e-6:
            continue
        for reach in (1e-2, 1e-4, 1e-6):
            end = start * (1 + reach)
            way = enclosed.least(model, model.rate * side, v, start * (1 - reach), end)
            if way > 0:
                evidence = {"Z": z_bound, "v": v, "z_start": start, "enclosed": {
                    "v": v, "z_from": start, "z_to": end, "dz_dt_at_least": way}}  # fmt: skip
                return Verdict(False, "a constant speed moves z outward from |z| = Z (interval arithmetic)", evidence)
    return undecided("neither a proof nor a constant speed that takes z past the bound was found", Z=z_bound)


def _to_the_end(model: Model, shown: dict[str, float], level: float) -> dict[str, float]:
    """The largest z at constant speeds, within 0.1 %; z may have a larger bound."""
    z_bound = shown["z"] / shown["z_over_Z"]
    low, high = level, max(2 * level, 2.0)
    for _ in range(12):
        middle = 0.5 * (low + high)
        fastest = _fastest(model, middle * z_bound)
        if fastest is None:
            high = middle
        else:
            low, shown = middle, {"z": middle * z_bound, "z_over_Z": middle, "v": fastest[0], "time": fastest[1]}
    return shown


def _fastest(model: Model, level: float) -> tuple[float, float] | None:
    """The constant speed that takes z from 0 to a level soonest, and the time; None if there is none."""
    law = model.law
    v = Storage(law, per_decade=12).v
    v = v[v > 0]
    z = level * np.linspace(0, 1, 41)
    with np.errstate(all="ignore"):
        rate = law.rate(v[:, None], z)
        slowest = rate.min(axis=1)
        size = np.maximum(abs(law.rate(v, -level)), abs(law.rate(v, 0.0)))
        time: Array = np.where(slowest > 1e-9 * size, (1 / rate).mean(axis=1) * level, np.inf)
    if not np.isfinite(time).any():
        return None
    # the slowest speed that needs at most a second, or twice the shortest time
    enough = np.flatnonzero(time <= max(1.0, 2 * float(time.min())))
    chosen = float(v[enough[0]])
    return chosen, integrate(law, chosen, 0.0, level)[0]
