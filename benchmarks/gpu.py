"""The ensemble on a GPU: stick-slip over 300 s, k_v and F_s varied, beside all threads of the processor and diffrax.

The tolerance is the loosest at which the typical error (the median over the lanes of a lane's largest error of y, as a
part of its range) is at most 1e-7, as in ensemble.py; kernel and processor use the same. Times are of whole calls, with
the way to the GPU and back, without the kernel's compilation, which is told apart. All take turns in every repetition.
"""

from __future__ import annotations

import statistics
import sys
from collections.abc import Callable
from time import perf_counter
from typing import Any

import numpy as np
from ensemble_ways import PROBLEM, Array
from measure import machine, options, say, spread, table, write
from peers import diffrax_rows

import stribeck
from stribeck.simulation import cuda
from stribeck.simulation.lanes import threads_of_this_machine

LIMIT, REFERENCE, CHECKED = 1e-7, 1e-10, 64
COUNTS = (1_000, 10_000, 100_000, 1_000_000)
ON_PROCESSOR, BY_DIFFRAX = (1_000, 10_000), (1_000, 10_000)
STEP = 3.0  # s between rows: 101 rows, so that a million lanes fit


def varied(count: int) -> dict[str, Array]:
    """k_v from 1e6 to 1e8 s/m, evenly on a logarithmic scale, and F_s from 1.2 to 1.8 N, drawn at random."""
    drawn = np.random.default_rng(1).random((count, 2))
    return {"law.k_v": 10 ** (6 + 2 * drawn[:, 0]), "law.parameters.F_s": 1.2 + 0.6 * drawn[:, 1]}


def run(rtol: float, count: int, device: str) -> Array:
    """y of every lane."""
    scenario = PROBLEM.scenario.with_changes({"solve.rtol": rtol, "output.step": STEP})
    found = stribeck.simulate_ensemble(scenario, varied(count), device=device)
    assert not any(found.reason)
    return found["y"]


def error(y: Array, reference: Array) -> float:
    """The typical error of the lanes checked."""
    y = y[:CHECKED]
    return float(np.median(np.max(np.abs(y - reference), axis=1) / np.max(np.abs(reference), axis=1)))


def by_diffrax(count: int, rtol: float) -> Callable[[], Array]:
    """diffrax Kvaerno3 over all lanes by jax.vmap on JAX's default device, compiled."""
    import jax

    rows = diffrax_rows(PROBLEM, "Kvaerno3")
    values = [jax.device_put(x) for x in varied(count).values()]
    batch = jax.jit(jax.vmap(rows, in_axes=(None, None, 0, 0)))
    compiled = batch.lower(rtol, 1e-3 * rtol, *values).compile()

    def solve() -> Array:
        y, good = compiled(rtol, 1e-3 * rtol, *values)
        if not np.all(good):
            raise ArithmeticError("diffrax needed too many steps")
        every = round(STEP / (PROBLEM.times[1] - PROBLEM.times[0]))
        return np.asarray(y)[:, ::every]

    return solve


def main() -> None:
    """Run the benchmark, print the table, write the results."""
    given = options(__doc__, "gpu", repetitions=3, quick=1)
    try:
        name = cuda.device()
    except cuda.NoDevice as reason:
        print(f"not measured: {reason}")
        sys.exit(0)
    reference = run(REFERENCE, CHECKED, "cpu")
    rtol = next(r for r in 10.0 ** -np.arange(4, 11, 0.25) if error(run(r, CHECKED, "cpu"), reference) <= LIMIT)
    say(f"rtol {rtol:.1e}")
    begun = perf_counter()
    errors = {"stribeck on the GPU": error(run(rtol, CHECKED, "cuda"), reference)}
    compiled_in = perf_counter() - begun
    counts = COUNTS[:2] if given.quick else COUNTS
    ways: dict[tuple[str, int], Callable[[], Any]] = {
        ("stribeck on the GPU", n): lambda n=n: run(rtol, n, "cuda") for n in counts
    }
    ways |= {("stribeck, all threads", n): lambda n=n: run(rtol, n, "cpu") for n in ON_PROCESSOR}
    try:
        tight = next(r for r in 10.0 ** -np.arange(5, 12, 0.5) if error(by_diffrax(CHECKED, r)(), reference) <= LIMIT)
        ways |= {("diffrax vmap", n): by_diffrax(n, tight) for n in BY_DIFFRAX}
        errors["diffrax vmap"] = error(by_diffrax(CHECKED, tight)(), reference)
    except (ImportError, ArithmeticError, StopIteration) as reason:
        say(f"diffrax: not measured: {reason!r}")
    times: dict[tuple[str, int], list[float]] = {way: [] for way in ways}
    for repetition in range(given.repetitions):
        for way, solve in list(ways.items()):
            if way[0] == "diffrax vmap" and repetition > 0 and times[way][0] > 20:
                continue
            begun = perf_counter()
            try:
                solve()
                times[way].append(perf_counter() - begun)
            except Exception as reason:
                say(f"{way}: {type(reason).__name__}: {str(reason)[:200]}")
                del ways[way], times[way]
        say(f"repetition {repetition + 1} of {given.repetitions}")
    lines = [
        {"solver": solver, "lanes": n, "wall_seconds": spread(taken), "trajectories_per_second": n / statistics.median(taken)}
        for (solver, n), taken in times.items()
    ]  # fmt: skip
    write(given.out, {
        "benchmark": "ensemble on a GPU: 300 s of stick-slip, k_v and F_s varied", "machine": machine(), "gpu": name,
        "threads": threads_of_this_machine(), "rtol": rtol, "errors": errors, "first_call_with_compilation": compiled_in,
        "solvers": lines,
    })  # fmt: skip
    rows = [
        (x["solver"], str(x["lanes"]), f"{x['wall_seconds']['median']:.4g}", f"{x['trajectories_per_second']:.5g}")
        for x in lines
    ]
    print(
        f"{name}, {threads_of_this_machine()} threads, rtol {rtol:.1e}, first call {compiled_in:.2g} s, errors {errors}"
    )
    print(table(("solver", "lanes", "wall s", "trajectories/s"), rows))


if __name__ == "__main__":
    main()
