"""An ensemble: 1000 trajectories of stick-slip over 300 s, k_v and F_s varied, by this project and by its peers.

Each solver's tolerance is the loosest at which the typical error (the median over the lanes of a lane's largest error of
y, as a part of its range) is at most 1e-7. This project's is found in every run, its peers' are kept in tolerances.json
and checked. Slow solvers take fewer lanes; what counts is the time for a lane. All take turns in every repetition. Ratios
between single threads are of processor time, those that count threads of time on the wall (of use on an idle machine).
"""

from __future__ import annotations

import math
import os
import random
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import peers
from measure import Given, Seconds, keep, kept, run, say, spread, timed, version
from problems import Array, stick_slip

import stribeck
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, native
from stribeck.simulation.lanes import threads_of_this_machine
from stribeck.simulation.variations import Variations

Run = Callable[[], Array]  # solves all lanes: y of shape (lanes, times)
Solve = Callable[[float, float, int], Run]  # rtol, atol, lanes -> prepared

LANES, SECONDS, STEP = 1000, 300.0, 0.3
ATOL_SHARE = 1e-3  # atol/rtol of the peers
ONE, ALL, SCALAR = "stribeck, 1 thread", "stribeck, all threads", "stribeck, scalar loop"
PROBLEM = stick_slip(SECONDS, STEP)
NOTHING = Seconds(0.0, 0.0)


def values(count: int) -> dict[str, Array]:
    """What varies: k_v from 1e6 to 1e8 s/m, evenly on a logarithmic scale, and F_s from 1.2 to 1.8 N, drawn at random."""
    drawn = np.random.default_rng(1).random((LANES, 2))[:count]
    return {"law.k_v": 10 ** (6 + 2 * drawn[:, 0]), "law.parameters.F_s": 1.2 + 0.6 * drawn[:, 1]}


@dataclass
class Way:
    """A way to solve the ensemble.

    Attributes:
        name, what: for the table.
        solve: prepares for tolerances and a number of lanes, and returns what is timed, which returns y (lanes, times).
        lanes: how many it takes in a repetition.
        loosest: the rtol at which the search for its tolerance begins.
        like: the way whose tolerance it takes.
        rtol, error, worst: its tolerance, and the errors at it: the median lane's and the largest.
        last: what the last call of errors took.
        made_in: what making it took once, s: importing it and, for some, compiling.
    """

    name: str
    what: str
    solve: Solve = field(repr=False)
    lanes: int
    loosest: float = 1e-2
    like: str | None = None
    made_in: float | None = None
    rtol: float = math.nan
    error: float = math.nan
    worst: float = math.nan
    last: Seconds = NOTHING
    times: list[Seconds] = field(default_factory=list)

    def errors(self, rtol: float, count: int, y: Array) -> Array:
        """The error of each lane: the largest of y as a part of its range; infinite where it gives up."""
        run, built = self.solve(rtol, ATOL_SHARE * rtol, count), []
        try:
            self.last = timed(lambda: built.append(run()))
        except ArithmeticError:
            return np.full(count, math.inf)
        off = np.abs(np.nan_to_num(built[0], nan=math.inf) - y[:count])
        return np.max(off, axis=1) / np.max(np.abs(y[:count]), axis=1)


# -- this project --------------------------------------------------------------------------------------------------


def width() -> int:
    """How many lanes a vector has."""
    chosen = compiler.find()
    assert chosen is not None
    library, _ = cache.library(source(PROBLEM.scenario.system, lanes=True), chosen.for_lanes())
    return int(library.stribeck_lanes())


def own(threads: int | None) -> Solve:
    """simulate_ensemble, at default atol."""

    def solve(rtol: float, atol: float, count: int) -> Run:
        scenario, varied = PROBLEM.scenario.with_changes({"solve.rtol": rtol}), values(count)
        return lambda: stribeck.simulate(scenario, varied, threads=threads)["y"]

    return solve


def scalar_loop(rtol: float, atol: float, count: int) -> Run:
    """native.solve, one lane after the other."""
    varied = Variations(PROBLEM.scenario.with_changes({"solve.rtol": rtol}), values(count))
    scenarios = [varied.scenario.with_changes(varied.changes(i)) for i in range(count)]
    chosen = compiler.find()
    assert chosen is not None
    library, _ = cache.library(source(varied.scenario.system), chosen)
    return lambda: np.stack([native.solve(library, scenario).states[:, 0] for scenario in scenarios])


# -- peers ---------------------------------------------------------------------------------------------------------


def lane_by_lane(one: peers.Solve) -> Solve:
    """A solver of one simulation, one lane after the other."""

    def solve(rtol: float, atol: float, count: int) -> Run:
        every = list(zip(*(x.tolist() for x in values(count).values()), strict=True))
        return lambda: np.stack([one(rtol, atol, lane)[:, 0] for lane in every])

    return solve


def diffrax(count: int) -> Solve:
    """diffrax Kvaerno3 over so many lanes at once."""
    one = peers.diffrax(PROBLEM, "Kvaerno3", values(count))
    return lambda rtol, atol, some: lambda: one(rtol, atol)[:some, :, 0]


