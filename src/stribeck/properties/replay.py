"""Scenarios that show a counterexample, and their simulation."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from stribeck import laws
from stribeck.errors import InputError, StribeckNote
from stribeck.laws.base import Law
from stribeck.properties.plain import Json

if TYPE_CHECKING:
    from stribeck.simulation import Solution

_ROWS = 1000  # of a replayed counterexample: the resolution of a plot
AGREES = 1e-6  # relative difference of a replay from its stated result: the solver's default promise
_MOST_STEPS = 1_000_000  # a wrong law may vibrate forever


def law_table(law: Law) -> dict[str, Json] | None:
    """The table [law] of a scenario for this law, or None if a file cannot hold it."""
    cls = type(law)
    name = cls.name
    if laws.builtin().get(name) is not cls:
        file = getattr(sys.modules.get(cls.__module__), "__file__", None)
        if file is None or getattr(sys.modules[cls.__module__], cls.__name__, None) is not cls:
            return None
        name = f"{Path(file).resolve()}:{cls.__name__}"
    return {**law.to_dict(), "name": name}


def scenario_of(
    law: Law, name: str, drive: Mapping[str, Json], t_end: float, plant: Mapping[str, Json], energy: bool = False
) -> dict[str, Json] | None:
    """The tables of a scenario that ends with a row at t_end, or None if a file cannot hold the law."""
    table = law_table(law)
    if table is None:
        return None
    begun = {"schema": 1, "name": name, "law": table, "plant": dict(plant), "drive": dict(drive)}
    return begun | run_of(t_end, energy)


def run_of(t_end: float, energy: bool) -> dict[str, Json]:
    """The tables [solve] and [output] of a replay."""
    return {
        "solve": {"t_end": t_end, "rtol": 1e-11, "max_steps": _MOST_STEPS},
        "output": {"step": t_end / _ROWS, "energy": energy},
    }


def held(values: Sequence[float], durations: Sequence[float]) -> dict[str, Json]:
    """A signal that holds each value for its duration."""
    ends = np.cumsum(durations).tolist()
    t = [0.0, *(x for end in ends for x in (end, end))][:-1]
    return {"kind": "points", "t": t, "value": [x for value in values for x in (value, value)]}


def velocity_drive(speeds: Sequence[float], durations: Sequence[float]) -> tuple[dict[str, Json], float]:
    """A drive with pieces of constant speed, and its end time."""
    signal = held(speeds, durations)
    return {"kind": "velocity", "signal": signal}, signal["t"][-1]


def run(tables: Mapping[str, Json] | None) -> Solution | None:
    """The simulation, or None if there is no scenario or it failed."""
    if tables is None:
        return None
    from stribeck.scenario import Scenario  # takes 0.2 s; a law with all properties does not need it
    from stribeck.simulation import simulate

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", StribeckNote)
            solution = simulate(Scenario(tables))
    except (InputError, ArithmeticError):  # extreme constants cannot be simulated
        return None
    return solution if solution.status == "done" else None


def repeats(tables: Mapping[str, Json], stated: Mapping[str, float]) -> bool:
    """Whether a simulation ends with the stated values, within 1e-6."""
    solution = run(tables)
    if solution is None:
        return False
    return all(abs(solution.final[n] - x) <= AGREES * abs(x) for n, x in stated.items())
