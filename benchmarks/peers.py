"""Every solver of a problem behind one call: tolerances in, y at the problem's times out.

Those that an ensemble takes too have k_v and F_s as a third argument.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache, partial
from time import perf_counter
from typing import Any

import numpy as np
from measure import version
from numpy.typing import NDArray
from problems import F_S, K_V, SIGMA_0, Problem, friction_by

import stribeck
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, native

Array = NDArray[np.float64]
Solve = Callable[..., Array]  # rtol, atol (None: the solver's own choice), k_v and F_s -> y at the times
VALUES = (K_V, F_S)

MOST_STEPS = 10**6
DIFFRAX_FIRST_STEP = 1e-6


def odeint(problem: Problem, tuned: bool) -> Solve:
    """SciPy's odeint (LSODA in Fortran or C), numerical Jacobian."""
    from scipy.integrate import odeint

    times, rest, rates = problem.times, problem.rest, _python(problem, tuned)

    def solve(rtol: float, atol: float | None, values: tuple[float, ...] = VALUES) -> Array:
        rows, info = odeint(
            rates, rest, times, values, rtol=rtol, atol=atol, tfirst=True, mxstep=MOST_STEPS, full_output=True
        )
        if info["message"] != "Integration successful.":
            raise ArithmeticError(info["message"])
        return rows[:, 0]

    return solve


def solve_ivp(problem: Problem, method: str, tuned: bool) -> Solve:
    """SciPy's solve_ivp with a method, numerical Jacobian."""
    from scipy.integrate import solve_ivp

    times, rest, rates = problem.times, problem.rest, _python(problem, tuned)

    def solve(rtol: float, atol: float | None) -> Array:
        result = solve_ivp(rates, (times[0], times[-1]), rest, method=method, t_eval=times, rtol=rtol, atol=atol)
        if not result.success:
            raise ArithmeticError(result.message)
        return result.y[0]

    return solve


def _python(problem: Problem, tuned: bool) -> Callable[..., Any]:
    """The equations in Python; tuned, on Python's own floats, which are quicker than NumPy's scalars."""
    rates = problem.rates()
    return (lambda t, x, *values: rates(t, x.tolist(), *values)) if tuned else rates


def numbalsoda(problem: Problem) -> Solve:
    """numbalsoda (LSODA in C++) with equations compiled by numba."""
    from numbalsoda import lsoda

    function, times, rest = problem.compiled_rates(), problem.times, problem.rest

    def solve(rtol: float, atol: float | None, values: tuple[float, ...] = VALUES) -> Array:
        data = np.array(values)
        rows, success = lsoda(function.address, rest, times, data=data, rtol=rtol, atol=atol, mxstep=MOST_STEPS)
        if not success:
            raise ArithmeticError("numbalsoda failed")
        return rows[:, 0]

    return solve


def cvode(problem: Problem) -> Solve:
    """SUNDIALS CVODE (BDF) through scikit-sundae, Python equations, numerical Jacobian."""
    from sksundae.cvode import CVODE

    times, rest, rates = problem.times, problem.rest, problem.rates()

    def right_side(t: float, x: Array, derivative: Array) -> None:
        derivative[:] = rates(t, x)

    def solve(rtol: float, atol: float | None) -> Array:
        result = CVODE(right_side, rtol=rtol, atol=atol, max_num_steps=MOST_STEPS).solve(times, rest)
        if not result.success:
            raise ArithmeticError(result.message)
        return result.y[:, 0]

    return solve


def casadi(problem: Problem) -> Solve:
    """SUNDIALS CVODES (BDF) through CasADi, symbolic equations, derived Jacobian."""
    import casadi

    times, rest = problem.times, problem.rest
    t, x = casadi.SX.sym("t"), casadi.SX.sym("x", problem.order)
    rates = problem.equations(friction_by(casadi))(t, casadi.vertsplit(x))
    equations = {"t": t, "x": x, "ode": casadi.vertcat(*rates)}

    @lru_cache
    def integrator(rtol: float, atol: float) -> Any:
        options = {"reltol": rtol, "abstol": atol, "max_num_steps": MOST_STEPS, "show_eval_warnings": False}
        return casadi.integrator("rows", "cvodes", equations, times[0], times[1:], options)

    def solve(rtol: float, atol: float | None) -> Array:
        assert atol is not None
        try:
            rows = integrator(rtol, atol)(x0=rest)["xf"]
        except RuntimeError as error:
            raise ArithmeticError(str(error)) from None
        return np.concatenate([rest[:1], np.asarray(rows)[0]])

    return solve


