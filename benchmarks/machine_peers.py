"""Other solvers of the machines in machines.py: CasADi's CVODES, numbalsoda, and CVODE with a sparse Jacobian."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
MOST_STEPS = 10**7


class Missing(Exception):
    """A package that is not installed."""


def piece_rows(t0: float, t1: float, rows: Array, t_end: float) -> Array:
    """The rows from t0 on and before t1 (with it at the end)."""
    return rows[(rows >= t0 - 1e-9) & ((rows < t1 - 1e-9) | (t1 == t_end))]


def by_pieces(
    torque: tuple[list[float], list[float]], rows: Array, states: int, solve: Callable[[Array, Array, tuple[float, ...]], Array]
) -> Array:  # fmt: skip
    """The states at the rows, one run for each piece of the torque; ``solve(times, x, (t0, level, slope))``."""
    x, found = np.zeros(states), []
    for (t0, u0), (t1, u1) in pairwise(zip(*torque, strict=True)):
        if t1 == t0:
            continue
        inner = piece_rows(t0, t1, rows, torque[0][-1])
        times = np.concatenate([[t0], inner[(inner > t0 + 1e-9) & (inner < t1 - 1e-9)], [t1]])
        every = solve(times, x, (t0, u0, (u1 - u0) / (t1 - t0)))
        x = every[-1]
        keep = np.array([np.min(np.abs(inner - t)) < 1e-9 if len(inner) else False for t in times])
        found.append(every[keep][: len(inner)])
    return np.concatenate(found)


def casadi_drive(
    equations: Callable[..., Sequence[Any]], torque: Any, rows: Array, scales: Array
) -> Callable[[float], Array]:
    """CVODES through CasADi: symbolic equations, derived Jacobian; one absolute tolerance for states scaled to 1."""
    import casadi

    t, x, p = casadi.SX.sym("t"), casadi.SX.sym("x", len(scales)), casadi.SX.sym("p", 3)
    functions = {"exp": casadi.exp, "atan": casadi.atan, "min": casadi.fmin}
    rates = equations(
        t, [xi * s for xi, s in zip(casadi.vertsplit(x), scales, strict=True)], casadi.vertsplit(p), functions
    )
    ode = {"t": t, "x": x, "p": p, "ode": casadi.vertcat(*(r / s for r, s in zip(rates, scales, strict=True)))}

    @cache
    def integrator(times: tuple[float, ...], rtol: float) -> Any:
        options = {"reltol": rtol, "abstol": rtol, "max_num_steps": MOST_STEPS, "show_eval_warnings": False}
        return casadi.integrator("rows", "cvodes", ode, times[0], list(times[1:]), options)

    def solve(rtol: float) -> Array:
        def piece(times: Array, x0: Array, q: tuple[float, ...]) -> Array:
            found = integrator(tuple(times.tolist()), rtol)(x0=x0 / scales, p=q)["xf"]
            return np.vstack([x0, np.asarray(found).T * scales])

        return by_pieces(torque, rows, len(scales), piece)

    return solve


def numbalsoda_drive(
    equations: Callable[..., Sequence[Any]], torque: Any, rows: Array, scales: Array
) -> Callable[[float], Array]:
    """numbalsoda's LSODA, the equations compiled by numba; one absolute tolerance for states scaled to 1."""
    try:
        from numbalsoda import lsoda, lsoda_sig
    except ImportError as error:
        raise Missing("numbalsoda") from error
    import numba as nb

    code = _as_source(equations, scales)
    scope: dict[str, Any] = {"nb": nb, "lsoda_sig": lsoda_sig}
    exec(code, scope)
    function = scope["rates"]

    def solve(rtol: float) -> Array:
        def piece(times: Array, x0: Array, q: tuple[float, ...]) -> Array:
            found, good = lsoda(
                function.address, x0 / scales, times, data=np.array(q), rtol=rtol, atol=rtol, mxstep=MOST_STEPS
            )
            if not good:
                raise ArithmeticError("numbalsoda failed")
            return np.asarray(found * scales)

        return by_pieces(torque, rows, len(scales), piece)

    return solve


def _as_source(equations: Callable[..., Sequence[Any]], scales: Array) -> str:
    """The equations as a function that numba compiles, traced from the same Python function."""

    class Text(str):
        def __new__(cls, text: object) -> Text:
            return str.__new__(cls, text)

        def _two(self, sign: str, other: object, swap: bool = False) -> Text:
            a, b = (other, self) if swap else (self, other)
            return Text(f"({a} {sign} {b})")

        __add__ = lambda s, o: s._two("+", o)  # noqa: E731
        __radd__ = lambda s, o: s._two("+", o, True)  # noqa: E731
        __sub__ = lambda s, o: s._two("-", o)  # noqa: E731
        __rsub__ = lambda s, o: s._two("-", o, True)  # noqa: E731
        __mul__ = lambda s, o: s._two("*", o)  # noqa: E731
        __rmul__ = lambda s, o: s._two("*", o, True)  # noqa: E731
        __truediv__ = lambda s, o: s._two("/", o)  # noqa: E731
        __rtruediv__ = lambda s, o: s._two("/", o, True)  # noqa: E731
        __pow__ = lambda s, o: s._two("**", o)  # noqa: E731
        __neg__ = lambda s: Text(f"(-{s})")  # noqa: E731

    functions = {n: (lambda *a, n=n: Text(f"{n}({', '.join(map(str, a))})")) for n in ("exp", "atan", "min")}
    x = [Text(f"(x_[{i}] * {s!r})") for i, s in enumerate(scales.tolist())]
    rates = equations(Text("t"), x, [Text(f"p_[{i}]") for i in range(3)], functions)
    body = "".join(f"    dx_[{i}] = {r} / {s!r}\n" for i, (r, s) in enumerate(zip(rates, scales.tolist(), strict=True)))
    head = "from math import atan, exp\n@nb.cfunc(lsoda_sig)\ndef rates(t, x, dx, p):\n"
    return f"{head}    x_, dx_, p_ = nb.carray(x, ({len(x)},)), nb.carray(dx, ({len(x)},)), nb.carray(p, (3,))\n{body}"


