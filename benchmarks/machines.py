"""Machines: a two-mass drive against SciPy at equal error, and chains of bodies: time and compile time against size."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from measure import Given, run, say, spread, timed
from peers import (
    Solve,
    Solver,
    Stribeck,
    casadi,
    cvode,
    installed,
    loosest,
    numbalsoda,
    odeint,
    race,
    solve_ivp,
    tried,
)  # fmt: skip
from problems import Problem, chain, drive

from stribeck import simulate
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, native

ERROR = 1e-6  # of the peak of y and v of every body
SERIES = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)  # of rtol
FOR_DRIVE = {
    "CasADi CVODES": casadi, "numbalsoda": numbalsoda, "SciPy odeint": partial(odeint, tuned=False),
    "SciPy solve_ivp LSODA": partial(solve_ivp, method="LSODA", tuned=False),
}  # fmt: skip
FOR_CHAIN = {"CasADi CVODES, sparse": casadi, "scikit-sundae CVODE, sparse": cvode}


def measured(problem: Problem, makers: dict[str, Callable[[Problem], Solve]], repetitions: int) -> list[dict[str, Any]]:
    """Each solver at the loosest tolerance that keeps the error, in turn: processor seconds, and the ratios of each round."""
    own = Stribeck(problem)
    exact = own.simulate(1e-13, None)
    made, missing = installed({name: partial(make, problem) for name, make in makers.items()})
    solvers = [Solver("stribeck", "", own.simulate, (None,))]
    solvers += [Solver(name, "", solve, (1.0,)) for name, (solve, _) in made.items()]
    found = []
    for solver in solvers:
        tries = partial(tried, solver, share=solver.shares[0], exact=exact)
        try:
            found.append(loosest(SERIES, tries, lambda choice: choice.errors.max() <= ERROR))
        except ArithmeticError as reason:
            missing[solver.name] = str(reason)
    for name, why in missing.items():
        say(f"{name} left out: {why}")
    race(found, repetitions, lambda choice, _: timed(choice.run))
    seconds = [np.array([t.cpu for t in choice.times.values()]) for choice in found]
    return [
        {"solver": choice.solver.name, "rtol": choice.rtol, "error": float(choice.errors.max()),
         "seconds": spread(taken.tolist()), "against_stribeck": float(np.median(taken / seconds[0]))}
        for choice, taken in zip(found, seconds, strict=True)
    ]  # fmt: skip


def chains(sizes: tuple[int, ...], repetitions: int) -> list[dict[str, Any]]:
    """Time to write the C, to compile it, and to solve, by size."""
    rows, chosen = [], compiler.find()
    for count in sizes:
        problem = chain(count)
        scenario = problem.scenario.with_changes({"solve.rtol": 1e-8})
        writing = timed(lambda s=scenario: source.__wrapped__(s.system)).wall
        with tempfile.TemporaryDirectory() as folder:
            os.environ["STRIBECK_CACHE"] = folder
            compiling = timed(lambda s=scenario: cache.library(source(s.system), chosen, native.check)).wall
        solution = simulate(scenario)
        rows.append({
            "bodies": count, "states": len(scenario.system.states), "write_s": writing, "compile_s": compiling,
            "steps": solution.stats["accepted"], "solvers": measured(problem, FOR_CHAIN, repetitions),
        })  # fmt: skip
    return rows


def benchmark(given: Given) -> dict[str, Any]:
    """The drive and the chains."""
    drive_rows = measured(drive(), FOR_DRIVE, given.repetitions)
    chain_rows = chains((2, 4) if given.repetitions <= 2 else (2, 4, 8, 16), given.repetitions)
    return {"two_masses": drive_rows, "chains": chain_rows}


if __name__ == "__main__":
    run(benchmark, __doc__, "machines", "machines", "chains", repetitions=(15, 2))
