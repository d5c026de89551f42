"""Every solver of the limit cycle behind one call: tolerances in, y at the rows from START on out."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import limit_cycle as job
import numpy as np
from measure import version
from numpy.typing import NDArray
from prototype import FLAGS, PLAIN_FLAGS, Missing, Prototype

import stribeck
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, native

Array = NDArray[np.float64]
Rates = Callable[[float, Array], list[float]]
Solve = Callable[[float, float | None], Array]  # rtol, atol (None: the solver's own choice) -> y at TIMES

BASE = "stribeck"
PEERS_ATOL = "stribeck, peers' atol"
TIMES = np.arange(job.FIRST_ROW, job.ROWS) * job.STEP
REST = np.zeros(4)
OWN_LOOSEST = 1e-2  # this project's solver works to a part of the rtol it is given
PROTOTYPE_LOOSEST = 10**-5.5  # looser ones can keep it busy for minutes
PEER_SHARES = (1e-1, 1e-2, 1e-3)
PEER_ATOL = "one atol on y, v, sigma_0 z and I"
MOST_STEPS = 10**6


@dataclass(frozen=True)
class Solver:
    """A way to solve the limit cycle.

    Attributes:
        name: for the table.
        what: what is timed.
        solve: solves once.
        shares: the ratios atol/rtol that the scan tries; None leaves atol to the solver.
        loosest: the rtol at which the scan begins.
        like: the solver whose tolerances it takes, where they are the same equations and method; else a scan.
    """

    name: str
    what: str
    solve: Solve = field(repr=False)
    shares: tuple[float | None, ...] = PEER_SHARES
    loosest: float = 10**-4.5
    like: str | None = None


class Stribeck:
    """The compiled simulator of this project."""

    def __init__(self) -> None:
        self.scenario = stribeck.Scenario(tomllib.loads(job.SCENARIO))
        chosen = compiler.find()
        if chosen is None:
            raise SystemExit("there is no C compiler: nothing to measure")
        self.library, _ = cache.library(source(self.scenario.system), chosen)
        self._scenarios: dict[tuple[float, float | None], stribeck.Scenario] = {}

    def at(self, rtol: float, atol: float | None) -> stribeck.Scenario:
        """The scenario with these tolerances, made once."""
        key = (rtol, atol)
        if key not in self._scenarios:
            changes: dict[str, object] = {"solve.rtol": rtol}
            if atol is not None:
                changes["solve.atol"] = {"y": atol, "v": atol, "z": atol / job.SIGMA_0, "I": atol}
            self._scenarios[key] = self.scenario.with_changes(changes)
        return self._scenarios[key]

    def solve(self, rtol: float, atol: float | None) -> Array:
        """The solver alone: native.solve, rows and events included."""
        result = native.solve(self.library, self.at(rtol, atol))
        if result.reason is not None:
            raise ArithmeticError(result.reason)
        return result.states[job.FIRST_ROW :, 0]

    def simulate(self, rtol: float, atol: float | None) -> Array:
        """The whole public call, with the look into the cache and the column y."""
        return stribeck.simulate(self.at(rtol, atol))["y"][job.FIRST_ROW :]


def tuned_rates(t: float, x: Array) -> list[float]:
    """The same equations on Python's own floats, which are quicker than NumPy's scalars."""
    return job.rates(t, x.tolist())


def odeint(rates: Rates) -> Solve:
    """SciPy's odeint (LSODA in Fortran or C), numerical Jacobian."""
    from scipy.integrate import odeint

    def solve(rtol: float, atol: float | None) -> Array:
        rows, info = odeint(rates, REST, TIMES, rtol=rtol, atol=atol, tfirst=True, mxstep=MOST_STEPS, full_output=True)
        if info["message"] != "Integration successful.":
            raise ArithmeticError(info["message"])
        return rows[:, 0]

    return solve


