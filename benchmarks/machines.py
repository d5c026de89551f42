"""Machines: a two-mass drive against SciPy at equal error, and chains of bodies: time and compile time against size."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from functools import lru_cache, partial
from itertools import pairwise
from math import atan, exp, pi
from typing import Any

import numpy as np
from measure import finish, in_turn, options, say, spread, timed
from numpy.typing import NDArray
from scipy.integrate import odeint, solve_ivp

from stribeck import Scenario, simulate
from stribeck.codegen import source
from stribeck.simulation import cache, compiler, native

Array = NDArray[np.float64]
MOST_STEPS = 10**7


def piece_rows(t0: float, t1: float, rows: Array, t_end: float) -> Array:
    """The rows from t0 on and before t1 (with it at the end)."""
    return rows[(rows >= t0 - 1e-9) & ((rows < t1 - 1e-9) | (t1 == t_end))]


def by_pieces(
    torque: tuple[list[float], list[float]], rows: Array, states: int, solve: Callable[[Array, Array, tuple[float, ...]], Array]
) -> Array:  # fmt: skip
    """The states at the rows, one run for each piece of the torque; ``solve(times, x, (t0, level, slope))``."""
    x, result = np.zeros(states), []
    for (t0, u0), (t1, u1) in pairwise(zip(*torque, strict=True)):
        if t1 == t0:
            continue
        inner = piece_rows(t0, t1, rows, torque[0][-1])
        times = np.concatenate([[t0], inner[(inner > t0 + 1e-9) & (inner < t1 - 1e-9)], [t1]])
        every = solve(times, x, (t0, u0, (u1 - u0) / (t1 - t0)))
        x = every[-1]
        keep = np.array([np.min(np.abs(inner - t)) < 1e-9 if len(inner) else False for t in times])
        result.append(every[keep][: len(inner)])
    return np.concatenate(result)


def casadi_drive(torque: Any, rows: Array, scales: Array) -> Callable[[float], Array]:
    """CVODES through CasADi: symbolic equations, derived Jacobian; one absolute tolerance for states scaled to 1."""
    import casadi

    t, x, p = casadi.SX.sym("t"), casadi.SX.sym("x", len(scales)), casadi.SX.sym("p", 3)
    equations = drive_equations(casadi.exp, casadi.atan, casadi.fmin)
    rates = equations(t, [xi * s for xi, s in zip(casadi.vertsplit(x), scales, strict=True)], casadi.vertsplit(p))
    ode = {"t": t, "x": x, "p": p, "ode": casadi.vertcat(*(r / s for r, s in zip(rates, scales, strict=True)))}

    @lru_cache
    def integrator(times: tuple[float, ...], rtol: float) -> Any:
        options = {"reltol": rtol, "abstol": rtol, "max_num_steps": MOST_STEPS, "show_eval_warnings": False}
        return casadi.integrator("rows", "cvodes", ode, times[0], list(times[1:]), options)

    def solve(rtol: float) -> Array:
        def piece(times: Array, x0: Array, q: tuple[float, ...]) -> Array:
            result = integrator(tuple(times.tolist()), rtol)(x0=x0 / scales, p=q)["xf"]
            return np.vstack([x0, np.asarray(result).T * scales])

        return by_pieces(torque, rows, len(scales), piece)

    return solve


def numbalsoda_drive(torque: Any, rows: Array, scales: Array) -> Callable[[float], Array]:
    """numbalsoda's LSODA, the equations compiled by numba; one absolute tolerance for states scaled to 1."""
    import numba
    from numbalsoda import lsoda, lsoda_sig

    equations, own = numba.njit(drive_equations(exp, atan, min)), tuple(scales.tolist())

    @numba.cfunc(lsoda_sig)
    def function(t, x, derivative, data):  # type: ignore[no-untyped-def]
        state = (x[0] * own[0], x[1] * own[1], x[2] * own[2], x[3] * own[3], x[4] * own[4], x[5] * own[5])
        result = equations(t, state, (data[0], data[1], data[2]))
        for i in range(6):
            derivative[i] = result[i] / own[i]

    def solve(rtol: float) -> Array:
        def piece(times: Array, x0: Array, q: tuple[float, ...]) -> Array:
            result, good = lsoda(
                function.address, x0 / scales, times, data=np.array(q), rtol=rtol, atol=rtol, mxstep=MOST_STEPS
            )
            if not good:
                raise ArithmeticError("numbalsoda failed")
            return np.asarray(result * scales)

        return by_pieces(torque, rows, len(scales), piece)

    return solve


