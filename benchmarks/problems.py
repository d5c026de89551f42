"""The jobs that are timed: as templates of this project, and as equations that are written once for all its peers.

The peers' equations are written apart from this project's own, so that equal results mean something. ``w`` is sigma_0 z,
so that one absolute tolerance suits every state.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

import stribeck
from stribeck import examples

SIGMA_0, SIGMA_1, SIGMA_2 = 1e5, 316.22776601683796, 0.4
F_C, F_S, V_S, K_V = 1.0, 1.5, 0.001, 1e7
MASS = 1.0
K_P, K_I, K_D, SETPOINT, START = 3.0, 4.0, 6.0, 1.0, 10.0
STIFFNESS, PULLING_SPEED = 2.0, 0.1
TWO_OVER_PI = 2 / math.pi

Rates = Callable[..., Any]  # t, state, k_v, F_s -> dx/dt, a tuple
Friction = Callable[..., tuple[Any, Any]]  # v, w, k_v, F_s -> dw/dt, F


def friction_by(mathematics: ModuleType) -> Friction:
    """dw/dt and F of lugre_sobczyk with somebody's exp and atan: math, casadi or jax.numpy."""
    exp, atan = mathematics.exp, mathematics.atan

    def friction(v, w, k_v, F_s):  # type: ignore[no-untyped-def]
        smooth_sign = TWO_OVER_PI * atan(k_v * v)
        g = F_C + (F_s - F_C) * exp(-((v / V_S) ** 2))  # N
        dz_dt = smooth_sign * v * (smooth_sign - w / g)
        return SIGMA_0 * dz_dt, w + SIGMA_1 * dz_dt + SIGMA_2 * v

    return friction


def limit_cycle_by(friction: Friction) -> Rates:
    """A body under PID control; from the step of the setpoint on, until then it rests."""

    def rates(t, state, k_v=K_V, F_s=F_S):  # type: ignore[no-untyped-def]
        y, v, w, integral = state
        dw_dt, force = friction(v, w, k_v, F_s)
        error = y - SETPOINT
        return v, (-K_P * error - K_I * integral - K_D * v - force) / MASS, dw_dt, error

    return rates


def stick_slip_by(friction: Friction) -> Rates:
    """A body pulled through a spring whose far end moves at constant speed."""

    def rates(t, state, k_v=K_V, F_s=F_S):  # type: ignore[no-untyped-def]
        y, v, w = state
        dw_dt, force = friction(v, w, k_v, F_s)
        return v, (STIFFNESS * (PULLING_SPEED * t - y) - force) / MASS, dw_dt

    return rates


@dataclass(frozen=True)
class Problem:
    """A job: the scenario of this project, and for the peers the equations and where they begin.

    Attributes:
        name: of the template.
        end, step: of the rows, s.
        equations: makes the right side from somebody's friction.
        order: how many states there are.
        first_row: the row at which the peers begin, all states being 0.
    """

    name: str
    end: float
    step: float
    equations: Callable[[Friction], Rates] = field(repr=False)
    order: int
    first_row: int = 0

    @property
    def scenario(self) -> stribeck.Scenario:
        """This project's scenario."""
        return stribeck.load(examples.path(self.name), {"solve.t_end": self.end, "output.step": self.step})

    @property
    def times(self) -> NDArray[np.float64]:
        """The times of the rows that are compared, s."""
        scenario = self.scenario
        return np.arange(self.first_row, scenario.rows) * scenario.output.step

    @property
    def rest(self) -> NDArray[np.float64]:
        """The peers' first state."""
        return np.zeros(self.order)

    def rates(self) -> Rates:
        """The right side in plain Python."""
        return self.equations(friction_by(math))

    def compiled_rates(self) -> Any:
        """The right side as a numba C function for numbalsoda, its data being k_v and F_s."""
        import numba
        from numbalsoda import lsoda_sig

        rates, order = numba.njit(self.equations(numba.njit(friction_by(math)))), self.order

        @numba.cfunc(lsoda_sig)
        def function(t, x, derivative, data):  # type: ignore[no-untyped-def]
            state = (x[0], x[1], x[2], x[3]) if order == 4 else (x[0], x[1], x[2])
            result = rates(t, state, data[0], data[1])
            for i in range(order):
                derivative[i] = result[i]

        return function


def limit_cycle(end: float, step: float = 0.05) -> Problem:
    """The limit cycle up to t = end, s."""
    return Problem("limit_cycle", end, step, limit_cycle_by, 4, round(START / step))


def stick_slip(end: float, step: float = 0.01) -> Problem:
    """Stick-slip up to t = end, s."""
    return Problem("stick_slip", end, step, stick_slip_by, 3)


LIMIT_CYCLE = limit_cycle(250.0)
