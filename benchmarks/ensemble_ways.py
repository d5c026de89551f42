"""The ways to solve the ensemble: this project's, and its peers'."""

from __future__ import annotations

import atexit
import math
import os
import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from measure import Seconds, timed, version
from numpy.typing import NDArray
from peers import MOST_STEPS, diffrax_rows
from problems import stick_slip
from prototype import Missing, PrototypeOfLanes

import stribeck
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, lanes, native
from stribeck.simulation.ensemble import Ensemble
from stribeck.simulation.variations import Variations

Array = NDArray[np.float64]
Run = Callable[[], Any]  # solves all lanes; what it returns has y of shape (lanes, times)
Solve = Callable[[float, float, int], Run]  # rtol, atol, lanes -> prepared

LANES, SECONDS, STEP = 1000, 300.0, 0.3
ATOL_SHARE = 1e-3  # atol/rtol of the peers
ONE, ALL, NARROW, SCALAR = (
    "stribeck, 1 thread",
    "stribeck, all threads",
    "stribeck, AVX2, 1 thread",
    "stribeck, scalar loop",
)
DIFFRAX = "diffrax vmap"
PROTOTYPE = "C++ prototype, 1 thread"
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
        compiled_in: s, where something was compiled apart.
    """

    name: str
    what: str
    solve: Solve = field(repr=False)
    lanes: int
    loosest: float = 1e-2
    like: str | None = None
    compiled_in: float | None = None
    rtol: float = math.nan
    error: float = math.nan
    worst: float = math.nan
    last: Seconds = NOTHING
    times: list[Seconds] = field(default_factory=list)

    def errors(self, count: int, y: Array) -> Array:
        """The error of each lane: the largest of y as a part of its range; infinite where it gives up."""
        run, made = self.solve(self.rtol, ATOL_SHARE * self.rtol, count), []
        try:
            self.last = timed(lambda: made.append(run()))
            found = made[0]
            if isinstance(found, Ensemble):
                found = found["y"]
        except ArithmeticError:
            return np.full(count, math.inf)
        return np.max(np.abs(np.nan_to_num(found, nan=math.inf) - y[:count]), axis=1) / np.max(
            np.abs(y[:count]), axis=1
        )


# -- this project --------------------------------------------------------------------------------------------------


@contextmanager
def without_avx512() -> Iterator[None]:
    """Within, the compiler is told to do without AVX-512."""
    before = os.environ.get("STRIBECK_CC")
    chosen = compiler.find()
    assert chosen is not None
    os.environ["STRIBECK_CC"] = " ".join((*chosen.command, "-mno-avx512f"))
    try:
        yield
    finally:
        if before is None:
            del os.environ["STRIBECK_CC"]
        else:
            os.environ["STRIBECK_CC"] = before


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
        return lambda: stribeck.simulate_ensemble(scenario, varied, threads=threads)

    return solve


def own_narrow(rtol: float, atol: float, count: int) -> Run:
    """simulate_ensemble on one thread without AVX-512."""
    solve = own(1)(rtol, atol, count)

    def narrow() -> Ensemble:
        with without_avx512():
            return solve()

    return narrow


def scalar_loop(rtol: float, atol: float, count: int) -> Run:
    """native.solve, one lane after the other."""
    varied = Variations(PROBLEM.scenario.with_changes({"solve.rtol": rtol}), values(count))
    scenarios = [varied.scenario.with_changes(varied.changes(i)) for i in range(count)]
    chosen = compiler.find()
    assert chosen is not None
    library, _ = cache.library(source(varied.scenario.system), chosen)
    return lambda: np.stack([native.solve(library, scenario).states[:, 0] for scenario in scenarios])


# -- peers ---------------------------------------------------------------------------------------------------------


def numbalsoda() -> Solve:
    """numbalsoda, one lane after the other."""
    from numbalsoda import lsoda

    function, times, rest = PROBLEM.compiled_rates(), PROBLEM.times, PROBLEM.rest

    def solve(rtol: float, atol: float, count: int) -> Run:
        data = np.stack(list(values(count).values()), axis=1)

        def run() -> Array:
            found = [lsoda(function.address, rest, times, d, rtol=rtol, atol=atol, mxstep=MOST_STEPS) for d in data]
            if not all(success for _, success in found):
                raise ArithmeticError("numbalsoda failed")
            return np.stack([rows[:, 0] for rows, _ in found])

        return run

    return solve


def odeint() -> Solve:
    """SciPy's odeint with the equations on Python's own floats, one lane after the other."""
    from scipy.integrate import odeint as scipy_odeint

    rates, times, rest = PROBLEM.rates(), PROBLEM.times, PROBLEM.rest

    def tuned(t: float, x: Array, k_v: float, F_s: float) -> Any:
        return rates(t, x.tolist(), k_v, F_s)

    def solve(rtol: float, atol: float, count: int) -> Run:
        lane_values = np.stack(list(values(count).values()), axis=1).tolist()

        def one(lane: list[float]) -> Array:
            rows, info = scipy_odeint(
                tuned, rest, times, tuple(lane), rtol=rtol, atol=atol, tfirst=True, mxstep=MOST_STEPS, full_output=True
            )
            if info["message"] != "Integration successful.":
                raise ArithmeticError(info["message"])
            return rows[:, 0]

        return lambda: np.stack([one(lane) for lane in lane_values])

    return solve


def prototype() -> Solve:
    """The C++ prototype, in vectors as wide as ours."""
    folder = tempfile.mkdtemp()
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    made = PrototypeOfLanes(Path(folder), width())

    def solve(rtol: float, atol: float, count: int) -> Run:
        varied = values(count)
        return lambda: made.solve(varied["law.k_v"], varied["law.parameters.F_s"], PROBLEM.times, rtol, atol)

    return solve


def diffrax(way: Way) -> Solve:
    """diffrax Kvaerno3 over all lanes at once by jax.vmap; compiled here."""
    rows = diffrax_rows(PROBLEM, "Kvaerno3")
    import jax

    started = perf_counter()
    batch = jax.vmap(rows, in_axes=(None, None, 0, 0))
    compiled = jax.jit(batch).lower(1e-6, 1e-9, *values(way.lanes).values()).compile()
    way.compiled_in = perf_counter() - started

    def solve(rtol: float, atol: float, count: int) -> Run:
        varied = values(way.lanes)

        def run() -> Array:
            y, success = compiled(rtol, atol, *varied.values())
            if not np.all(success):
                raise ArithmeticError("diffrax needed too many steps")
            return np.asarray(y)[:count]

        return run

    return solve


def ways(quick: bool) -> tuple[list[Way], dict[str, str]]:
    """What can be measured here, and why the rest cannot."""
    share = 10 if quick else 1
    threads = lanes.threads_of_this_machine()
    found = [
        Way(ONE, f"simulate_ensemble, vectors of {width()}", own(1), LANES // share),
        Way(ALL, f"simulate_ensemble on {threads} threads", own(None), LANES // share, like=ONE),
        Way(SCALAR, "native.solve lane by lane, 1 thread", scalar_loop, 250 // share, like=ONE),
    ]
    missing = {}
    with without_avx512():
        narrow = width()
    if narrow == 4:
        found.insert(2, Way(NARROW, "compiled without AVX-512, vectors of 4", own_narrow, LANES // share, like=ONE))
    else:
        missing[NARROW] = f"the compiler without AVX-512 makes vectors of {narrow}"
    try:
        found.insert(1, Way(PROTOTYPE, "the prototype's lanes, no events", prototype(), LANES // share))
    except Missing as error:
        missing[PROTOTYPE] = str(error)
    makers: list[tuple[str, str, str, int, Callable[[Way], Solve]]] = [
        ("numbalsoda", "numbalsoda", "LSODA lane by lane, equations compiled", 80 // share, lambda way: numbalsoda()),
        (
            "SciPy odeint, tuned",
            "scipy",
            "LSODA lane by lane, Python equations",
            8 // min(share, 4),
            lambda way: odeint(),
        ),
        (DIFFRAX, "diffrax", "Kvaerno3, compiled by JAX", 100 // share, diffrax),
    ]
    for name, package, what, count, make in makers:
        try:
            way = Way(name, f"{package} {version(package)}, {what}", lambda *_: np.empty, count, loosest=1e-5)
            way.solve = make(way)
            found.append(way)
        except (ImportError, OSError) as error:
            missing[name] = f"not installed ({error})"
    return found, missing
