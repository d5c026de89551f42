"""Work against precision: error and time of every solver at rtol 1e-3 to 1e-12, on the limit cycle and on stick-slip.

The peers have atol = rtol/1000 on all states, sigma_0 z among them, this project its default. A solver whose run at one
tolerance took long is not asked for tighter ones. The errors are those of y, as a part of its range, against this
project at rtol 1e-12 (its steps are then as exact as they get, from rtol 1e-11 on, where it is not judged); how far SciPy
is from that reference is the least error that means anything.
"""

from __future__ import annotations

import math
import os
import random
import statistics
import tempfile
from pathlib import Path
from typing import Any

import figures
import numpy as np
from measure import machine, options, say, table, timed, write
from peers import PEERS, odeint
from problems import LIMIT_CYCLE, STICK_SLIP, Problem
from solvers import BASE, Array, Solver, available

RTOLS = [10.0**-i for i in range(3, 13)]
OWN_TIGHTEST = 1e-10
ATOL_SHARE = 1e-3
REFERENCE_RTOL, CHECK_RTOL = 1e-12, 1e-13
LONGEST = 1.5  # s of processor time: a solver that needs more is not asked for more
SHORT = 0.02  # s: runs shorter than this are repeated, and their median counts


def point(solver: Solver, rtol: float, y: Array, repetitions: int) -> dict[str, Any]:
    """Error and time at one tolerance; None where the solver gives up."""
    atol = None if solver.name == BASE else ATOL_SHARE * rtol
    found: list[Array] = []
    try:
        times = [timed(lambda: found.append(solver.solve(rtol, atol))).cpu]
        if times[0] < SHORT:
            times = [timed(lambda: solver.solve(rtol, atol)).cpu for _ in range(repetitions)]
    except ArithmeticError:
        return {"rtol": rtol, "error": None, "milliseconds": None}
    error = float(np.max(np.abs(found[0] - y)) / np.max(np.abs(y)))
    return {
        "rtol": rtol,
        "error": error if math.isfinite(error) else None,
        "milliseconds": 1e3 * statistics.median(times),
    }


def curves(problem: Problem, folder: Path, repetitions: int, longest: float) -> dict[str, Any]:
    """All curves of a problem; at each tolerance the solvers take turns, in random order."""
    wanted = {BASE, *(peer.name for peer in PEERS if peer.curve)}
    solvers, missing = available(problem, folder)
    solvers = [solver for solver in solvers if solver.name in wanted]
    y = solvers[0].solve(REFERENCE_RTOL, None)
    check = odeint(problem, tuned=True)(CHECK_RTOL, ATOL_SHARE * CHECK_RTOL)
    points: dict[str, list[dict[str, Any]]] = {solver.name: [] for solver in solvers}
    for solver in solvers:
        point(solver, RTOLS[0], y, 1)  # what is loaded or compiled at the first call is not counted
    tired = set()
    for rtol in RTOLS:
        for solver in random.sample(solvers, len(solvers)):
            if solver.name in tired or (solver.name == BASE and rtol < 0.99 * OWN_TIGHTEST):
                continue
            made = point(solver, rtol, y, repetitions)
            points[solver.name].append(made)
            if made["milliseconds"] is not None and made["milliseconds"] > 1e3 * longest:
                tired.add(solver.name)
        say(f"{problem.name}: rtol {rtol:g}")
    return {
        "problem": problem.name,
        "rows": len(problem.times),
        "least_error": float(np.max(np.abs(check - y)) / np.max(np.abs(y))),
        "solvers": [{"solver": s.name, "what": s.what, "points": points[s.name]} for s in solvers],
        "not_measured": {name: reason for name, reason in missing.items() if name in wanted},
    }


def benchmark(repetitions: int, quick: bool) -> dict[str, Any]:
    """The curves of both problems."""
    about_machine = machine()
    with tempfile.TemporaryDirectory() as folder:
        os.environ["STRIBECK_CACHE"] = folder
        longest = LONGEST / 10 if quick else LONGEST
        found = [curves(problem, Path(folder), repetitions, longest) for problem in (LIMIT_CYCLE, STICK_SLIP)]
    return {
        "benchmark": "work against precision",
        "machine": about_machine,
        "reference": f"stribeck at rtol {REFERENCE_RTOL:g}; least_error: SciPy odeint at {CHECK_RTOL:g} differs by it",
        "problems": found,
    }


def report(results: dict[str, Any]) -> str:
    """The results as plain text: milliseconds and error at each tolerance."""
    text = f"{results['benchmark']}: cpu ms (error/range)\n"
    for problem in results["problems"]:
        rows = []
        for line in problem["solvers"]:
            by_rtol = {made["rtol"]: made for made in line["points"]}
            cells = [by_rtol.get(rtol, {"error": None, "milliseconds": None}) for rtol in RTOLS]
            rows.append((line["solver"], *("-" if c["error"] is None else cell(c) for c in cells)))
        text += f"\n{problem['problem']}; SciPy odeint at {CHECK_RTOL:g} is {problem['least_error']:.0e} off\n\n"
        text += table(("solver", *(f"{rtol:.0e}" for rtol in RTOLS)), rows) + "\n"
        text += "".join(f"{name}: not measured: {reason}\n" for name, reason in problem["not_measured"].items())
    return text


def cell(point: dict[str, Any]) -> str:
    """One point as text."""
    return f"{point['milliseconds']:.3g} ({point['error']:.0e})"


def main() -> None:
    """Run the benchmark, print the table, write the results and their figure."""
    given = options(__doc__, "precision", repetitions=7, quick=2)
    results = benchmark(given.repetitions, given.quick)
    write(given.out, results)
    figures.draw("precision", given.out)
    print(report(results))


if __name__ == "__main__":
    main()
