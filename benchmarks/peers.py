"""Every solver of a problem behind one call, and the search for the tolerance that gives an error.

A call takes rtol, atol and what the problem's pieces have of their own, and returns the compared columns at the rows.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache, partial
from time import perf_counter
from types import SimpleNamespace
from typing import Any, TypeVar

import numpy as np
from measure import Seconds, say, timed, version
from problems import SIGMA_0, Array, Problem, Rates

import stribeck
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, native

T = TypeVar("T")
Solve = Callable[..., Array]  # rtol, atol (None: the solver's own choice), values of the pieces -> rows
Piece = Callable[..., Array]  # rtol, atol, first and last row, states there, values -> states at the rows

MOST_STEPS = 10**6
DIFFRAX_FIRST_STEP = 1e-6


def in_pieces(problem: Problem, piece: Piece) -> Solve:
    """A solver that is run for each stretch without a jump."""

    def solve(rtol: float, atol: float, values: tuple[float, ...] | None = None) -> Array:
        states = np.zeros((len(problem.times), len(problem.scales)))
        for first, last, own in problem.pieces:
            states[first : last + 1] = piece(rtol, atol, first, last, states[first], values or own)
        return states[:, : len(problem.columns)]

    return solve


def odeint(problem: Problem, tuned: bool) -> Solve:
    """SciPy's odeint (LSODA in Fortran or C), numerical Jacobian."""
    from scipy.integrate import odeint

    rates = _python(problem, tuned)

    def piece(rtol: float, atol: float, first: int, last: int, x: Array, values: Any) -> Array:
        rows, info = odeint(
            rates, x, problem.times[first : last + 1], (values,), rtol=rtol, atol=atol * problem.scales, tfirst=True,
            mxstep=MOST_STEPS, full_output=True,
        )  # fmt: skip
        if info["message"] != "Integration successful.":
            raise ArithmeticError(info["message"])
        return rows

    return in_pieces(problem, piece)


def solve_ivp(problem: Problem, method: str, tuned: bool) -> Solve:
    """SciPy's solve_ivp with a method, numerical Jacobian."""
    from scipy.integrate import solve_ivp

    rates = _python(problem, tuned)

    def piece(rtol: float, atol: float, first: int, last: int, x: Array, values: Any) -> Array:
        times, how = problem.times[first : last + 1], {"rtol": rtol, "atol": atol * problem.scales}
        result = solve_ivp(rates, (times[0], times[-1]), x, method, times, args=(values,), **how)
        if not result.success:
            raise ArithmeticError(result.message)
        return result.y.T

    return in_pieces(problem, piece)


def _python(problem: Problem, tuned: bool) -> Rates:
    """The equations in Python; tuned, on Python's own floats, which are quicker than NumPy's scalars."""
    rates = problem.equations(math)
    return (lambda t, x, values: rates(t, x.tolist(), values)) if tuned else rates


def numbalsoda(problem: Problem) -> Solve:
    """numbalsoda (LSODA in C++) with equations compiled by numba."""
    import numba
    from numbalsoda import lsoda, lsoda_sig

    by_numba = SimpleNamespace(exp=math.exp, atan=math.atan, compiled=numba.njit)
    rates, s, order = numba.njit(problem.equations(by_numba)), tuple(problem.scales.tolist()), len(problem.scales)

    @numba.cfunc(lsoda_sig)
    def function(t, x, derivative, data):  # type: ignore[no-untyped-def]
        three = (x[0] * s[0], x[1] * s[1], x[2] * s[2])
        # numba keeps the branch of this order alone
        more = () if order == 3 else (x[3] * s[3],) if order == 4 else (x[3] * s[3], x[4] * s[4], x[5] * s[5])
        result = rates(t, three + more, data)
        for i in range(order):
            derivative[i] = result[i] / s[i]

    def piece(rtol: float, atol: float, first: int, last: int, x: Array, values: Any) -> Array:
        times, data = problem.times[first : last + 1], np.array(values)
        start = x / problem.scales
        rows, success = lsoda(function.address, start, times, data=data, rtol=rtol, atol=atol, mxstep=MOST_STEPS)
        if not success:
            raise ArithmeticError("numbalsoda failed")
        return rows * problem.scales

    return in_pieces(problem, piece)


