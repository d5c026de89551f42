"""The jobs that are timed: as scenarios of this project, and as equations that are written once for all its peers.

The peers' equations are written apart from this project's own, so that equal results mean something.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

import stribeck
from stribeck import examples

Array = NDArray[np.float64]
Rates = Callable[..., Any]  # t, states, what a piece of the motion has of its own -> their rates, a tuple
TWO_OVER_PI = 2 / math.pi


@dataclass(frozen=True)
class Problem:
    """A job: the scenario of this project, and for the peers the equations and their rows. All begin at rest.

    Attributes:
        scenario: this project's.
        columns: of its solution that are compared; the peers' first states are the same.
        equations: makes the right side from somebody's mathematics: math, numpy, casadi, jax.numpy.
        times: of the rows that are compared, s.
        pieces: first and last row of each stretch without a jump, and what the equations are given there.
        scales: of the states, for absolute tolerances.
        width: numbers in each state that the equations are given, if these are arrays.
        neighbors: which states the rate of each depends on, if those are few.
    """

    scenario: stribeck.Scenario
    columns: tuple[str, ...]
    equations: Callable[[Any], Rates] = field(repr=False)
    times: Array
    pieces: tuple[tuple[int, int, tuple[float, ...]], ...]
    scales: Array
    width: int = 1
    neighbors: Any = None

    @property
    def first_row(self) -> int:
        """The row of the scenario at which the peers begin."""
        return self.scenario.rows - len(self.times)


# -- a body under a PID controller, or pulled through a spring: lugre_sobczyk -----------------------------------------

SIGMA_0, SIGMA_1, SIGMA_2 = 1e5, 316.22776601683796, 0.4
F_C, F_S, V_S, K_V = 1.0, 1.5, 0.001, 1e7
MASS = 1.0
K_P, K_I, K_D, SETPOINT, START = 3.0, 4.0, 6.0, 1.0, 10.0
STIFFNESS, PULLING_SPEED = 2.0, 0.1


def friction_by(mathematics: Any) -> Callable[..., tuple[Any, Any]]:
    """dw/dt and F of v, w, k_v and F_s; ``w`` is sigma_0 z, so that one absolute tolerance suits every state."""
    exp, atan = mathematics.exp, mathematics.atan

    def friction(v, w, k_v, F_s):  # type: ignore[no-untyped-def]
        smooth_sign = TWO_OVER_PI * atan(k_v * v)
        g = F_C + (F_s - F_C) * exp(-((v / V_S) ** 2))  # N
        dz_dt = smooth_sign * v * (smooth_sign - w / g)
        return SIGMA_0 * dz_dt, w + SIGMA_1 * dz_dt + SIGMA_2 * v

    return getattr(mathematics, "compiled", lambda function: function)(friction)


def limit_cycle_by(mathematics: Any) -> Rates:
    """A body under PID control; from the step of the setpoint on, until then it rests."""
    friction = friction_by(mathematics)

    def rates(t, state, p):  # type: ignore[no-untyped-def]
        y, v, w, integral = state
        dw_dt, force = friction(v, w, p[0], p[1])
        error = y - SETPOINT
        return v, (-K_P * error - K_I * integral - K_D * v - force) / MASS, dw_dt, error

    return rates


def stick_slip_by(mathematics: Any) -> Rates:
    """A body pulled through a spring whose far end moves at constant speed."""
    friction = friction_by(mathematics)

    def rates(t, state, p):  # type: ignore[no-untyped-def]
        y, v, w = state
        dw_dt, force = friction(v, w, p[0], p[1])
        return v, (STIFFNESS * (PULLING_SPEED * t - y) - force) / MASS, dw_dt

    return rates


def template(
    name: str, equations: Callable[[Any], Rates], order: int, begin: float, end: float, step: float
) -> Problem:
    """A job from a template, of which the peers solve what follows ``begin``, s."""
    scenario = stribeck.load(examples.path(name), {"solve.t_end": end, "output.step": step})
    times = np.arange(round(begin / step), scenario.rows) * step
    return Problem(scenario, ("y",), equations, times, ((0, len(times) - 1, (K_V, F_S)),), np.ones(order))


limit_cycle = partial(template, "limit_cycle", limit_cycle_by, 4, START)
stick_slip = partial(template, "stick_slip", stick_slip_by, 3, 0.0)

# -- a two-mass drive: a motor, a ball screw, a table, friction at both ------------------------------------------------

T_END, STEP = 2.0, 4e-3
TORQUE = ([0.0, 0.2, 0.5, 0.5, 1.0, 1.0, 1.4, 1.7, 2.0], [0.0, 0.25, 0.25, 0.08, 0.08, -0.05, -0.3, -0.3, 0.0])
BEARING = {"sigma_0": 12.0, "sigma_1": 0.04, "sigma_2": 2e-4, "F_c": 0.03, "F_s": 0.045, "v_s": 1.5}
GUIDE = {"sigma_0": 1.5e6, "sigma_1": 4e3, "sigma_2": 150.0, "F_c": 30.0, "F_s": 48.0, "v_s": 4e-3}
RATIO = 0.01 / (2 * math.pi)


def drive_by(mathematics: Any) -> Rates:
    """The drive within a piece of the torque: its begin, the level there, the slope."""
    exp, atan, least, pi = mathematics.exp, mathematics.atan, getattr(mathematics, "fmin", min), math.pi
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


def drive() -> Problem:
    """The drive under a torque that jumps and rises."""
    bearing = {"name": "lugre_majorant", "k_v": 1e4, "parameters": BEARING}
    guide = {"name": "lugre_sobczyk", "k_v": 1e5, "parameters": GUIDE}
    signal = {"kind": "points", "t": TORQUE[0], "value": TORQUE[1]}
    scenario = stribeck.Scenario({
        "schema": 2, "bodies": {"rotor": {"inertia": 1.2e-4}, "table": {"mass": 20.0}},
        "links": {"screw": {"from": "rotor", "to": "table", "ratio": RATIO, "stiffness": 2e7, "damping": 3e3}},
        "contacts": {"bearing": {"from": "rotor", "law": bearing}, "guide": {"from": "table", "law": guide}},
        "loads": {"torque": {"on": "rotor", "kind": "signal", "signal": signal}},
        "solve": {"t_end": T_END}, "output": {"step": STEP},
    })  # fmt: skip
    times, pieces = np.arange(round(T_END / STEP) + 1) * STEP, []
    for (t0, u0), (t1, u1) in pairwise(zip(*TORQUE, strict=True)):
        if t1 > t0:  # else it jumps
            first, last = round(t0 / STEP), round(t1 / STEP)
            times[[first, last]] = t0, t1
            pieces.append((first, last, (t0, u0, (u1 - u0) / (t1 - t0))))
    columns, scales = ("rotor.y", "table.y", "rotor.v", "table.v"), np.array([1e-3, 1e-5, 1.5, 4e-3, 4e-3, 3e-5])
    return Problem(scenario, columns, drive_by, times, tuple(pieces), scales)


# -- bodies in a row, each rubbing on the ground, the first pushed to and fro ------------------------------------------

CHAIN, CHAIN_K_V = {"sigma_0": 1e4, "sigma_1": 30.0, "sigma_2": 1.0, "F_c": 1.0, "F_s": 1.5, "v_s": 0.01}, 1e5
LINK = {"stiffness": 1e3, "damping": 1.0}


def chain_by(mathematics: Any) -> Rates:
    """The chain by arrays of y, v and z of every body."""
    join = getattr(mathematics, "vertcat", None) or mathematics.append
    exp, atan, sin, p, pi = mathematics.exp, mathematics.atan, mathematics.sin, CHAIN, math.pi

    def rates(t: Any, states: Any, _: Any) -> Any:
        y, v, z = states
        m = v * (2 / pi) * atan(CHAIN_K_V * v) + 2 / (pi * CHAIN_K_V)
        g = (p["F_c"] + (p["F_s"] - p["F_c"]) * exp(-((v / p["v_s"]) ** 2))) / p["sigma_0"]
        dz = v - m / g * z
        f = LINK["stiffness"] * (y[:-1] - y[1:]) + LINK["damping"] * (v[:-1] - v[1:])
        push = 5.0 * y.shape[0] * sin(2 * pi * t)
        return v, join(push, f) - join(f, 0.0) - p["sigma_0"] * z - p["sigma_1"] * dz - p["sigma_2"] * v, dz

    return rates


def chain(count: int) -> Problem:
    """The chain of so many bodies."""
    from scipy.sparse import bmat, diags, eye

    law = {"name": "lugre_majorant", "k_v": CHAIN_K_V, "parameters": CHAIN}
    signal = {"kind": "sine", "amplitude": 5.0 * count, "frequency": 1.0}
    scenario = stribeck.Scenario({
        "schema": 2, "bodies": {f"m{i}": {"mass": 1.0} for i in range(count)},
        "links": {f"k{i}": {"from": f"m{i}", "to": f"m{i + 1}", **LINK} for i in range(count - 1)},
        "contacts": {f"c{i}": {"from": f"m{i}", "law": law} for i in range(count)},
        "loads": {"push": {"on": "m0", "kind": "signal", "signal": signal}},
        "solve": {"t_end": 1.0}, "output": {"step": 5e-3},
    })  # fmt: skip
    near, one = diags([1.0, 1.0, 1.0], [-1, 0, 1], shape=(count, count)), eye(count)
    pattern = (bmat([[None, one, None], [near, near, one], [None, one, one]]) != 0).astype(float)
    columns = tuple(f"m{i}.{x}" for x in "yv" for i in range(count))
    scales = np.repeat([1e-4, 1e-2, 1.5e-4], count)
    times = np.arange(201) * 5e-3
    return Problem(
        scenario, columns, chain_by, times, ((0, 200, ()),), scales, count, (pattern + eye(3 * count)).tocsc()
    )
