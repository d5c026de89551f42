"""Every solver of a problem behind one call: tolerances in, y at the problem's times out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import numpy as np
import peers
from measure import version
from numpy.typing import NDArray
from problems import LIMIT_CYCLE, SIGMA_0, Problem
from prototype import FLAGS, PLAIN_FLAGS, Missing, Prototype

import stribeck
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, native

Array = NDArray[np.float64]
Solve = Callable[[float, float | None], Array]  # rtol, atol (None: the solver's own choice) -> y at the times

BASE = "stribeck"
PEERS_ATOL = "stribeck, peers' atol"
OWN_LOOSEST = 1e-2  # this project's solver works to a part of the rtol it is given
PROTOTYPE_LOOSEST = 10**-5.5  # looser ones can keep it busy for minutes
PEER_SHARES = (1e-1, 1e-2, 1e-3)
PEER_ATOL = "one atol on all states, sigma_0 z among them"


@dataclass(frozen=True)
class Solver:
    """A way to solve a problem.

    Attributes:
        name: for the table.
        what: what is timed.
        solve: solves once.
        shares: the ratios atol/rtol that the scan tries; None leaves atol to the solver.
        loosest: the rtol at which the scan begins.
        like: the solver whose tolerances it takes, where they are the same equations and method; else a scan.
        made_in: what making it took once, s: for some, compiling.
    """

    name: str
    what: str
    solve: Solve = field(repr=False)
    shares: tuple[float | None, ...] = PEER_SHARES
    loosest: float = 10**-4.5
    like: str | None = None
    made_in: float | None = None


class Stribeck:
    """The compiled simulator of this project."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.scenario = problem, problem.scenario
        chosen = compiler.find()
        if chosen is None:
            raise SystemExit("there is no C compiler: nothing to measure")
        started = perf_counter()
        self.library, _ = cache.library(source(self.scenario.system), chosen)
        self.made_in = perf_counter() - started
        self._scenarios: dict[tuple[float, float | None], stribeck.Scenario] = {}

    def at(self, rtol: float, atol: float | None) -> stribeck.Scenario:
        """The scenario with these tolerances, made once."""
        key = (rtol, atol)
        if key not in self._scenarios:
            changes: dict[str, object] = {"solve.rtol": rtol}
            if atol is not None:
                names = [state.name for state in self.scenario.system.states]
                changes["solve.atol"] = {name: atol / SIGMA_0 if name == "z" else atol for name in names}
            self._scenarios[key] = self.scenario.with_changes(changes)
        return self._scenarios[key]

    def solve(self, rtol: float, atol: float | None) -> Array:
        """The solver alone: native.solve, rows and events included."""
        result = native.solve(self.library, self.at(rtol, atol))
        if result.reason is not None:
            raise ArithmeticError(result.reason)
        return result.states[self.problem.first_row :, 0]

    def simulate(self, rtol: float, atol: float | None) -> Array:
        """The whole public call, with the look into the cache and the column y."""
        return stribeck.simulate(self.at(rtol, atol))["y"][self.problem.first_row :]


def own_solvers(problem: Problem) -> list[Solver]:
    """This project's solver, as it is timed: alone, with the peers' atol, and as the whole public call."""
    own = Stribeck(problem)
    whole = "stribeck.simulate, the compiled system in the cache, default atol"
    return [
        Solver(BASE, "native.solve, default atol", own.solve, (None,), OWN_LOOSEST, made_in=own.made_in),
        Solver(PEERS_ATOL, f"native.solve, {PEER_ATOL}", own.solve, loosest=OWN_LOOSEST),
        Solver("stribeck.simulate", whole, own.simulate, like=BASE),
    ]


def prototypes(folder: Path) -> tuple[list[Solver], dict[str, str]]:
    """The hand-written prototypes of the limit cycle, and why some cannot be measured."""
    found, missing = [], {}
    for name, flags in (("C prototype", FLAGS), ("C prototype, plain", PLAIN_FLAGS)):
        try:
            solve = Prototype(folder, flags).solve
            found.append(Solver(name, f"{' '.join(flags)}, {PEER_ATOL}", solve, loosest=PROTOTYPE_LOOSEST))
        except Missing as reason:
            missing[name] = str(reason)
    return found, missing


def available(problem: Problem, folder: Path) -> tuple[list[Solver], dict[str, str]]:
    """The solvers that can be measured here, the one of this project first; and why the others cannot."""
    found, missing = own_solvers(problem), {}
    if problem is LIMIT_CYCLE:
        more, missing = prototypes(folder)
        found += more
    for peer in peers.PEERS:
        try:
            started = perf_counter()
            solve = peer.make(problem)
            what = f"{peer.package} {version(peer.package)}, {peer.what}, {PEER_ATOL}"
            made_in = perf_counter() - started if peer.compiles else None
            found.append(Solver(peer.name, what, solve, peer.shares or PEER_SHARES, like=peer.like, made_in=made_in))
        except (ImportError, OSError) as error:
            missing[peer.name] = f"not installed ({error})"
    return found, missing
