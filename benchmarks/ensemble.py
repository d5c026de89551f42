"""An ensemble: 1000 trajectories of stick-slip over 300 s, k_v and F_s varied, by this project and by its peers.

Each solver's tolerance is the loosest at which the typical error (the median over the lanes of a lane's largest error of
y, as a part of its range) is at most 1e-7. This project's is found in every run, its peers' are kept in tolerances.json
and checked. Slow solvers take fewer lanes; what counts is the time for a lane. All take turns in every repetition. Ratios
between single threads are of processor time, those that count threads of time on the wall (of use on an idle machine).
"""

from __future__ import annotations

import os
import random
import statistics
import tempfile
from typing import Any

import figures
import numpy as np
from ensemble_ways import (
    ALL,
    ATOL_SHARE,
    DIFFRAX,
    LANES,
    NARROW,
    ONE,
    PROBLEM,
    SCALAR,
    SECONDS,
    Array,
    Way,
    odeint,
    own,
    ways,
    width,
)
from measure import keep, kept, machine, options, say, spread, table, targets_table, timed, write

from stribeck.simulation.lanes import threads_of_this_machine

LIMIT = 1e-7  # of the range of y
REFERENCE_RTOL, CHECK_RTOL = 1e-10, 1e-12
PER_DECADE, TIGHTEST = 4, 1e-11
TRUSTED = (LIMIT / 4, 1.5 * LIMIT)
SLOW = 10.0  # s: what takes longer is run once


def reference(count: int) -> tuple[Array, dict[str, Any]]:
    """The rows of tight runs, and how well SciPy agrees on two lanes."""
    y = own(None)(REFERENCE_RTOL, 0.0, count)()["y"]
    other = odeint()(CHECK_RTOL, ATOL_SHARE * CHECK_RTOL, 2)()
    differs = float(np.max(np.abs(other - y[:2]) / np.max(np.abs(y[:2]), axis=1, keepdims=True)))
    if differs > LIMIT / 10:
        raise SystemExit(f"the reference is uncertain: {differs:.1e} from SciPy's odeint")
    about = {"solver": f"stribeck at rtol {REFERENCE_RTOL:g}", f"differs_from_scipy_odeint_at_{CHECK_RTOL:g}": differs}
    return y, about


def find_tolerance(way: Way, found: dict[str, Way], y: Array, quick: bool) -> None:
    """Give a way its rtol and error; the run that shows the error of a slow way also is the one that is timed.

    Quick, on few lanes, a kept tolerance is taken as it is.
    """
    key = f"ensemble: {way.name}"
    errors = None
    if way.like in found:
        way.rtol = found[way.like].rtol
    elif key in (before := kept()):
        way.rtol = before[key]["rtol"]
        errors = way.errors(way.lanes, y)
    fits = errors is not None and (quick or TRUSTED[0] <= np.median(errors) <= TRUSTED[1])
    if way.like not in found and not fits:
        errors = None
        scan(way, y)
        if way.name != ONE:
            keep(key, way.rtol, ATOL_SHARE * way.rtol)
    if errors is None:
        errors = way.errors(way.lanes, y)
    way.error, way.worst = float(np.median(errors)), float(np.max(errors))
    if way.last.cpu > SLOW:
        way.times.append(way.last)


def scan(way: Way, y: Array) -> None:
    """The loosest rtol whose typical error keeps the limit, on some of the lanes."""
    say(f"scan for the tolerance of {way.name}")
    way.rtol = way.loosest
    while np.median(way.errors(min(way.lanes, 64), y)) > LIMIT:
        way.rtol /= 10 ** (1 / PER_DECADE)
        if way.rtol < TIGHTEST:
            raise ArithmeticError(f"no tolerance gives an error of {LIMIT:g} of the range")


def entry(way: Way, scalar: Way) -> dict[str, Any]:
    """A way's line of the results; times are for a lane."""
    return {
        "solver": way.name,
        "what": way.what,
        "lanes": way.lanes,
        "rtol": way.rtol,
        "error": way.error,
        "worst_error": way.worst,
        "compiled_in_seconds": way.compiled_in,
        "cpu_milliseconds": spread([1e3 * t.cpu / way.lanes for t in way.times]),
        "wall_milliseconds": spread([1e3 * t.wall / way.lanes for t in way.times]),
        "trajectories_per_second": spread([way.lanes / t.wall for t in way.times]),
        "cpu_ratio_to_scalar_loop": spread(ratios(scalar, way, "cpu")),
    }