def chain_equations(
    count: int, p: dict[str, float], k_v: float, stiffness: float, damping: float
) -> Callable[..., Any]:
    """The chain with arrays: y, v and z of every body, the push on the first."""

    def rates(t: float, x: Array) -> Array:
        y, v, z = x[:count], x[count : 2 * count], x[2 * count :]
        m = v * (2 / pi) * np.arctan(k_v * v) + 2 / (pi * k_v)
        g = (p["F_c"] + (p["F_s"] - p["F_c"]) * np.exp(-((v / p["v_s"]) ** 2))) / p["sigma_0"]
        dz = v - m / g * z
        force = np.zeros(count)
        force[0] = 5.0 * count * np.sin(2 * pi * t)
        f = stiffness * (y[:-1] - y[1:]) + damping * (v[:-1] - v[1:])
        force[:-1] -= f
        force[1:] += f
        return np.concatenate([v, force - p["sigma_0"] * z - p["sigma_1"] * dz - p["sigma_2"] * v, dz])

    return rates


def sparse_chain(count: int, p: dict[str, float], k_v: float, stiffness: float, damping: float, rows: Array,
                 scales: Array) -> Callable[[float], Array]:  # fmt: skip
    """SUNDIALS CVODE through scikit-sundae: NumPy equations, sparse Jacobian by grouped differences, SuperLU."""
    try:
        from sksundae.cvode import CVODE
    except ImportError as error:
        raise Missing("scikit-sundae") from error
    from scipy.sparse import bmat, diags, eye

    rates = chain_equations(count, p, k_v, stiffness, damping)
    near, one = diags([1.0, 1.0, 1.0], [-1, 0, 1], shape=(count, count)), eye(count)
    pattern = (bmat([[None, one, None], [near, near, one], [None, one, one]]) != 0).astype(float)
    n = 3 * count
    own = np.concatenate([np.full(count, scales[0]), np.full(count, scales[1]), np.full(count, scales[2])])

    def right_side(t: float, x: Array, dx: Array) -> None:
        dx[:] = rates(t, x)

    def solve(rtol: float) -> Array:
        solver = CVODE(
            right_side,
            rtol=rtol,
            atol=rtol * own,
            max_num_steps=MOST_STEPS,
            linsolver="sparse",
            sparsity=(pattern + eye(n)).tocsc(),
        )
        found = solver.solve(rows, np.zeros(n))
        if not found.success:
            raise ArithmeticError(found.message)
        return np.asarray(found.y[:, : 2 * count])

    return solve


def casadi_chain(count: int, p: dict[str, float], k_v: float, stiffness: float, damping: float, rows: Array,
                 scales: Array) -> Callable[[float], Array]:  # fmt: skip
    """CVODES through CasADi: symbolic equations, derived sparse Jacobian, sparse direct solver."""
    import casadi

    t, x = casadi.SX.sym("t"), casadi.SX.sym("x", 3 * count)
    own = np.concatenate([np.full(count, s) for s in scales])
    xs = [xi * s for xi, s in zip(casadi.vertsplit(x), own, strict=True)]
    y, v, z = xs[:count], xs[count : 2 * count], xs[2 * count :]
    force: list[Any] = [0.0] * count
    force[0] = 5.0 * count * casadi.sin(2 * pi * t)
    for i in range(count - 1):
        f = stiffness * (y[i] - y[i + 1]) + damping * (v[i] - v[i + 1])
        force[i], force[i + 1] = force[i] - f, force[i + 1] + f
    rates: list[Any] = [*v]
    dz = []
    for vi, zi in zip(v, z, strict=True):
        m = vi * (2 / pi) * casadi.atan(k_v * vi) + 2 / (pi * k_v)
        dz.append(vi - m * p["sigma_0"] / (p["F_c"] + (p["F_s"] - p["F_c"]) * casadi.exp(-((vi / p["v_s"]) ** 2))) * zi)
    for fi, vi, zi, di in zip(force, v, z, dz, strict=True):
        rates.append(fi - p["sigma_0"] * zi - p["sigma_1"] * di - p["sigma_2"] * vi)
    ode = {"t": t, "x": x, "ode": casadi.vertcat(*(r / s for r, s in zip([*rates, *dz], own, strict=True)))}

    @cache
    def integrator(rtol: float) -> Any:
        options = {"reltol": rtol, "abstol": rtol, "max_num_steps": MOST_STEPS, "show_eval_warnings": False}
        return casadi.integrator("rows", "cvodes", ode, rows[0], rows[1:].tolist(), options)

    def solve(rtol: float) -> Array:
        found = np.asarray(integrator(rtol)(x0=np.zeros(3 * count))["xf"]).T * own
        return np.vstack([np.zeros(3 * count), found])[:, : 2 * count]

    return solve
