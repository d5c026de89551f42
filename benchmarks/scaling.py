"""Cost against size: one limit cycle of 50 to 5000 s, and ensembles of 1 to 1000 lanes of stick-slip over 300 s.

All at tolerances that give an error of about 1e-6 (one run) or less than 1e-6 (lanes) of the range.
"""

from __future__ import annotations

import os
import random
import statistics
import tempfile
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import ensemble_ways as ways
import figures
from measure import machine, options, say, table, timed, write
from peers import numbalsoda, odeint
from problems import limit_cycle
from solvers import BASE, Stribeck

LENGTHS = (50.0, 100.0, 250.0, 500.0, 1000.0, 2500.0, 5000.0)  # s
LANES = (1, 2, 4, 8, 16, 64, 256, 1000)
DIFFRAX_LANES = (1, 16)
SLOW = 1.0  # s: what takes longer is run once
OWN_RTOL, PEER_RTOL = 1e-4, 1e-8
DIFFRAX_RTOL = 1e-7
ATOL_SHARE = 1e-3
PYTHON_LONGEST = 1000.0  # s, for the slow peer


def medians(calls: dict[str, Callable[[], object]], repetitions: int) -> dict[str, dict[str, float]]:
    """Median milliseconds of each, all in turn. The first call warms up; of a slow one it is the only one."""
    times = {name: [timed(call)] for name, call in calls.items()}
    quick = [name for name, (first,) in times.items() if first.cpu < SLOW]
    for name in quick:
        times[name].clear()
    for _ in range(repetitions):
        for name in random.sample(quick, len(quick)):
            times[name].append(timed(calls[name]))
    return {
        name: {
            "cpu_milliseconds": 1e3 * statistics.median(t.cpu for t in each),
            "wall_milliseconds": 1e3 * statistics.median(t.wall for t in each),
        }
        for name, each in times.items()
    }


def lengths(repetitions: int) -> list[dict[str, Any]]:
    """One run, longer and longer."""
    found = []
    for end in LENGTHS:
        problem = limit_cycle(end)
        own = Stribeck(problem)
        calls: dict[str, Callable[[], object]] = {BASE: lambda own=own: own.solve(OWN_RTOL, None)}
        for name, make, longest in (
            ("numbalsoda", numbalsoda, LENGTHS[-1]),
            ("SciPy odeint, tuned", lambda p: odeint(p, tuned=True), PYTHON_LONGEST),
        ):
            if end > longest:
                continue
            with suppress(ImportError, OSError):
                solve = make(problem)
                calls[name] = lambda solve=solve: solve(PEER_RTOL, ATOL_SHARE * PEER_RTOL)
        found += [{"solver": name, "seconds": end, **cost} for name, cost in medians(calls, repetitions).items()]
        say(f"{end:g} s")
    return found


def lanes(repetitions: int, quick: bool) -> list[dict[str, Any]]:
    """More and more lanes; the costs are for all together."""
    found = []
    solves = {ways.ONE: ways.own(1), ways.ALL: ways.own(None), ways.SCALAR: ways.scalar_loop}
    for count in LANES:
        calls = {name: solve(OWN_RTOL, 0.0, count) for name, solve in solves.items()}
        if not quick and count in DIFFRAX_LANES:
            way = ways.Way(ways.DIFFRAX, "", ways.own(1), count)
            with suppress(ImportError, OSError):
                calls[ways.DIFFRAX] = ways.diffrax(way)(DIFFRAX_RTOL, ATOL_SHARE * DIFFRAX_RTOL, count)
        found += [{"solver": name, "lanes": count, **cost} for name, cost in medians(calls, repetitions).items()]
        say(f"{count} lanes")
    return found


def benchmark(repetitions: int, quick: bool) -> dict[str, Any]:
    """Both."""
    about_machine = machine()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["STRIBECK_CACHE"] = folder
        return {
            "benchmark": "cost against size",
            "machine": about_machine,
            "rtol": {"stribeck": OWN_RTOL, "peers": PEER_RTOL, "diffrax": DIFFRAX_RTOL},
            "length": lengths(repetitions),
            "lanes": lanes(repetitions, quick),
        }


def report(results: dict[str, Any]) -> str:
    """The results as plain text."""
    text = results["benchmark"] + "\n"
    for what, size, unit in (("length", "seconds", "ms/1000 s"), ("lanes", "lanes", "ms/lane")):
        lines, share = results[what], 1000 if what == "length" else 1
        sizes = sorted({line[size] for line in lines})
        names = list(dict.fromkeys(line["solver"] for line in lines))
        costs = {(line["solver"], line[size]): line["cpu_milliseconds"] * share / line[size] for line in lines}
        rows = [(n, *(f"{costs[n, s]:.3g}" if (n, s) in costs else "-" for s in sizes)) for n in names]
        text += f"\n{what}, cpu {unit}\n\n{table(('solver', *(f'{s:g}' for s in sizes)), rows)}\n"
    return text


def main() -> None:
    """Run the benchmark, print the table, write the results and their figure."""
    given = options(__doc__, "scaling", repetitions=3, quick=1)
    results = benchmark(given.repetitions, given.quick)
    write(given.out, results)
    figures.draw("scaling", given.out)
    print(report(results))


if __name__ == "__main__":
    main()
