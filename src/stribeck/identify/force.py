"""The force of a fitted law along a record, by simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize_scalar

from stribeck import laws
from stribeck.arrays import Array
from stribeck.errors import StribeckError
from stribeck.identify.log import BEGIN, FEWEST_SAMPLES, Log
from stribeck.identify.models import terms
from stribeck.identify.models.terms import TERMS
from stribeck.laws.base import Law
from stribeck.scenario import Scenario
from stribeck.simulation import simulate

Values = Mapping[str, Any]  # numbers, and a law's choices in words
_BENT = 5.0  # break-away distances: largest deflection of the bristles at the start of a run


def parts(name: str, values: Values, log: Log, bent: Sequence[float | None] = ()) -> tuple[Array, Array]:
    """The friction of a fitted law along a record, and the rest of its force, N at each row.

    Args:
        values: the law's constants, and terms.
        bent: deflection of the bristles at the start of each run, m; the steady deflection at its speed unless given.

    Raises:
        StribeckError: the law cannot be simulated along the motion.
    """
    friction, beside = _along(name, values, log, bent), np.zeros(len(log))
    for n, term in TERMS.items():
        if n in values and term.column and not term.level:
            into = friction if term.friction else beside
            into += float(values[n]) * terms.column(n, log)
    late = float(values.get("delay", 0.0))
    return later(log, friction, late), later(log, beside, late)


def initial_deflections(name: str, values: Values, log: Log) -> list[float]:
    """The deflection of the bristles at the start of each run, m, fitted to the force of its first rows.

    A body that sticks keeps this deflection, and with it an error of the force, for as long as it sticks.
    """
    law = laws.find(name)
    if not law.has_z:
        return []
    largest = farthest(with_constants(law, values))
    deflections = []
    for rows in runs(log):
        first = log.rows(slice(rows.start, min(rows.start + BEGIN, rows.stop)))

        def residual(share: float, first: Log = first) -> float:
            friction, beside = parts(name, values, first, [share * largest])
            return float(np.linalg.norm(first.force - friction - beside))

        deflections.append(largest * float(minimize_scalar(residual, bounds=(-1.0, 1.0), method="bounded").x))
    return deflections


def later(log: Log, x: Array, by: float) -> Array:
    """A column of the record at times later by ``by`` seconds; beyond the ends of a run it is constant."""
    if not by:
        return x
    moved = np.empty(len(log))
    for rows in log.runs():
        moved[rows] = np.interp(log.time[rows] + by, log.time[rows], x[rows])
    return moved


def _along(name: str, values: Values, log: Log, bent: Sequence[float | None]) -> Array:
    """The law simulated along the measured velocity of each run."""
    friction, law = np.zeros(len(log)), with_constants(laws.find(name), values)
    for i, rows in enumerate(runs(log)):
        v, t = log.velocity[rows], log.step * np.arange(rows.stop - rows.start)
        start = {"y": float(log.position[rows.start])}
        if law.has_z:
            z = bent[i] if i < len(bent) else None
            start["z"] = float(law.steady_deflection(float(v[0]))) if z is None else z
        table: dict[str, object] = {
            "schema": 1, "law": law_table(name, values), "plant": {"initial": start},
            "drive": {"kind": "velocity", "signal": {"kind": "points", "t": t.tolist(), "value": v.tolist()}},
            "solve": {"t_end": float(t[-1])}, "output": {"step": float(log.step), "energy": False},
        }  # fmt: skip
        solution = simulate(Scenario(table, folder=Path(), trust=True))
        if solution.status != "done":
            raise StribeckError(f"law '{name}': its simulation along this record fails: {solution.reason}")
        friction[rows] = solution["F"]
    return friction


def runs(log: Log) -> list[slice]:
    """The rows of each run that is long enough to be simulated."""
    return [rows for rows in log.runs() if rows.stop - rows.start >= FEWEST_SAMPLES]


def with_constants(law: type[Law], values: Values) -> Law:
    """A law with its constants, of all values."""
    return law({n: x for n, x in values.items() if n in law.constants()})


def farthest(law: Law) -> float:
    """The largest deflection of the bristles, m, that a run may begin with."""
    return _BENT * law.scales(law.p).length


def law_table(name: str, values: Values) -> dict[str, object]:
    """The table of a law with its constants, of all values."""
    return {**with_constants(laws.find(name), values).to_dict(), "name": name}
