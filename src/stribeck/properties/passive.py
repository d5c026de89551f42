"""Passivity from v to F."""

from __future__ import annotations

from time import monotonic
from typing import Any

from stribeck.expressions.boxes import Cover
from stribeck.properties import cells, cycles, elastic, replay
from stribeck.properties.model import Model
from stribeck.properties.storage import Storage, largest_speed, reach_of
from stribeck.properties.verdicts import Verdict, later, undecided

_CYCLE = "a cycle of held speeds that returns z to its start and draws energy, replayed by simulation"
_ENDLESS = (
    "unwinding from |z| = Z draws energy in proportion to the speed, without limit: more than any storage function holds; "
    "one such run, replayed by simulation"
)


def decide(model: Model, v_max: float | None, bounded: bool | None, deadline: float) -> Verdict:
    """Passive, with a storage function that a proof confirms; or not, with a cycle that draws energy."""
    law = model.law
    storage = Storage(law, v_max, reach_of(law, bounded))
    found = _proved(model, storage, deadline) if storage.exists else _refuted(storage)
    found.evidence["v_max"] = v_max
    if v_max is None and found.holds is not True and monotonic() < deadline:
        largest = largest_speed(law, storage.reach, deadline)
        found.evidence["largest_v_max"] = largest
        found.evidence["largest_v_max_method"] = "bisection with the storage interval as sampled"
    return found


def _proved(model: Model, storage: Storage, deadline: float) -> Verdict:
    v_max, reach = storage.v_max, storage.reach
    bounds = {"z_within": reach, "speeds": "all" if v_max is None else f"|v| <= {v_max:g}"}
    cover = elastic.prove(model, v_max, reach, deadline)
    if cover.holds:
        evidence: dict[str, Any] = {
            "storage": "the law's own stored energy, sigma_0 z^2/2",
            "boxes": cover.boxes,
            **bounds,
        }
        return Verdict(True, elastic.METHOD, evidence, again=lambda: elastic.prove(model, v_max, reach, later()).holds)
    own = cover
    cover, fitted = cells.prove(model, storage, deadline)
    if not cover.holds or fitted is None:
        return undecided(_why(own, cover), sampled="a storage function exists as far as sampled", **bounds)
    evidence = {
        "storage": "S' = sigma_0 z up to |z| = own_up_to, beyond it fitted between L and U",
        "own_up_to": fitted.own, "boxes": cover.boxes, **bounds,
        "slopes": [[float(x) for x in row] for row in zip(fitted.low, fitted.high, fitted.slope, strict=True)],
    }  # fmt: skip
    return Verdict(True, cells.METHOD, evidence, again=lambda: cells.prove(model, storage, later())[0].holds)


def _why(own: Cover, fitted: Cover) -> str:
    def text(cover: Cover) -> str:
        return f"{cover.reason} after {cover.boxes} boxes" if cover.boxes else cover.reason

    return f"no proof: with the law's own stored energy {text(own)}; with a fitted one {text(fitted)}"


def _refuted(storage: Storage) -> Verdict:
    law = storage.law
    cycle = cycles.find(law, storage)
    found = undecided("no storage function exists as far as sampled, but no cycle that draws energy was found")
    if cycle is not None:
        found = _replayed(storage, cycle, _CYCLE)
    if found.holds is None and storage.endless:
        found = _replayed(storage, cycles.unwinding(law, storage), _ENDLESS)
    return found


def _replayed(storage: Storage, cycle: cycles.Cycle, method: str) -> Verdict:
    tables = cycles.scenario(storage.law, cycle)
    solution = replay.run(tables)
    if tables is None or solution is None:
        reason = "energy can be drawn, by quadrature, and it could not be replayed"
        return undecided(reason, **cycle.evidence())
    stated = {"E_in": solution.final["E_in"], "z": solution.final["z"]}
    evidence: dict[str, Any] = {**cycle.evidence(), "energy_drawn": -stated["E_in"], "replay": stated}
    span = max(*cycle.turns, cycle.start) - min(*cycle.turns, cycle.start)
    if not stated["E_in"] < 0 or abs(stated["z"] - cycle.turns[-1]) > 1e-4 * span:
        return undecided("energy can be drawn, by quadrature, but the replay differs", **evidence)
    return Verdict(False, method, evidence, tables, again=lambda: replay.repeats(tables, stated))