def diffrax_rows(problem: Problem, method: str) -> Callable[..., Any]:
    """rtol, atol, k_v, F_s -> y at the times, and whether all went well; for jax.jit and jax.vmap."""
    import diffrax
    import jax
    import jax.numpy

    jax.config.update("jax_enable_x64", True)
    rates = problem.equations(friction_by(jax.numpy))
    term = diffrax.ODETerm(lambda t, x, args: jax.numpy.stack(rates(t, x, *args)))
    times, rest = jax.numpy.asarray(problem.times), jax.numpy.asarray(problem.rest)

    def rows(rtol: Any, atol: Any, k_v: Any, F_s: Any) -> Any:
        outcome = diffrax.diffeqsolve(
            term, getattr(diffrax, method)(), times[0], times[-1], DIFFRAX_FIRST_STEP, rest, args=(k_v, F_s),
            saveat=diffrax.SaveAt(ts=times), stepsize_controller=diffrax.PIDController(rtol=rtol, atol=atol),
            max_steps=MOST_STEPS, throw=False,
        )  # fmt: skip
        return outcome.ys[:, 0], outcome.result == diffrax.RESULTS.successful

    return rows


def diffrax(problem: Problem, method: str) -> Solve:
    """diffrax: an implicit Runge-Kutta method, equations and solver compiled by JAX; compiled here, once."""
    rows = diffrax_rows(problem, method)
    import jax

    compiled = jax.jit(rows).lower(1e-6, 1e-9, K_V, F_S).compile()

    def solve(rtol: float, atol: float | None) -> Array:
        y, success = compiled(rtol, atol, K_V, F_S)
        if not success:
            raise ArithmeticError("diffrax needed too many steps")
        return np.asarray(y)

    return solve


_PLAIN, _TUNED = "Python equations, state unpacked", "Python equations on x.tolist()"
_JAX = "equations and solver compiled by JAX"
# name, package, what for the table, how it is made for a problem, and what of a Solver is not as usual
PEERS: tuple[tuple[str, str, str, Callable[[Problem], Solve], dict[str, Any]], ...] = (
    ("numbalsoda", "numbalsoda", "LSODA, equations compiled by numba", numbalsoda, {}),
    ("CasADi CVODES", "casadi", "BDF, symbolic equations, derived Jacobian", casadi, {}),
    ("scikit-sundae CVODE", "scikit-sundae", f"BDF, {_PLAIN}", cvode, {}),
    ("SciPy odeint", "scipy", _PLAIN, partial(odeint, tuned=False), {}),
    ("SciPy odeint, tuned", "scipy", _TUNED, partial(odeint, tuned=True), {"like": "SciPy odeint"}),
    ("solve_ivp LSODA", "scipy", _PLAIN, partial(solve_ivp, method="LSODA", tuned=False), {}),
    ("solve_ivp LSODA, tuned", "scipy", _TUNED, partial(solve_ivp, method="LSODA", tuned=True), {"like": "solve_ivp LSODA"}),
    ("solve_ivp Radau", "scipy", _PLAIN, partial(solve_ivp, method="Radau", tuned=False), {}),
    ("diffrax Kvaerno3", "diffrax", f"order 3, {_JAX}", partial(diffrax, method="Kvaerno3"), {"shares": (1e-3,)}),
    ("diffrax Kvaerno5", "diffrax", f"order 5, {_JAX}", partial(diffrax, method="Kvaerno5"), {"shares": (1e-3,)}),
)  # fmt: skip

BASE = "stribeck"
PEERS_ATOL = "stribeck, peers' atol"
OWN_LOOSEST = 1e-2  # this project's solver works to a part of the rtol it is given
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
        made_in: what making it took once, s: importing it and, for some, compiling.
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


def available(problem: Problem) -> tuple[list[Solver], dict[str, str]]:
    """The solvers that can be measured here, the one of this project first; and why the others cannot."""
    outcome, missing = own_solvers(problem), dict[str, str]()
    for name, package, words, make, more in PEERS:
        try:
            started = perf_counter()
            solve = make(problem)
            what = f"{package} {version(package)}, {words}, {PEER_ATOL}"
            outcome.append(Solver(name, what, solve, made_in=perf_counter() - started, **more))
        except (ImportError, OSError) as error:
            missing[name] = f"not installed ({error})"
    return outcome, missing
