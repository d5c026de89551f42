"""Delay, gravity and direction in fits by simulation."""

import numpy as np
import pytest

import stribeck
from stribeck.identify.data.filters import shifted
from stribeck.identify.log import Log
from stribeck.identify.methods.dynamic import fit_dynamic
from stribeck.identify.methods.motion import RigProblem
from stribeck.identify.models.dynamic_problem import velocity_problem
from stribeck.identify.predict import FittedModel, predict
from tests.identify import rig


@pytest.fixture(scope="module")
def late():
    """A record whose motion lags the force by 2.4 ms."""
    log = rig.measured([*rig.LOOPS, *rig.STROKES])
    return log.with_columns(force=shifted(log.force, 2.4), run=np.zeros(len(log), np.int32))


def test_a_delay_is_fitted_by_simulation_and_predicted_with(late):
    fit = fit_dynamic(late, "lugre", mass=0.0, body=("offset", "delay"), starts=2, start=rig.TRUTH, profiles=False)
    assert fit.body["delay"].value == pytest.approx(2.4e-3, abs=1e-4)
    without = fit_dynamic(late, "lugre", mass=0.0, starts=1, start=rig.TRUTH, profiles=False)
    assert fit.relative_force_error < 0.5 * without.relative_force_error
    values = {**fit.fixed, **fit.used}
    values = {
        n: v
        for n, v in values.items()
        if n in ("offset", "delay", "mass") or n in stribeck.law("lugre", rig.TRUTH).values
    }
    model = FittedModel(
        "lugre", "dynamic", {n: v for n, v in values.items() if v is not None}, None, {}, {}, {}, None, None
    )
    assert predict(model, late).force_error == pytest.approx(fit.relative_force_error, rel=0.2)


def test_a_delay_is_not_drawn_to_where_it_averages_the_force_s_noise():
    """By force 0.49 ms were told at 1 kHz where there is no delay: the measured force was moved, and half a sample between two
    takes a quarter of its noise away."""
    log = rig.measured([*rig.LOOPS, *rig.STROKES[:3]], seed=4)
    fit = fit_dynamic(log, "lugre", mass=0.0, body=("offset", "delay"), starts=1, start=rig.TRUTH, profiles=False)
    assert fit.body["delay"].low <= 0 <= fit.body["delay"].high
    assert fit.body["delay"].high < 3e-4
    assert fit.estimates["sigma_1"].low <= rig.TRUTH["sigma_1"] <= fit.estimates["sigma_1"].high
    without = fit_dynamic(log, "lugre", mass=0.0, starts=1, start=rig.TRUTH, profiles=False)
    assert not any("delay" in note for note in without.notes)


def test_gravity_acts_in_a_fit_of_the_motion():
    """An arm under a force: simulated apart, with SciPy."""
    from scipy.integrate import solve_ivp

    t = np.arange(0, 3, 2e-3)
    push = 3 * np.sin(2 * np.pi * 0.8 * t) + 1.5

    def friction(v):
        return 0.5 * 2 / np.pi * np.arctan(200 * v) + 0.3 * v

    def rates(time, x):
        return [x[1], (np.interp(time, t, push) - friction(x[1]) - 1.2 * np.sin(x[0]) - 0.4 * np.cos(x[0]) - 0.1) / 0.2]

    y, v = solve_ivp(rates, (0, t[-1]), [0.0, 0.0], t_eval=t, rtol=1e-9, atol=1e-10, max_step=2e-3).y
    log = Log(t, y, v, np.gradient(v, 2e-3), push, np.zeros(len(t), np.int32), step=2e-3)
    truth = {"F_c": 0.5, "sigma_2": 0.3, "mass": 0.2, "offset": 0.1, "gravity_sin": 1.2, "gravity_cos": 0.4}
    inverse, *_ = velocity_problem(
        log, "coulomb_viscous", fixed={"k_v": 200.0}, body=("offset", "gravity_sin", "gravity_cos")
    )
    problem = RigProblem(inverse, {"kind": "force"}, "position")
    u = problem.point({**problem.values(problem.home), **truth})
    misfit = problem.misfit(u)
    assert np.sqrt(np.mean(misfit**2)) < 2e-3 * np.ptp(y)
    off = problem.misfit(problem.point({**problem.values(problem.home), **truth, "gravity_sin": 1.0}))
    assert np.sqrt(np.mean(off**2)) > 5e-3 * np.ptp(y)