def scipy_drive(way: str, torque: Any, rows: Array, scales: Array) -> Callable[[float], Array]:
    """SciPy's odeint, or solve_ivp by a method, on plain floats."""
    equations = drive_equations(exp, atan, min)

    def solve(rtol: float) -> Array:
        def piece(times: Array, x0: Array, q: tuple[float, ...]) -> Array:
            how: dict[str, Any] = {"args": (q,), "rtol": rtol, "atol": rtol * scales}
            if way == "odeint":
                return np.asarray(odeint(equations, x0, times, tfirst=True, mxstep=10**6, **how))
            return np.asarray(solve_ivp(equations, (times[0], times[-1]), x0, way, times, **how).y.T)

        return by_pieces(torque, rows, len(scales), piece)

    return solve


def chain_equations(
    mathematics: Any, join: Callable[..., Any], p: dict[str, float], k_v: float, stiffness: float, damping: float
) -> Callable[..., Any]:
    """The chain by arrays of y, v and z of every body, the push on the first; with somebody's functions of arrays."""

    def rates(t: Any, y: Any, v: Any, z: Any) -> Any:
        m = v * (2 / pi) * mathematics.arctan(k_v * v) + 2 / (pi * k_v)
        g = (p["F_c"] + (p["F_s"] - p["F_c"]) * mathematics.exp(-((v / p["v_s"]) ** 2))) / p["sigma_0"]
        dz = v - m / g * z
        f = stiffness * (y[:-1] - y[1:]) + damping * (v[:-1] - v[1:])
        push = 5.0 * y.shape[0] * mathematics.sin(2 * pi * t)
        return join(v, join(push, f) - join(f, 0.0) - p["sigma_0"] * z - p["sigma_1"] * dz - p["sigma_2"] * v, dz)

    return rates


def sparse_chain(count: int, p: dict[str, float], k_v: float, stiffness: float, damping: float, rows: Array,
                 scales: Array) -> Callable[[float], Array]:  # fmt: skip
    """SUNDIALS CVODE through scikit-sundae: NumPy equations, sparse Jacobian by grouped differences, SuperLU."""
    from scipy.sparse import bmat, diags, eye
    from sksundae.cvode import CVODE

    rates = chain_equations(np, lambda *parts: np.hstack(parts), p, k_v, stiffness, damping)
    near, one = diags([1.0, 1.0, 1.0], [-1, 0, 1], shape=(count, count)), eye(count)
    pattern = (bmat([[None, one, None], [near, near, one], [None, one, one]]) != 0).astype(float)
    n = 3 * count
    own = np.repeat(scales, count)

    def right_side(t: float, x: Array, dx: Array) -> None:
        dx[:] = rates(t, x[:count], x[count : 2 * count], x[2 * count :])

    def solve(rtol: float) -> Array:
        solver = CVODE(
            right_side,
            rtol=rtol,
            atol=rtol * own,
            max_num_steps=MOST_STEPS,
            linsolver="sparse",
            sparsity=(pattern + eye(n)).tocsc(),
        )
        result = solver.solve(rows, np.zeros(n))
        if not result.success:
            raise ArithmeticError(result.message)
        return np.asarray(result.y[:, : 2 * count])

    return solve


def casadi_chain(count: int, p: dict[str, float], k_v: float, stiffness: float, damping: float, rows: Array,
                 scales: Array) -> Callable[[float], Array]:  # fmt: skip
    """CVODES through CasADi: symbolic equations, derived sparse Jacobian, sparse direct solver."""
    import casadi

    t, x = casadi.SX.sym("t"), casadi.SX.sym("x", 3 * count)
    own = np.repeat(scales, count)
    xs = x * own
    rates = chain_equations(casadi, casadi.vertcat, p, k_v, stiffness, damping)
    ode = {"t": t, "x": x, "ode": rates(t, xs[:count], xs[count : 2 * count], xs[2 * count :]) / own}

    @lru_cache
    def integrator(rtol: float) -> Any:
        options = {"reltol": rtol, "abstol": rtol, "max_num_steps": MOST_STEPS, "show_eval_warnings": False}
        return casadi.integrator("rows", "cvodes", ode, rows[0], rows[1:].tolist(), options)

    def solve(rtol: float) -> Array:
        result = np.asarray(integrator(rtol)(x0=np.zeros(3 * count))["xf"]).T * own
        return np.vstack([np.zeros(3 * count), result])[:, : 2 * count]

    return solve