def cvode(problem: Problem) -> Solve:
    """SUNDIALS CVODE (BDF) through scikit-sundae, NumPy equations; the Jacobian by differences, sparse if few states meet."""
    from sksundae.cvode import CVODE

    rates, wide, sparse = problem.equations(np if problem.width > 1 else math), problem.width, {}
    if problem.neighbors is not None:
        sparse = {"linsolver": "sparse", "sparsity": problem.neighbors}

    def piece(rtol: float, atol: float, first: int, last: int, x: Array, values: Any) -> Array:
        def right_side(t: float, x: Array, derivative: Array) -> None:
            derivative[:] = rates(t, x, values) if wide == 1 else np.hstack(rates(t, x.reshape(-1, wide), values))

        how = {"rtol": rtol, "atol": atol * problem.scales, "max_num_steps": MOST_STEPS, **sparse}
        result = CVODE(right_side, **how).solve(problem.times[first : last + 1], x)
        if not result.success:
            raise ArithmeticError(result.message)
        return result.y

    return in_pieces(problem, piece)


def casadi(problem: Problem) -> Solve:
    """SUNDIALS CVODES (BDF) through CasADi, symbolic equations, derived Jacobian."""
    import casadi

    s = problem.scales
    t, x, p = casadi.SX.sym("t"), casadi.SX.sym("x", len(s)), casadi.SX.sym("p", len(problem.pieces[0][-1]))
    rates = problem.equations(casadi)(t, casadi.vertsplit(x * s, problem.width), casadi.vertsplit(p))
    equations = {"t": t, "x": x, "p": p, "ode": casadi.vertcat(*rates) / s}

    @lru_cache
    def integrator(first: int, last: int, rtol: float, atol: float) -> Any:
        options = {"reltol": rtol, "abstol": atol, "max_num_steps": MOST_STEPS, "show_eval_warnings": False}
        times = problem.times[first : last + 1]
        return casadi.integrator("rows", "cvodes", equations, times[0], times[1:], options)

    def piece(rtol: float, atol: float, first: int, last: int, x: Array, values: Any) -> Array:
        try:
            rows = integrator(first, last, rtol, atol)(x0=x / s, p=values)["xf"]
        except RuntimeError as error:
            raise ArithmeticError(str(error)) from None
        return np.vstack([x, np.asarray(rows).T * s])

    return in_pieces(problem, piece)


def diffrax(problem: Problem, method: str, lanes: Mapping[str, Array] | None = None) -> Solve:
    """diffrax: an implicit Runge-Kutta method, equations and solver compiled by JAX, here and once; lanes all at once."""
    import diffrax
    import jax
    import jax.numpy

    jax.config.update("jax_enable_x64", True)
    rates, values = problem.equations(jax.numpy), problem.pieces[0][-1]
    term = diffrax.ODETerm(lambda t, x, p: jax.numpy.stack(rates(t, x, p)))
    times, rest = jax.numpy.asarray(problem.times), jax.numpy.zeros(len(problem.scales))

    def rows(rtol: Any, atol: Any, p: Any) -> Any:
        outcome = diffrax.diffeqsolve(
            term, getattr(diffrax, method)(), times[0], times[-1], DIFFRAX_FIRST_STEP, rest, args=p,
            saveat=diffrax.SaveAt(ts=times), stepsize_controller=diffrax.PIDController(rtol=rtol, atol=atol),
            max_steps=MOST_STEPS, throw=False,
        )  # fmt: skip
        return outcome.ys[:, : len(problem.columns)], outcome.result == diffrax.RESULTS.successful

    if lanes is not None:
        rows, values = jax.vmap(rows, in_axes=(None, None, 0)), tuple(lanes.values())
    compiled = jax.jit(rows).lower(1e-6, 1e-9, values).compile()

    def solve(rtol: float, atol: float) -> Array:
        y, success = compiled(rtol, atol, values)
        if not np.all(success):
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

    @lru_cache  # noqa: B019
    def at(self, rtol: float, atol: float | None = None) -> stribeck.Scenario:
        """The scenario with these tolerances, made once."""
        changes: dict[str, object] = {"solve.rtol": rtol}
        if atol is not None:
            names = [state.name for state in self.scenario.system.states]
            changes["solve.atol"] = {name: atol / SIGMA_0 if name == "z" else atol for name in names}
        return self.scenario.with_changes(changes)

    def solve(self, rtol: float, atol: float | None) -> Array:
        """The solver alone: native.solve, rows and events included."""
        result = native.solve(self.library, self.at(rtol, atol))
        if result.reason is not None:
            raise ArithmeticError(result.reason)
        return result.states[self.problem.first_row :, : len(self.problem.columns)]

    def simulate(self, rtol: float, atol: float | None) -> Array:
        """The whole public call, with the look into the cache and the columns."""
        solution, first = stribeck.simulate(self.at(rtol, atol)), self.problem.first_row
        return np.stack([solution[name][first:] for name in self.problem.columns], axis=1)


