"""The result of a solver, in C or WebAssembly."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, floor
from typing import TypedDict

import numpy as np

from stribeck.arrays import Array
from stribeck.errors import nearest

NOT_FINITE = -2  # a status of runtime/run.c and lanes.c


class Stats(TypedDict, total=False):
    """The cost of a run.

    It has accepted and rejected steps, evaluations of rates and Jacobians, and the smallest and largest step (s). It also has
    solver and backend, whether code was built for this run, and the seconds of building and solving.
    """

    accepted: int
    rejected: int
    rates: int
    jacobians: int
    smallest_step: float | None
    largest_step: float | None
    solver: str
    backend: str
    built: bool
    build_seconds: float
    seconds: float


@dataclass(frozen=True)
class Result:
    """The result of a solver.

    Attributes:
        states: the reached rows of states, held outputs, and the shown part of the controllers' memory.
        events: time (s) and number of each event: 4 times the watched quantity's index, plus the index of the event.
        reason: why the run ended early, else None.
        stats: the cost of the run.
        remarks: promised accuracy that was not reached.
    """

    states: Array
    events: list[tuple[float, int]]
    reason: str | None
    stats: Stats
    remarks: list[str] = field(default_factory=list)


def held_back(end: float, lanes: Sequence[Sequence[Mapping[str, float]]]) -> tuple[int, Array]:
    """The most outputs of a sampled controller that wait for their delay, and the standard normal noise of the controllers.

    Args:
        end: end of the run, s.
        lanes: the sampling of each controller, in each lane.
    """
    samplings = [each for lane in lanes for each in lane]
    if not samplings:
        return 1, np.zeros((0, 0))
    room = max(ceil(min(each["delay"], end) / each["period"]) for each in samplings) + 2  # later ones never act
    count = max((floor(end / each["period"]) + 2 for each in samplings if each["noise"]), default=0)
    noise = [np.random.default_rng(int(each["seed"])).standard_normal(count) for each in lanes[0]]
    return room, np.array(noise)


def failure(status: int, t: float, max_steps: int) -> str | None:
    """Why a compiled run ended at t, by its status; None if it is done."""
    if status == 0:
        return None
    if status == -1:
        return f"at t = {t:.9g} s the step needed for solve.rtol fell below what floating point resolves"
    if status == NOT_FINITE:
        return f"after t = {t:.9g} s the equations are no longer finite"
    if status == -4:
        return f"at t = {t:.9g} s the steps needed for solve.rtol became so short that the end is 1e12 of them away"
    return f"gave up at t = {t:.9g} s after solve.max_steps = {max_steps} attempted steps"


def unknown_column(name: str, known: Iterable[str]) -> KeyError:
    """The error about a column that a result does not have."""
    return KeyError(f"{name!r}: no such column{nearest(str(name), known) or ' (known: ' + ', '.join(known) + ')'}")
