"""One scenario simulated: compiled where there is a C compiler, by SciPy elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from stribeck.codegen import source
from stribeck.control.sampled import Held
from stribeck.errors import BuildError, note
from stribeck.scenario import Scenario
from stribeck.scenario.objects import Machine, scenario_of
from stribeck.simulation import cache, compiler, fallback, native
from stribeck.simulation.result import Result
from stribeck.simulation.solution import Solution

_SWING, _MOST_SWINGS = 0.02, 25  # of the valve's limit; turns in a quarter of a run that need no word


def simulate(
    scenario: Scenario | Machine | str | Path | Mapping[str, Any],
    progress: Callable[[float], None] | None = None,
    *,
    t_end: float | None = None,
    step: float | None = None,
    **solve: Any,
) -> Solution:
    """Simulate a scenario or a machine.

    The first simulation of a structure (law, drive, kind of signal) compiles it, some 0.3 s; later ones, in this
    process or another, find it in the cache.

    Args:
        scenario: what to simulate: a scenario, a machine, the path of its file, or its tables.
        t_end: when it ends, s; must be given for a :class:`Machine`.
        step: time between rows, s; of a :class:`Machine` t_end/1000 unless given.
        **solve: other values of [solve], such as ``rtol=1e-10``; of a :class:`Machine` ``energy=True`` too.
        progress: called now and then with the share of the time done, 0 to 1.

    Returns:
        The solution. A failed computation is a solution too: its ``status`` is "failed", its ``reason`` says why, and
        it holds the rows that were reached.

    Raises:
        InputError: the file or the tables are no valid scenario.
    """
    scenario = scenario_of(scenario, t_end, step, **solve)
    started = perf_counter()
    library, built, build_seconds = None, False, 0.0
    chosen = compiler.find()
    if chosen is None:
        note("no C compiler found: solving with SciPy, hundreds of times slower (pip install 'stribeck[compiler]')")
    else:
        try:
            library, built = cache.library(source(scenario.system), chosen, native.check)
            build_seconds = perf_counter() - started
        except (BuildError, OSError) as error:
            note(f"compiling failed ({' '.join(str(error).split())}): solving with SciPy, hundreds of times slower")
    if library is not None:
        for text in native.doubts(scenario):
            note(text)
    result = _solve(library, scenario, progress)
    result.stats.update(
        {"built": built, "build_seconds": build_seconds, "seconds": perf_counter() - started - build_seconds}
    )
    solution = Solution(scenario, result)
    if scenario.servo is not None and solution.reason is None:
        _say_if_limited(solution)
        if result.log is not None:
            _say_if_it_swings(solution, result.log)
    return solution


def _say_if_it_swings(solution: Solution, log: Held) -> None:
    """Say that a sampled servo oscillates, when its valve goes to and fro to the end far more often than its path."""
    scenario, end = solution.scenario, solution.scenario.end
    swing = _SWING * scenario.drive_values["u_max"]
    swings = _reversals([u for t, u in log.voltage if t >= 0.75 * end], swing)
    waves = 0.25 * end / (8 * scenario.signal.longest_step)
    if swings > max(_MOST_SWINGS, 6 * waves):
        text = f"the valve goes to and fro {swings} times by more than {swing:g} V in the last quarter of the run"
        note(f"{scenario.name}: {text}: sample_time, delay or noise are too large for these gains")


def _reversals(values: list[float], swing: float) -> int:
    """How often a sequence turns back by more than ``swing``."""
    count, extreme, rising = 0, values[0] if values else 0.0, 0
    for x in values:
        if (x - extreme) * rising > 0 or (not rising and abs(x - extreme) > swing):
            rising, extreme = (1 if x > extreme else -1), x
        elif rising and abs(x - extreme) > swing:
            count, rising, extreme = count + 1, -rising, x
    return count


def _say_if_limited(solution: Solution) -> None:
    """Say that the valve of a servo ends at its limit, when it has been there for a tenth of the run."""
    limit = solution.scenario.drive_values["u_max"]
    free = np.flatnonzero(np.abs(solution["u"]) < limit * (1 - 1e-9))
    first = free[-1] + 1 if len(free) else 0
    if len(solution.t) - first > 0.1 * len(solution.t):
        since = f"from t = {solution.t[first]:.4g} s to the end"
        note(
            f"{solution.scenario.name}: the valve is at its limit of {limit:g} V {since}: it cannot do what is asked of it"
        )


def _solve(library: object, scenario: Scenario, progress: Callable[[float], None] | None) -> Result:
    import ctypes

    result = (
        native.solve(library, scenario, progress)
        if isinstance(library, ctypes.CDLL)
        else fallback.solve(scenario, progress)
    )
    if scenario.rig is None and scenario.drive.sets_velocity and scenario.threshold > 0:
        # the velocity is no state then: its events are those of the signal, as far as the run came
        reached = scenario.end if result.reason is None else max(len(result.states) - 1, 0) * scenario.output.step
        found = scenario.signal.crossings(scenario.threshold, reached)
        result.events.extend((t, int(not rises)) for t, rises in found)
    return result
