"""What a solver returns, whichever it was."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import ceil, floor
from typing import TypedDict

import numpy as np

from stribeck.arrays import Array
from stribeck.scenario import Scenario

NOT_FINITE = -2  # of the statuses that runtime/run.c and lanes.c return


class Stats(TypedDict, total=False):
    """What a run took: steps kept and tried again, evaluations of rates and Jacobians, the sizes of steps (s) where the
    solver says them, which solver, by C or WebAssembly, whether its code was built for it, and the seconds of building and
    solving."""

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
    """The states at the output rows that were reached, the events met, why it ended early if so, statistics, and what of
    the promised accuracy was not reached."""

    states: Array  # then held outputs, and what is shown of the controllers' memory
    events: list[tuple[float, int]]  # time; which watched quantity (times 4), and which of its events
    reason: str | None
    stats: Stats
    remarks: list[str] = field(default_factory=list)


def held_back(end: float, lanes: Sequence[Sequence[Mapping[str, float]]]) -> tuple[int, Array]:
    """How many outputs of a sampled controller wait at most, and the standard normal numbers of the controllers' noise,
    from the sampling of each controller in each lane."""
    every = [each for lane in lanes for each in lane]
    if not every:
        return 1, np.zeros((0, 0))
    room = max(ceil(min(each["delay"], end) / each["period"]) for each in every) + 2  # later ones never act
    count = max((floor(end / each["period"]) + 2 for each in every if each["noise"]), default=0)
    noise = [np.random.default_rng(int(each["seed"])).standard_normal(count) for each in lanes[0]]
    return room, np.array(noise)


def failure(status: int, t: float, max_steps: int) -> str | None:
    """Why a compiled run ended at t, by the status that runtime/run.c and lanes.c return; None when it is done."""
    if status == 0:
        return None
    if status == -1:
        return f"at t = {t:.9g} s the step needed for solve.rtol fell below what floating point resolves"
    if status == NOT_FINITE:
        return f"after t = {t:.9g} s the equations are no longer finite"
    if status == -4:
        return f"at t = {t:.9g} s the steps needed for solve.rtol became so short that the end is 1e12 of them away"
    return f"gave up at t = {t:.9g} s after solve.max_steps = {max_steps} attempted steps"


def ended(scenario: Scenario, t: float, x: Array) -> str | None:
    """Why equations that are no longer finite ended, where the plant says why."""
    return scenario.system.ended(scenario.values(), t, x)
