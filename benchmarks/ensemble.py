"""An ensemble: 1000 trajectories of stick-slip over 300 s, k_v and F_s varied, by this project and by its peers.

Each solver's tolerance is the loosest at which the typical error (the median over the lanes of a lane's largest error of
y, as a part of its range) is at most 1e-7. This project's is found in every run, its peers' are kept in tolerances.json
and checked. Slow solvers take fewer lanes; what counts is the time for a lane. All take turns in every repetition. Ratios
between single threads are of processor time, those that count threads of time on the wall (of use on an idle machine).
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from typing import Any

import numpy as np
from measure import Given, keep, kept, run, say, spread, timed, version
from peers import (
    OWN_LOOSEST,
    Choice,
    Solve,
    Solver,
    Stribeck,
    diffrax,
    installed,
    loosest,
    numbalsoda,
    odeint,
    race,
    tried,
)  # fmt: skip
from problems import Array, stick_slip

import stribeck
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, native
from stribeck.simulation.lanes import threads_of_this_machine
from stribeck.simulation.variations import Variations

LANES, SECONDS, STEP = 1000, 300.0, 0.3
ATOL_SHARE = 1e-3  # atol/rtol of the peers
ONE, ALL, SCALAR = "stribeck, 1 thread", "stribeck, all threads", "stribeck, scalar loop"
PROBLEM = stick_slip(SECONDS, STEP)


def values(count: int) -> dict[str, Array]:
    """What varies: k_v from 1e6 to 1e8 s/m, evenly on a logarithmic scale, and F_s from 1.2 to 1.8 N, drawn at random."""
    drawn = np.random.default_rng(1).random((LANES, 2))[:count]
    return {"law.k_v": 10 ** (6 + 2 * drawn[:, 0]), "law.parameters.F_s": 1.2 + 0.6 * drawn[:, 1]}


# -- this project --------------------------------------------------------------------------------------------------


def width() -> int:
    """How many lanes a vector has."""
    chosen = compiler.find()
    library, _ = cache.library(source(PROBLEM.scenario.system, lanes=True), chosen.for_lanes())
    return int(library.stribeck_lanes())


def own(threads: int | None, count: int) -> Solve:
    """simulate_ensemble, at default atol."""
    at, varied = Stribeck(PROBLEM).at, values(count)
    return lambda rtol, atol: stribeck.simulate(at(rtol), varied, threads=threads)["y"].T


def scalar_loop(count: int) -> Solve:
    """native.solve, one lane after the other."""
    one = Stribeck(PROBLEM)

    @lru_cache
    def lanes(rtol: float) -> list[stribeck.Scenario]:
        varied = Variations(one.at(rtol), values(count))
        return [varied.scenario.with_changes(varied.changes(i)) for i in range(count)]

    return lambda rtol, atol: np.stack([native.solve(one.library, lane).states[:, 0] for lane in lanes(rtol)], axis=1)


# -- peers ---------------------------------------------------------------------------------------------------------


def lane_by_lane(one: Solve, count: int) -> Solve:
    """A solver of one simulation, one lane after the other."""
    every = list(zip(*(x.tolist() for x in values(count).values()), strict=True))
    return lambda rtol, atol: np.hstack([one(rtol, atol, lane) for lane in every])


def at_once(count: int) -> Solve:
    """diffrax Kvaerno3 over all lanes at once."""
    lanes = diffrax(PROBLEM, "Kvaerno3", values(count))
    return lambda rtol, atol: lanes(rtol, atol)[:, :, 0].T


def solvers(quick: bool) -> tuple[list[Solver], dict[str, str]]:
    """What can be measured here, and why the rest cannot."""
    share = 10 if quick else 1
    vectors, threads = f"vectors of {width()}", f"on {threads_of_this_machine()} threads"
    results = [
        Solver(ONE, f"simulate_ensemble, {vectors}", own(1, LANES // share), (None,), OWN_LOOSEST),
        Solver(ALL, f"simulate_ensemble {threads}", own(None, LANES // share), (None,), like=ONE),
        Solver(SCALAR, "native.solve lane by lane, 1 thread", scalar_loop(250 // share), (None,), like=ONE),
    ]
    makers: dict[str, tuple[str, str, Callable[[], Solve]]] = {
        "numbalsoda": ("numbalsoda", "LSODA lane by lane, equations compiled",
                       lambda: lane_by_lane(numbalsoda(PROBLEM), 80 // share)),
        "SciPy odeint, tuned": ("scipy", "LSODA lane by lane, Python equations",
                                lambda: lane_by_lane(odeint(PROBLEM, tuned=True), 8 // min(share, 4))),
        "diffrax vmap": ("diffrax", "Kvaerno3, compiled by JAX", lambda: at_once(100 // share)),
    }  # fmt: skip
    made, missing = installed({name: make for name, (*_, make) in makers.items()})
    for name, (solve, seconds) in made.items():
        package, what, _ = makers[name]
        results.append(
            Solver(name, f"{package} {version(package)}, {what}", solve, (ATOL_SHARE,), 1e-5, made_in=seconds)
        )
    return results, missing


LIMIT = 1e-7  # of the range of y
REFERENCE_RTOL, CHECK_RTOL = 1e-10, 1e-12
PER_DECADE, TIGHTEST = 4, 1e-11
SOME = 64  # lanes, whose typical error a scan looks at
TRUSTED = (LIMIT / 4, 1.5 * LIMIT)
SLOW = 10.0  # s: what takes longer is run once


def reference(count: int) -> tuple[Array, dict[str, Any]]:
    """The rows of tight runs, and how well SciPy agrees on two lanes."""
    y = own(None, count)(REFERENCE_RTOL, None)
    other = lane_by_lane(odeint(PROBLEM, tuned=True), 2)(CHECK_RTOL, ATOL_SHARE * CHECK_RTOL)
    differs = float(np.max(np.abs(other - y[:, :2]) / np.max(np.abs(y[:, :2]), axis=0)))
    if differs > LIMIT / 10:
        raise SystemExit(f"the reference is uncertain: {differs:.1e} from SciPy's odeint")
    about = {"solver": f"stribeck at rtol {REFERENCE_RTOL:g}", f"differs_from_scipy_odeint_at_{CHECK_RTOL:g}": differs}
    return y, about


def chosen(solver: Solver, found: dict[str, Choice], y: Array, quick: bool) -> Choice:
    """A solver with its tolerance; quick, on few lanes, a kept tolerance is taken as it is."""
    key, tries = f"ensemble: {solver.name}", partial(tried, solver, share=solver.shares[0], exact=y)
    if solver.like in found:
        return tries(found[solver.like].rtol)
    if key in (before := kept()):
        choice = tries(before[key]["rtol"])
        if quick or TRUSTED[0] <= choice.error <= TRUSTED[1]:
            return choice
    say(f"scan for the tolerance of {solver.name}")
    choice = loosest(series(solver.loosest), tries, lambda choice: np.median(choice.errors[:SOME]) <= LIMIT)
    if solver.name != ONE:
        keep(key, choice.rtol, ATOL_SHARE * choice.rtol)
    return choice


def series(rtol: float) -> Iterator[float]:
    """Tolerances from one on, ever tighter."""
    while rtol >= TIGHTEST:
        yield rtol
        rtol /= 10 ** (1 / PER_DECADE)


def entry(choice: Choice, scalar: Choice) -> dict[str, Any]:
    """A solver's line of the results; times are for a lane, ratios within a repetition (of a slow solver there is but one)."""
    lanes, times = len(choice.errors), choice.times
    pairs = [(scalar.times[i].cpu / len(scalar.errors), t.cpu / lanes) for i, t in times.items() if i in scalar.times]
    return {
        "solver": choice.solver.name,
        "what": choice.solver.what,
        "lanes": lanes,
        "rtol": choice.rtol,
        "error": choice.error,
        "worst_error": float(np.max(choice.errors)),
        "made_in_seconds": choice.solver.made_in,
        "cpu_milliseconds": spread([1e3 * t.cpu / lanes for t in times.values()]),
        "wall_milliseconds": spread([1e3 * t.wall / lanes for t in times.values()]),
        "cpu_ratio_to_scalar_loop": spread([slow / fast for slow, fast in pairs]),
    }


def benchmark(given: Given) -> dict[str, Any]:
    """Find the tolerances, and measure; the run that shows the error of a slow solver also is the one that is timed."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["STRIBECK_CACHE"] = folder
        listed, missing = solvers(given.quick)
        say("reference")
        y, about = reference(LANES // 10 if given.quick else LANES)
        found: dict[str, Choice] = {}
        for solver in listed:
            try:
                choice = found[solver.name] = chosen(solver, found, y, given.quick)
                choice.times = {0: choice.took} if choice.took.cpu > SLOW else {}
            except ArithmeticError as reason:
                missing[solver.name] = str(reason)
        race(found.values(), given.repetitions, lambda choice, _: None if choice.took.cpu > SLOW else timed(choice.run))
    return {
        "benchmark": f"ensemble: {LANES} x {SECONDS:g} s of stick-slip, k_v and F_s varied",
        "error_limit": LIMIT,
        "rows": PROBLEM.scenario.rows,
        "threads": threads_of_this_machine(),
        "reference": about,
        "solvers": [entry(choice, found[SCALAR]) for choice in found.values()],
        "not_measured": missing,
    }


if __name__ == "__main__":
    run(benchmark, __doc__, "ensemble", repetitions=(5, 1))
