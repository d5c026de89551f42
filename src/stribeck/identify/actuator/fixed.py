"""The numbers of the machine that are not sought, and how the residuals move with them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from stribeck.arrays import Array
from stribeck.identify.actuator.coordinates import MachineCoordinate, paths
from stribeck.identify.actuator.problem import MachineProblem, number_at
from stribeck.simulation.places import machine_places

_ROOM = 5.0  # times the number, to either side
_SMOOTHING = (".k_v", ".z_ba")  # of the model, not of the machine


def candidates(problem: MachineProblem, u: Array) -> Iterator[tuple[MachineCoordinate, float, Array]]:
    """Each number that all recordings have in common, as a coordinate, with its value and the residuals' slopes by it."""
    numbers = fixed(problem)
    if not numbers:
        return
    own = replace(problem, sought=[*problem.sought, *(c for c, _ in numbers)], noise=dict(problem.noise))
    there = np.append(u, [c.inner(x) for c, x in numbers])
    J = own.slopes(there[None], np.full(len(there), own.step))[1][0]
    for i, (c, x) in enumerate(numbers):
        slopes = J[:, len(u) + i] / c.slope(c.inner(x))
        if np.isfinite(slopes).all() and slopes @ slopes > 0:
            yield c, x, slopes


def fixed(problem: MachineProblem) -> list[tuple[MachineCoordinate, float]]:
    """The machine's numbers that are neither sought nor known of single recordings."""
    sought, found = paths(problem.sought), list[tuple[MachineCoordinate, float]]()
    for path in machine_places(problem.runs[0].scenario):
        if path in sought or ".initial." in path or ".signal." in path or path.endswith(_SMOOTHING):
            continue
        values = {number_at(run, path) for run in problem.runs}
        x = values.pop()
        if x and not values:
            low, high = sorted((x / _ROOM, x * _ROOM))
            found.append((MachineCoordinate(path, low, high, x, None, {path: 1.0}), x))
    return found
