"""One simulation: the limit cycle of 250 s by this project's solver and by its peers, each at the same error.

The error at a single tolerance is a matter of luck: a change of rtol in its last digit can double it. So each solver's
tolerance comes from a scan: it is the loosest rtol at which, and at all tighter ones of the scan, the typical error
(the median of neighboring tolerances) of y is at most 1e-6 of its range. Among several ratios atol/rtol the fastest is
taken. Quick solvers are scanned in every run. The scan of the slow ones takes minutes (--scan): what it finds is kept
in tolerances.json, and a run checks that it still gives the error.

All solvers are timed in one interleaved run: in every repetition each in turn, in random order. The peers start when
the setpoint steps (before that the body rests); this project's solver runs from t = 0 and locates all slip and stick
instants besides.
"""

from __future__ import annotations

import math
import os
import statistics
import tempfile
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from measure import Given, Seconds, keep, kept, run, say, spread, timed
from peers import BASE, Choice, Solver, Stribeck, available, race, solve_ivp, tried
from problems import Array, limit_cycle

PROBLEM = limit_cycle(250.0, 0.05)
LIMIT = 1e-6  # of the range of y
REFERENCE_RTOL = 1e-12
CHECK_RTOL = 1e-10
TIGHTEST = -11  # log10 of the rtol at which a scan gives up
# points of a scan for each decade of rtol, and how many neighbors on each side share in the typical error
COARSE, FINE = (8, 1), (40, 5)
QUICK = 0.02  # s: solvers faster than this are scanned finely, and in every run
TRUSTED = (LIMIT / 3, 1.5 * LIMIT)  # typical errors between which kept tolerances are used again
BLOCK = 0.03  # s: a solver's calls within a repetition take about so long together; their median counts
MOST_CALLS = 15
SLOW, FEW = 0.4, 5  # solvers slower than so many s take part in so many repetitions only


def reference() -> tuple[Array, dict[str, Any]]:
    """The reference rows, and how well two others agree with them."""
    own = Stribeck(PROBLEM)
    y = own.solve(REFERENCE_RTOL, None)
    scale = float(np.max(np.abs(y)))
    looser = float(np.max(np.abs(own.solve(10 * REFERENCE_RTOL, None) - y))) / scale
    radau = float(np.max(np.abs(solve_ivp(PROBLEM, "Radau", tuned=True)(CHECK_RTOL, CHECK_RTOL / 100) - y))) / scale
    if max(looser, radau) > LIMIT / 10:
        raise SystemExit(f"the reference is uncertain: {looser:.1e} by rtol, {radau:.1e} from SciPy's Radau")
    return y, {
        "solver": f"stribeck at rtol {REFERENCE_RTOL:g}",
        "range_m": scale,
        "differs_from_ten_times_the_rtol": looser,
        f"differs_from_scipy_radau_at_{CHECK_RTOL:g}": radau,
    }


def seconds(call: Callable[[], object], calls: int) -> Seconds:
    """The median times of some calls in a row."""
    times = [timed(call) for _ in range(calls)]
    return Seconds(*(statistics.median(clock) for clock in zip(*times, strict=True)))


def tolerances(solvers: list[Solver], y: Array, rescan: bool) -> tuple[list[Choice], dict[str, str]]:
    """Each solver with its tolerances, kept or found by its scan, and those without."""
    choices: dict[str, Choice] = {}
    failed, before = {}, {} if rescan else kept()
    for solver in solvers:
        if same := choices.get(solver.like or ""):
            choice = Choice(solver, same.rtol, same.atol, same.errors, same.took)
            choice.took = seconds(choice.run, 2)
        else:
            choice = from_kept(solver, before.get(solver.name), y)
        if choice is None:
            say(f"scan for the tolerances of {solver.name}")
            choice = scan(solver, y)
            if choice is not None and choice.took.cpu >= QUICK:
                keep(solver.name, choice.rtol, choice.atol or 0.0)
        if choice is None:
            failed[solver.name] = f"no tolerance of the scan gives an error of {LIMIT:g} of the range"
        else:
            choices[solver.name] = choice
    return list(choices.values()), failed


