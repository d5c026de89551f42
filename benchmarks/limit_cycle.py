"""The job that is timed: the limit cycle of a body under PID control, as a scenario and as plain Python equations."""

from __future__ import annotations

import math
from collections.abc import Callable

SCENARIO = """\
schema = 1
name = "limit_cycle"

[law]
name = "lugre_sobczyk"
k_v = 1e7

[law.parameters]
sigma_0 = 1e5
sigma_1 = 316.22776601683796
sigma_2 = 0.4
F_c = 1.0
F_s = 1.5
v_s = 0.001

[plant]
mass = 1.0

[drive]
kind = "pid"
K_p = 3.0
K_i = 4.0
K_d = 6.0

[drive.signal]
kind = "step"
value = 1.0
time = 10.0

[solve]
t_end = 250.0

[output]
step = 0.05
"""

SIGMA_0, SIGMA_1, SIGMA_2 = 1e5, 316.22776601683796, 0.4
F_C, F_S, V_S, K_V = 1.0, 1.5, 0.001, 1e7
MASS, K_P, K_I, K_D, SETPOINT = 1.0, 3.0, 4.0, 6.0, 1.0

START, END, STEP = 10.0, 250.0, 0.05  # the body rests until the setpoint steps at START: the peers begin there
FIRST_ROW, ROWS = 200, 5001  # the row at START, and how many there are from t = 0

TWO_OVER_PI = 2 / math.pi


def rates(t: float, state: list[float]) -> list[float]:
    """dx/dt of x = y, v, w, I from t = START on; w = sigma_0 z, so that one absolute tolerance suits every state."""
    y, v, w, integral = state
    smooth_sign = TWO_OVER_PI * math.atan(K_V * v)
    g = F_C + (F_S - F_C) * math.exp(-((v / V_S) ** 2))  # N
    dz_dt = smooth_sign * v * (smooth_sign - w / g)
    friction = w + SIGMA_1 * dz_dt + SIGMA_2 * v
    error = y - SETPOINT
    return [v, (-K_P * error - K_I * integral - K_D * v - friction) / MASS, SIGMA_0 * dz_dt, error]


def compiled_rates() -> Callable[..., None]:
    """The same equations as a numba C function for numbalsoda; the constants are known to its compiler."""
    import numba
    from numbalsoda import lsoda_sig

    @numba.cfunc(lsoda_sig)
    def function(t, state, derivative, parameters):  # type: ignore[no-untyped-def]
        y, v, w, integral = state[0], state[1], state[2], state[3]
        smooth_sign = TWO_OVER_PI * math.atan(K_V * v)
        g = F_C + (F_S - F_C) * math.exp(-((v / V_S) ** 2))
        dz_dt = smooth_sign * v * (smooth_sign - w / g)
        friction = w + SIGMA_1 * dz_dt + SIGMA_2 * v
        error = y - SETPOINT
        derivative[0] = v
        derivative[1] = (-K_P * error - K_I * integral - K_D * v - friction) / MASS
        derivative[2] = SIGMA_0 * dz_dt
        derivative[3] = error

    return function