def installed(makers: Mapping[str, Callable[[], T]]) -> tuple[dict[str, tuple[T, float]], dict[str, str]]:
    """What can be made here, with the time that it took, s; and why the others cannot."""
    outcome, missing = dict[str, tuple[T, float]](), dict[str, str]()
    for name, make in makers.items():
        started = perf_counter()
        try:
            outcome[name] = make(), perf_counter() - started
        except (ImportError, OSError) as error:
            missing[name] = f"not installed ({error})"
    return outcome, missing


def available(problem: Problem) -> tuple[list[Solver], dict[str, str]]:
    """The solvers that can be measured here, the one of this project first; and why the others cannot."""
    own = Stribeck(problem)
    whole = "stribeck.simulate, the compiled system in the cache, default atol"
    outcome = [
        Solver(BASE, "native.solve, default atol", own.solve, (None,), OWN_LOOSEST, made_in=own.made_in),
        Solver(PEERS_ATOL, f"native.solve, {PEER_ATOL}", own.solve, loosest=OWN_LOOSEST),
        Solver("stribeck.simulate", whole, own.simulate, like=BASE),
    ]
    made, missing = installed({name: partial(make, problem) for name, _, _, make, _ in PEERS})
    for name, package, words, _, more in PEERS:
        if name in made:
            what = f"{package} {version(package)}, {words}, {PEER_ATOL}"
            outcome.append(Solver(name, what, made[name][0], made_in=made[name][1], **more))
    return outcome, missing


@dataclass
class Choice:
    """A solver with its tolerances.

    Attributes:
        errors: the largest of each column over the rows, as a part of its range; or those at neighboring tolerances.
        took: what a run takes.
        times: what it took in the repetitions.
    """

    solver: Solver
    rtol: float
    atol: float | None
    errors: Array
    took: Seconds
    times: dict[int, Seconds] = field(default_factory=dict)

    @property
    def error(self) -> float:
        """The typical error."""
        return float(np.median(self.errors))

    def run(self) -> Array:
        """Solve once."""
        return self.solver.solve(self.rtol, self.atol)


def tried(solver: Solver, rtol: float, share: float | None, exact: Array) -> Choice:
    """A solver after one run at a ratio atol/rtol; its error is infinite where it gives up."""
    choice = Choice(solver, rtol, None if share is None else share * rtol, np.full(1, math.inf), Seconds(0.0, 0.0))
    rows: list[Array] = []
    try:
        choice.took = timed(lambda: rows.append(choice.run()))
    except ArithmeticError:
        return choice
    exact = exact[:, : rows[0].shape[1]]
    off = np.abs(np.nan_to_num(rows[0], nan=math.inf) - exact)
    choice.errors = np.max(off, axis=0) / np.max(np.abs(exact), axis=0)
    return choice


def loosest(rtols: Iterable[float], tries: Callable[[float], Choice], keeps: Callable[[Choice], bool]) -> Choice:
    """The first of tolerances, ever tighter, that keeps the error."""
    for rtol in rtols:
        if keeps(choice := tries(rtol)):
            return choice
    raise ArithmeticError("no tolerance of the scan keeps the error")


def race(choices: Iterable[Choice], repetitions: int, run: Callable[[Choice, int], Seconds | None]) -> None:
    """Time all in turn, in random order in every repetition; ``run`` gives none where a slow one takes no part."""
    each = list(choices)
    for repetition in range(repetitions):
        for choice in random.sample(each, len(each)):
            if (took := run(choice, repetition)) is not None:
                choice.times[repetition] = took
        say(f"repetition {repetition + 1} of {repetitions}")