def from_kept(solver: Solver, found: dict[str, float] | None, y: Array) -> Choice | None:
    """The tolerances of an earlier scan, if they still give the error."""
    if found is None:
        return None
    share = found["atol"] / found["rtol"]
    per_decade, reach = COARSE
    nearby = [found["rtol"] * 10 ** (i / per_decade) for i in range(-reach, reach + 1)]
    errors = np.array([tried(solver, rtol, share, y).error for rtol in nearby])
    choice = Choice(solver, found["rtol"], found["atol"], errors, Seconds(0.0, 0.0))
    if not TRUSTED[0] <= choice.error <= TRUSTED[1]:
        return None
    choice.took = seconds(choice.run, 1)
    return choice


def scan(solver: Solver, y: Array) -> Choice | None:
    """The tolerances for the limit, with the share at which they are the fastest; None where there are none."""
    choices = [choice for share in solver.shares if (choice := scan_share(solver, share, y)) is not None]
    return min(choices, key=lambda choice: choice.took, default=None)


def scan_share(solver: Solver, share: float | None, y: Array) -> Choice | None:
    """The loosest rtol from which on the typical error keeps the limit."""
    once = partial(tried, solver, solver.loosest / 10, share, y)
    per_decade, reach = FINE if seconds(once, 3).cpu < QUICK else COARSE
    tries: list[Choice] = []
    passed, exponent = 0, math.log10(solver.loosest)
    while passed <= per_decade / 2 and exponent > TIGHTEST:
        tries.append(tried(solver, 10**exponent, share, y))
        passed = passed + 1 if tries[-1].error < LIMIT / 10 else 0
        exponent -= 1 / per_decade
    every = np.array([choice.error for choice in tries])
    for i, choice in enumerate(tries):
        choice.errors = every[max(i - reach, 0) : i + reach + 1]
    first = max((i + 1 for i, choice in enumerate(tries) if choice.error > LIMIT), default=0)
    if first == len(tries):
        return None
    choice = tries[first]
    choice.took = min(timed(choice.run) for _ in range(15 if per_decade == FINE[0] else 2))
    return choice


def timing(choice: Choice, repetition: int) -> Seconds | None:
    """What a solver takes in a repetition: the median of calls that fill a block of time; of a slow one in a few only."""
    if choice.took.cpu > SLOW and repetition >= FEW:
        return None
    return seconds(choice.run, min(max(math.ceil(BLOCK / choice.took.cpu), 1), MOST_CALLS))


def entry(choice: Choice, base: Choice) -> dict[str, Any]:
    """A solver's line of the results; its ratios to the base are taken within repetitions."""
    return {
        "solver": choice.solver.name,
        "what": choice.solver.what,
        "rtol": choice.rtol,
        "atol": choice.atol,
        "error": choice.error,
        "milliseconds": spread([1e3 * t.cpu for t in choice.times.values()]),
        "wall_milliseconds": spread([1e3 * t.wall for t in choice.times.values()]),
        "ratio": spread([t.cpu / base.times[i].cpu for i, t in choice.times.items()]),
        "made_in_seconds": choice.solver.made_in,
    }


def benchmark(given: Given) -> dict[str, Any]:
    """Find the tolerances, and measure."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["STRIBECK_CACHE"] = folder
        say("reference")
        y, about = reference()
        solvers, missing = available(PROBLEM)
        choices, failed = tolerances(solvers, y, given.scan)
        missing |= failed
        if not choices or choices[0].solver.name != BASE:
            raise SystemExit(f"{BASE}: {missing[BASE]}")
        race(choices, given.repetitions, timing)
    lines = [entry(choice, choices[0]) for choice in choices]
    return {
        "benchmark": "limit cycle, one simulation",
        "error_limit": LIMIT,
        "rows": PROBLEM.scenario.rows,
        "reference": about,
        "solvers": lines,
        "not_measured": missing,
    }


if __name__ == "__main__":
    run(benchmark, __doc__, "single", repetitions=(15, 2), scan=False)
