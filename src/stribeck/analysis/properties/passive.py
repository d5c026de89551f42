"""Passivity from v to F."""

from __future__ import annotations

from stribeck.analysis.properties import cycles, replay
from stribeck.analysis.properties.storage import Storage, largest_speed, reach_of
from stribeck.analysis.properties.verdicts import Verdict, undecided
from stribeck.laws.base import Law

_CYCLE = "a cycle of held speeds that returns z to its start and draws energy, replayed by simulation"


def decide(law: Law, v_max: float | None, bounded: bool | None, deadline: float) -> Verdict:
    """Passive, with a storage function that a proof confirms; or not, with a cycle that draws energy."""
    storage = Storage(law, v_max, reach_of(law, bounded))
    limit = {} if v_max is not None else {"largest_v_max": largest_speed(law, storage.reach)}
    if storage.exists:
        return undecided("a storage function exists as far as sampled; no proof was found", **limit)
    cycle = cycles.find(law, storage)
    if cycle is None:
        return undecided("no storage function exists as far as sampled; no cycle was found", **limit)
    tables = cycles.scenario(law, cycle)
    solution = replay.run(tables)
    if solution is None or tables is None:
        return undecided("a cycle that draws energy could not be replayed", **cycle.evidence(), **limit)
    stated = {"E_in": solution.final["E_in"], "z": solution.final["z"]}
    evidence = {**cycle.evidence(), "replay": stated, **limit}
    return Verdict(False, _CYCLE, evidence, tables, again=lambda: replay.repeats(tables, stated))
