"""The motion that a dither causes, and a frequency for a dither."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from stribeck.arrays import Array
from stribeck.loops.loop import Loop, SlidingLoop, controller_of
from stribeck.scenario import Scenario

SHARE = 1.5  # over the swing of the sliding linear loop: a margin for the effects of sampling and friction
_SQUARE = 4 / np.pi  # amplitude of the first harmonic of a square wave
_SMALL = 0.01  # of the largest response: 1 % of a dither's swing is below what one accepts at the axis
_OF_SAMPLING = 8  # samples of a wave at least: with fewer, a sampled sine loses its shape
_GRID = np.geomspace(1e-2, 1e5, 281)  # of 1/(2 pi the slowest time constant), Hz


def swings(loop: Loop, values: Mapping[str, Array], count: int) -> list[dict[str, float]]:
    """Peak to peak motion that the dithers of a loop may cause, by lane and body (m or rad); empty without a dither.

    It is that of the linear loop while all contacts slide (:class:`SlidingLoop`), times :data:`SHARE`.
    """
    machine = loop.scenario.elements
    swing: list[dict[str, float]] = [{} for _ in range(count)]
    for each in machine.system.controllers:
        if each.dither is None:
            continue
        sliding, known = SlidingLoop(loop.scenario, each.name), dict[float, dict[str, float]]()
        first = _SQUARE if each.dither.kind == "square" else 1.0
        amplitude, frequency = (
            np.broadcast_to(values.get(f"{each.path}.dither.{n}", machine.values[f"{each.path}.dither", n]), (count,))
            for n in ("amplitude", "frequency")
        )
        for lane in range(count):
            f = float(frequency[lane])
            if f not in known:
                known[f] = sliding.response(f)
            for body, x in known[f].items():
                swing[lane][body] = swing[lane].get(body, 0.0) + 2 * SHARE * first * float(amplitude[lane]) * x
    return swing


def frequency_for(scenario: Scenario, controller: str, slowest: float) -> float:
    """A frequency for a dither, Hz, at which the response of the sliding loop falls to 1 % of its largest.

    It is at most an eighth of the sampling rate.
    """
    machine = scenario.elements
    each = controller_of(scenario, controller)
    sliding, name = SlidingLoop(scenario, controller), machine.leader(each.body).name
    grid = _GRID / (2 * np.pi * slowest)
    answer = np.array([sliding.response(float(f)).get(name, 0.0) for f in grid])
    after = int(np.argmax(answer))
    small = np.flatnonzero(answer[after:] <= _SMALL * answer[after])
    frequency = float(grid[after + int(small[0])]) if len(small) else float(grid[-1])
    if each.sampling is not None:
        frequency = min(frequency, 1 / (_OF_SAMPLING * machine.values[f"{each.path}.sampling", "period"]))
    return float(f"{frequency:.3g}")