def ways(quick: bool) -> tuple[list[Way], dict[str, str]]:
    """What can be measured here, and why the rest cannot."""
    share = 10 if quick else 1
    threads = threads_of_this_machine()
    results = [
        Way(ONE, f"simulate_ensemble, vectors of {width()}", own(1), LANES // share),
        Way(ALL, f"simulate_ensemble on {threads} threads", own(None), LANES // share, like=ONE),
        Way(SCALAR, "native.solve lane by lane, 1 thread", scalar_loop, 250 // share, like=ONE),
    ]
    makers: dict[str, tuple[str, str, int, Callable[[], Solve]]] = {
        "numbalsoda": ("numbalsoda", "LSODA lane by lane, equations compiled", 80 // share,
                       lambda: lane_by_lane(peers.numbalsoda(PROBLEM))),
        "SciPy odeint, tuned": ("scipy", "LSODA lane by lane, Python equations", 8 // min(share, 4),
                                lambda: lane_by_lane(peers.odeint(PROBLEM, tuned=True))),
        "diffrax vmap": ("diffrax", "Kvaerno3, compiled by JAX", 100 // share, lambda: diffrax(100 // share)),
    }  # fmt: skip
    made, missing = peers.installed({name: make for name, (*_, make) in makers.items()})
    for name, (solve, seconds) in made.items():
        package, what, count, _ = makers[name]
        results.append(Way(name, f"{package} {version(package)}, {what}", solve, count, 1e-5, made_in=seconds))
    return results, missing


LIMIT = 1e-7  # of the range of y
REFERENCE_RTOL, CHECK_RTOL = 1e-10, 1e-12
PER_DECADE, TIGHTEST = 4, 1e-11
TRUSTED = (LIMIT / 4, 1.5 * LIMIT)
SLOW = 10.0  # s: what takes longer is run once


def reference(count: int) -> tuple[Array, dict[str, Any]]:
    """The rows of tight runs, and how well SciPy agrees on two lanes."""
    y = own(None)(REFERENCE_RTOL, 0.0, count)()
    other = lane_by_lane(peers.odeint(PROBLEM, tuned=True))(CHECK_RTOL, ATOL_SHARE * CHECK_RTOL, 2)()
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
        errors = way.errors(way.rtol, way.lanes, y)
    fits = errors is not None and (quick or TRUSTED[0] <= np.median(errors) <= TRUSTED[1])
    if way.like not in found and not fits:
        say(f"scan for the tolerance of {way.name}")
        some, errors = min(way.lanes, 64), None
        way.rtol, _ = peers.loosest(series(way.loosest), lambda rtol: np.median(way.errors(rtol, some, y)), LIMIT)
        if way.name != ONE:
            keep(key, way.rtol, ATOL_SHARE * way.rtol)
    if errors is None:
        errors = way.errors(way.rtol, way.lanes, y)
    way.error, way.worst = float(np.median(errors)), float(np.max(errors))
    if way.last.cpu > SLOW:
        way.times.append(way.last)


def series(rtol: float) -> Iterator[float]:
    """Tolerances from one on, ever tighter."""
    while rtol >= TIGHTEST:
        yield rtol
        rtol /= 10 ** (1 / PER_DECADE)


def entry(way: Way, scalar: Way) -> dict[str, Any]:
    """A way's line of the results; times are for a lane."""
    return {
        "solver": way.name,
        "what": way.what,
        "lanes": way.lanes,
        "rtol": way.rtol,
        "error": way.error,
        "worst_error": way.worst,
        "made_in_seconds": way.made_in,
        "cpu_milliseconds": spread([1e3 * t.cpu / way.lanes for t in way.times]),
        "wall_milliseconds": spread([1e3 * t.wall / way.lanes for t in way.times]),
        "trajectories_per_second": spread([way.lanes / t.wall for t in way.times]),
        "cpu_ratio_to_scalar_loop": spread(ratios(scalar, way)),
    }


def ratios(slow: Way, fast: Way) -> list[float]:
    """How many times faster a lane is, repetition by repetition (of a slow way there is but one)."""
    return [(s.cpu / slow.lanes) / (f.cpu / fast.lanes) for s, f in zip(slow.times, fast.times, strict=False)]


def benchmark(given: Given) -> dict[str, Any]:
    """Find the tolerances, and measure."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["STRIBECK_CACHE"] = folder
        listed, missing = ways(given.quick)
        say("reference")
        y, about = reference(max(way.lanes for way in listed))
        measured: dict[str, Way] = {}
        for way in listed:
            try:
                find_tolerance(way, measured, y, given.quick)
                measured[way.name] = way
            except ArithmeticError as reason:
                missing[way.name] = str(reason)
        for repetition in range(given.repetitions):
            for way in random.sample(list(measured.values()), len(measured)):
                if way.last.cpu <= SLOW:
                    way.times.append(timed(way.solve(way.rtol, ATOL_SHARE * way.rtol, way.lanes)))
            say(f"repetition {repetition + 1} of {given.repetitions}")
    return {
        "benchmark": f"ensemble: {LANES} x {SECONDS:g} s of stick-slip, k_v and F_s varied",
        "error_limit": LIMIT,
        "rows": PROBLEM.scenario.rows,
        "threads": threads_of_this_machine(),
        "reference": about,
        "solvers": [entry(way, measured[SCALAR]) for way in measured.values()],
        "not_measured": missing,
    }


if __name__ == "__main__":
    run(benchmark, __doc__, "ensemble", repetitions=(5, 1))