def solve_ivp(method: str, rates: Rates) -> Solve:
    """SciPy's solve_ivp with a method, numerical Jacobian."""
    from scipy.integrate import solve_ivp

    def solve(rtol: float, atol: float | None) -> Array:
        span = (job.START, TIMES[-1])
        result = solve_ivp(rates, span, REST, method=method, t_eval=TIMES, rtol=rtol, atol=atol)
        if not result.success:
            raise ArithmeticError(result.message)
        return result.y[0]

    return solve


def numbalsoda() -> Solve:
    """numbalsoda (LSODA in C++) with equations compiled by numba."""
    from numbalsoda import lsoda

    function = job.compiled_rates()
    address = function.address

    def solve(rtol: float, atol: float | None) -> Array:
        assert function is not None  # keeps the compiled function alive
        rows, success = lsoda(address, REST, TIMES, rtol=rtol, atol=atol, mxstep=MOST_STEPS)
        if not success:
            raise ArithmeticError("numbalsoda failed")
        return rows[:, 0]

    return solve


def cvode() -> Solve:
    """SUNDIALS CVODE (BDF) through scikit-sundae, Python equations, numerical Jacobian."""
    from sksundae.cvode import CVODE

    def right_side(t: float, x: Array, derivative: Array) -> None:
        derivative[:] = job.rates(t, x)

    def solve(rtol: float, atol: float | None) -> Array:
        result = CVODE(right_side, rtol=rtol, atol=atol, max_num_steps=MOST_STEPS).solve(TIMES, REST)
        if not result.success:
            raise ArithmeticError(result.message)
        return result.y[:, 0]

    return solve


def own_solvers() -> list[Solver]:
    """This project's solver, as it is timed: alone, with the peers' atol, and as the whole public call."""
    own = Stribeck()
    whole = "stribeck.simulate, the compiled system in the cache, default atol"
    return [
        Solver(BASE, "native.solve, default atol", own.solve, (None,), OWN_LOOSEST),
        Solver(PEERS_ATOL, f"native.solve, {PEER_ATOL}", own.solve, loosest=OWN_LOOSEST),
        Solver("stribeck.simulate", whole, own.simulate, like=BASE),
    ]


def available(folder: Path) -> tuple[list[Solver], dict[str, str]]:
    """The solvers that can be measured here, the one of this project first; and why the others cannot."""
    found, missing = own_solvers(), {}
    for name, flags in (("C prototype", FLAGS), ("C prototype, plain", PLAIN_FLAGS)):
        try:
            found.append(
                Solver(
                    name, f"{' '.join(flags)}, {PEER_ATOL}", Prototype(folder, flags).solve, loosest=PROTOTYPE_LOOSEST
                )
            )
        except Missing as reason:
            missing[name] = str(reason)
    plain, tuned = "Python equations, state unpacked", "Python equations on x.tolist()"
    makers: list[tuple[str, str, str, Callable[[], Solve], str | None]] = [
        ("numbalsoda", "numbalsoda", "LSODA, equations compiled by numba", numbalsoda, None),
        ("scikit-sundae CVODE", "scikit-sundae", f"BDF, {plain}", cvode, None),
        ("SciPy odeint", "scipy", plain, lambda: odeint(job.rates), None),
        ("SciPy odeint, tuned", "scipy", tuned, lambda: odeint(tuned_rates), "SciPy odeint"),
        ("solve_ivp LSODA", "scipy", plain, lambda: solve_ivp("LSODA", job.rates), None),
        ("solve_ivp LSODA, tuned", "scipy", tuned, lambda: solve_ivp("LSODA", tuned_rates), "solve_ivp LSODA"),
        ("solve_ivp Radau", "scipy", plain, lambda: solve_ivp("Radau", job.rates), None),
    ]
    for name, package, what, make, like in makers:
        try:
            found.append(Solver(name, f"{package} {version(package)}, {what}, {PEER_ATOL}", make(), like=like))
        except (ImportError, OSError) as error:
            missing[name] = f"not installed ({error})"
    return found, missing