T_END, STEP, ERROR = 2.0, 4e-3, 1e-6
TORQUE = ([0.0, 0.2, 0.5, 0.5, 1.0, 1.0, 1.4, 1.7, 2.0], [0.0, 0.25, 0.25, 0.08, 0.08, -0.05, -0.3, -0.3, 0.0])
BEARING = {"sigma_0": 12.0, "sigma_1": 0.04, "sigma_2": 2e-4, "F_c": 0.03, "F_s": 0.045, "v_s": 1.5}
GUIDE = {"sigma_0": 1.5e6, "sigma_1": 4e3, "sigma_2": 150.0, "F_c": 30.0, "F_s": 48.0, "v_s": 4e-3}
RATIO = 0.01 / (2 * pi)
CHAIN, CHAIN_K_V = {"sigma_0": 1e4, "sigma_1": 30.0, "sigma_2": 1.0, "F_c": 1.0, "F_s": 1.5, "v_s": 0.01}, 1e5
SCALES = np.array([1e-3, 1e-5, 1.5, 4e-3, 4e-3, 3e-5])  # of y, v and z of both bodies, for absolute tolerances


def drive(rtol: float = 1e-8) -> Scenario:
    """The two-mass drive: a motor, a ball screw, a table, friction at both."""
    bearing = {"name": "lugre_majorant", "k_v": 1e4, "parameters": BEARING}
    guide = {"name": "lugre_sobczyk", "k_v": 1e5, "parameters": GUIDE}
    signal = {"kind": "points", "t": TORQUE[0], "value": TORQUE[1]}
    return Scenario({
        "schema": 2, "bodies": {"rotor": {"inertia": 1.2e-4}, "table": {"mass": 20.0}},
        "links": {"screw": {"from": "rotor", "to": "table", "ratio": RATIO, "stiffness": 2e7, "damping": 3e3}},
        "contacts": {"bearing": {"from": "rotor", "law": bearing}, "guide": {"from": "table", "law": guide}},
        "loads": {"torque": {"on": "rotor", "kind": "signal", "signal": signal}},
        "solve": {"t_end": T_END, "rtol": rtol}, "output": {"step": STEP},
    })  # fmt: skip


def drive_equations(exp: Any, atan: Any, least: Any) -> Callable[..., Any]:
    """The same with somebody's functions, within one piece of the torque: p = (its begin, the level there, the slope)."""
    a, b = (tuple(p[n] for n in ("sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s")) for p in (BEARING, GUIDE))

    def rates(t: Any, x: Any, p: Any) -> Any:
        y1, y2, v1, v2, z1, z2 = x
        g1 = (a[3] + (a[4] - a[3]) * exp(-((v1 / a[5]) ** 2))) / a[0]
        dz1 = v1 - (v1 * 2 / pi * atan(1e4 * v1) + 2 / (pi * 1e4)) / g1 * z1
        g2 = (b[3] + (b[4] - b[3]) * exp(-least((v2 / b[5]) ** 2, 700.0))) / b[0]
        sign = 2 / pi * atan(1e5 * v2)
        dz2 = sign * sign * v2 - v2 * sign / g2 * z2
        f = 2e7 * (RATIO * y1 - y2) + 3e3 * (RATIO * v1 - v2)
        F1, F2 = a[0] * z1 + a[1] * dz1 + a[2] * v1, b[0] * z2 + b[1] * dz2 + b[2] * v2
        torque = p[1] + p[2] * (t - p[0])
        return v1, v2, (torque - RATIO * f - F1) / 1.2e-4, (f - F2) / 20.0, dz1, dz2

    return rates


def error(states: np.ndarray, exact: np.ndarray) -> float:
    """The largest error of y and v of every body, as a share of each peak."""
    n = exact.shape[1]
    return float(np.max(np.max(np.abs(states[:, :n] - exact), axis=0) / np.max(np.abs(exact), axis=0)))


def ours(scenario: Scenario) -> np.ndarray:
    """The same columns by Stribeck."""
    s = simulate(scenario)
    return np.stack([s[n] for n in ("rotor.y", "table.y", "rotor.v", "table.v")], axis=1)


def tolerance(name: str, way: Callable[[float], np.ndarray], exact: np.ndarray) -> tuple[float, float]:
    """The loosest rtol of a series that keeps the error, and the error there."""
    for rtol in (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11):
        try:
            reached = error(way(rtol), exact)
        except (ArithmeticError, RuntimeError, ValueError):
            continue
        if reached <= ERROR:
            break
    say(f"{name}: rtol {rtol:g}, error {reached:.1e}")
    return rtol, reached


def measured(
    ways: dict[str, tuple[Callable[[float], np.ndarray], float, float]], repetitions: int
) -> list[dict[str, Any]]:
    """Each way at its tolerance, in turn; processor seconds, and the ratios of each round."""
    taken = in_turn({name: partial(way, rtol) for name, (way, rtol, _) in ways.items()}, repetitions)
    seconds = {name: np.array([s.cpu for s in x]) for name, x in taken.items()}
    return [
        {"solver": name, "rtol": rtol, "error": reached, "seconds": spread(seconds[name].tolist()),
         "against_stribeck": float(np.median(seconds[name] / seconds["stribeck"]))}
        for name, (_, rtol, reached) in ways.items()
    ]  # fmt: skip