def ratios(slow: Way, fast: Way, clock: str) -> list[float]:
    """How many times faster a lane is, repetition by repetition (of a slow way there is but one)."""
    pairs = zip(slow.times, fast.times, strict=False)
    return [(getattr(s, clock) / slow.lanes) / (getattr(f, clock) / fast.lanes) for s, f in pairs]


def judge(measured: dict[str, Way]) -> list[dict[str, Any]]:
    """The targets, and whether they are met by the medians."""
    wide = ONE if width() == 8 else "(no AVX-512 here)"
    wanted = (
        ("AVX-512, one thread, against the own scalar loop (cpu)", SCALAR, wide, "cpu", 5.0),
        ("AVX2, one thread, against the own scalar loop (cpu)", SCALAR, NARROW, "cpu", 3.0),
        ("one thread against diffrax vmap (cpu)", DIFFRAX, ONE, "cpu", 250.0),
        ("all threads against diffrax vmap (wall)", DIFFRAX, ALL, "wall", None),
        ("all threads against one (wall)", ONE, ALL, "wall", None),
    )
    judged = []
    for text, slow, fast, clock, least in wanted:
        ratio = None
        if slow in measured and fast in measured:
            ratio = statistics.median(ratios(measured[slow], measured[fast], clock))
        judged.append(
            {
                "target": text,
                "wanted": "-" if least is None else f">= {least:g} x",
                "measured": None if ratio is None else f"{ratio:.3g} x",
                "met": None if ratio is None or least is None else ratio >= least,
            }
        )
    return judged


def benchmark(repetitions: int, quick: bool) -> dict[str, Any]:
    """Find the tolerances, measure, and judge."""
    about_machine = machine()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["STRIBECK_CACHE"] = folder
        listed, missing = ways(quick)
        say("reference")
        y, about = reference(max(way.lanes for way in listed))
        measured: dict[str, Way] = {}
        for way in listed:
            try:
                find_tolerance(way, measured, y, quick)
                measured[way.name] = way
            except ArithmeticError as reason:
                missing[way.name] = str(reason)
        for repetition in range(repetitions):
            for way in random.sample(list(measured.values()), len(measured)):
                if way.last.cpu <= SLOW:
                    way.times.append(timed(way.solve(way.rtol, ATOL_SHARE * way.rtol, way.lanes)))
            say(f"repetition {repetition + 1} of {repetitions}")
        targets = judge(measured)
    return {
        "benchmark": f"ensemble: {LANES} x {SECONDS:g} s of stick-slip, k_v and F_s varied",
        "machine": about_machine,
        "error_limit": LIMIT,
        "rows": PROBLEM.scenario.rows,
        "threads": threads_of_this_machine(),
        "reference": about,
        "solvers": [entry(way, measured[SCALAR]) for way in measured.values()],
        "not_measured": missing,
        "targets": targets,
    }


def report(results: dict[str, Any]) -> str:
    """The results as plain text."""
    rows = []
    for line in results["solvers"]:
        cpu, wall, rate, ratio = (
            line[key]["median"]
            for key in ("cpu_milliseconds", "wall_milliseconds", "trajectories_per_second", "cpu_ratio_to_scalar_loop")
        )
        rows.append(
            (
                line["solver"], str(line["lanes"]), f"{cpu:.3g}", f"{wall:.3g}", f"{rate:.4g}", f"{ratio:.3g}",
                f"{line['error']:.1e}", f"{line['worst_error']:.1e}", f"{line['rtol']:.1e}",
            )
        )  # fmt: skip
    head = (
        "solver",
        "lanes",
        "cpu ms/lane",
        "wall ms/lane",
        "lanes/s",
        "scalar loop/cpu",
        "error/range",
        "worst",
        "rtol",
    )
    missing = "".join(f"{name}: not measured: {reason}\n" for name, reason in results["not_measured"].items())
    return f"{results['benchmark']}\n\n{table(head, rows)}\n{missing}\n{targets_table(results['targets'])}\n"


def main() -> None:
    """Run the benchmark, print the table, write the results."""
    given = options(__doc__, "ensemble", repetitions=5, quick=1)
    results = benchmark(given.repetitions, given.quick)
    write(given.out, results)
    figures.draw("ensemble", given.out)
    print(report(results))


if __name__ == "__main__":
    main()
