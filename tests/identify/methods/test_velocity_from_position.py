"""Fits of a velocity that is the slope of a measured position: its noise is not white, and hides presliding."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import stribeck
from stribeck.identify.data.filters import low_pass, spline_derivative
from stribeck.identify.log import Log
from stribeck.identify.models.motion_problem import output_noise

TRUTH = {
    "sigma_0": 81731.5,
    "sigma_1": 330.011,
    "sigma_2": 0.494427,
    "F_c": 0.925088,
    "F_s": 1.21547,
    "v_s": 1.27498e-3,
}
MASS, STEP = 1.1, 2e-3


def recorded(seed, seconds=20.0):
    """LuGre's equations by SciPy: a body under a sine of force, positions with 1 um of noise at 500 Hz."""
    s0, s1, s2, f_c, f_s, v_s = (TRUTH[n] for n in ("sigma_0", "sigma_1", "sigma_2", "F_c", "F_s", "v_s"))

    def force(t):
        return 2.054 * np.sin(2 * np.pi * 0.384013 * t)

    def rates(t, state):
        _, v, z = state
        slip = v - s0 * abs(v) / (f_c + (f_s - f_c) * np.exp(-((v / v_s) ** 2))) * z
        return v, (force(t) - s0 * z - s1 * slip - s2 * v) / MASS, slip

    t = np.arange(0, seconds + STEP / 2, STEP)
    found = solve_ivp(
        rates, (0, t[-1]), [0, 0, 0], "LSODA", t_eval=t, rtol=1e-9, atol=[1e-12, 1e-11, 1e-13], max_step=2e-3
    )
    return {"t": t, "x": found.y[0] + 1e-6 * np.random.default_rng(seed).standard_normal(len(t)), "F": force(t)}


def test_the_noise_of_a_slope_is_that_of_the_position_behind_the_filter():
    rng = np.random.default_rng(1)
    t = np.arange(0, 20, STEP)
    noise = low_pass(1e-6 * rng.standard_normal(len(t)), 120.0, STEP)
    true = np.sin(3 * t)
    position = true + 1e-6 * rng.standard_normal(len(t))
    v, nothing = 3 * np.cos(3 * t), np.zeros(len(t))
    log = Log(
        t, true, v + spline_derivative(noise, STEP), nothing, nothing, np.zeros(len(t), np.int32), unfiltered=position,
        step=STEP, bandwidth=120.0, sources={"unfiltered": "position"},
    )  # fmt: skip
    assert output_noise(log, "velocity") == pytest.approx(np.std(log.velocity - v), rel=0.05)
    assert output_noise(log, "position") == pytest.approx(1e-6, rel=0.05)


@pytest.mark.thorough
def test_bristles_that_noise_hides_are_not_told_wrongly():
    fit = stribeck.fit(
        recorded(1), "lugre", time="t", position="x", force="F", method="dynamic", output="velocity", mass=MASS
    )
    for name, truth in TRUTH.items():
        estimate = fit.estimates[name]
        if estimate.identifiable:
            assert estimate.low <= truth <= estimate.high, name
    assert fit.estimates["sigma_0"].value == pytest.approx(TRUTH["sigma_0"], rel=0.2)
    assert fit.estimates["F_c"].identifiable