def two_masses(repetitions: int) -> list[dict[str, Any]]:
    """Each solver at the loosest tolerance of a series that keeps the error."""
    exact, rows = ours(drive(1e-13)), np.arange(round(T_END / STEP) + 1) * STEP
    built = lru_cache(None)(drive)  # once, as the peers' integrators are

    def own(rtol: float) -> np.ndarray:
        return ours(built(rtol))

    ways: dict[str, Callable[[float], np.ndarray]] = {"stribeck": own}
    for name, make in (("CasADi CVODES", casadi_drive), ("numbalsoda", numbalsoda_drive)):
        try:
            ways[name] = make(TORQUE, rows, SCALES)
        except ImportError as missing:
            say(f"two masses: {name} left out: {missing}")
    ways["SciPy odeint"] = scipy_drive("odeint", TORQUE, rows, SCALES)
    ways["SciPy solve_ivp LSODA"] = scipy_drive("LSODA", TORQUE, rows, SCALES)
    return measured({n: (w, *tolerance(f"two masses: {n}", w, exact)) for n, w in ways.items()}, repetitions)


def chain(count: int, rtol: float = 1e-8) -> Scenario:
    """Bodies in a row, each rubbing on the ground, the first pushed to and fro."""
    law = {"name": "lugre_majorant", "k_v": CHAIN_K_V, "parameters": CHAIN}
    signal = {"kind": "sine", "amplitude": 5.0 * count, "frequency": 1.0}
    return Scenario({
        "schema": 2, "bodies": {f"m{i}": {"mass": 1.0} for i in range(count)},
        "links": {f"k{i}": {"from": f"m{i}", "to": f"m{i + 1}", "stiffness": 1e3, "damping": 1.0} for i in range(count - 1)},
        "contacts": {f"c{i}": {"from": f"m{i}", "law": law} for i in range(count)},
        "loads": {"push": {"on": "m0", "kind": "signal", "signal": signal}},
        "solve": {"t_end": 1.0, "rtol": rtol}, "output": {"step": 5e-3},
    })  # fmt: skip


def chains(sizes: tuple[int, ...], repetitions: int) -> list[dict[str, Any]]:
    """Time to write the C, to compile it, and to solve, by size."""
    rows, chosen = [], compiler.find()
    assert chosen is not None
    for count in sizes:
        scenario = chain(count)
        writing = timed(lambda s=scenario: source.__wrapped__(s.system)).wall
        with tempfile.TemporaryDirectory() as folder:
            os.environ["STRIBECK_CACHE"] = folder
            compiling = timed(lambda s=scenario: cache.library(source(s.system), chosen, native.check)).wall
        solution, names = simulate(scenario), [f"m{i}.{x}" for x in "yv" for i in range(count)]
        made = lru_cache(None)(partial(chain, count))

        def own(rtol: float, names: Any = names, made: Any = made) -> np.ndarray:
            s = simulate(made(rtol))
            return np.stack([s[n] for n in names], axis=1)

        given = (count, CHAIN, CHAIN_K_V, 1e3, 1.0, np.arange(201) * 5e-3, np.array([1e-4, 1e-2, 1.5e-4]))
        ways: dict[str, Callable[[float], np.ndarray]] = {"stribeck": own}
        for name, make in (("CasADi CVODES, sparse", casadi_chain), ("scikit-sundae CVODE, sparse", sparse_chain)):
            try:
                ways[name] = make(*given)
            except ImportError as missing:
                say(f"chain: {name} left out: {missing}")
        exact = own(1e-13)
        solvers = measured({n: (w, *tolerance(f"{count} bodies: {n}", w, exact)) for n, w in ways.items()}, repetitions)
        rows.append({
            "bodies": count, "states": len(scenario.system.states), "write_s": writing, "compile_s": compiling,
            "steps": solution.stats["accepted"], "solvers": solvers,
        })  # fmt: skip
        say(f"chain of {count}: {writing + compiling:.2f} s to build")
    return rows


def main() -> None:
    """Measure, print, write."""
    given = options(__doc__, "machines", repetitions=(15, 2))
    drive_rows = two_masses(given.repetitions)
    chain_rows = chains((2, 4) if given.repetitions <= 2 else (2, 4, 8, 16), given.repetitions)
    finish(given, {"two_masses": drive_rows, "chains": chain_rows}, "machines", "chains")


if __name__ == "__main__":
    main()
